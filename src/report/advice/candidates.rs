//! Candidates of an advice: rows of a table with a value and a cost, their Pareto front, and the advised candidate.

use super::query::{AdviceQuery, COST, VALUE, refuse_none, rows_with};
use crate::error::{Error, Result};
use crate::report::swept::{Setting, Swept};
use crate::table::{Better, Column, Role, Scale, Table, Value, front};
use std::collections::HashMap;

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
    pub(super) swept: Swept<'a>,
    /// Indices of the rows that satisfy the given conditions.
    rows: Vec<usize>,
    /// Cost columns with the largest cost that a choice may have.
    limits: Vec<(&'a Column, f64)>,
}

impl<'a> Candidates<'a> {
    /// Returns the candidates from the first table that contains choices and the requested value and cost columns.
    ///
    /// # Errors
    /// If no table has these columns, or a condition or a cost limit is not valid for the table.
    pub fn new(tables: &'a [Table], asked: &AdviceQuery) -> Result<Self> {
        let mut offering: Vec<&Table> = tables.iter().filter(|t| t.offers_choices()).collect();
        // A table in which choices differ is preferred; a study may also have a single configuration in each condition.
        for is_preferred in [Table::compares_choices, |table: &Table| table.n_rows > 1] {
            if offering.iter().any(|table| is_preferred(table)) {
                offering.retain(|table| is_preferred(table));
            }
        }
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
        let mut found = Self::all(table, value(table), COST.columns(table, cost)[0]);
        let mut given = asked.given.iter();
        found.rows = given.try_fold(found.rows, |rows, text| rows_with(table, rows, text))?;
        for (name, most) in &asked.limits {
            found.limit(name, *most)?;
        }
        Ok(found)
    }

    /// Adds an upper bound of the named cost column, in the unit of the column.
    ///
    /// # Errors
    /// If no such cost column exists, or the bound is not a positive number.
    pub fn limit(&mut self, name: &str, most: f64) -> Result<()> {
        let columns = COST.columns(self.table, Some(name));
        let known = COST.columns(self.table, None).into_iter();
        refuse_none(
            &columns,
            ("limit of", name),
            known.map(|column| &column.name[..]).collect(),
        )?;
        if !(most > 0.0 && most.is_finite()) {
            return Err(over_limit(columns[0], most, "a positive number".to_owned()));
        }
        self.limits.push((columns[0], most));
        Ok(())
    }

    /// Returns the candidates whose costs are within all limits.
    ///
    /// # Errors
    /// If there are none; the error names the first limit that no candidate meets, and the smallest cost.
    fn within_limits(&self, candidates: &[Candidate]) -> Result<Vec<Candidate>> {
        let mut kept = candidates.to_vec();
        for &(column, most) in &self.limits {
            let of = |candidate: &Candidate| self.table.number(&column.name, candidate.row);
            let least = kept.iter().map(of).fold(f64::INFINITY, f64::min);
            kept.retain(|candidate| of(candidate) <= most);
            if kept.is_empty() && least.is_finite() {
                let least = column.phrase(&Value::Number(least));
                return Err(over_limit(
                    column,
                    most,
                    format!("the smallest here is {least}"),
                ));
            }
        }
        if kept.is_empty() {
            let given = format!("no {} and {}", self.value.words, self.cost.words);
            let allowed = "at least one choice whose value and costs are known";
            return Err(Error::input(self.table.file, given, allowed));
        }
        Ok(kept)
    }

    /// Creates candidates from all rows of a table, given the names of its value column and its cost column; `None` without such columns.
    pub fn of_columns(table: &'a Table, value: &str, cost: &str) -> Option<Self> {
        let (value, cost) = (table.column(value)?.0, table.column(cost)?.0);
        Some(Self::all(table, value, cost))
    }

    /// Restricts the candidates to the rows for which `is_kept` returns true.
    pub(crate) fn retain(&mut self, is_kept: impl Fn(usize) -> bool) {
        self.rows.retain(|&row| is_kept(row));
    }

    fn all(table: &'a Table, value: &'a Column, cost: &'a Column) -> Self {
        Self {
            table,
            value,
            cost,
            swept: Swept::of(table),
            rows: table.all_rows(),
            limits: Vec::new(),
        }
    }

    /// Returns the candidate of a row; `None` if its value or cost is absent.
    fn candidate(&self, row: usize) -> Option<Candidate> {
        let value = self.table.number(&self.value.name, row);
        let cost = self.table.number(&self.cost.name, row);
        let is_known = value.is_finite() && cost.is_finite();
        is_known.then_some(Candidate { row, value, cost })
    }

    /// Returns the candidates in one group per condition, in the order in which the conditions first occur in the table. A condition in which no row has both
    /// a value and a cost is omitted.
    pub fn by_condition(&self) -> Vec<Vec<Candidate>> {
        self.by_condition_of(&self.rows)
    }

    /// Returns the candidates among the given rows as [`Candidates::by_condition`] does.
    pub(crate) fn by_condition_of(&self, rows: &[usize]) -> Vec<Vec<Candidate>> {
        let conditions = self.conditions(rows).into_iter();
        let candidates = conditions.map(|(_, candidates)| candidates);
        candidates.filter(|of_one| !of_one.is_empty()).collect()
    }

    /// Returns each condition of the given rows as text, with its candidates.
    fn conditions(&self, rows: &[usize]) -> Vec<(String, Vec<Candidate>)> {
        let conditions = self.swept.by_condition(rows).into_iter();
        let candidates = |rows: Vec<usize>| {
            let candidates = rows.iter().filter_map(|&row| self.candidate(row));
            (self.swept.condition_words(rows[0]), candidates.collect())
        };
        conditions.map(candidates).collect()
    }

    /// Returns each condition as text, with its candidates.
    pub(crate) fn all_conditions(&self) -> Vec<(String, Vec<Candidate>)> {
        self.conditions(&self.rows)
    }

    /// Returns, for each choice, a candidate that has the worst value and the highest cost over all conditions, and the number of choices that are left out,
    /// because they were not measured or exceed a limit in at least one condition.
    ///
    /// # Errors
    /// If all choices are left out; the error names the condition in which the fewest choices are within the limits.
    pub fn worst(&self) -> Result<(Vec<Candidate>, usize)> {
        let choices = Setting::groups(&self.swept.free_choices(), self.table, &self.rows);
        let mut within: HashMap<usize, Candidate> = HashMap::new();
        let mut counts = Vec::new();
        for (condition, candidates) in self.all_conditions() {
            let kept = self.within_limits(&candidates);
            let kept = kept.map_err(|error| error.under(format!("with {condition}: ")))?;
            counts.push((kept.len(), condition));
            within.extend(kept.into_iter().map(|candidate| (candidate.row, candidate)));
        }
        let worse = |a: Candidate, b: Candidate| Candidate {
            cost: a.cost.max(b.cost),
            ..[a, b][usize::from(self.is_better(a.value, b.value))]
        };
        let worst = choices.iter().filter_map(|rows| {
            let measured = rows.iter().filter_map(|row| within.get(row)).copied();
            let is_everywhere = measured.clone().count() == counts.len();
            measured.reduce(worse).filter(|_| is_everywhere)
        });
        let worst: Vec<Candidate> = worst.collect();
        let n_conditions = counts.len();
        let fewest = counts.into_iter().min_by_key(|(n, _)| *n);
        if let (true, Some((n, condition))) = (worst.is_empty(), fewest) {
            let n_choices = choices.len();
            let given = format!("{n} of {n_choices} choices with {condition}, others elsewhere");
            let allowed = format!(
                "a choice that was measured and is within the limits in all {n_conditions} conditions"
            );
            return Err(Error::input("--worst", given, allowed));
        }
        let n_left_out = choices.len() - worst.len();
        Ok((worst, n_left_out))
    }

    /// Returns the advice for a requirement, selected from the candidates under one condition that are within all limits.
    ///
    /// # Errors
    /// If the requirement is out of range, no candidate is within the limits, or none meets the requirement; the error names the nearest candidate.
    pub fn advise(&self, candidates: &[Candidate], requirement: Requirement) -> Result<Advice> {
        let (place, column, wanted) = match requirement {
            Requirement::Value(wanted) => ("required value", self.value, wanted),
            Requirement::Budget(most) => ("budget", self.cost, most),
            Requirement::Best => ("budget", self.cost, f64::INFINITY),
        };
        let refuse =
            |allowed: &str| Error::input(place, column.phrase(&Value::Number(wanted)), allowed);
        let is_share = column.scale == Scale::Share;
        let (is_in_range, range) = match requirement {
            Requirement::Value(share) if is_share => {
                (share > 0.0 && share <= 1.0, "more than 0, at most 1")
            }
            Requirement::Value(value) => (value.is_finite(), "a number"),
            Requirement::Budget(most) => (most > 0.0 && most.is_finite(), "a positive number"),
            Requirement::Best => (true, ""),
        };
        if !is_in_range {
            return Err(refuse(range));
        }
        let candidates = self.within_limits(candidates)?;
        let front = self.front(&candidates);
        let is_enough = |value: f64| match requirement {
            Requirement::Value(wanted) => self.is_enough(value, wanted),
            Requirement::Budget(_) | Requirement::Best => false,
        };
        let (found, nearest, what) = match requirement {
            Requirement::Value(_) => {
                let found = front.iter().position(|one| is_enough(one.value));
                (found, front.len() - 1, "best")
            }
            Requirement::Budget(_) | Requirement::Best => (
                front.iter().rposition(|one| one.cost <= wanted),
                0,
                "cheapest",
            ),
        };
        let nearest = || format!("the {what} here is {}", self.in_words(&front[nearest]));
        let place = found.ok_or_else(|| refuse(&nearest()))?;
        let certain = candidates
            .into_iter()
            .filter(|one| is_enough(self.worse_end(one)));
        let certain = self.front(&certain.collect::<Vec<_>>()).first().copied();
        Ok(Advice {
            choice: front[place],
            certain: certain.filter(|certain| *certain != front[place]),
            next_up: front.get(place + 1).copied(),
        })
    }

    /// Returns the Pareto front, cheapest first: each candidate on the front is better than all candidates of equal or lower cost. Among equal candidates, only
    /// the first is returned.
    pub fn front(&self, candidates: &[Candidate]) -> Vec<Candidate> {
        let points = candidates.iter().map(|one| (one.cost, one.value));
        let points: Vec<(f64, f64)> = points.collect();
        let is_on = front(&points, |a, b| self.is_better(a, b));
        let on = candidates.iter().zip(is_on).filter(|(_, is_on)| *is_on);
        let mut front: Vec<Candidate> = on.map(|(candidate, _)| *candidate).collect();
        // The sort is stable: among equal candidates, the first stays first.
        front.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        front.dedup_by_key(|candidate| candidate.cost);
        front
    }

    /// Returns the best candidate, and the cheapest candidate whose value lies within the confidence interval of the best; `None` without candidates.
    pub(crate) fn best_and_as_good(&self, candidates: &[Candidate]) -> Option<[Candidate; 2]> {
        let front = self.front(candidates);
        let best = *front.last()?;
        let wanted = self.worse_end(&best);
        let mut front = front.into_iter();
        let as_good = front.find(|candidate| self.is_enough(candidate.value, wanted));
        Some([best, as_good.unwrap_or(best)])
    }

    /// Returns, for conditions of the given rows, the cheapest candidate within the interval of the best as text, such as `0.98 in 34 µs (noise 10 %)`. If
    /// there are more than three conditions, only the first and the last are named.
    pub(crate) fn as_good_words(&self, rows: &[usize]) -> String {
        let mut conditions = self.by_condition_of(rows);
        if conditions.len() > 3 {
            conditions.drain(1..conditions.len() - 1);
        }
        let is_one = conditions.len() == 1;
        let said = conditions.iter().filter_map(|of_one| {
            let [_, cheapest] = self.best_and_as_good(of_one)?;
            let value = self.table.bounded(self.value, cheapest.row);
            let value = value.split(" [").next().unwrap_or_default().to_owned();
            let cost = self.cost.number_words(cheapest.cost);
            Some(match &self.condition(&cheapest)[..] {
                words if !is_one && !words.is_empty() => format!("{value} in {cost} ({words})"),
                _ => format!("{value} in {cost}"),
            })
        });
        said.collect::<Vec<_>>().join(", ")
    }

    fn is_less_better(&self) -> bool {
        matches!(self.value.role, Role::Value(Better::Less) | Role::Cost)
    }

    fn is_better(&self, a: f64, b: f64) -> bool {
        if self.is_less_better() { a < b } else { a > b }
    }

    fn is_enough(&self, value: f64, wanted: f64) -> bool {
        value == wanted || self.is_better(value, wanted)
    }

    /// Returns the worse end of the confidence interval of a candidate's value; NaN without an interval.
    fn worse_end(&self, candidate: &Candidate) -> f64 {
        let ends = self.table.interval(self.value, candidate.row);
        ends.map_or(
            f64::NAN,
            |[low, high]| if self.is_less_better() { high } else { low },
        )
    }
}

/// Returns the error about a limit of a cost column.
fn over_limit(column: &Column, most: f64, allowed: String) -> Error {
    let place = format!("limit of {}", column.words);
    Error::input(place, column.phrase(&Value::Number(most)), allowed)
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
    fn advised(asked: &AdviceQuery, requirement: Requirement) -> Result<[Option<String>; 3]> {
        let tables = settings();
        let candidates = Candidates::new(&tables, asked)?;
        let advice = candidates.advise(&candidates.by_condition()[0], requirement)?;
        let design = |candidate: Candidate| tables[0].word("design", candidate.row).to_owned();
        let found = [Some(advice.choice), advice.certain, advice.next_up];
        Ok(found.map(|candidate| candidate.map(design)))
    }

    fn choice(asked: &AdviceQuery, requirement: Requirement) -> String {
        advised(asked, requirement).unwrap()[0].clone().unwrap()
    }

    #[test]
    fn nothing_beats_a_setting_of_the_front_and_something_beats_every_other() {
        let tables = settings();
        let candidates = Candidates::new(&tables, &AdviceQuery::default()).unwrap();
        let all = &candidates.by_condition()[0];
        let front = candidates.front(all);
        let rows: Vec<usize> = front.iter().map(|candidate| candidate.row).collect();
        assert_eq!(rows, [2, 1, 3]);
        for candidate in all {
            let is_no_better_than =
                |on: &Candidate| on.cost <= candidate.cost && on.value >= candidate.value;
            assert!(front.iter().any(is_no_better_than), "{candidate:?}");
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
        let requirement = Requirement::Value(0.65);
        assert_eq!(choice(&query("accuracy", "time"), requirement), "middle");
        assert_eq!(choice(&query("accuracy", "taxels"), requirement), "best");
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
            let error = advised(&query(value, cost), requirement)
                .unwrap_err()
                .to_string();
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
        let candidates = Candidates::new(&tables, &AdviceQuery::default()).unwrap();
        assert_eq!(candidates.by_condition().len(), 2);
        let (worst, n_left_out) = candidates.worst().unwrap();
        assert_eq!(n_left_out, 1, "measured in one condition only");
        let worst: Vec<(usize, f64, f64)> = worst
            .iter()
            .map(|candidate| (candidate.row, candidate.value, candidate.cost))
            .collect();
        assert_eq!(worst, [(3, 0.50, 6.0), (4, 0.80, 5.0)]);
        // A limit leaves out what exceeds it in any condition, and names a condition that nothing meets.
        let limited = |most: f64| {
            let limits = vec![("time".to_owned(), most)];
            let asked = AdviceQuery {
                limits,
                ..AdviceQuery::default()
            };
            Candidates::new(&tables, &asked).and_then(|candidates| candidates.worst())
        };
        let (worst, n_left_out) = limited(5.0).unwrap();
        assert_eq!((worst[0].row, worst.len(), n_left_out), (4, 1, 2));
        let error = limited(3.0).unwrap_err().to_string();
        let said = "with world noisy: limit of time: time 3 µs; the smallest here is time 4 µs";
        assert!(error.contains(said), "{error}");
        let error = limited(4.0).unwrap_err().to_string();
        assert!(error.contains("1 of 3 choices with world quiet"), "{error}");
    }

    #[test]
    fn choices_that_are_equally_good_are_choices() {
        let tables = table(&[setting("a", 5.0, 1.0, 0.0), setting("b", 4.0, 1.0, 0.0)]);
        let candidates = Candidates::new(&tables, &AdviceQuery::default()).unwrap();
        let advice = candidates
            .advise(&candidates.by_condition()[0], Requirement::Best)
            .unwrap();
        assert_eq!(candidates.setting(&advice.choice), "design b");
    }

    #[test]
    fn a_wish_that_nothing_fulfils_is_an_error_that_names_the_nearest() {
        let text = |value: &str, requirement| {
            let error = advised(&query(value, "time"), requirement).unwrap_err();
            error.to_string()
        };
        let dear = text("accuracy", Requirement::Value(0.99));
        assert!(
            dear.contains("the best here is accuracy 0.97 [") && dear.contains("best"),
            "{dear}"
        );
        let fine = text("error", Requirement::Value(1e-3));
        assert!(fine.contains("the best here is error 0.03"), "{fine}");
        let cheap = text("accuracy", Requirement::Budget(5.0));
        assert!(
            cheap.contains("time 10 µs") && cheap.contains("cheap"),
            "{cheap}"
        );
        for requirement in [Requirement::Value(0.0), Requirement::Value(1.1)] {
            assert!(text("accuracy", requirement).contains("at most 1"));
        }
        for budget in [0.0, f64::NAN, f64::INFINITY] {
            assert!(text("accuracy", Requirement::Budget(budget)).contains("positive"));
        }
        let error = Candidates::new(&[], &AdviceQuery::default())
            .map(drop)
            .unwrap_err();
        assert!(error.to_string().contains("no table offers choices"));
    }
}
