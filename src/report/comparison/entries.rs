//! Exact comparison of two versions of a table: the common rows, and the columns whose entries differ in these rows.
//!
//! The module `differences` compares means over trials. This module compares single entries exactly. The entries include outcomes, notes, numbers
//! that one version lacks, and tables that identify configurations by number.

use crate::report::swept::Setting;
use crate::table::{Column, Role, Table, Value};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Columns that contain configuration numbers, which may differ between runs.
const CONFIGURATION_NUMBERS: [&str; 2] = ["configuration", "best_configuration"];

/// Roles of the columns whose entries together identify a row of a table.
const KEY_ROLES: [Role; 3] = [Role::Choice, Role::Condition, Role::Subject];

/// Row indices of two corresponding rows: in the first and in the second version of a table.
type Pair = (usize, usize);

/// Result of comparing two versions of a table row by row.
pub struct TableEntries {
    /// Name of the file that contains the table.
    pub file: &'static str,
    /// Number of rows that both versions contain.
    pub n_both: usize,
    /// Number of rows that exist only in the first version.
    pub n_first_only: usize,
    /// Number of rows that exist only in the second version.
    pub n_second_only: usize,
    /// Names of the columns that only one version of the table contains.
    pub one_sided: Vec<String>,
    /// Columns in which corresponding rows of the two versions differ.
    pub columns: Vec<ColumnEntries>,
}

/// Differences in one column between the common rows of two versions of a table.
pub struct ColumnEntries {
    /// Description of the compared column.
    pub column: Column,
    /// Number of corresponding rows with equal entries.
    pub n_same: usize,
    /// Changed entries, as (text in the first version, text in the second version, number of rows), in the order of first occurrence.
    pub changes: Vec<(String, String, usize)>,
    /// Number of rows whose entry exists only in the first version.
    pub n_first_only: usize,
    /// Number of rows that exist only in the second version.
    pub n_second_only: usize,
}

impl ColumnEntries {
    /// Returns the number of rows whose entries differ between the two versions.
    pub fn n_changed(&self) -> usize {
        self.changes.iter().map(|(.., n)| n).sum()
    }
}

/// Compares all tables that exist in both folders, in the order of the second folder.
pub fn entries(first: &[Table], second: &[Table]) -> Vec<TableEntries> {
    let numbers = [first, second].map(configurations);
    let with_files = second.iter().filter(|table| !table.csv.is_empty());
    let found = with_files.filter_map(|second| {
        let first = first.iter().find(|first| first.file == second.file)?;
        Some(of_table([first, second], &numbers))
    });
    found.collect()
}

/// Returns the names of the table files that exist in the first list but not in the second.
pub fn files_of_one<'a>(one: &'a [Table], other: &[Table]) -> Vec<&'a str> {
    let files = one.iter().filter(|table| !table.csv.is_empty());
    let alone = files.filter(|table| other.iter().all(|known| known.file != table.file));
    alone.map(|table| table.file).collect()
}

/// Settings of each configuration as text; the key is the number of the configuration.
pub(super) type Configurations = HashMap<u64, String>;

fn configurations(tables: &[Table]) -> Configurations {
    let mut known = Configurations::new();
    let mut named = HashSet::new();
    for table in tables {
        let Some((column, numbers)) = table.column("configuration") else {
            continue;
        };
        // In a table of configurations, the number is a note beside their settings.
        if column.role == Role::Note {
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
    }
    known
}

/// Returns the values of some columns in a row as text with units, which does not depend on the order of the columns. An absent entry and an absent column are
/// treated alike: the setting does not apply.
pub(super) fn key(columns: &[Setting], row: usize, configurations: &Configurations) -> String {
    let entries = columns
        .iter()
        .filter_map(|one| entry(*one, row, configurations));
    let mut entries: Vec<String> = entries.collect();
    entries.sort();
    entries.concat()
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

fn of_table(tables: [&Table; 2], configurations: &[Configurations; 2]) -> TableEntries {
    let roles = KEY_ROLES;
    let mut places: HashMap<String, Vec<usize>> = HashMap::new();
    let [first, second] = tables;
    let columns = tables.map(|table| Setting::of_roles(table, &roles).collect::<Vec<_>>());
    let key = |side: usize, row| key(&columns[side], row, &configurations[side]);
    for row in (0..first.n_rows).rev() {
        places.entry(key(0, row)).or_default().push(row);
    }
    let pairs = (0..second.n_rows).filter_map(|row| {
        // If no setting distinguishes rows, they are paired in order.
        let same = places.get_mut(&key(1, row))?;
        Some((same.pop()?, row))
    });
    let pairs: Vec<Pair> = pairs.collect();
    let has = |table: &Table, column: &Column| table.place(&column.name).is_some();
    let one_sided = |of: &Table, other: &Table| -> Vec<String> {
        let columns = of.columns.iter().filter(|column| !has(other, column));
        columns.map(|column| column.name.to_string()).collect()
    };
    let compared = Setting::all(second)
        .filter(|one| !roles.contains(&one.column.role) && has(first, one.column));
    let columns = compared.filter_map(|one| of_column(one, tables, configurations, &pairs));
    TableEntries {
        file: second.file,
        n_both: pairs.len(),
        n_first_only: first.n_rows - pairs.len(),
        n_second_only: second.n_rows - pairs.len(),
        one_sided: [one_sided(first, second), one_sided(second, first)].concat(),
        columns: columns.collect(),
    }
}

/// Compares one column in the corresponding rows of both versions; returns `None` if all entries are equal.
fn of_column(
    one: Setting,
    [first, _]: [&Table; 2],
    configurations: &[Configurations; 2],
    pairs: &[Pair],
) -> Option<ColumnEntries> {
    let (column, data) = first.column(&one.column.name)?;
    let other = Setting { column, data };
    let mut changes: BTreeMap<(String, String), (usize, usize)> = BTreeMap::new();
    let (mut n_same, mut n_first_only, mut n_second_only) = (0, 0, 0);
    for (place, &(theirs, ours)) in pairs.iter().enumerate() {
        let before = entry(other, theirs, &configurations[0]);
        let after = entry(one, ours, &configurations[1]);
        if before == after {
            n_same += 1;
            continue;
        }
        n_first_only += usize::from(after.is_none());
        n_second_only += usize::from(before.is_none());
        let words = (words(other, theirs), words(one, ours));
        let (_, n) = changes.entry(words).or_insert((place, 0));
        *n += 1;
    }
    let mut changes: Vec<_> = changes.into_iter().collect();
    changes.sort_by_key(|(_, (place, _))| *place);
    let changes = changes
        .into_iter()
        .map(|((from, to), (_, n))| (from, to, n))
        .collect::<Vec<_>>();
    (!changes.is_empty()).then(|| ColumnEntries {
        column: one.column.clone(),
        n_same,
        changes,
        n_first_only,
        n_second_only,
    })
}

/// Formats the entry of a row; numbers are not rounded.
fn words(one: Setting, row: usize) -> String {
    match one.data.value(row) {
        None => "nothing".to_owned(),
        Some(Value::Number(number)) => number.to_string(),
        Some(Value::Word(word)) => one.column.word(&word),
    }
}
