//! Texts about a candidate: its value, cost, choices and condition, in words and as JSON.

use super::candidates::{Candidate, Candidates};
use crate::report::swept::Setting;
use crate::table::{Scale, Value};

impl Candidates<'_> {
    /// Returns the value, interval and cost of a candidate as text, such as `accuracy 0.830 (0.800 to 0.860), time of a decision 210 µs`.
    pub fn gives(&self, candidate: &Candidate) -> String {
        let interval = match self.table.interval(self.value, candidate.row) {
            Some(ends) => {
                let [low, high] = ends.map(|end| self.value_words(end));
                format!(" ({low} to {high})")
            }
            None => String::new(),
        };
        let value = self.value_words(candidate.value);
        let cost = self.cost.phrase(&Value::Number(candidate.cost));
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
