//! Tables in text files: `.csv`, `.tsv` and `.txt` with a row in each line. Separators are tabs, semicolons, commas or spaces.
//!
//! **First line.** The first line is a header if it has a text above a column of numbers. Numbers 0 … k − 1 (or 1 … k) in the first line are a header, too;
//! pandas writes them as the names of k columns. Chosen columns have ascending whole numbers above readings with fractions. If the number of rows is known, such a line is a header only if the table has one line more than rows.
//! A first line of texts above texts is then a header, too.
//!
//! **Columns that are left out.** A column without a name, or with the name `Unnamed: …` of pandas, is left out. A column that counts the rows from 0 or 1 is an
//! index and is left out; the count may begin again with each touch. So is a column of at least 8 consecutive integers in any order or, beside readings with
//! fractions, of at least 8 distinct whole numbers. Empty columns behind the last separators of all lines are no columns. A note states what was left out.
//!
//! **Readings.** The columns of frames have names of one family (module `column_names`), or match given patterns.

use crate::encoding::decoded;
use crate::error::{Error, Result};
use crate::inputs::arrays::column_names::{column_families, listed, matches};
use crate::inputs::arrays::{ElementKind, Elements, FileArray};
use std::collections::{BTreeSet, HashSet};
use std::path::Path;

/// Minimum number of consecutive integers that are a count of rows. With a smaller value, entries 0 and 1 of class columns are taken as an index.
const MIN_COUNT: usize = 3;
/// Minimum number of integers that are a count from any number or an index in any order, such as that of chosen or shuffled rows. With a smaller value, whole
/// readings are taken as an index.
const MIN_RUN: usize = 8;

/// Content of a table, which decides which of its lines and columns are data.
#[derive(Clone, Copy, Debug)]
pub enum TableContent<'a> {
    /// Numbers of any kind.
    Any,
    /// Values of `n` rows, such as labels.
    Rows(usize),
    /// Readings of taxels.
    Frames {
        /// Patterns of the names of the reading columns, separated by commas; `None` for all columns, which are then one family.
        columns: Option<&'a str>,
        /// Key or option that sets the patterns, with the text that precedes its value, such as `--columns `.
        key: &'a str,
    },
}

/// Table of a text file.
#[derive(Clone, Debug)]
pub struct Table {
    /// Name of the file, for error messages.
    pub place: String,
    /// Names of the columns; `None` without a header.
    pub names: Option<Vec<String>>,
    /// Notes on columns that were left out.
    pub notes: Vec<String>,
    /// Lines of the file, each with its number from 1 and one cell for each column.
    rows: Vec<(usize, Vec<String>)>,
    separator: Option<char>,
}

impl Table {
    /// Reads a table. If the number of its rows is known, `n_rows` is this number.
    ///
    /// # Errors
    /// If the file cannot be read, is empty, or its lines differ in the number of cells.
    pub fn read(path: &Path, n_rows: Option<usize>) -> Result<Self> {
        let place = path.display().to_string();
        let bytes = crate::files::read(path).map_err(|e| Error::io(path, "read", e))?;
        let (text, note) = decoded(&place, &bytes);
        let is_data = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.starts_with('#');
        let lines = text.trim_start_matches('\u{feff}').lines();
        let lines = (1..).zip(lines).filter(is_data);
        let lines: Vec<(usize, &str)> = lines.collect();
        let Some((_, first)) = lines.first() else {
            return Err(Error::input(place, "an empty file", "rows of numbers"));
        };
        check_export(path, &lines)?;
        let separator = ['\t', ';', ','].into_iter().find(|s| first.contains(*s));
        let rows = lines.iter().map(|&(number, line)| {
            let cells = match separator {
                None => numbers_or_text(line),
                Some(separator) => cells(line, separator),
            };
            (number, cells)
        });
        let mut table = Self {
            rows: rows.collect(),
            place,
            names: None,
            notes: note.into_iter().collect(),
            separator,
        };
        if table.drop_empty_end() {
            while table.drop_empty_end() {}
            let note = "the lines end with a separator; no column follows it";
            table.notes.push(format!("{}: {note}", table.place));
        }
        table.check_decimal_commas()?;
        table.check_widths()?;
        table.check_decimal_points()?;
        if table.has_header(n_rows) {
            let names = table.rows.remove(0).1;
            let is_named = |name: &String| !name.is_empty() && !name.starts_with("Unnamed:");
            let named: Vec<usize> = (0..names.len()).filter(|&k| is_named(&names[k])).collect();
            table.names = Some(names);
            if !named.is_empty() {
                table.keep(&named, "has no name");
            }
        }
        Ok(table)
    }

    /// Returns the number of columns.
    pub fn n_columns(&self) -> usize {
        match (&self.names, self.rows.first()) {
            (Some(names), _) => names.len(),
            (None, Some((_, cells))) => cells.len(),
            (None, None) => 0,
        }
    }

    /// Returns the cells of a column.
    fn column(&self, column: usize) -> impl Iterator<Item = &str> {
        self.rows.iter().map(move |(_, cells)| &cells[column][..])
    }

    /// Returns the cells of each column.
    pub fn columns(&self) -> Vec<Vec<&str>> {
        let all = 0..self.n_columns();
        all.map(|column| self.column(column).collect()).collect()
    }

    /// Returns the columns that are no index of the rows; all columns if each of them is one.
    pub fn without_index(&self) -> Vec<usize> {
        let among_fractions = 2 * self.n_fractional(0) > self.n_columns();
        let counts = |column: &usize| {
            let numbers: Option<Vec<f64>> = self.column(*column).map(number).collect();
            numbers.is_some_and(|numbers| {
                counts_rows(&numbers) || names_rows(&numbers, among_fractions)
            })
        };
        let all = 0..self.n_columns();
        let kept: Vec<usize> = all.clone().filter(|column| !counts(column)).collect();
        match kept.is_empty() {
            true => all.collect(),
            false => kept,
        }
    }

    /// Returns the number of columns with a fraction below the first `n_above` lines.
    fn n_fractional(&self, n_above: usize) -> usize {
        let has_fraction = |&column: &usize| {
            let mut below = self.column(column).skip(n_above).filter_map(number);
            below.any(|number| number.is_finite() && number.fract() != 0.0)
        };
        let n_columns = self.rows.first().map_or(0, |(_, cells)| cells.len());
        (0..n_columns).filter(has_fraction).count()
    }

    /// Leaves out all other columns, with a note for each; `why` is the reason.
    fn keep(&mut self, columns: &[usize], why: &str) {
        if columns.len() == self.n_columns() {
            return;
        }
        for column in (0..self.n_columns()).filter(|column| !columns.contains(column)) {
            let name = self.names.as_ref().map(|names| &names[column]);
            let name = name.filter(|name| !name.is_empty());
            let name = name.map_or(String::new(), |name| format!(" `{name}`"));
            let note = format!(
                "{}: column {}{name} {why}; it is left out",
                self.place,
                column + 1
            );
            self.notes.push(note);
        }
        self.select(columns);
    }

    fn select(&mut self, columns: &[usize]) {
        let of = |cells: &Vec<String>| columns.iter().map(|&k| cells[k].clone()).collect();
        self.names = self.names.as_ref().map(of);
        for (_, cells) in &mut self.rows {
            *cells = of(cells);
        }
    }

    /// Adds a note for each column of few whole numbers beside readings with fractions, which may be the classes of the rows, and for a column that alone
    /// ascends from row to row, which may be a time.
    fn note_other_columns(&mut self) {
        let ascends = |&column: &usize| {
            let numbers = self
                .column(column)
                .map(|cell| number(cell).unwrap_or(f64::NAN));
            self.rows.len() >= MIN_RUN && numbers.is_sorted_by(|a, b| a < b)
        };
        let ascending: Vec<usize> = (0..self.n_columns()).filter(ascends).collect();
        let has_fractions = 2 * self.n_fractional(0) > self.n_columns();
        let may_be_class = |&column: &usize| {
            let mut cells = self.column(column);
            let are_whole = has_fractions && cells.all(|cell| cell.parse::<u32>().is_ok());
            let values = || self.column(column).collect::<HashSet<_>>().len();
            are_whole && (2..=self.rows.len() / 2).contains(&values())
        };
        let classes = (0..self.n_columns()).filter(may_be_class);
        let classes = classes.map(|column| (column, "has few whole numbers", "class of each row"));
        let times = ascending.iter().filter(|_| ascending.len() == 1);
        let times = times.map(|&column| (column, "ascends from row to row", "time of each row"));
        let notes: Vec<String> = classes
            .chain(times)
            .map(|(column, what, other)| {
                let (place, number) = (&self.place, column + 1);
                format!("{place}: column {number} {what} and counts as a taxel; remove it if it is the {other}")
            })
            .collect();
        self.notes.extend(notes);
    }

    /// Leaves out the columns that are no data of the given content.
    ///
    /// # Errors
    /// If the columns of frames are of several families, or no column matches a pattern; the error lists the families.
    pub fn for_content(mut self, content: TableContent) -> Result<Self> {
        let TableContent::Frames { columns, key } = content else {
            self.keep(&self.without_index(), COUNTS);
            return Ok(self);
        };
        let Some(columns) = columns else {
            self.keep(&self.without_index(), COUNTS);
            let families = self.names.as_deref().and_then(column_families);
            let Some((listed, largest)) = families else {
                self.note_other_columns();
                return Ok(self);
            };
            let given = format!("columns of several kinds: {listed}");
            let allowed =
                format!("those that are readings, such as {key}{largest:?}, or {key}\"*\" for all");
            return Err(Error::input(self.place, given, allowed));
        };
        let refuse =
            |given: String, allowed: String| Err(Error::input(&self.place, given, allowed));
        let Some(names) = &self.names else {
            let given = format!("{key}{columns:?} for a table without names of columns");
            let allowed = "a first line with the name of each column";
            return refuse(given, allowed.to_owned());
        };
        let patterns: Vec<&str> = columns.split(',').map(str::trim).collect();
        let is_of = |pattern: &&str| names.iter().any(|name| matches(pattern, name));
        if let Some(pattern) = patterns.iter().find(|pattern| !is_of(pattern)) {
            let allowed = format!("patterns of {}", listed(names));
            return refuse(format!("{key}{columns:?}: no column `{pattern}`"), allowed);
        }
        let is_chosen = |&k: &usize| patterns.iter().any(|pattern| matches(pattern, &names[k]));
        let chosen: Vec<usize> = (0..names.len()).filter(is_chosen).collect();
        self.select(&chosen);
        Ok(self)
    }

    /// Converts the cells to an array of numbers or, if a cell is no number, of texts. An empty cell among numbers is NaN. A single column with a whole number
    /// both with and without leading zeros, such as 007 and 7, contains texts.
    pub fn into_array(mut self) -> FileArray {
        let shape = vec![self.rows.len(), self.n_columns()];
        // Numbers in place of names are positions.
        let columns = self.names.take();
        let columns = columns.filter(|names| names.iter().any(|name| number(name).is_none()));
        let is_text = |cell: &&String| number(cell).is_none();
        let mut all = self
            .rows
            .iter()
            .flat_map(|(line, cells)| cells.iter().map(move |c| (line, c)));
        let text = all.find(|(_, cell)| is_text(cell));
        let text = text.map(|(line, cell)| {
            let at = format!("{}, line {line}", self.place);
            [at, format!("`{cell}`"), "numbers".to_owned()]
        });
        let are_texts = text.is_some() || self.has_padded_twin();
        let cells = self.rows.into_iter().flat_map(|(_, cells)| cells);
        let (kind, elements) = if are_texts {
            (ElementKind::Text, Elements::Texts(cells.collect()))
        } else {
            let mut kind = ElementKind::Integer;
            let numbers = cells.map(|cell| {
                if cell.parse::<i64>().is_err() {
                    kind = ElementKind::Float(f64::EPSILON);
                }
                number(&cell).unwrap_or(f64::NAN)
            });
            let numbers = numbers.collect();
            (kind, Elements::Numbers(numbers))
        };
        FileArray {
            place: self.place,
            shape,
            kind,
            elements,
            columns,
            refusal: text,
        }
    }

    /// Returns whether the table is a single column with a whole number both with and without leading zeros.
    fn has_padded_twin(&self) -> bool {
        if self.n_columns() != 1 {
            return false;
        }
        let texts: HashSet<&str> = self.column(0).collect();
        let is_padded = |text: &&&str| {
            text.len() > 1
                && text.starts_with('0')
                && text.bytes().all(|byte| byte.is_ascii_digit())
        };
        let mut padded = texts.iter().filter(is_padded);
        padded.any(|text| texts.contains(text.trim_start_matches('0')))
    }

    /// Returns an error if the numbers of a column have decimal commas, which are texts of other programs.
    fn check_decimal_points(&self) -> Result<()> {
        let Some(separator) = self.separator.filter(|separator| *separator != ',') else {
            return Ok(());
        };
        let has_comma =
            |cell: &str| number(cell).is_none() && number(&cell.replacen(',', ".", 1)).is_some();
        for column in 0..self.n_columns() {
            let mut below = self.column(column).skip(1);
            let are_numbers = below.all(|cell| number(cell).is_some() || has_comma(cell));
            let found = self
                .rows
                .iter()
                .find(|(_, cells)| has_comma(&cells[column]));
            if let (true, Some((line, cells))) = (are_numbers, found) {
                let place = format!("{}, line {line}", self.place);
                let words = if separator == ';' {
                    "semicolons"
                } else {
                    "tabs"
                };
                let cell = &cells[column];
                let given = format!("`{cell}`, a table with {words} and decimal commas");
                let allowed = format!(
                    "decimal points: pandas.read_csv({:?}, sep={separator:?}, decimal=\",\").to_csv(\"points.csv\", index=False)",
                    self.place
                );
                return Err(Error::input(place, given, allowed));
            }
        }
        Ok(())
    }

    /// Returns an error if commas stand both between numbers and before their decimals. Of each pair of columns, the second then has digits without a sign, and
    /// it alone has leading zeros. Numbers without leading zeros in their decimals are not recognised.
    fn check_decimal_commas(&self) -> Result<()> {
        let below = &self.rows[usize::from(self.rows.len() > 1)..];
        let n = below[0].1.len();
        let is_padded = |cell: &str| cell.len() > 1 && cell.starts_with('0');
        let (mut padded, mut first) = (BTreeSet::new(), None);
        for (line, cells) in below {
            for (from_end, cell) in cells.iter().rev().enumerate() {
                // A table with an odd number of cells begins with an index.
                let has_decimals = from_end % 2 == 0 && from_end + 1 < n;
                let digits = cell.strip_prefix('-').filter(|_| !has_decimals);
                let digits = digits.unwrap_or(cell);
                let are_digits = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
                if !are_digits || cells.len() != n || !has_decimals && is_padded(digits) {
                    return Ok(());
                }
                if is_padded(digits) {
                    padded.insert(from_end);
                    first.get_or_insert((line, &cells[n - 2 - from_end], cell));
                }
            }
        }
        match first {
            Some((line, whole, decimals)) if self.separator == Some(',') && padded.len() > 1 => {
                let place = format!("{}, line {line}", self.place);
                let given = format!("`{whole},{decimals}`, commas between numbers and in numbers");
                Err(Error::input(
                    place,
                    given,
                    "decimal points, or semicolons between the columns",
                ))
            }
            _ => Ok(()),
        }
    }

    /// Removes the empty cell behind the last separator of all lines, and returns whether there is one. The first line may have a name in its place, which makes
    /// it a column, or no cell.
    fn drop_empty_end(&mut self) -> bool {
        let is_empty = |(_, cells): &(usize, Vec<String>)| {
            cells.len() > 1 && cells.last().is_some_and(String::is_empty)
        };
        let n_first = self.rows[0].1.len();
        let is_longer = |(_, cells): &(usize, Vec<String>)| cells.len() > n_first;
        let mut others = self.rows.iter().skip(1);
        // A header may end with a separator although the other lines do not.
        let is_of_header = is_empty(&self.rows[0])
            && self.rows.len() > 1
            && others.clone().all(|(_, cells)| cells.len() + 1 == n_first);
        let is_of_all = others.clone().all(is_empty)
            && (is_empty(&self.rows[0]) || self.rows.len() > 1 && others.all(is_longer));
        let n_shortened = match (is_of_header, is_of_all) {
            (true, _) => 1,
            (false, true) => self.rows.len(),
            (false, false) => return false,
        };
        let mut rows = self.rows.iter_mut().take(n_shortened);
        rows.by_ref().filter(|row| is_empty(row)).for_each(|row| {
            row.1.pop();
        });
        true
    }

    fn check_widths(&self) -> Result<()> {
        let (first, known) = &self.rows[0];
        let Some((line, cells)) = self
            .rows
            .iter()
            .find(|(_, cells)| cells.len() != known.len())
        else {
            return Ok(());
        };
        let place = format!("{}, line {line}", self.place);
        let allowed = format!("{}, as line {first} has", known.len());
        Err(Error::input(
            place,
            format!("{} values", cells.len()),
            allowed,
        ))
    }

    /// Returns whether the first line has the names of the columns.
    fn has_header(&self, n_rows: Option<usize>) -> bool {
        let ((_, first), others) = (&self.rows[0], &self.rows[1..]);
        let is_text = |cell: &str| number(cell).is_none();
        let are_texts = first.iter().any(|cell| is_text(cell))
            && first.iter().all(|cell| cell.is_empty() || is_text(cell));
        if others.is_empty() {
            return n_rows.is_none() && are_texts;
        }
        let is_above_numbers = |&column: &usize| {
            let mut below = self.column(column).skip(1);
            is_text(&first[column]) && !below.any(is_text)
        };
        if (0..first.len()).any(|column| is_above_numbers(&column)) {
            return true;
        }
        if n_rows.is_some_and(|n| n != others.len()) {
            return false;
        }
        let numbered: Vec<f64> = first
            .iter()
            .filter(|cell| !cell.is_empty())
            .filter_map(|cell| number(cell))
            .collect();
        let n_min = match n_rows.is_some() || first.iter().any(String::is_empty) {
            true => 1,
            false => 2,
        };
        let counts_few = counts_from(&numbered, 0.0) && numbered.len() >= n_min;
        // Ascending whole numbers above columns of which most have fractions are the names of chosen columns.
        let are_chosen = numbered.len() == first.len()
            && first.len() >= MIN_COUNT
            && first.iter().all(|cell| cell.parse::<u32>().is_ok())
            && numbered.is_sorted_by(|a, b| a < b)
            && 2 * self.n_fractional(1) > first.len();
        let is_count = counts_few || is_count(&numbered) || are_chosen;
        // A known number of rows makes a first line of texts a header.
        is_count || n_rows.is_some() && are_texts
    }
}

/// Reason why a column is left out.
const COUNTS: &str = "counts the rows";

/// Reads a text file as an array. Notes are written to standard error.
///
/// # Errors
/// Returns the errors of [`Table::read`] and [`Table::for_content`].
pub fn read(path: &Path, content: TableContent) -> Result<(FileArray, Vec<String>)> {
    let n_rows = match content {
        TableContent::Rows(n) => Some(n),
        _ => None,
    };
    let mut table = Table::read(path, n_rows)?.for_content(content)?;
    let notes = std::mem::take(&mut table.notes);
    Ok((table.into_array(), notes))
}

/// Returns a cell as a number; NaN if it is empty, and `None` if it is a text.
fn number(cell: &str) -> Option<f64> {
    match cell.is_empty() {
        true => Some(f64::NAN),
        false => cell.parse().ok(),
    }
}

/// Returns whether numbers are `first`, `first` + 1, …
fn counts_from(numbers: &[f64], first: f64) -> bool {
    let mut counted = numbers.iter().enumerate();
    counted.all(|(k, &number)| number == first + k as f64)
}

/// Returns whether numbers count from 0 or 1, or are a long run of consecutive integers.
fn is_count(numbers: &[f64]) -> bool {
    let Some(&first) = numbers.first() else {
        return false;
    };
    let n_min = match first {
        0.0 | 1.0 => MIN_COUNT,
        _ => MIN_RUN,
    };
    first.fract() == 0.0 && numbers.len() >= n_min && counts_from(numbers, first)
}

/// Returns whether the numbers of a column count the rows. A count from 0 or 1 may begin again, such as with each touch.
fn counts_rows(numbers: &[f64]) -> bool {
    let mut runs = numbers.chunk_by(|a, b| *b == a + 1.0);
    let begins_again = |run: &[f64]| run[0] == numbers[0] && run[0] <= 1.0 && is_count(run);
    is_count(numbers) || !numbers.is_empty() && runs.all(begins_again)
}

/// Returns whether the numbers of a column are the index of shuffled rows: consecutive integers in any order. Beside readings with fractions, distinct whole
/// numbers are the index of chosen rows.
fn names_rows(numbers: &[f64], among_fractions: bool) -> bool {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let are_whole = |number: &f64| number.fract() == 0.0 && *number >= 0.0;
    sorted.len() >= MIN_RUN
        && sorted.iter().all(are_whole)
        && match among_fractions {
            true => sorted.is_sorted_by(|a, b| a < b),
            false => counts_from(&sorted, sorted[0]),
        }
}

/// Returns an error if the file is an export of a pressure mat with a block of lines for each frame.
fn check_export(path: &Path, lines: &[(usize, &str)]) -> Result<()> {
    let (number, first) = lines[0];
    if !first.trim_start_matches('"').starts_with("DATA_TYPE") {
        return Ok(());
    }
    let value = |key: &str| {
        let found = lines.iter().find_map(|(_, line)| line.strip_prefix(key));
        let found = found.and_then(|rest| {
            rest.split([' ', ',', '\t', ';'])
                .find(|word| !word.is_empty())
        });
        found.unwrap_or(key).to_owned()
    };
    let place = format!("{}, line {number}", path.display());
    let given =
        format!("`{first}`, an I-Scan (Tekscan) export with a block of lines for each frame");
    let allowed = format!(
        "an array of frames: numpy.save(\"frames.npy\", numpy.array([line.split(\",\") for line in open({:?}) if line[0].isdigit()], float).reshape(-1, {}, {}))",
        path.display().to_string(),
        value("ROWS"),
        value("COLS"),
    );
    Err(Error::input(place, given, allowed))
}

/// Returns the numbers in a line of numbers separated by spaces; returns any other line as one text.
fn numbers_or_text(line: &str) -> Vec<String> {
    let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
    match words.iter().all(|word| word.parse::<f64>().is_ok()) {
        true => words,
        false => vec![line.trim().trim_matches('"').to_owned()],
    }
}

/// Splits a line of a CSV file at the separator; returns the entries without their quotes.
fn cells(line: &str, separator: char) -> Vec<String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(separator as u8)
        .from_reader(line.as_bytes());
    let record = reader.records().next().and_then(std::result::Result::ok);
    let record = record.unwrap_or_default();
    record.iter().map(|cell| cell.trim().to_owned()).collect()
}
