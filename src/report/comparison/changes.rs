//! Exact comparison of two versions of each table: the common rows, and the columns whose entries differ in these rows.
//!
//! The module `differences` compares means over trials. This module compares single entries exactly. The entries include outcomes, notes, numbers
//! that one version lacks, and tables that identify configurations by number.

use crate::report::swept::Setting;
use crate::row;
use crate::table::{Column, Role, Table, Value, short_number};
use std::collections::{HashMap, HashSet};

/// Columns that contain configuration numbers, which may differ between runs.
const CONFIGURATION_NUMBERS: [&str; 2] = ["configuration", "best_configuration"];
/// Roles of the columns whose entries together identify a row of a table.
const KEY_ROLES: [Role; 3] = [Role::Choice, Role::Condition, Role::Subject];
/// Maximum number of different changes that a text lists, such as `right` to `wrong`.
const MAX_CHANGES: usize = 8;

row! {
/// Numbers of common rows of one table in two result folders.
pub struct ComparedTable {
    /// Name of the file that contains the table.
    table: String => Subject;
    /// Number of rows that both folders contain.
    n_both: usize => Value(Neither) "rows of both runs": Linear;
    /// Number of rows that only the first folder contains.
    n_first_only: usize => Value(Neither) "in the first alone": Linear;
    /// Number of rows that only the second folder contains.
    n_second_only: usize => Value(Neither) "in the second alone": Linear;
} }

row! {
/// Column whose entries differ between the common rows of a table in two result folders, or that only one folder contains.
pub struct ChangedColumn {
    /// Name of the file that contains the table.
    table: String => Subject;
    /// Name of the column.
    column: String => Subject;
    /// Number of common rows with equal entries.
    n_same: usize => Value(Neither) "rows alike": Linear;
    /// Number of common rows whose entries differ.
    n_changed: usize => Value(Neither) "rows that differ": Linear;
    /// Description of the change, such as `226 from right to not finite` or `by -0.1 to 0.2`.
    change: String => Subject;
} }

/// Compares all tables of two result folders, in the order of the second folder. A table that only one folder contains has no common rows.
pub fn changes(first: &[Table], second: &[Table]) -> (Vec<ComparedTable>, Vec<ChangedColumn>) {
    let configurations = [first, second].map(configurations);
    let (mut tables, mut columns) = (Vec::new(), Vec::new());
    // A table without a file is derived from other tables and contains nothing new.
    let has_file = |table: &&Table| !table.csv.is_empty();
    for table in second.iter().filter(has_file) {
        let Some(before) = first.iter().find(|first| first.file == table.file) else {
            tables.push(ComparedTable::new(table, 0, [0, table.n_rows]));
            continue;
        };
        let pair = Pair::new([before, table], &configurations);
        let n_both = pair.rows.len();
        let alone = [before, table].map(|table| table.n_rows - n_both);
        tables.push(ComparedTable::new(table, n_both, alone));
        columns.extend(pair.changed_columns());
    }
    let is_second = |file: &str| second.iter().any(|table| table.file == file);
    let lost = first.iter().filter(has_file);
    let lost = lost.filter(|table| !is_second(table.file));
    tables.extend(lost.map(|table| ComparedTable::new(table, 0, [table.n_rows, 0])));
    (tables, columns)
}

impl ComparedTable {
    fn new(table: &Table, n_both: usize, [n_first_only, n_second_only]: [usize; 2]) -> Self {
        Self {
            table: table.file.to_owned(),
            n_both,
            n_first_only,
            n_second_only,
        }
    }
}

/// Settings of each configuration as text; the key is the number of the configuration.
pub(super) type Configurations = HashMap<u64, String>;

/// Returns the settings of all configurations, from the tables in which the number of a configuration is a note beside its settings.
fn configurations(tables: &[Table]) -> Configurations {
    let mut known = Configurations::new();
    let mut named = HashSet::new();
    for table in tables {
        let Some((column, numbers)) = table.column("configuration") else {
            continue;
        };
        if column.role != Role::Note {
            continue;
        }
        // Seeds are subjects, too. The trial is left out, because a configuration has several trials.
        let columns = Setting::of_roles(table, &KEY_ROLES);
        let columns: Vec<Setting> = columns.filter(|one| one.column.name != "trial").collect();
        for row in 0..table.n_rows {
            let number = numbers.key(row);
            if known.contains_key(&number) {
                continue;
            }
            let said = key(&columns, row, &Configurations::new());
            // If the settings already have a number, the number was changed between rows.
            if named.insert(said.clone()) {
                known.insert(number, said);
            }
        }
    }
    known
}

/// Returns the values of some columns in a row as text with units, which does not depend on the order of the columns. An absent entry and an absent column are
/// treated alike: the setting does not apply.
fn key(columns: &[Setting], row: usize, configurations: &Configurations) -> String {
    let entries = columns.iter();
    let entries = entries.filter_map(|one| entry(*one, row, configurations));
    let mut entries: Vec<String> = entries.collect();
    entries.sort();
    entries.concat()
}

/// Returns the rows with equal values of the given columns in two versions of a table, one pair of lists for each combination of values that both versions
/// have, in the order of the second version.
pub(super) fn common_rows(
    tables: [&Table; 2],
    columns: &[Vec<Setting>; 2],
    configurations: &[Configurations; 2],
) -> Vec<[Vec<usize>; 2]> {
    let mut places = HashMap::new();
    let mut groups: Vec<[Vec<usize>; 2]> = Vec::new();
    for side in [1, 0] {
        for row in 0..tables[side].n_rows {
            let key = key(&columns[side], row, &configurations[side]);
            let place = *places.entry(key).or_insert(groups.len());
            if place == groups.len() {
                groups.push([Vec::new(), Vec::new()]);
            }
            groups[place][side].push(row);
        }
    }
    groups.retain(|rows| rows.iter().all(|rows| !rows.is_empty()));
    groups
}

/// Returns the entry of a row as text, with the display name and unit of its column. A configuration number is replaced by the settings of the configuration.
fn entry(one: Setting, row: usize, configurations: &Configurations) -> Option<String> {
    let value = one.data.value(row)?;
    let name = &one.column.name;
    let is_number = CONFIGURATION_NUMBERS.contains(&&name[..]);
    Some(match configurations.get(&one.data.key(row)) {
        Some(settings) if is_number => format!("{name} = {settings};"),
        _ => format!("{name} = {value} {};", one.column.unit),
    })
}

/// Two versions of a table.
struct Pair<'a> {
    tables: [&'a Table; 2],
    configurations: &'a [Configurations; 2],
    /// Indices of corresponding rows in both versions.
    rows: Vec<[usize; 2]>,
}

impl<'a> Pair<'a> {
    /// Pairs the rows of two versions of a table that have equal settings. Rows that no setting distinguishes are paired in order.
    fn new(tables: [&'a Table; 2], configurations: &'a [Configurations; 2]) -> Self {
        let columns = tables.map(|table| Setting::of_roles(table, &KEY_ROLES).collect::<Vec<_>>());
        let common = common_rows(tables, &columns, configurations).into_iter();
        let rows = common.flat_map(|[theirs, ours]| theirs.into_iter().zip(ours));
        let mut rows: Vec<[usize; 2]> = rows.map(|(theirs, ours)| [theirs, ours]).collect();
        rows.sort_by_key(|[_, ours]| *ours);
        Self {
            rows,
            tables,
            configurations,
        }
    }

    fn changed_columns(&self) -> Vec<ChangedColumn> {
        let [first, second] = self.tables;
        let has = |table: &Table, column: &Column| table.place(&column.name).is_some();
        let mut changed = Vec::new();
        for (of, other, change) in [
            (first, second, "in the first run alone"),
            (second, first, "in the second run alone"),
        ] {
            let alone = of.columns.iter().filter(|column| !has(other, column));
            changed.extend(alone.map(|column| self.changed(column, [0, 0], change.to_owned())));
        }
        let compared = Setting::all(second)
            .filter(|one| !KEY_ROLES.contains(&one.column.role) && has(first, one.column));
        changed.extend(compared.filter_map(|one| self.changed_column(one)));
        changed
    }

    fn changed(&self, column: &Column, counts: [usize; 2], change: String) -> ChangedColumn {
        let [n_same, n_changed] = counts;
        ChangedColumn {
            table: self.tables[1].file.to_owned(),
            column: column.name.to_string(),
            n_same,
            n_changed,
            change,
        }
    }

    /// Compares one column in the corresponding rows of both versions; returns `None` if all entries are equal.
    fn changed_column(&self, after: Setting) -> Option<ChangedColumn> {
        let (column, data) = self.tables[0].column(&after.column.name)?;
        let before = Setting { column, data };
        let differs = |&&[theirs, ours]: &&[usize; 2]| {
            entry(before, theirs, &self.configurations[0])
                != entry(after, ours, &self.configurations[1])
        };
        let rows: Vec<[usize; 2]> = self.rows.iter().filter(differs).copied().collect();
        let counts = [self.rows.len() - rows.len(), rows.len()];
        (!rows.is_empty()).then(|| self.changed(after.column, counts, words(before, after, &rows)))
    }
}

/// Returns the changes of a column as text: the range of the differences of numbers, and the changes of other entries in the order of first occurrence, such as
/// `226 from right to not finite`.
fn words(before: Setting, after: Setting, rows: &[[usize; 2]]) -> String {
    let word = |value: Option<Value>| value.map(|value| after.column.value_words(&value));
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut changes: Vec<(String, usize)> = Vec::new();
    for &[theirs, ours] in rows {
        let (theirs, ours) = (before.data.value(theirs), after.data.value(ours));
        if let (Some(Value::Number(theirs)), Some(Value::Number(ours))) = (&theirs, &ours) {
            (low, high) = (low.min(ours - theirs), high.max(ours - theirs));
            continue;
        }
        let [theirs, ours] = [theirs, ours].map(|value| word(value).unwrap_or("nothing".into()));
        let change = format!("from {theirs} to {ours}");
        match changes.iter_mut().find(|(known, _)| *known == change) {
            Some((_, n)) => *n += 1,
            None => changes.push((change, 1)),
        }
    }
    let range = (low <= high).then(|| match [low, high].map(short_number) {
        [low, high] if low == high => format!("by {low}"),
        [low, high] => format!("by {low} to {high}"),
    });
    let others = changes.len().saturating_sub(MAX_CHANGES);
    let listed = changes.into_iter().take(MAX_CHANGES);
    let listed = listed.map(|(change, n)| format!("{n} {change}"));
    let others = (others > 0).then(|| "and others".to_owned());
    let all = range.into_iter().chain(listed).chain(others);
    all.collect::<Vec<_>>().join(", ")
}
