//! Advice from a result table, based on the roles of its columns.
//!
//! For each condition, the advised row is the cheapest choice whose value meets a bound, or the best choice within a budget.

use crate::error::{Error, Result};
use crate::report::swept::{Setting, Swept};
use crate::table::{Better, Column, Role, Scale, Table, Value, column_name, front};
use std::collections::HashSet;

/// Selector of a value or cost column of a table, by role and name.
struct ColumnSelector {
    /// Name of the command-line option that selects the column, for error messages.
    option: &'static str,
    /// Name of the default column, used if no name is given and at least one table has the column. Otherwise, the first column with the role is used.
    usual: &'static str,
    has_role: fn(Role) -> bool,
    /// Column names that all kinds of studies accept, each with the actual names in the different kinds.
    shared: &'static [(&'static str, &'static [&'static str])],
}

const VALUE: ColumnSelector = ColumnSelector {
    option: "--value",
    usual: "accuracy",
    has_role: |role| matches!(role, Role::Value(Better::More | Better::Less)),
    shared: &[],
};

const COST: ColumnSelector = ColumnSelector {
    option: "--cost",
    usual: "decision_time",
    has_role: |role| role == Role::Cost,
    shared: &[
        ("decision_time", &["predict_us_per_decision", "decision_us"]),
        ("training_time", &["fit_s"]),
        ("taxels", &["taxels", "n_taxels"]),
        (
            "measurements",
            &["measurements_per_decision", "measurements"],
        ),
    ],
};

/// Query for advice about a design; fields that are `None` are filled in automatically.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AdviceQuery {
    /// File name of the table to search.
    pub table: Option<String>,
    /// Name of the value column to optimise.
    pub value: Option<String>,
    /// Name of the cost column to minimise: a column name, or a short name that all kinds of studies accept.
    pub cost: Option<String>,
    /// Fixed conditions, each as text of the form `noise=0.05`.
    pub given: Vec<String>,
    /// Upper bounds of cost columns, as pairs (column name, bound); choices above a bound are omitted.
    pub limits: Vec<(String, f64)>,
}

/// Requirement of the user: a bound on the value or on a cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Requirement {
    /// Minimum of the value: the cheapest choice that reaches at least this value is selected.
    Value(f64),
    /// Maximum of the cost, positive: the choice with the best value within this budget is selected.
    Budget(f64),
    /// No requirement: the choice with the best value is selected at any cost.
    Best,
}

/// Candidate for advice: a row of the table, with its value and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Index of the candidate's row in the table.
    pub row: usize,
    /// Value of the candidate, in the unit of the value column.
    pub value: f64,
    /// Cost of the candidate, in the unit of the cost column.
    pub cost: f64,
}

/// Advice under one condition: the advised choice and its alternatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advice {
    /// Advised choice: the cheapest candidate with a sufficient value, or the best candidate within the budget.
    pub choice: Candidate,
    /// Cheapest choice whose whole confidence interval meets the requirement; `None` if there is none or if it equals `choice`.
    pub certain: Option<Candidate>,
    /// Cheapest candidate with a better value than `choice`.
    pub next_up: Option<Candidate>,
}

/// Rows of one table from which advice is selected, restricted to the given conditions.
pub struct Candidates<'a> {
    /// Table that contains the candidates.
    pub table: &'a Table,
    /// Value column to optimise.
    pub value: &'a Column,
    /// Cost column whose values should be small.
    pub cost: &'a Column,
    swept: Swept<'a>,
    /// Indices of the rows that satisfy the given conditions and have both a value and a cost.
    rows: Vec<usize>,
}

impl<'a> Candidates<'a> {
    /// Returns the candidates from the first table that contains choices and the requested value and cost columns.
    ///
    /// # Errors
    /// If no table has these columns, or a condition or a cost limit is not valid for the table.
    pub fn new(tables: &'a [Table], asked: &AdviceQuery) -> Result<Self> {
        let mut offering: Vec<&Table> = tables.iter().filter(|t| t.offers_choices()).collect();
        let has_several = offering.iter().any(|table| table.n_rows > 1);
        offering.retain(|table| table.n_rows > 1 || !has_several);
        if offering.is_empty() {
            let allowed = "a study with a table of choices that have a value and a cost";
            return Err(Error::input("advice", "no table offers choices", allowed));
        }
        if let Some(file) = &asked.table {
            let known = offering.iter().map(|table| table.file).collect();
            offering.retain(|table| table.file == file);
            refuse_none(&offering, ("--table", file), known)?;
        }
        let value = VALUE.narrow(&mut offering, asked.value.as_deref())?;
        let cost = COST.narrow(&mut offering, asked.cost.as_deref())?;
        let value = |table: &'a Table| VALUE.columns(table, value)[0];
        // Among several tables, one whose values have confidence intervals is preferred.
        let has_interval = |table: &&&'a Table| value(table).interval.is_some();
        let table = *offering.iter().find(has_interval).unwrap_or(&offering[0]);
        let mut found = Self::of_columns(table, value(table), COST.columns(table, cost)[0]);
        let rows = (0..table.n_rows).collect();
        let mut given = asked.given.iter();
        let rows: Vec<usize> = given.try_fold(rows, |rows, text| given_rows(table, rows, text))?;
        found.rows.retain(|row| rows.binary_search(row).is_ok());
        for (name, most) in &asked.limits {
            found.limit(name, *most)?;
        }
        Ok(found)
    }

    /// Removes all candidates whose cost in the named column is absent or exceeds `most`.
    ///
    /// # Errors
    /// If no such cost column exists, the limit is not a positive number, or no row satisfies the limit.
    fn limit(&mut self, name: &str, most: f64) -> Result<()> {
        let columns = COST.columns(self.table, Some(name));
        let known = COST.columns(self.table, None).into_iter();
        refuse_none(
            &columns,
            ("limit of", name),
            known.map(|column| &column.name[..]).collect(),
        )?;
        let column = columns[0];
        let of = |row: &usize| self.table.number(&column.name, *row);
        let refuse = |allowed: String| {
            let place = format!("limit of {}", column.words);
            Error::input(place, column.phrase(&Value::Number(most)), allowed)
        };
        if !(most > 0.0 && most.is_finite()) {
            return Err(refuse("a positive number".to_owned()));
        }
        let kept: Vec<usize> = self
            .rows
            .iter()
            .copied()
            .filter(|row| of(row) <= most)
            .collect();
        if kept.is_empty() {
            let least = self.rows.iter().map(of).fold(f64::INFINITY, f64::min);
            let least = column.phrase(&Value::Number(least));
            return Err(refuse(format!("the smallest here is {least}")));
        }
        self.rows = kept;
        Ok(())
    }

    /// Creates candidates from all rows of a table that have both a value and a cost.
    pub fn of_columns(table: &'a Table, value: &'a Column, cost: &'a Column) -> Self {
        let rows: Vec<usize> = (0..table.n_rows).collect();
        let mut found = Self {
            table,
            value,
            cost,
            swept: Swept::new(table, &rows),
            rows: Vec::new(),
        };
        let is_known = |row: &usize| found.offer(*row).is_some();
        found.rows = rows.into_iter().filter(is_known).collect();
        found
    }

    /// Returns the candidate of a row; `None` if its value or cost is absent.
    fn offer(&self, row: usize) -> Option<Candidate> {
        let value = self.table.number(&self.value.name, row);
        let cost = self.table.number(&self.cost.name, row);
        let is_known = value.is_finite() && cost.is_finite();
        is_known.then_some(Candidate { row, value, cost })
    }

    /// Returns the candidates in one group per condition, in the order in which the conditions first occur in the table.
    pub fn by_condition(&self) -> Vec<Vec<Candidate>> {
        let conditions = self.swept.by_condition(&self.rows).into_iter();
        let offers =
            |rows: Vec<usize>| rows.into_iter().filter_map(|row| self.offer(row)).collect();
        conditions.map(offers).collect()
    }

    /// Returns, for each choice, a candidate that has the worst value and the highest cost over all conditions. Choices that were not measured in every
    /// condition are omitted.
    pub fn worst(&self) -> Vec<Candidate> {
        let n_conditions = self.swept.by_condition(&self.rows).len();
        let choices = self.swept.of_role(Role::Choice);
        let choices = self.swept.groups(&choices, &self.rows).into_iter();
        let measured = choices.filter(|rows| rows.len() == n_conditions);
        let worst = |rows: Vec<usize>| {
            let offers = rows.iter().filter_map(|&row| self.offer(row));
            offers.reduce(|a, b| {
                let worse = if self.is_better(a.value, b.value) {
                    b
                } else {
                    a
                };
                let cost = a.cost.max(b.cost);
                Candidate { cost, ..worse }
            })
        };
        measured.filter_map(worst).collect()
    }

    /// Returns the advice for a requirement, selected from the candidates under one condition.
    ///
    /// # Errors
    /// If the requirement is out of range, there are no candidates, or no candidate meets the requirement; the error names the nearest candidate.
    pub fn advise(&self, offers: &[Candidate], wish: Requirement) -> Result<Advice> {
        let (column, wanted, place) = match wish {
            Requirement::Value(wanted) => (self.value, wanted, "wish"),
            Requirement::Budget(most) => (self.cost, most, "budget"),
            Requirement::Best => (self.cost, f64::INFINITY, "budget"),
        };
        let given = column.phrase(&Value::Number(wanted));
        let refuse = |allowed: String| Error::input(place, &given, allowed);
        let is_share = column.scale == Scale::Share;
        let (is_in_range, range) = match wish {
            Requirement::Value(share) if is_share => {
                (share > 0.0 && share <= 1.0, "more than 0, at most 1")
            }
            Requirement::Value(wanted) => (wanted.is_finite(), "a number"),
            Requirement::Budget(most) => (most > 0.0 && most.is_finite(), "a positive number"),
            Requirement::Best => (true, ""),
        };
        if !is_in_range {
            return Err(refuse(range.to_owned()));
        }
        let front = self.front(offers);
        let (Some(cheapest), Some(best)) = (front.first(), front.last()) else {
            return Err(refuse(
                "at least one choice whose value and cost are known".to_owned(),
            ));
        };
        let place = match wish {
            Requirement::Value(wanted) => front
                .iter()
                .position(|offer| self.is_enough(offer.value, wanted)),
            Requirement::Budget(most) => front.iter().rposition(|offer| offer.cost <= most),
            Requirement::Best => Some(front.len() - 1),
        };
        let Some(place) = place else {
            return Err(refuse(match wish {
                Requirement::Value(_) => format!("the best here is {}", self.in_words(best)),
                Requirement::Budget(_) | Requirement::Best => {
                    format!("the cheapest here is {}", self.in_words(cheapest))
                }
            }));
        };
        let certain = match wish {
            Requirement::Value(wanted) if self.value.interval.is_some() => {
                let offers = offers.iter().copied();
                let certain = offers.filter(|offer| self.is_enough(self.worse_end(offer), wanted));
                let certain = self.front(&certain.collect::<Vec<_>>());
                let cheapest = certain.first().copied();
                cheapest.filter(|cheapest| *cheapest != front[place])
            }
            _ => None,
        };
        Ok(Advice {
            choice: front[place],
            certain,
            next_up: front.get(place + 1).copied(),
        })
    }

    /// Returns the Pareto front, cheapest first: each candidate on the front is better than all candidates of equal or lower cost. Among equal candidates, only
    /// the first is returned.
    pub fn front(&self, offers: &[Candidate]) -> Vec<Candidate> {
        let points: Vec<(f64, f64)> = offers.iter().map(|o| (o.cost, o.value)).collect();
        let is_on = front(&points, |a, b| self.is_better(a, b));
        let on = offers.iter().zip(is_on).filter(|(_, is_on)| *is_on);
        let mut front: Vec<Candidate> = on.map(|(offer, _)| *offer).collect();
        // The sort is stable: among equal candidates, the first stays first.
        front.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        front.dedup_by_key(|offer| offer.cost);
        front
    }

    fn wants_less(&self) -> bool {
        self.value.role == Role::Value(Better::Less)
    }

    fn is_better(&self, a: f64, b: f64) -> bool {
        if self.wants_less() { a < b } else { a > b }
    }

    fn is_enough(&self, value: f64, wanted: f64) -> bool {
        value == wanted || self.is_better(value, wanted)
    }

    /// Returns the worse end of the confidence interval of a candidate's value; NaN without an interval.
    fn worse_end(&self, offer: &Candidate) -> f64 {
        let ends = self.table.interval(self.value, offer.row);
        ends.map_or(
            f64::NAN,
            |[low, high]| if self.wants_less() { high } else { low },
        )
    }

    /// Returns the value, interval and cost of a candidate as text, such as `accuracy 0.830 (0.800 to 0.860), time of a decision 210 µs`.
    pub fn gives(&self, offer: &Candidate) -> String {
        let interval = match self.table.interval(self.value, offer.row) {
            Some(ends) => {
                let [low, high] = ends.map(|end| self.value_words(end));
                format!(" ({low} to {high})")
            }
            None => String::new(),
        };
        let value = self.value_words(offer.value);
        let cost = self.cost.phrase(&Value::Number(offer.cost));
        format!("{} {value}{interval}, {cost}", self.value.words)
    }

    /// Formats a value of the value column, or a difference between two such values. Fractions have three decimal places.
    pub fn value_words(&self, value: f64) -> String {
        match self.value.scale == Scale::Share && self.value.unit.is_empty() {
            true => format!("{value:.3}"),
            false => self.value.number_words(value),
        }
    }

    /// Returns the value, cost and choices of a candidate as text, such as `accuracy 0.830, time of a decision 210 µs: RBF SVM, m = 64`.
    pub fn in_words(&self, offer: &Candidate) -> String {
        format!("{}: {}", self.gives(offer), self.setting(offer))
    }

    /// Returns the choices of a candidate as text, or "the only setting" if no choice varies in the table.
    pub fn setting(&self, offer: &Candidate) -> String {
        match self.choices(offer) {
            words if words.is_empty() => "the only setting".to_owned(),
            words => words,
        }
    }

    /// Returns the choices of a candidate as text; empty if no choice varies in the table.
    pub fn choices(&self, offer: &Candidate) -> String {
        self.swept.choice_words(offer.row)
    }

    /// Returns the condition of a candidate as text; empty if the table has only one condition.
    pub fn condition(&self, offer: &Candidate) -> String {
        self.swept.condition_words(offer.row)
    }

    /// Returns the candidate as a JSON object: choices and condition as text, and the entries of all columns by name.
    pub fn json(&self, offer: &Candidate) -> serde_json::Value {
        let mut row = serde_json::Map::new();
        row.insert("setting".to_owned(), self.setting(offer).into());
        row.insert("condition".to_owned(), self.condition(offer).into());
        for Setting { column, data } in Setting::all(self.table) {
            let value = serde_json::json!(data.value(offer.row));
            row.insert(column.name.to_string(), value);
        }
        row.insert(self.cost.name.to_string(), offer.cost.into());
        row.into()
    }
}

impl ColumnSelector {
    /// Returns the numeric columns of a table with the given name; if no name is given, all numeric columns with the required role. Columns that vary come
    /// first.
    fn columns<'t>(&self, table: &'t Table, name: Option<&str>) -> Vec<&'t Column> {
        let shared = self.shared.iter().find(|(known, _)| Some(*known) == name);
        let is_named = |column: &str| match name {
            Some(name) => {
                name == column || shared.is_some_and(|(_, columns)| columns.contains(&column))
            }
            None => true,
        };
        let is_sought = |one: &Setting| {
            (self.has_role)(one.column.role) && is_named(&one.column.name) && one.is_number()
        };
        let mut found: Vec<Setting> = Setting::all(table).filter(is_sought).collect();
        found.sort_by_key(|one| !one.data.varies(0..table.n_rows));
        found.into_iter().map(|one| one.column).collect()
    }

    /// Removes the tables that lack a requested column. Without a request, the default column is required if any table has it. Returns the required name.
    fn narrow<'n>(
        &self,
        tables: &mut Vec<&Table>,
        asked: Option<&'n str>,
    ) -> Result<Option<&'n str>> {
        let has = |table: &&Table, name| !self.columns(table, name).is_empty();
        let usual = Some(self.usual).filter(|usual| tables.iter().any(|t| has(t, Some(usual))));
        let name = asked.or(usual);
        let all = tables.iter().flat_map(|table| self.columns(table, None));
        let mut known: Vec<&str> = all.map(|column| &column.name[..]).collect();
        known.extend(self.shared.iter().map(|(name, _)| name));
        tables.retain(|table| has(table, name));
        refuse_none(tables, (self.option, name.unwrap_or_default()), known)?;
        Ok(name)
    }
}

fn refuse_none<T>(found: &[T], (option, given): (&str, &str), mut known: Vec<&str>) -> Result<()> {
    let mut told = HashSet::new();
    known.retain(|name| told.insert(*name));
    match found.is_empty() {
        true => Err(Error::input(
            option,
            given,
            format!("one of {}", known.join(", ")),
        )),
        false => Ok(()),
    }
}

/// Returns the given rows that satisfy a condition of the form `noise=0.05`.
fn given_rows(table: &Table, rows: Vec<usize>, text: &str) -> Result<Vec<usize>> {
    let refuse = || Error::input("--given", text, "a condition and its value: noise=0.05");
    let (key, value) = text.split_once('=').ok_or_else(refuse)?;
    let (key, value) = (column_name(key.trim()), value.trim());
    if key.is_empty() || value.is_empty() {
        return Err(refuse());
    }
    let place = format!("--given {key}");
    match table.column(key).map(|(column, _)| column.role) {
        Some(Role::Condition) => {}
        Some(Role::Choice) => {
            let allowed = "a condition of the world; choices are what is advised";
            return Err(Error::input(place, "is a choice", allowed));
        }
        _ => {
            let allowed = match table.of_role(Role::Condition)[..] {
                [] => "no such option: the study was made in one condition".to_owned(),
                ref known => format!("one of {}", known.join(", ")),
            };
            let given = "is no condition of this study";
            return Err(Error::input(place, given, allowed));
        }
    }
    let data = table.column(key).map(|(_, data)| data);
    let value_of = |row: usize| data.and_then(|data| data.value(row));
    let mut known = table.one_of(key, rows.iter().copied());
    if rows.iter().any(|&row| value_of(row).is_none()) {
        known += ", none";
    }
    let with = |is_wanted: &dyn Fn(Option<Value>) -> bool| -> Vec<usize> {
        let rows = rows.iter().copied();
        rows.filter(|&row| is_wanted(value_of(row))).collect()
    };
    let unit = table.column(key).map_or("", |(column, _)| &column.unit);
    let wanted = given_value(value, unit).ok_or_else(|| {
        let allowed = format!("a number, in the unit of the column: {unit}");
        Error::input(&place, value, allowed)
    })?;
    // An exact match has priority over a match within the tolerance.
    let mut found = with(&|known| known.as_ref() == Some(&wanted));
    if found.is_empty() {
        found = with(&|known| known.is_some_and(|known| known.agrees(&wanted)));
    }
    if found.is_empty() && value == "none" {
        found = with(&|known| known.is_none());
    }
    match found.is_empty() {
        true => Err(Error::input(place, value, known)),
        false => Ok(found),
    }
}

/// Parses the value of a condition: a text, or a number with an optional unit (`0.5 mm`, `5 %`). Returns `None` if the unit differs from the column's unit.
fn given_value(text: &str, unit: &str) -> Option<Value> {
    if let Ok(number) = text.parse() {
        return Some(Value::Number(number));
    }
    let ends = |letter: char| letter.is_alphabetic() || matches!(letter, '%' | '°');
    let start = text.trim_end_matches(ends).trim_end();
    let Ok(number) = start.parse::<f64>() else {
        return Some(Value::Word(text.to_owned()));
    };
    match (text[start.len()..].trim(), unit) {
        ("%", "%") => Some(Value::Number(0.01 * number)),
        (given, unit) => (given == unit).then_some(Value::Number(number)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::File;

    crate::row! {
    /// Row of a test table.
    pub struct Setting {
        /// Name of the design.
        design: String => Choice;
        /// Name of the condition, used as text in the table.
        world: String => Condition;
        /// Time, µs.
        time: f64 => Cost in "µs": Linear;
        /// Number of taxels.
        taxels: f64 => Cost: Linear;
        /// Weight of the design; all rows lack this value.
        weight: Option<f64> => Cost: Linear;
        /// Accuracy, a fraction.
        accuracy: f64 => Value(More): Share between [low, high];
        /// Lower end of the accuracy's interval.
        low: f64 => Note: Share;
        /// Upper end of the accuracy's interval.
        high: f64 => Note: Share;
        /// Error of a measured quantity.
        error: f64 => Value(Less): Log;
    } }

    fn setting(design: &str, time: f64, accuracy: f64, half_width: f64) -> Setting {
        Setting {
            design: design.to_owned(),
            world: "quiet".to_owned(),
            time,
            taxels: 300.0 - time,
            weight: None,
            accuracy,
            low: accuracy - half_width,
            high: accuracy + half_width,
            error: 1.0 - accuracy,
        }
    }

    fn table(rows: &[Setting]) -> [Table; 1] {
        [File::new("settings.csv", "Settings", "")
            .table(rows)
            .unwrap()]
    }

    fn settings() -> [Table; 1] {
        table(&[
            setting("dear and worse", 90.0, 0.70, 0.01),
            setting("middle", 50.0, 0.91, 0.03),
            setting("cheap", 10.0, 0.60, 0.02),
            setting("best", 200.0, 0.97, 0.01),
            setting("certain", 60.0, 0.905, 0.004),
            setting("as good as the middle", 50.0, 0.91, 0.03),
        ])
    }

    fn query(value: &str, cost: &str) -> AdviceQuery {
        AdviceQuery {
            value: Some(value.to_owned()),
            cost: Some(cost.to_owned()),
            ..AdviceQuery::default()
        }
    }

    /// Returns the names of three designs: the advised choice, the certain choice and the next better choice.
    fn advised(asked: &AdviceQuery, wish: Requirement) -> Result<[Option<String>; 3]> {
        let tables = settings();
        let offers = Candidates::new(&tables, asked)?;
        let advice = offers.advise(&offers.by_condition()[0], wish)?;
        let design = |offer: Candidate| tables[0].word("design", offer.row).to_owned();
        let found = [Some(advice.choice), advice.certain, advice.next_up];
        Ok(found.map(|offer| offer.map(design)))
    }

    fn choice(asked: &AdviceQuery, wish: Requirement) -> String {
        advised(asked, wish).unwrap()[0].clone().unwrap()
    }

    #[test]
    fn nothing_beats_a_setting_of_the_front_and_something_beats_every_other() {
        let tables = settings();
        let offers = Candidates::new(&tables, &AdviceQuery::default()).unwrap();
        let all = &offers.by_condition()[0];
        let front = offers.front(all);
        let rows: Vec<usize> = front.iter().map(|offer| offer.row).collect();
        assert_eq!(rows, [2, 1, 3]);
        for offer in all {
            let is_no_better_than =
                |on: &Candidate| on.cost <= offer.cost && on.value >= offer.value;
            assert!(front.iter().any(is_no_better_than), "{offer:?}");
        }
    }

    #[test]
    fn the_cheapest_that_is_good_enough_is_advised_with_the_certain_one_and_the_next() {
        let some = |name: &str| Some(name.to_owned());
        let accurate = query("accuracy", "time");
        let found = advised(&accurate, Requirement::Value(0.9)).unwrap();
        assert_eq!(found, [some("middle"), some("certain"), some("best")]);
        let found = advised(&accurate, Requirement::Value(0.95)).unwrap();
        assert_eq!(found, [some("best"), None, None]);
        // For an error, smaller values are better.
        let found = advised(&query("error", "time"), Requirement::Value(0.1)).unwrap();
        assert_eq!(found, [some("middle"), None, some("best")]);
    }

    #[test]
    fn another_cost_is_another_answer_and_one_that_nobody_knows_is_refused() {
        let wish = Requirement::Value(0.65);
        assert_eq!(choice(&query("accuracy", "time"), wish), "middle");
        assert_eq!(choice(&query("accuracy", "taxels"), wish), "best");
        let tables = settings();
        let unknown = Candidates::new(&tables, &query("accuracy", "weight")).unwrap();
        assert!(unknown.by_condition().is_empty());
        for (value, cost, said) in [
            (
                "accuracy",
                "colour",
                "--cost: colour; one of time, taxels, weight, decision_time",
            ),
            ("speed", "time", "--value: speed; one of accuracy, error"),
        ] {
            let error = advised(&query(value, cost), wish).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn the_best_within_a_budget_is_advised_and_a_budget_is_a_limit_that_may_be_reached() {
        for (budget, design) in [(10.0, "cheap"), (49.9, "cheap"), (199.0, "middle")] {
            assert_eq!(
                choice(&AdviceQuery::default(), Requirement::Budget(budget)),
                design
            );
        }
    }

    #[test]
    fn the_worst_condition_of_each_choice_is_where_it_is_least_good_and_what_it_costs_at_most() {
        let at = |world: &str, setting: Setting| Setting {
            world: world.to_owned(),
            ..setting
        };
        let tables = table(&[
            at("quiet", setting("a", 5.0, 0.99, 0.0)),
            at("quiet", setting("b", 5.0, 0.90, 0.0)),
            at("quiet", setting("only here", 1.0, 1.0, 0.0)),
            at("noisy", setting("a", 6.0, 0.50, 0.0)),
            at("noisy", setting("b", 4.0, 0.80, 0.0)),
        ]);
        let offers = Candidates::new(&tables, &AdviceQuery::default()).unwrap();
        assert_eq!(offers.by_condition().len(), 2);
        let worst: Vec<(usize, f64, f64)> = offers
            .worst()
            .iter()
            .map(|offer| (offer.row, offer.value, offer.cost))
            .collect();
        assert_eq!(worst, [(3, 0.50, 6.0), (4, 0.80, 5.0)]);
    }

    #[test]
    fn a_wish_that_nothing_fulfils_is_an_error_that_names_the_nearest() {
        let text = |value: &str, wish| {
            let error = advised(&query(value, "time"), wish).unwrap_err();
            error.to_string()
        };
        let dear = text("accuracy", Requirement::Value(0.99));
        assert!(
            dear.contains("the best here is accuracy 0.970") && dear.contains("best"),
            "{dear}"
        );
        let fine = text("error", Requirement::Value(1e-3));
        assert!(fine.contains("the best here is error 0.03"), "{fine}");
        let cheap = text("accuracy", Requirement::Budget(5.0));
        assert!(
            cheap.contains("time 10 µs") && cheap.contains("cheap"),
            "{cheap}"
        );
        for wish in [Requirement::Value(0.0), Requirement::Value(1.1)] {
            assert!(text("accuracy", wish).contains("at most 1"));
        }
        assert!(text("accuracy", Requirement::Budget(f64::NAN)).contains("positive"));
        let error = Candidates::new(&[], &AdviceQuery::default())
            .map(drop)
            .unwrap_err();
        assert!(error.to_string().contains("no table offers choices"));
    }
}
