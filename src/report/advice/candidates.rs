//! Candidates of an advice: rows of a table with a value and a cost, their Pareto front, and the advised candidate.

use super::column_selector::{COST, VALUE, refuse_none};
use super::given_condition::rows_with;
use crate::error::{Error, Result};
use crate::report::swept::Swept;
use crate::table::{Better, Column, Role, Scale, Table, Value, front};

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
    pub(super) swept: Swept<'a>,
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
        let rows: Vec<usize> = given.try_fold(rows, |rows, text| rows_with(table, rows, text))?;
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
        let is_known = |row: &usize| found.candidate(*row).is_some();
        found.rows = rows.into_iter().filter(is_known).collect();
        found
    }

    /// Returns the candidate of a row; `None` if its value or cost is absent.
    fn candidate(&self, row: usize) -> Option<Candidate> {
        let value = self.table.number(&self.value.name, row);
        let cost = self.table.number(&self.cost.name, row);
        let is_known = value.is_finite() && cost.is_finite();
        is_known.then_some(Candidate { row, value, cost })
    }

    /// Returns the candidates in one group per condition, in the order in which the conditions first occur in the table.
    pub fn by_condition(&self) -> Vec<Vec<Candidate>> {
        let conditions = self.swept.by_condition(&self.rows).into_iter();
        let candidates = |rows: Vec<usize>| {
            rows.into_iter()
                .filter_map(|row| self.candidate(row))
                .collect()
        };
        conditions.map(candidates).collect()
    }

    /// Returns, for each choice, a candidate that has the worst value and the highest cost over all conditions. Choices that were not measured in every
    /// condition are omitted.
    pub fn worst(&self) -> Vec<Candidate> {
        let n_conditions = self.swept.by_condition(&self.rows).len();
        let choices = self.swept.of_role(Role::Choice);
        let choices = self.swept.groups(&choices, &self.rows).into_iter();
        let measured = choices.filter(|rows| rows.len() == n_conditions);
        let worst = |rows: Vec<usize>| {
            let candidates = rows.iter().filter_map(|&row| self.candidate(row));
            candidates.reduce(|a, b| {
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
    pub fn advise(&self, candidates: &[Candidate], requirement: Requirement) -> Result<Advice> {
        let (column, wanted, place) = match requirement {
            Requirement::Value(wanted) => (self.value, wanted, "required value"),
            Requirement::Budget(most) => (self.cost, most, "budget"),
            Requirement::Best => (self.cost, f64::INFINITY, "budget"),
        };
        let given = column.phrase(&Value::Number(wanted));
        let refuse = |allowed: String| Error::input(place, &given, allowed);
        let is_share = column.scale == Scale::Share;
        let (is_in_range, range) = match requirement {
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
        let front = self.front(candidates);
        let (Some(cheapest), Some(best)) = (front.first(), front.last()) else {
            return Err(refuse(
                "at least one choice whose value and cost are known".to_owned(),
            ));
        };
        let place = match requirement {
            Requirement::Value(wanted) => front
                .iter()
                .position(|candidate| self.is_enough(candidate.value, wanted)),
            Requirement::Budget(most) => front.iter().rposition(|candidate| candidate.cost <= most),
            Requirement::Best => Some(front.len() - 1),
        };
        let Some(place) = place else {
            return Err(refuse(match requirement {
                Requirement::Value(_) => format!("the best here is {}", self.in_words(best)),
                Requirement::Budget(_) | Requirement::Best => {
                    format!("the cheapest here is {}", self.in_words(cheapest))
                }
            }));
        };
        let certain = match requirement {
            Requirement::Value(wanted) if self.value.interval.is_some() => {
                let candidates = candidates.iter().copied();
                let certain = candidates
                    .filter(|candidate| self.is_enough(self.worse_end(candidate), wanted));
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
    pub fn front(&self, candidates: &[Candidate]) -> Vec<Candidate> {
        let points: Vec<(f64, f64)> = candidates
            .iter()
            .map(|candidate| (candidate.cost, candidate.value))
            .collect();
        let is_on = front(&points, |a, b| self.is_better(a, b));
        let on = candidates.iter().zip(is_on).filter(|(_, is_on)| *is_on);
        let mut front: Vec<Candidate> = on.map(|(candidate, _)| *candidate).collect();
        // The sort is stable: among equal candidates, the first stays first.
        front.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        front.dedup_by_key(|candidate| candidate.cost);
        front
    }

    fn is_less_better(&self) -> bool {
        self.value.role == Role::Value(Better::Less)
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
        let worst: Vec<(usize, f64, f64)> = candidates
            .worst()
            .iter()
            .map(|candidate| (candidate.row, candidate.value, candidate.cost))
            .collect();
        assert_eq!(worst, [(3, 0.50, 6.0), (4, 0.80, 5.0)]);
    }

    #[test]
    fn a_wish_that_nothing_fulfils_is_an_error_that_names_the_nearest() {
        let text = |value: &str, requirement| {
            let error = advised(&query(value, "time"), requirement).unwrap_err();
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
        for requirement in [Requirement::Value(0.0), Requirement::Value(1.1)] {
            assert!(text("accuracy", requirement).contains("at most 1"));
        }
        assert!(text("accuracy", Requirement::Budget(f64::NAN)).contains("positive"));
        let error = Candidates::new(&[], &AdviceQuery::default())
            .map(drop)
            .unwrap_err();
        assert!(error.to_string().contains("no table offers choices"));
    }
}
