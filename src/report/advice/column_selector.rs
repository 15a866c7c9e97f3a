//! Selection of the value column and the cost column of an advice.

use crate::error::{Error, Result};
use crate::report::swept::Setting;
use crate::table::{Better, Column, Role, Table};
use std::collections::HashSet;

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
