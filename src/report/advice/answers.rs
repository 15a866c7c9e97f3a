//! Answers of `bubbletouch advise`: candidates and advice for each condition, as text and as JSON.

use super::candidates::{Advice, Candidate, Candidates, Requirement};
use crate::error::{Error, Result};
use crate::report::swept::Setting;
use crate::table::{Role, Table, Value};

/// Advice for one condition, or the reason why no advice exists.
pub struct Answer {
    /// Condition as text; empty if the table has only one condition.
    pub condition: String,
    /// Advice for the condition, or an error that contains the requirement and the nearest candidate.
    pub advice: Result<Advice>,
    /// Number of choices that were not compared, because they were not measured or exceed a limit in at least one of several conditions.
    pub n_left_out: usize,
}

/// Returns the advice under each condition, or the reason why there is none. If `worst` is true, returns a single answer that is based on the worst value of
/// each choice over all conditions.
///
/// # Errors
/// If no condition has advice; returns the error of the first condition.
pub fn answers(offers: &Candidates, wish: Requirement, worst: bool) -> Result<Vec<Answer>> {
    let conditions = offers.all_conditions();
    let n = conditions.len();
    if worst && n > 1 {
        let (choices, n_left_out) = offers.worst()?;
        let condition = format!("the worst of {n} conditions");
        let advice = Ok(offers.advise(&choices, wish).map_err(|refused| {
            let best = offers.front(&choices).pop();
            let world = best.map_or_else(String::new, |best| offers.condition(&best));
            refused.under(format!("with {condition} ({world}): "))
        })?);
        return Ok(vec![Answer {
            condition,
            advice,
            n_left_out,
        }]);
    }
    let answers = conditions.into_iter().map(|(condition, choices)| Answer {
        condition,
        advice: offers.advise(&choices, wish),
        n_left_out: 0,
    });
    let answers: Vec<Answer> = answers.collect();
    if answers.iter().any(|answer| answer.advice.is_ok()) {
        return Ok(answers);
    }
    // Only the error of the first condition is returned.
    let first = answers.into_iter().next();
    let Some((condition, Err(refused))) = first.map(|first| (first.condition, first.advice)) else {
        let given = "no choice whose value and cost are known";
        return Err(Error::input(offers.table.file, given, "at least one"));
    };
    Err(match n {
        1 => refused,
        _ => refused.under(format!("in none of {n} conditions; with {condition}: ")),
    })
}

/// Returns the answers as JSON: the table, its value and cost columns, and the advised choices for each condition.
pub fn answers_json(offers: &Candidates, answers: &[Answer]) -> serde_json::Value {
    let in_json = |offer: &Candidate| offers.json(offer);
    let answers = answers.iter().map(|answer| match &answer.advice {
        Ok(advice) => serde_json::json!({
            "condition": answer.condition,
            "choice": in_json(&advice.choice),
            "certain": advice.certain.as_ref().map(in_json),
            "next_up": advice.next_up.as_ref().map(in_json),
            "n_left_out": answer.n_left_out,
        }),
        Err(refused) => {
            let refused = refused.to_string();
            serde_json::json!({ "condition": answer.condition, "refused": refused })
        }
    });
    serde_json::json!({
        "table": offers.table.file,
        "value": offers.value.name,
        "cost": offers.cost.name,
        "answers": answers.collect::<Vec<_>>(),
    })
}

/// Maximum number of conditions for which sentences are written.
const MAX_CONDITIONS: usize = 8;

impl Candidates<'_> {
    /// Returns sentences on the best choices under each condition: the cheapest one within the interval of the best, and the best one. Of many conditions, only
    /// the first ones have sentences.
    pub(crate) fn sentences(&self) -> Vec<String> {
        let conditions = self.by_condition();
        let listed = conditions.iter().take(MAX_CONDITIONS);
        let best = listed.filter_map(|choices| self.best_and_as_good(choices));
        let mut sentences: Vec<String> = best.flat_map(|best| self.best_words(best)).collect();
        if conditions.len() > MAX_CONDITIONS {
            let n = conditions.len() - MAX_CONDITIONS;
            let more = format!("The best of {n} more conditions are in the tables.");
            sentences.push(more);
        }
        sentences
    }

    /// Returns the best-of table: the Pareto front of each condition, cheapest first, with the settings that vary, the value and the cost.
    pub(crate) fn front_table(&self) -> Table {
        let conditions = self.by_condition();
        let fronts = conditions.iter().flat_map(|of_one| self.front(of_one));
        let rows: Vec<usize> = fronts.map(|candidate| candidate.row).collect();
        let settings = self.swept.of_role(Role::Condition);
        let settings = settings.iter().chain(&self.swept.choices);
        let settings = settings.map(|one| &one.column.name);
        let ends = self.value.interval.iter().flatten();
        let found = [&self.value.name, &self.cost.name].into_iter().chain(ends);
        let columns: Vec<&str> = settings.chain(found).map(|name| &name[..]).collect();
        let about = ("fronts.csv", "Pareto front of each condition");
        self.table.select(about, &rows, &columns)
    }

    fn best_words(&self, [best, as_good]: [Candidate; 2]) -> Vec<String> {
        let with = match &self.condition(&best)[..] {
            "" => String::new(),
            words => format!(" with {words}"),
        };
        let said = |candidate: &Candidate| {
            let value = self.table.bounded(self.value, candidate.row);
            match &self.choices(candidate)[..] {
                "" => value,
                words => format!("{value} at {words}"),
            }
        };
        let (value, cost) = (&self.value.words, &self.cost.words);
        let cheapest = (as_good != best).then(|| {
            format!(
                "Within the interval of the best{with}, for the least {cost}: {}.",
                said(&as_good)
            )
        });
        let best = format!("Best {value}{with}: {}.", said(&best));
        cheapest.into_iter().chain([best]).collect()
    }

    /// Returns the value, interval and cost of a candidate as text, such as `accuracy 0.83 [0.80, 0.86], time of a decision 210 µs`.
    pub fn gives(&self, candidate: &Candidate) -> String {
        let value = self.table.bounded(self.value, candidate.row);
        let cost = self.cost.phrase(&Value::Number(candidate.cost));
        format!("{} {value}, {cost}", self.value.words)
    }

    /// Returns the value, cost and choices of a candidate as text, such as `accuracy 0.83, time of a decision 210 µs: RBF SVM, m = 64`.
    pub fn in_words(&self, candidate: &Candidate) -> String {
        format!("{}: {}", self.gives(candidate), self.setting(candidate))
    }

    /// Returns the choices of a candidate as text, or "the only setting" if no choice varies in the table.
    pub fn setting(&self, candidate: &Candidate) -> String {
        match self.choices(candidate) {
            words if words.is_empty() => "the only setting".to_owned(),
            words => words,
        }
    }

    /// Returns the choices of a candidate as text; empty if no choice varies in the table.
    pub fn choices(&self, candidate: &Candidate) -> String {
        self.swept.choice_words(candidate.row)
    }

    /// Returns the condition of a candidate as text; empty if the table has only one condition.
    pub fn condition(&self, candidate: &Candidate) -> String {
        self.swept.condition_words(candidate.row)
    }

    /// Returns the candidate as a JSON object: choices and condition as text, and the entries of all columns by name.
    pub fn json(&self, candidate: &Candidate) -> serde_json::Value {
        let mut row = serde_json::Map::new();
        row.insert("setting".to_owned(), self.setting(candidate).into());
        row.insert("condition".to_owned(), self.condition(candidate).into());
        for Setting { column, data } in Setting::all(self.table) {
            let value = serde_json::json!(data.value(candidate.row));
            row.insert(column.name.to_string(), value);
        }
        row.insert(self.cost.name.to_string(), candidate.cost.into());
        row.into()
    }
}
