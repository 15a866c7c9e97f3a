//! Which settings vary over the rows of a table, and how.
//!
//! Charts, sentences and terminal tables show the columns that vary and state the others once. A column whose value is known from the other
//! varying ones (the ratio, when m and the array are chosen) follows them and gets no place of its own.

use crate::table::{Column, Data, Role, Table, Value};
use std::collections::HashSet;

/// Settings that follow from others are given up in this order: m and the ratio say the same twice at one array; the array's sides follow
/// its pitch when nx stays. One that a study can only choose directly is dropped last.
const GIVEN_UP_FIRST: [&str; 16] = [
    "nx",
    "ny",
    "measurements",
    "ratio",
    "size_mm",
    "pitch_mm",
    "c",
    "train_touches",
    "mislabelled_fraction",
    "class_imbalance",
    "fused_touches",
    "smoothing_mm",
    "noise_std",
    "frames",
    "over_time",
    "features",
];

/// A column with its values.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// What it is.
    pub column: &'a Column,
    /// Its values.
    pub data: &'a Data,
}

/// The choices and conditions of a table, by whether they vary.
pub struct Swept<'a> {
    table: &'a Table,
    /// Those that vary by themselves, in the order of the table.
    pub free: Vec<Setting<'a>>,
    /// Those that vary only because others do.
    pub following: Vec<Setting<'a>>,
    /// Of the free ones those of which at most one leaves its first value in any row; none if there are fewer than two.
    pub one_at_a_time: Vec<Setting<'a>>,
    /// Those with one value.
    pub fixed: Vec<Setting<'a>>,
}

impl<'a> Setting<'a> {
    /// All columns of a table.
    pub fn all(table: &'a Table) -> impl Iterator<Item = Self> {
        let columns = table.columns.iter().zip(&table.data);
        columns.map(|(column, data)| Self { column, data })
    }

    /// Those that have one of some roles.
    pub fn of_roles(table: &'a Table, roles: &[Role]) -> impl Iterator<Item = Self> {
        Self::all(table).filter(|one| roles.contains(&one.column.role))
    }

    /// Rows of a table by the values of some of its settings, in the order in which rows first have them.
    pub fn groups(settings: &[Self], table: &Table, rows: &[usize]) -> Vec<Vec<usize>> {
        let names: Vec<&str> = settings.iter().map(|one| &one.column.name[..]).collect();
        table.groups(&names, rows.iter().copied())
    }

    /// Whether it varies over rows.
    pub fn varies(&self, rows: &[usize]) -> bool {
        self.data.varies(rows.iter().copied())
    }

    /// Whether it has a value in all rows: a number, a word, or an absent one that has a name.
    pub fn applies(&self, rows: &[usize]) -> bool {
        let has_name = !self.column.word("").is_empty();
        has_name || rows.iter().all(|&row| self.data.value(row).is_some())
    }

    /// Whether its values are numbers.
    pub fn is_number(&self) -> bool {
        matches!(self.data, Data::Numbers(_))
    }

    /// Its name and value in a row: `m = 64`; of words, the value alone where that says it.
    pub fn phrase(&self, row: usize) -> String {
        match self.data.value(row) {
            Some(value) => self.column.phrase(&value),
            None => format!("{} {}", self.column.words, self.label(row)),
        }
    }

    /// Its value in a row; of an absent one, what the column calls it.
    pub fn label(&self, row: usize) -> String {
        match self.data.value(row) {
            Some(value) => self.column.value_words(&value),
            None => Some(self.column.word(""))
                .filter(|word| !word.is_empty())
                .unwrap_or_else(|| "none".to_owned()),
        }
    }

    /// Its value in a row, for a title: a number says what it is of.
    pub fn title(&self, row: usize) -> String {
        match self.is_number() {
            true => self.phrase(row),
            false => self.label(row),
        }
    }

    /// A row for each of its values: numbers rising, words in the order of first rows.
    pub fn levels(&self, rows: &[usize]) -> Vec<usize> {
        let mut firsts = rows.to_vec();
        if let Data::Numbers(numbers) = self.data {
            firsts.sort_by(|&a, &b| numbers[a].total_cmp(&numbers[b]));
        }
        let mut known = HashSet::new();
        firsts.retain(|&row| known.insert(self.data.key(row)));
        firsts
    }
}

impl<'a> Swept<'a> {
    /// Of some rows of a table.
    pub fn of(table: &'a Table, rows: &[usize]) -> Self {
        let all = Setting::of_roles(table, &[Role::Choice, Role::Condition]);
        let (mut free, fixed): (Vec<Setting>, Vec<Setting>) =
            all.partition(|one| !rows.is_empty() && one.varies(rows));
        let mut order = free.clone();
        order.sort_by_key(|one| {
            let mut given_up = GIVEN_UP_FIRST.iter();
            let place = given_up.position(|name| *name == one.column.name);
            place.unwrap_or(GIVEN_UP_FIRST.len())
        });
        let mut following = Vec::new();
        for one in order {
            let others = without(&free, &one);
            // A setting that does not apply in some rows does not tell what another one is there.
            let telling: Vec<Setting> = others
                .iter()
                .filter(|other| other.applies(rows))
                .copied()
                .collect();
            let alike = Setting::groups(&telling, table, rows);
            if !telling.is_empty() && alike.iter().all(|rows| !one.varies(rows)) {
                following.push(one);
                free = others;
            }
        }
        Self {
            table,
            one_at_a_time: one_at_a_time(&free, rows),
            free,
            following,
            fixed,
        }
    }

    /// Rows by the values of some settings, in the order in which rows first have them.
    pub fn groups(&self, settings: &[Setting], rows: &[usize]) -> Vec<Vec<usize>> {
        Setting::groups(settings, self.table, rows)
    }

    /// Those that vary and have a role.
    pub fn of_role(&self, role: Role) -> Vec<Setting<'a>> {
        let of_role = self.varying().filter(|one| one.column.role == role);
        of_role.copied().collect()
    }

    /// Those that vary, by themselves or with others.
    pub fn varying(&self) -> impl Iterator<Item = &Setting<'a>> {
        self.free.iter().chain(&self.following)
    }

    /// What a chart and a table show first: of those that vary by themselves the number of most values, of equals the last, since what is done
    /// with measurements stands behind how they are made. Numbers that do not apply in all rows come after words, since their axis has no place for such
    /// a row.
    pub fn main(&self, rows: &[usize]) -> Option<Setting<'a>> {
        let numbers = self.free.iter().filter(|setting| setting.is_number());
        let numbers = numbers.filter(|setting| numbers_are_there(setting, rows));
        let main = numbers.max_by_key(|setting| setting.levels(rows).len());
        let words = self.free.iter().find(|setting| !setting.is_number());
        main.or(words).or(self.free.first()).copied()
    }

    /// The conditions of the world in a row, in words; where one thing at a time happens, that one. Empty if there is one condition.
    pub fn condition_words(&self, row: usize) -> String {
        let conditions = self.of_role(Role::Condition);
        let is_absent = |setting: &Setting| {
            let mut one_at_a_time = self.one_at_a_time.iter();
            one_at_a_time.any(|one| one.column.name == setting.column.name)
                && matches!(setting.data.value(row), None | Some(Value::Number(0.0)))
        };
        let said = conditions.iter().filter(|one| !is_absent(one));
        let said: Vec<String> = said.map(|one| one.phrase(row)).collect();
        match said.is_empty() && !conditions.is_empty() {
            true => "an ideal signal".to_owned(),
            false => said.join(", "),
        }
    }

    /// The choices of a row that vary, in words.
    pub fn choice_words(&self, row: usize) -> String {
        // What does not apply to a row is not said of it.
        let applies =
            |one: &&Setting| one.data.value(row).is_some() || !one.column.word("").is_empty();
        let choices = self.of_role(Role::Choice);
        let said = choices.iter().filter(applies).map(|one| one.phrase(row));
        said.collect::<Vec<_>>().join(", ")
    }

    /// Rows by their conditions, in the order in which rows first have them.
    pub fn by_condition(&self, rows: &[usize]) -> Vec<Vec<usize>> {
        self.groups(&self.of_role(Role::Condition), rows)
    }
}

/// Whether a setting of numbers has one in every row.
fn numbers_are_there(setting: &Setting, rows: &[usize]) -> bool {
    rows.iter().all(|&row| setting.data.value(row).is_some())
}

/// All settings but one.
pub fn without<'a>(settings: &[Setting<'a>], one: &Setting) -> Vec<Setting<'a>> {
    let others = settings.iter().copied();
    others
        .filter(|other| other.column.name != one.column.name)
        .collect()
}

/// Returns all numbers, or else those of the signal, if each row leaves the first row's value of at most one of them.
fn one_at_a_time<'a>(free: &[Setting<'a>], rows: &[usize]) -> Vec<Setting<'a>> {
    let is_signal = |setting: &Setting| {
        setting.column.role == Role::Condition || setting.column.name == "smoothing_mm"
    };
    let numbers = free.iter().copied().filter(Setting::is_number);
    let numbers: Vec<Setting> = numbers.collect();
    let signal = numbers.iter().copied().filter(is_signal).collect();
    let is_one_at_a_time = |settings: &Vec<Setting>| {
        let leaves = |row: usize| {
            let left = settings.iter().filter(|one| one.varies(&[rows[0], row]));
            left.count()
        };
        settings.len() > 1 && rows.iter().all(|&row| leaves(row) <= 1)
    };
    let found = [numbers, signal].into_iter().find(is_one_at_a_time);
    found.unwrap_or_default()
}
