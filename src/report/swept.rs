//! Swept settings: columns whose values vary between the rows of a table.
//!
//! Charts, sentences and terminal tables show the columns that vary and state the others once. A column is dependent if other varying columns determine its
//! value; for example, m and the array determine the compression ratio. Dependent columns are not shown separately.

use crate::table::{Column, Data, Role, Table, Value};
use std::cmp::Reverse;
use std::collections::HashSet;

/// Setting of a table (choice, condition or subject): a column and its values.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// Description of the setting's column.
    pub column: &'a Column,
    /// Values of the setting, one per row of the table.
    pub data: &'a Data,
}

/// Settings of a table, divided into varying, dependent and constant settings.
pub struct Swept<'a> {
    table: &'a Table,
    /// Varying settings whose values are not determined by other settings, in column order of the table.
    pub free: Vec<Setting<'a>>,
    /// Varying settings whose values are determined by other settings.
    pub following: Vec<Setting<'a>>,
    /// Independent settings of a study in which single settings are changed, one at a time. Each row changes at most one of them from its value in the first
    /// row. The list is empty for other studies, or if there are fewer than two such settings.
    pub one_at_a_time: Vec<Setting<'a>>,
    /// Settings that have equal values in all rows.
    pub fixed: Vec<Setting<'a>>,
    /// Varying choices, without those that the conditions alone determine, such as a number of training touches that follows from the split.
    pub choices: Vec<Setting<'a>>,
}

impl<'a> Setting<'a> {
    /// Returns all columns of a table.
    pub fn all(table: &'a Table) -> impl Iterator<Item = Self> {
        let columns = table.columns.iter().zip(&table.data);
        columns.map(|(column, data)| Self { column, data })
    }

    /// Returns the columns of a table that have one of the given roles.
    pub fn of_roles(table: &'a Table, roles: &[Role]) -> impl Iterator<Item = Self> {
        Self::all(table).filter(|one| roles.contains(&one.column.role))
    }

    /// Groups rows of a table by the values of the given settings, in the order in which the values first occur.
    pub fn groups(settings: &[Self], table: &Table, rows: &[usize]) -> Vec<Vec<usize>> {
        let names: Vec<&str> = settings.iter().map(|one| &one.column.name[..]).collect();
        table.groups(&names, rows.iter().copied())
    }

    /// Returns whether the setting has different values in the given rows.
    pub fn varies(&self, rows: &[usize]) -> bool {
        self.data.varies(rows.iter().copied())
    }

    /// Returns whether the setting has a value in every given row: a number, a text, or a named absent value.
    pub fn applies(&self, rows: &[usize]) -> bool {
        let has_name = !self.column.word("").is_empty();
        has_name || rows.iter().all(|&row| self.data.value(row).is_some())
    }

    /// Returns whether two settings are the same column of a table.
    fn is(&self, other: &Self) -> bool {
        self.column.name == other.column.name
    }

    /// Returns whether the values of the setting are numbers.
    pub fn is_number(&self) -> bool {
        matches!(self.data, Data::Numbers(_))
    }

    /// Returns the name and value of the setting in a row as text, such as `m = 64`. A word that needs no name is returned alone.
    pub fn phrase(&self, row: usize) -> String {
        match self.data.value(row) {
            Some(value) => self.column.phrase(&value),
            None => format!("{} {}", self.column.words, self.label(row)),
        }
    }

    /// Returns the names and values of settings in a row as text; settings that do not apply are omitted.
    pub fn phrases(settings: &[Self], row: usize) -> String {
        let said = settings.iter().filter(|one| one.applies(&[row]));
        said.map(|one| one.phrase(row))
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// Returns the values of settings in a row in few words, such as `Gaussian, 64:1, touches 5`; settings that do not apply are omitted. A number has its name if it has no
    /// unit, or if another setting has the same unit.
    pub fn short_words(settings: &[Self], row: usize) -> String {
        let said = settings.iter().filter(|one| one.applies(&[row]));
        let said = said.map(|one| {
            let unit = &one.column.unit;
            let alike = settings.iter();
            let n_alike = alike.filter(|other| other.is_number() && other.column.unit == *unit);
            match one.is_number() && (unit.is_empty() || n_alike.count() > 1) {
                true => one.short_phrase(row),
                false => one.label(row),
            }
        });
        said.collect::<Vec<_>>().join(", ")
    }

    /// Returns the name and value of the setting in a row as text without what the name counts per, such as `touches 5` for touches per decision.
    fn short_phrase(&self, row: usize) -> String {
        let words = &self.column.words[..];
        let name = words.split(" per ").next().unwrap_or_default();
        self.phrase(row).replacen(words, name, 1)
    }

    /// Returns the value of the setting in a row as text. For an absent value, returns the column's name for it, or "none".
    pub fn label(&self, row: usize) -> String {
        match self.data.value(row) {
            Some(value) => self.column.value_words(&value),
            None => Some(self.column.word(""))
                .filter(|word| !word.is_empty())
                .unwrap_or_else(|| "none".to_owned()),
        }
    }

    /// Returns the value of the setting in a row as text for a title; a number includes the column's name.
    pub fn title(&self, row: usize) -> String {
        match self.is_number() {
            true => self.phrase(row),
            false => self.label(row),
        }
    }

    /// Returns the value of the setting in a row as a position among numbers. Returns `None` for a text, an absent value, and a number with a name, such as
    /// 0 bits for "no converter".
    pub fn position(&self, row: usize) -> Option<f64> {
        match self.data.value(row)? {
            Value::Number(number) => (!self.column.is_named(number)).then_some(number),
            Value::Word(_) => None,
        }
    }

    /// Returns one row for each distinct value of the setting: numbers ascending, then values that have no position among numbers, in the order of first
    /// occurrence.
    pub fn levels(&self, rows: &[usize]) -> Vec<usize> {
        let mut firsts = rows.to_vec();
        let position = |row: &usize| self.position(*row).unwrap_or(f64::INFINITY);
        firsts.sort_by(|a, b| position(a).total_cmp(&position(b)));
        let mut known = HashSet::new();
        firsts.retain(|&row| known.insert(self.data.key(row)));
        firsts
    }
}

impl<'a> Swept<'a> {
    /// Classifies the settings of all rows of a table.
    pub fn of(table: &'a Table) -> Self {
        Self::new(table, &table.all_rows())
    }

    /// Classifies the settings of the given rows as varying, dependent or constant.
    pub fn new(table: &'a Table, rows: &[usize]) -> Self {
        let all = Setting::of_roles(table, &[Role::Choice, Role::Condition]);
        let (mut free, fixed): (Vec<Setting>, Vec<Setting>) =
            all.partition(|one| !rows.is_empty() && one.varies(rows));
        let mut order = free.clone();
        // Of two settings that determine each other, the one that was swept has fewer values.
        order.sort_by_key(|one| {
            let rank = one.column.gives_way.unwrap_or(u8::MAX);
            (rank, Reverse(one.levels(rows).len()))
        });
        let mut following = Vec::new();
        for one in order {
            let others = without(&free, &[one]);
            // A setting that does not apply in some rows cannot determine another setting there.
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
        let mut swept = Self {
            table,
            one_at_a_time: one_at_a_time(&free, rows),
            free,
            following,
            fixed,
            choices: Vec::new(),
        };
        let conditions = swept.by_condition(rows);
        let is_choice = |one: &Setting| conditions.iter().any(|rows| one.varies(rows));
        let of_conditions = swept.following.iter().filter(|one| !is_choice(one));
        let of_conditions: Vec<Setting> = of_conditions.copied().collect();
        swept.choices = without(&swept.of_role(Role::Choice), &of_conditions);
        swept
    }

    /// Returns the varying settings that have the given role.
    pub fn of_role(&self, role: Role) -> Vec<Setting<'a>> {
        let of_role = self.varying().filter(|one| one.column.role == role);
        of_role.copied().collect()
    }

    /// Returns the varying settings: first independent settings, then those determined by others.
    pub fn varying(&self) -> impl Iterator<Item = &Setting<'a>> {
        self.free.iter().chain(&self.following)
    }

    /// Returns the main setting of charts and tables, which is the independent numeric setting with the most values. If several have equally many values, the
    /// last column is taken, because columns follow the order of processing. A setting that is absent in some rows is ranked after words, because its axis has
    /// no place for such a row.
    pub fn main(&self, rows: &[usize]) -> Option<Setting<'a>> {
        let numbers = self.free.iter().filter(|setting| setting.is_number());
        let is_there = |one: &&Setting| rows.iter().all(|&row| one.data.value(row).is_some());
        let numbers = numbers.filter(is_there);
        let main = numbers.max_by_key(|setting| setting.levels(rows).len());
        let words = self.free.iter().find(|setting| !setting.is_number());
        main.or(words).or(self.free.first()).copied()
    }

    /// Returns the values of the conditions in a row as text. If at most one condition differs at a time, only this condition is stated. The text is empty if
    /// there is one condition.
    pub fn condition_words(&self, row: usize) -> String {
        let is_zero =
            |one: &Setting| matches!(one.data.value(row), None | Some(Value::Number(0.0)));
        let conditions = self.of_role(Role::Condition);
        let is_absent = |setting: &Setting| {
            is_zero(setting) && self.one_at_a_time.iter().any(|one| one.is(setting))
        };
        let words = |said: Vec<&Setting>| {
            let said: Vec<String> = said.into_iter().map(|one| one.phrase(row)).collect();
            said.join(", ")
        };
        let said: Vec<&Setting> = conditions.iter().filter(|one| !is_absent(one)).collect();
        if !said.is_empty() {
            return words(said);
        }
        // The signal is ideal if the conditions that all rows share are zero, too.
        let mut fixed = self
            .fixed
            .iter()
            .filter(|one| one.column.role == Role::Condition);
        match conditions.is_empty() || !fixed.all(|one| !one.is_number() || is_zero(one)) {
            true => words(conditions.iter().collect()),
            false => "an ideal signal".to_owned(),
        }
    }

    /// Returns the values of the varying choices in a row as text. A choice that the conditions alone determine is omitted.
    pub fn choice_words(&self, row: usize) -> String {
        Setting::phrases(&self.choices, row)
    }

    /// Returns the varying choices that no other settings determine.
    pub fn free_choices(&self) -> Vec<Setting<'a>> {
        let free = self.free.iter().copied();
        free.filter(|one| one.column.role == Role::Choice).collect()
    }

    /// Groups rows by condition, in the order in which the conditions first occur.
    pub fn by_condition(&self, rows: &[usize]) -> Vec<Vec<usize>> {
        Setting::groups(&self.of_role(Role::Condition), self.table, rows)
    }
}

/// Returns the choices and conditions with an equal value in all given rows as phrases without line breaks; those for which `is_said` returns false are omitted.
pub fn constant_phrases(
    table: &Table,
    rows: &[usize],
    is_said: impl Fn(&Setting) -> bool,
) -> Vec<String> {
    let settings = Setting::of_roles(table, &[Role::Choice, Role::Condition]);
    let has_one = |one: &Setting| {
        let value = rows.first().and_then(|&row| one.data.value(row));
        value.is_some() && !one.varies(rows) && is_said(one)
    };
    let phrases = settings
        .filter(has_one)
        .map(|one| one.phrase(rows[0]).replace(' ', "\u{a0}"));
    phrases.collect()
}

/// Returns the given settings without some of them.
pub fn without<'a>(settings: &[Setting<'a>], some: &[Setting]) -> Vec<Setting<'a>> {
    let is_kept = |one: &Setting| !some.iter().any(|other| other.is(one));
    settings.iter().copied().filter(is_kept).collect()
}

/// Returns all numeric settings, if each row differs from the first row in at most one of them. Otherwise, tries only the settings of the signal.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::File;

    crate::row! {
    /// Row of a test table.
    pub struct Errors {
        /// Noise of all rows.
        noise: f64 => Condition in "%": Share;
        /// Gain error.
        gain: f64 => Condition in "%": Share;
        /// Drift.
        drift: f64 => Condition in "%": Share;
    } }

    #[test]
    fn a_signal_is_ideal_only_if_the_conditions_of_all_rows_are_zero_too() {
        let rows = |noise: f64| {
            let errors = [(0.0, 0.0), (0.1, 0.0), (0.0, 0.1)];
            errors.map(|(gain, drift)| Errors { noise, gain, drift })
        };
        for (noise, words) in [(0.0, "an ideal signal"), (0.2, "gain 0 %, drift 0 %")] {
            let table = File::new("errors.csv", "Errors", "")
                .table(&rows(noise))
                .unwrap();
            let swept = Swept::new(&table, &[0, 1, 2]);
            assert_eq!(swept.condition_words(0), words);
            assert_eq!(swept.condition_words(1), "gain 10 %");
        }
    }
}
