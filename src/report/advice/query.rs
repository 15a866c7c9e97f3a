//! Query for advice: the table, its value column and its cost column, and the conditions that are fixed.

use crate::error::{Error, Result};
use crate::report::swept::Setting;
use crate::table::{Better, Column, Role, Table, Value, column_name};
use std::collections::HashSet;

/// Query for advice about a design, with the options of `bubbletouch advise`. Fields that are `None` are filled in automatically.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Selection")]
pub struct AdviceQuery {
    /// Minimise this cost [default: decision_time, or the first cost]
    ///
    /// Any column of costs, such as decision_time, training_time, taxels or measurements (of a decision).
    #[arg(long, value_name = "COST")]
    pub cost: Option<String>,
    /// Judge by this value [default: accuracy, or the first value]
    #[arg(long, value_name = "COLUMN", conflicts_with = "accuracy")]
    pub value: Option<String>,
    /// Read this table, if several tables list choices
    #[arg(long, value_name = "FILE")]
    pub table: Option<String>,
    /// Select a value of a condition, such as noise=0.05; repeatable
    ///
    /// Other forms: "noise=5 %", test_sensor=another_skin, and none for rows without a value.
    #[arg(long, value_name = "CONDITION=VALUE")]
    pub given: Vec<String>,
    /// Upper bounds of cost columns, as pairs (column name, bound); choices above a bound are not advised.
    #[arg(skip)]
    pub limits: Vec<(String, f64)>,
}

/// Selector of a value or cost column of a table, by role and name.
pub(super) struct ColumnSelector {
    /// Name of the command-line option that selects the column, for error messages.
    option: &'static str,
    /// Name of the default column, used if no name is given and at least one table has the column. Otherwise, the first column with the role is used.
    usual: &'static str,
    has_role: fn(Role) -> bool,
    /// Column names that all kinds of studies accept, each with the actual names in the different kinds.
    shared: &'static [(&'static str, &'static [&'static str])],
}

pub(super) const VALUE: ColumnSelector = ColumnSelector {
    option: "--value",
    usual: "accuracy",
    has_role: |role| matches!(role, Role::Value(Better::More | Better::Less)),
    shared: &[],
};

pub(super) const COST: ColumnSelector = ColumnSelector {
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

impl ColumnSelector {
    /// Returns the numeric columns of a table with the given name; if no name is given, all numeric columns with the required role. Columns that vary come
    /// first.
    pub(super) fn columns<'t>(&self, table: &'t Table, name: Option<&str>) -> Vec<&'t Column> {
        let shared = self.shared.iter().find(|(known, _)| Some(*known) == name);
        let is_named = |column: &str| match name {
            Some(name) => {
                name == column || shared.is_some_and(|(_, columns)| columns.contains(&column))
            }
            None => true,
        };
        let is_selected = |one: &Setting| {
            (self.has_role)(one.column.role) && is_named(&one.column.name) && one.is_number()
        };
        let mut found: Vec<Setting> = Setting::all(table).filter(is_selected).collect();
        found.sort_by_key(|one| !one.data.varies(0..table.n_rows));
        found.into_iter().map(|one| one.column).collect()
    }

    /// Removes the tables that lack a requested column. Without a request, the default column is required if any table has it. Returns the required name.
    pub(super) fn narrow<'n>(
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

/// Returns an error that lists the `known` names if nothing was found for the value `given` of an option.
pub(super) fn refuse_none<T>(
    found: &[T],
    (option, given): (&str, &str),
    mut known: Vec<&str>,
) -> Result<()> {
    let mut listed = HashSet::new();
    known.retain(|name| listed.insert(*name));
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
pub(super) fn rows_with(table: &Table, rows: Vec<usize>, text: &str) -> Result<Vec<usize>> {
    let refuse = || Error::input("--given", text, "a condition and its value: noise=0.05");
    let (key, value) = text.split_once('=').ok_or_else(refuse)?;
    let (key, value) = (column_name(key.trim()), value.trim());
    if key.is_empty() || value.is_empty() {
        return Err(refuse());
    }
    let place = format!("--given {key}");
    let found = table.column(key);
    let Some((column, data)) = found.filter(|(column, _)| column.role == Role::Condition) else {
        let is_choice = found.is_some_and(|(column, _)| column.role == Role::Choice);
        let (given, allowed) = match &table.of_role(Role::Condition).join(", ")[..] {
            _ if is_choice => (
                "is a choice",
                "a condition of the world; choices are what is advised".to_owned(),
            ),
            "" => (
                "is no condition of this study",
                "no such option: the study was made in one condition".to_owned(),
            ),
            known => ("is no condition of this study", format!("one of {known}")),
        };
        return Err(Error::input(place, given, allowed));
    };
    let wanted = given_value(value, &column.unit).ok_or_else(|| {
        let allowed = format!("a number, in the unit of the column: {}", column.unit);
        Error::input(&place, value, allowed)
    })?;
    let with = |is_wanted: &dyn Fn(Option<Value>) -> bool| -> Vec<usize> {
        let rows = rows.iter().copied();
        rows.filter(|&row| is_wanted(data.value(row))).collect()
    };
    // An exact match has priority over a match within the tolerance.
    let found = [
        with(&|known| known.as_ref() == Some(&wanted)),
        with(&|known| known.is_some_and(|known| known.agrees(&wanted))),
        with(&|known| known.is_none() && value == "none"),
    ];
    found
        .into_iter()
        .find(|rows| !rows.is_empty())
        .ok_or_else(|| {
            let mut known = table.one_of(key, rows.iter().copied());
            if !with(&|known| known.is_none()).is_empty() {
                known += ", none";
            }
            Error::input(place, value, known)
        })
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
