//! Result table: columns of numbers and texts, and the content of its file.

use super::{Better, Column, Role, Scale};
use crate::error::{Error, Result};
use serde::Serialize;
use std::collections::HashMap;
use std::fmt;
use std::path::Path;

/// Result table of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Name of the CSV file, such as `accuracy.csv`.
    pub file: &'static str,
    /// Title of the table for a heading, such as `Accuracy of every trial`.
    pub title: &'static str,
    /// Explanation of the table for the reader, one or two sentences; may be empty.
    pub note: String,
    /// Whether repeated runs of a study write identical tables; false for tables of computing times.
    pub repeats: bool,
    /// Whether each row summarises all work items of a study. A part of the items would then give other rows.
    pub is_summary: bool,
    /// Columns of the table, in the order of the file.
    pub columns: Vec<Column>,
    /// Values of the columns, in the order of `columns`.
    pub data: Vec<Data>,
    /// Number of rows of the table.
    pub n_rows: usize,
    /// Content of the CSV file; empty for a table without a file.
    pub csv: Vec<u8>,
}

/// Values of one column, with one value per row.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// Column of numbers; NaN for an absent value.
    Numbers(Vec<f64>),
    /// Column of texts, stored as codes; an empty text is an absent value.
    Words {
        /// Distinct texts in the column, in the order in which they first occur.
        levels: Vec<String>,
        /// Index in `levels` of the text in each row.
        codes: Vec<u32>,
    },
}

/// Value of one table entry: a number or a word.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// Number in the unit of its column.
    Number(f64),
    /// Word or code, as written in the file.
    Word(String),
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for Value {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

/// Formats the value as it is written in CSV files.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Word(word) => f.write_str(word),
        }
    }
}

/// Relative difference, with respect to the larger number, up to which two settings are considered equal. A ratio of 100 on 4,096 taxels, for example, gives 41
/// measurements, which is a ratio of 99.90. With a larger value, neighbouring settings are merged; with a smaller value, this ratio is rejected.
const SAME_SETTING: f64 = 1e-3;

impl Value {
    /// Returns whether two settings have equal values; numbers are compared with a small tolerance.
    pub fn agrees(&self, wanted: &Self) -> bool {
        match (self, wanted) {
            (Self::Number(a), Self::Number(b)) => {
                (a - b).abs() <= SAME_SETTING * a.abs().max(b.abs())
            }
            _ => self == wanted,
        }
    }
}

impl Data {
    /// Returns whether the given rows have different values in this column.
    pub fn varies(&self, rows: impl IntoIterator<Item = usize>) -> bool {
        let mut keys = rows.into_iter().map(|row| self.key(row));
        keys.next()
            .is_some_and(|first| keys.any(|key| key != first))
    }

    /// Returns the values in the given rows.
    pub(super) fn select(&self, rows: &[usize]) -> Self {
        match self {
            Self::Numbers(numbers) => Self::Numbers(rows.iter().map(|&row| numbers[row]).collect()),
            Self::Words { levels, codes } => Self::Words {
                levels: levels.clone(),
                codes: rows.iter().map(|&row| codes[row]).collect(),
            },
        }
    }

    /// Returns a number that identifies the value in a row; numbers are equal exactly if the values are equal.
    pub fn key(&self, row: usize) -> u64 {
        match self {
            Self::Numbers(numbers) => numbers[row].to_bits(),
            Self::Words { codes, .. } => u64::from(codes[row]),
        }
    }

    /// Returns the position of a text among the distinct texts of the column; `None` if the column lacks it.
    pub fn level(&self, word: &str) -> Option<usize> {
        match self {
            Self::Numbers(_) => None,
            Self::Words { levels, .. } => levels.iter().position(|level| level == word),
        }
    }

    /// Returns the value of the column in a row, or `None` if it is absent.
    pub fn value(&self, row: usize) -> Option<Value> {
        match self {
            Self::Numbers(numbers) => Some(numbers[row])
                .filter(|n| !n.is_nan())
                .map(Value::Number),
            Self::Words { levels, codes } => Some(&levels[codes[row] as usize])
                .filter(|word| !word.is_empty())
                .map(|word| Value::Word(word.clone())),
        }
    }
}

impl Table {
    /// Returns the table with a different note; the note explains the table to the reader.
    pub fn noted(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Returns whether each row of the table describes a choice with a value and a cost, and not one of several subjects.
    pub fn offers_choices(&self) -> bool {
        let has = |role: Role| self.columns.iter().any(|column| column.role == role);
        let has_value = has(Role::Value(Better::More)) || has(Role::Value(Better::Less));
        has(Role::Choice) && has(Role::Cost) && has_value && !self.varies_in(Role::Subject)
    }

    /// Returns whether the rows of the table differ in a choice.
    pub fn compares_choices(&self) -> bool {
        self.varies_in(Role::Choice)
    }

    /// Returns whether a column with this role has several values.
    fn varies_in(&self, role: Role) -> bool {
        let mut columns = self.columns.iter().zip(&self.data);
        columns.any(|(column, data)| column.role == role && data.varies(0..self.n_rows))
    }

    /// Returns the index of the column with this name; `None` if there is none.
    pub fn place(&self, column: &str) -> Option<usize> {
        self.columns.iter().position(|known| known.name == column)
    }

    /// Returns the column with this name, and its values; `None` if there is none.
    pub fn column(&self, column: &str) -> Option<(&Column, &Data)> {
        let place = self.place(column)?;
        Some((&self.columns[place], &self.data[place]))
    }

    /// Returns the numbers of a column, or `None` if there is no numeric column with this name.
    pub fn numbers(&self, column: &str) -> Option<&[f64]> {
        match self.column(column)? {
            (_, Data::Numbers(numbers)) => Some(numbers),
            _ => None,
        }
    }

    /// Returns a copy of the table with additional columns. The copy has no CSV file: its content is empty.
    pub fn with(
        &self,
        (file, title): (&'static str, &'static str),
        more: impl IntoIterator<Item = (Column, Data)>,
    ) -> Self {
        let mut table = Self {
            file,
            title,
            csv: Vec::new(),
            is_summary: true,
            ..self.clone()
        };
        for (column, data) in more {
            table.columns.push(column);
            table.data.push(data);
        }
        table
    }

    /// Returns a column of another table with its values arranged for the rows of this table. Rows correspond if both tables have an equal number in the column
    /// `key`. Values are absent for rows that the other table lacks.
    pub fn look_up(&self, other: &Self, key: &str, column: &str) -> Option<(Column, Data)> {
        let ((_, known), (_, wanted)) = (other.column(key)?, self.column(key)?);
        let (column, data) = other.column(column)?;
        let rows = (0..other.n_rows).map(|row| (known.key(row), row));
        let rows: HashMap<u64, usize> = rows.collect();
        let text = |row: usize| {
            let value = data.value(*rows.get(&wanted.key(row))?)?;
            Some(value.to_string())
        };
        let mut maker = Maker::new(column.scale);
        for row in 0..self.n_rows {
            maker.push(&text(row).unwrap_or_default());
        }
        Some((column.clone(), maker.data))
    }

    /// Parses the content of a CSV file as a table; `path` is only used in errors.
    pub(super) fn from_csv(
        (file, title): (&'static str, &'static str),
        known: Vec<Column>,
        path: &Path,
        csv: Vec<u8>,
    ) -> Result<Self> {
        let mut reader = csv::Reader::from_reader(&csv[..]);
        let bad = |at: Option<&csv::Position>, given: String, allowed: &str| {
            let place = csv_place(path, at.map(csv::Position::line));
            Error::input(place, given, allowed)
        };
        let broken = |e: csv::Error| bad(e.position(), e.to_string(), "a row of the table");
        let header = reader.headers().map_err(broken)?.clone();
        let mut columns: Vec<Column> = Vec::with_capacity(known.len());
        let mut all = known.into_iter();
        for name in &header {
            if columns.iter().any(|column| column.name == name) {
                let given = format!("column {name:?} twice");
                return Err(bad(header.position(), given, "each column once"));
            }
            // A required column before this one must not be skipped.
            match all.find(|column| column.name == name || !column.is_optional) {
                Some(column) if column.name == name => columns.push(column),
                other => {
                    let given = format!("column {name:?}");
                    let wanted = other.map(|column| format!("column {:?}", column.name));
                    let allowed = wanted.as_deref().unwrap_or("no such column");
                    return Err(bad(header.position(), given, allowed));
                }
            }
        }
        if let Some(missing) = all.find(|column| !column.is_optional) {
            let given = format!("no column {:?}", missing.name);
            return Err(bad(header.position(), given, "all columns of the table"));
        }
        let mut makers: Vec<Maker> = columns.iter().map(|c| Maker::new(c.scale)).collect();
        let mut n_rows = 0;
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(broken)? {
            n_rows += 1;
            for ((maker, column), text) in makers.iter_mut().zip(&columns).zip(&record) {
                if !maker.push(text) {
                    let given = format!("{text:?} in column {:?}", column.name);
                    return Err(bad(record.position(), given, "a number, or nothing"));
                }
            }
        }
        Ok(Self {
            file,
            title,
            note: String::new(),
            repeats: true,
            is_summary: false,
            columns,
            data: makers.into_iter().map(|maker| maker.data).collect(),
            n_rows,
            csv,
        })
    }
}

/// Returns a text with the path of a file and a line number, for error messages.
pub(crate) fn csv_place(path: &Path, line: Option<u64>) -> String {
    match line {
        Some(line) => format!("{}: line {line}", path.display()),
        None => path.display().to_string(),
    }
}

/// Collector of a column's values from the fields of a CSV file.
struct Maker {
    data: Data,
    /// Index into `levels` of each text found so far.
    known: HashMap<String, u32>,
}

impl Maker {
    fn new(scale: Scale) -> Self {
        let data = match scale {
            Scale::Words => Data::Words {
                levels: Vec::new(),
                codes: Vec::new(),
            },
            Scale::Linear | Scale::Log | Scale::Share => Data::Numbers(Vec::new()),
        };
        let known = HashMap::new();
        Self { data, known }
    }

    /// Appends the value of a CSV field to the column. Returns false if the column is numeric and the text is not a number.
    fn push(&mut self, text: &str) -> bool {
        match &mut self.data {
            Data::Numbers(numbers) => match (text.is_empty(), text.parse()) {
                (true, _) => numbers.push(f64::NAN),
                (false, Ok(number)) => numbers.push(number),
                (false, Err(_)) => return false,
            },
            Data::Words { levels, codes } => {
                let code = self.known.get(text).copied().unwrap_or_else(|| {
                    let code = levels.len() as u32;
                    self.known.insert(text.to_owned(), code);
                    levels.push(text.to_owned());
                    code
                });
                codes.push(code);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row;
    use crate::table::File;

    row! {
    pub struct Setting {
        method: String => Choice;
        #[serde(default, skip_serializing_if = "Option::is_none")]
        leak: Option<f64> => Condition "crosstalk" in "%": Share, optional;
        step_s: f64 => Choice "time step" in "s": Log;
    } }

    row! {
    pub struct Found {
        error: Option<f64> => Value(Less) "deflection error": Log;
    } }

    const FOUND: File<(Setting, Found)> = File::new("found.csv", "Found", "");

    fn rows(leak: Option<f64>) -> Vec<(Setting, Found)> {
        let row = |method: &str, step_s, error| {
            let method = method.to_owned();
            (
                Setting {
                    method,
                    leak,
                    step_s,
                },
                Found { error },
            )
        };
        vec![row("003", 1e-7, Some(0.1 + 0.2)), row("b, c", 2.0, None)]
    }

    #[test]
    fn a_table_holds_the_same_of_its_rows_and_of_its_file() {
        let folder = tempfile::tempdir().unwrap();
        for rows in [rows(Some(0.25)), rows(None), Vec::new()] {
            let made = FOUND.table(&rows).unwrap();
            std::fs::write(folder.path().join("found.csv"), &made.csv).unwrap();
            let read = FOUND.read(folder.path()).unwrap();
            assert_eq!((&read.columns, read.n_rows), (&made.columns, rows.len()));
            assert_eq!(read.csv, made.csv);
            let values = |table: &Table, row| -> Vec<Option<Value>> {
                table.data.iter().map(|data| data.value(row)).collect()
            };
            for row in 0..rows.len() {
                assert_eq!(values(&read, row), values(&made, row));
            }
        }
        let made = FOUND.table(&rows(None)).unwrap();
        assert_eq!(made.place("leak"), None);
        let words = made.column("method").unwrap().1.value(0);
        assert_eq!(words, Some(Value::Word("003".to_owned())));
        assert_eq!(made.numbers("error").unwrap()[0], 0.1 + 0.2);
        assert_eq!(made.column("error").unwrap().1.value(1), None);
    }

    #[test]
    fn another_header_and_a_word_for_a_number_are_told_with_their_line() {
        let folder = tempfile::tempdir().unwrap();
        for (text, wanted) in [
            ("method,step_s\n", "line 1: no column \"error\""),
            ("method,step,error\n", "line 1: column \"step\""),
            ("method,step_s,error,more\n", "line 1: column \"more\""),
            (
                "method,step_s,error\na,1,2\nb,x,3\n",
                "line 3: \"x\" in column \"step_s\"",
            ),
            ("method,step_s,error\na,1\n", "line 2"),
        ] {
            std::fs::write(folder.path().join("found.csv"), text).unwrap();
            let said = FOUND.read(folder.path()).unwrap_err().to_string();
            assert!(said.contains(wanted), "{said}");
        }
    }
}
