//! Functions that select, group and format the rows of a table.

use super::{Column, Data, Role, Scale, Shown, Table, Value};
use std::collections::HashMap;

impl Table {
    /// Groups the given rows by their values in some columns; the groups are in the order in which the values first occur. Missing columns are ignored.
    pub fn groups(
        &self,
        columns: &[&str],
        rows: impl IntoIterator<Item = usize>,
    ) -> Vec<Vec<usize>> {
        let columns = columns.iter().filter_map(|name| self.column(name));
        let columns: Vec<&Data> = columns.map(|(_, data)| data).collect();
        let key = |row: usize| -> Vec<u64> { columns.iter().map(|data| data.key(row)).collect() };
        let mut places = HashMap::new();
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for row in rows {
            let place = *places.entry(key(row)).or_insert(groups.len());
            if place == groups.len() {
                groups.push(Vec::new());
            }
            groups[place].push(row);
        }
        groups
    }

    /// Returns a filter for rows that have the value of `row` in a column; `None` if the value is absent.
    pub fn shown(&self, column: &str, row: usize) -> Option<Shown> {
        Some(Shown::new(column, self.column(column)?.1.value(row)?))
    }

    /// Returns the rows that pass all filters; numbers are compared with a small tolerance. An empty word selects absent values.
    pub fn rows_shown(&self, shown: &[Shown]) -> Vec<usize> {
        let passes = |row: usize, one: &Shown| {
            let value = self
                .column(&one.column)
                .and_then(|(_, data)| data.value(row));
            value.unwrap_or_else(|| "".into()).agrees(&one.value)
        };
        let mut rows = self.all_rows();
        rows.retain(|&row| shown.iter().all(|one| passes(row, one)));
        rows
    }

    /// Returns a table of the given rows and columns, without a file; columns that the table lacks are left out.
    pub fn select(
        &self,
        (file, title): (&'static str, &'static str),
        rows: &[usize],
        columns: &[&str],
    ) -> Self {
        let kept = columns.iter().filter_map(|name| self.column(name));
        let kept = kept.map(|(column, data)| (column.clone(), data.select(rows)));
        let (columns, data) = kept.unzip();
        Self {
            file,
            title,
            note: String::new(),
            repeats: self.repeats,
            is_summary: true,
            columns,
            data,
            n_rows: rows.len(),
            csv: Vec::new(),
        }
    }

    /// Returns the indices of all rows.
    pub fn all_rows(&self) -> Vec<usize> {
        (0..self.n_rows).collect()
    }

    /// Returns the names of all columns of the table that have the given role.
    pub fn of_role(&self, role: Role) -> Vec<&str> {
        let columns = self.columns.iter().filter(|column| column.role == role);
        columns.map(|column| column.name.as_ref()).collect()
    }

    /// Returns whether a row has the wanted value in a column; numbers are compared with a small tolerance.
    pub fn has_setting(&self, column: &str, row: usize, wanted: &Value) -> bool {
        let known = self.column(column).and_then(|(_, data)| data.value(row));
        known.is_some_and(|known| known.agrees(wanted))
    }

    /// Returns a list of the distinct values of a column for an error message, such as `one of 16, 64`. Returns an empty text if the column has no values.
    pub fn one_of(&self, column: &str, rows: impl IntoIterator<Item = usize>) -> String {
        let firsts = self.groups(&[column], rows);
        let data = self.column(column).map(|(_, data)| data);
        let values = firsts.iter().filter_map(|rows| data?.value(rows[0]));
        let values: Vec<String> = values.map(|value| value.to_string()).collect();
        match values.is_empty() {
            true => String::new(),
            false => format!("one of {}", values.join(", ")),
        }
    }

    /// Returns the lower and upper end of the interval of a row's value; `None` if an end is absent.
    pub fn interval(&self, column: &Column, row: usize) -> Option<[f64; 2]> {
        let ends = column.interval.as_ref()?.each_ref();
        let ends = ends.map(|end| self.number(end, row));
        ends.iter().all(|end| end.is_finite()).then_some(ends)
    }

    /// Formats the value of a row with its interval, such as `0.93 [0.90, 0.95]`. Fractions have two decimal places; from 0.995 to below 1 they have four, so
    /// that they are not rounded to 1. Other numbers have the digits of which the width of the interval has two. Returns an empty text if the value is absent.
    pub fn bounded(&self, column: &Column, row: usize) -> String {
        let value = self.number(&column.name, row);
        let is_share = column.scale == Scale::Share && column.unit.is_empty();
        let interval = self.interval(column, row);
        let said = |number: f64| match (value, interval) {
            (0.995..1.0, _) if is_share => format!("{number:.4}"),
            _ if is_share => format!("{number:.2}"),
            (_, Some([low, high])) if low < high => {
                let step = 10f64.powf((high - low).log10().floor() - 1.0);
                column.tick((number / step).round() * step)
            }
            _ => column.tick(number),
        };
        let unit = match column.number_words(value).rsplit_once(' ') {
            Some((_, unit)) if unit == column.unit => format!(" {unit}"),
            _ => String::new(),
        };
        match interval {
            _ if value.is_nan() => self.words(&column.name, row),
            Some([low, high]) => format!("{} [{}, {}]{unit}", said(value), said(low), said(high)),
            None if is_share => said(value),
            None => column.number_words(value),
        }
    }

    /// Returns the number in a row and a column of the table; NaN if the value is absent.
    pub fn number(&self, column: &str, row: usize) -> f64 {
        self.numbers(column)
            .map_or(f64::NAN, |numbers| numbers[row])
    }

    /// Returns the word in a row and a column of the table, as written in the file; empty if the value is absent.
    pub fn word(&self, column: &str, row: usize) -> &str {
        match self.column(column) {
            Some((_, Data::Words { levels, codes })) => &levels[codes[row] as usize],
            _ => "",
        }
    }

    /// Formats the value in a row and a column of the table with its unit; empty if the value is absent.
    pub fn words(&self, column: &str, row: usize) -> String {
        let found = self.column(column);
        let found = found.and_then(|(column, data)| Some(column.value_words(&data.value(row)?)));
        found.unwrap_or_default()
    }
}
