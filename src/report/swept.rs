//! Which settings vary over the rows of a table, and how.
//!
//! Charts, sentences and terminal tables show the columns that vary and state the others once. A column whose value is known from the other
//! varying ones (the ratio, when m and the array are chosen) follows them and gets no place of its own.

use crate::table::{Column, Data, Role, Table, Value};
use std::collections::{HashMap, HashSet};

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
    /// Whether it varies over rows.
    pub fn varies(&self, rows: &[usize]) -> bool {
        rows.iter()
            .any(|&row| self.data.key(row) != self.data.key(rows[0]))
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

    /// Its value in a row.
    pub fn label(&self, row: usize) -> String {
        match self.data.value(row) {
            Some(value) => self.column.value_words(&value),
            None => Some(self.column.word(""))
                .filter(|word| !word.is_empty())
                .unwrap_or_else(|| "none".to_owned()),
        }
    }

    /// A row for each of its values: numbers rising, words in the order of first rows.
    pub fn levels(&self, rows: &[usize]) -> Vec<usize> {
        let mut known = HashSet::new();
        let mut firsts: Vec<usize> = rows
            .iter()
            .copied()
            .filter(|&row| known.insert(self.data.key(row)))
            .collect();
        if let Data::Numbers(numbers) = self.data {
            firsts.sort_by(|&a, &b| numbers[a].total_cmp(&numbers[b]));
        }
        firsts
    }
}

impl<'a> Swept<'a> {
    /// Of some rows of a table; of columns that follow from each other, those that are named first are given up first.
    pub fn of(table: &'a Table, rows: &[usize], given_up_first: &[&str]) -> Self {
        let columns = table.columns.iter().zip(&table.data);
        let all =
            columns.filter(|(column, _)| matches!(column.role, Role::Choice | Role::Condition));
        let all = all.map(|(column, data)| Setting { column, data });
        let (mut free, fixed): (Vec<Setting>, Vec<Setting>) =
            all.partition(|setting| !rows.is_empty() && setting.varies(rows));
        let place = |setting: &Setting| {
            given_up_first
                .iter()
                .position(|name| *name == setting.column.name)
        };
        let mut order: Vec<&Column> = free.iter().map(|setting| setting.column).collect();
        order.sort_by_key(|column| {
            given_up_first
                .iter()
                .position(|name| *name == column.name)
                .unwrap_or(usize::MAX)
        });
        let mut following = Vec::new();
        for column in order {
            let (others, own): (Vec<Setting>, Vec<Setting>) =
                free.iter().partition(|one| one.column.name != column.name);
            if !others.is_empty() && follows(own[0], &others, rows) {
                following.extend(own);
                free = others;
            }
        }
        following.sort_by_key(|setting| place(setting).is_none());
        Self {
            one_at_a_time: one_at_a_time(&free, rows),
            free,
            following,
            fixed,
        }
    }

    /// Those that vary, by themselves or with others.
    pub fn varying(&self) -> impl Iterator<Item = &Setting<'a>> {
        self.free.iter().chain(&self.following)
    }

    /// The conditions of the world in a row, in words; where one thing at a time happens, that one. Empty if there is one condition.
    pub fn condition_words(&self, row: usize) -> String {
        let conditions = self
            .varying()
            .filter(|setting| setting.column.role == Role::Condition);
        let conditions: Vec<&Setting> = conditions.collect();
        let is_absent = |setting: &Setting| {
            let is_one = self
                .one_at_a_time
                .iter()
                .any(|one| one.column.name == setting.column.name);
            is_one && setting.data.value(row) == Some(Value::Number(0.0))
        };
        let said: Vec<String> = conditions
            .iter()
            .filter(|one| !is_absent(one))
            .map(|one| one.phrase(row))
            .collect();
        match said.is_empty() && !conditions.is_empty() {
            true => "an ideal signal".to_owned(),
            false => said.join(", "),
        }
    }

    /// The choices of a row that vary, in words.
    pub fn choice_words(&self, row: usize) -> String {
        let choices = self
            .varying()
            .filter(|setting| setting.column.role == Role::Choice);
        // What does not apply to a row is not said of it.
        let applies =
            |one: &&Setting| one.data.value(row).is_some() || !one.column.word("").is_empty();
        choices
            .filter(applies)
            .map(|setting| setting.phrase(row))
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// Rows by their conditions, in the order in which rows first have them.
    pub fn by_condition(&self, rows: &[usize]) -> Vec<Vec<usize>> {
        let conditions: Vec<Setting> = self
            .varying()
            .filter(|s| s.column.role == Role::Condition)
            .copied()
            .collect();
        groups(&conditions, rows)
    }
}

/// Rows by the values of some settings, in the order in which rows first have them.
pub fn groups(settings: &[Setting], rows: &[usize]) -> Vec<Vec<usize>> {
    let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
    let mut found: Vec<Vec<usize>> = Vec::new();
    for &row in rows {
        let key = settings
            .iter()
            .map(|setting| setting.data.key(row))
            .collect();
        let group = *known.entry(key).or_insert_with(|| {
            found.push(Vec::new());
            found.len() - 1
        });
        found[group].push(row);
    }
    found
}

/// Whether others say what the value of a setting is.
fn follows(setting: Setting, others: &[Setting], rows: &[usize]) -> bool {
    let mut known: HashMap<Vec<u64>, u64> = HashMap::new();
    rows.iter().all(|&row| {
        let key = others.iter().map(|other| other.data.key(row)).collect();
        *known.entry(key).or_insert_with(|| setting.data.key(row)) == setting.data.key(row)
    })
}

/// The numbers of the signal, where each row leaves the first row's value of at most one of them.
fn one_at_a_time<'a>(free: &[Setting<'a>], rows: &[usize]) -> Vec<Setting<'a>> {
    let is_signal = |setting: &&Setting| {
        setting.is_number()
            && (setting.column.role == Role::Condition || setting.column.name == "smoothing_mm")
    };
    let signal: Vec<Setting> = free.iter().filter(is_signal).copied().collect();
    let leaves = |row: usize| {
        signal
            .iter()
            .filter(|one| one.data.key(row) != one.data.key(rows[0]))
            .count()
    };
    match signal.len() > 1 && rows.iter().all(|&row| leaves(row) <= 1) {
        true => signal,
        false => Vec::new(),
    }
}
