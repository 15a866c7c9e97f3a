//! Classes, groups and row numbers read from arrays: integers, texts, or one column per class.

use crate::error::{Error, Result};
use crate::inputs::arrays::{ElementKind, Elements, FileArray, TableContent, is_member};
use crate::note::note;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fmt::{Display, Formatter};
use std::path::Path;
use unicode_normalization::UnicodeNormalization;

/// Number below which f64 represents every integer exactly: 2⁵³. The number itself may be a rounded 2⁵³ + 1.
const MAX_INTEGER: f64 = 9_007_199_254_740_992.0;

/// Value in a file that identifies the class or the group of a touch.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum KeyValue {
    /// Integer that identifies a class or group.
    Integer(i64),
    /// Text that identifies a class or group.
    Text(String),
}

impl KeyValue {
    /// Returns whether the value is a text.
    pub const fn is_text(&self) -> bool {
        matches!(self, Self::Text(_))
    }

    /// Returns the integer; `None` if the value is a text.
    pub const fn integer(&self) -> Option<i64> {
        match self {
            Self::Integer(number) => Some(*number),
            Self::Text(_) => None,
        }
    }
}

/// Writes the integer or the text.
impl Display for KeyValue {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        match self {
            Self::Integer(number) => number.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

/// Classes of all touches or rows of a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassLabels {
    /// Class number of every touch or row, from 0.
    pub labels: Vec<usize>,
    /// Value in the file for each class number: integers in ascending order, texts in the order of first occurrence.
    pub classes: Vec<KeyValue>,
}

impl ClassLabels {
    /// Assigns a class number to each of the given values; equal values get equal numbers.
    pub fn new(values: &[KeyValue]) -> Self {
        let classes = distinct(values);
        let number: HashMap<&KeyValue, usize> = classes.iter().zip(0..).collect();
        Self {
            labels: values.iter().map(|value| number[value]).collect(),
            classes,
        }
    }
}

/// Writes a note if classes or groups differ only by case, spaces, leading zeros or forms of Unicode, such as `mug`, `Mug` and `mug `, or é of one and of two
/// code points. `what` is the word for them.
pub fn note_spellings<'a>(what: &str, names: impl IntoIterator<Item = &'a str>) {
    let mut known: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for name in names.into_iter().collect::<BTreeSet<_>>() {
        let composed: String = name
            .nfkc()
            .filter(|letter| !letter.is_whitespace())
            .collect();
        let is_number = composed.bytes().all(|byte| byte.is_ascii_digit());
        let key = composed
            .trim_start_matches(|letter| is_number && letter == '0')
            .to_lowercase();
        // Combining accents are written as escapes.
        let shown = name.chars().flat_map(char::escape_debug).collect();
        known.entry(key).or_default().push(shown);
    }
    if let Some(same) = known.into_values().find(|names| names.len() > 1) {
        let (listed, n) = (same.join("\", \""), same.len());
        note(format_args!(
            "the {what} \"{listed}\" differ only by case, spaces, leading zeros or forms of Unicode, and count as {n} {what}"
        ));
    }
}

/// Returns the distinct values: integers in ascending order, texts in the order of first occurrence.
fn distinct(values: &[KeyValue]) -> Vec<KeyValue> {
    let all = values.iter().cloned();
    match values.first() {
        Some(KeyValue::Integer(_)) => all.collect::<BTreeSet<_>>().into_iter().collect(),
        _ => {
            let mut known = HashSet::new();
            all.filter(|value| known.insert(value.clone())).collect()
        }
    }
}

/// Array with one value for each touch or frame of a recording, or for each row of features.
pub struct OneForEach<'a> {
    path: &'a Path,
    name: &'a str,
    n: usize,
    each: String,
}

impl<'a> OneForEach<'a> {
    /// Creates the description of an array in a file; in an archive, `name` is the name of the array. There are `n` values; `each` names what has a value, such
    /// as `touch of frames.npy`.
    pub fn new(path: &'a Path, name: &'a str, n: usize, each: impl Into<String>) -> Self {
        let each = each.into();
        Self {
            path,
            name,
            n,
            each,
        }
    }

    /// Reads the values as classes. The file contains integers of any type, texts, an n × 1 array of either, or a column of 0 and 1 for each class.
    ///
    /// # Errors
    /// If the file does not exist or contains other data, or does not contain a class for each touch.
    pub fn classes(&self) -> Result<Vec<KeyValue>> {
        let allowed = "one class for each touch: int8 to int64, uint8 to uint64, whole floats (each below 2^53), bool or texts, or a column of 0 and 1 for each class";
        self.checked(values(one_hot(self.read()?)?, allowed)?)
    }

    /// Reads the values as groups: non-negative whole numbers of any type, or texts.
    ///
    /// # Errors
    /// If the file does not exist or contains other data, or does not contain a group for each touch. If an integer is not from 0 to 2⁵³ − 1; the error names
    /// its position.
    pub fn groups(&self) -> Result<Vec<KeyValue>> {
        let allowed = "one group for each touch: int8 to int64, uint8 to uint64, whole floats (each below 2^53), bool or texts";
        let values = values(self.read()?, allowed)?;
        not_below_zero(self.path, &values)?;
        self.checked(values)
    }

    /// Reads the values as classes of which integers are at least 0, and numbers the classes.
    ///
    /// # Errors
    /// Returns the errors of [`classes`](Self::classes), or an error if there are no labels or an integer is negative.
    pub fn class_labels(&self) -> Result<ClassLabels> {
        let values = self.classes()?;
        if values.is_empty() {
            return Err(Error::input(
                self.path.display(),
                "no labels",
                "at least one",
            ));
        }
        not_below_zero(self.path, &values)?;
        Ok(ClassLabels::new(&values))
    }

    /// Reads the values as numbers.
    ///
    /// # Errors
    /// If the file cannot be read, or contains texts, numbers that are not allowed, or another number of values.
    pub fn numbers(&self, is_allowed: impl Fn(f64) -> bool, allowed: &str) -> Result<Vec<f64>> {
        let array = self.read()?;
        let place = array.place.clone();
        let numbers = self.checked(array.into_numbers()?.into_iter().collect())?;
        check_each(&place, &numbers, |number| is_allowed(*number), allowed)?;
        Ok(numbers)
    }

    fn read(&self) -> Result<FileArray> {
        FileArray::read_content(self.path, self.name, TableContent::Rows(self.n))
    }

    /// Checks that there is one value for each touch, frame or row.
    fn checked<T>(&self, values: Vec<T>) -> Result<Vec<T>> {
        let Self {
            path,
            name,
            n,
            each,
        } = self;
        if values.len() == *n {
            return Ok(values);
        }
        let place = match is_member(path, name) {
            true => format!("{}, array `{name}`", path.display()),
            false => path.display().to_string(),
        };
        let given = format!("{} values", values.len());
        Err(Error::input(place, given, format!("{n}, one a {each}")))
    }
}

/// Converts group values to group numbers; equal values get equal numbers. Integers are unchanged; texts are numbered in the order of first occurrence.
pub fn group_keys(values: &[KeyValue]) -> Vec<usize> {
    let mut numbers = HashMap::new();
    let keys = values.iter().map(|value| match value {
        KeyValue::Integer(number) => *number as usize,
        KeyValue::Text(text) => {
            let next = numbers.len();
            *numbers.entry(&text[..]).or_insert(next)
        }
    });
    let keys = keys.collect();
    note_spellings("groups", numbers.into_keys());
    keys
}

/// Reads row numbers from a file that contains integers, or a mask with one truth value per row.
///
/// # Errors
/// If the file does not exist or contains other data. If a row does not exist (the error contains its position), or the length of the mask differs from the
/// number of rows.
pub fn read_rows(path: &Path, name: &str, n_rows: usize) -> Result<Vec<usize>> {
    const ALLOWED: &str =
        "one dimension of int8 to int64 or uint8 to uint64, or a bool for each row of features";
    let array = FileArray::read(path, name)?;
    let (place, kind) = (array.place.clone(), array.kind);
    if !matches!(kind, ElementKind::Integer | ElementKind::Truth) {
        return Err(Error::input(place, "elements of another type", ALLOWED));
    }
    let values = values(array, ALLOWED)?;
    let mut rows: Vec<i64> = values.iter().filter_map(KeyValue::integer).collect();
    if kind == ElementKind::Truth {
        if rows.len() != n_rows {
            let given = format!("a mask of {} rows", rows.len());
            let allowed = format!("one of {n_rows}, as there are rows of features");
            return Err(Error::input(place, given, allowed));
        }
        rows = (0..n_rows as i64)
            .filter(|&row| rows[row as usize] > 0)
            .collect();
    }
    if rows.is_empty() {
        return Err(Error::input(place, "no rows", "at least one"));
    }
    let last = n_rows.saturating_sub(1);
    let allowed = format!("0 to {last}, as there are {n_rows} rows of features");
    check_each(
        &place,
        &rows,
        |row| (0..n_rows as i64).contains(row),
        &allowed,
    )?;
    Ok(rows.into_iter().map(|row| row as usize).collect())
}

fn not_below_zero(path: &Path, values: &[KeyValue]) -> Result<()> {
    let is_allowed = |value: &KeyValue| value.integer().is_none_or(|number| number >= 0);
    let place = path.display().to_string();
    check_each(&place, values, is_allowed, "zero or more, below 2^53")
}

/// Returns an error if a value is not allowed; the error contains the position of the first such value.
fn check_each<T: ToString>(
    place: &str,
    values: &[T],
    is_allowed: impl Fn(&T) -> bool,
    allowed: &str,
) -> Result<()> {
    match values.iter().position(|value| !is_allowed(value)) {
        None => Ok(()),
        Some(position) => {
            let place = format!("{place}, position {position}");
            Err(Error::input(place, values[position].to_string(), allowed))
        }
    }
}

/// Converts a matrix with one 0/1 column per class to class numbers: for each row, the number of the column that contains 1.
fn one_hot(mut array: FileArray) -> Result<FileArray> {
    let ([n, n_classes], Elements::Numbers(numbers)) = (&array.shape[..], &array.elements) else {
        return Ok(array);
    };
    let (n, n_classes) = (*n, *n_classes);
    if n == 1 || n_classes < 2 {
        return Ok(array);
    }
    let mut columns = Vec::with_capacity(n);
    for (row, values) in numbers.chunks_exact(n_classes).enumerate() {
        let mut ones = (0..n_classes).filter(|&column| values[column] == 1.0);
        let (one, other) = (ones.next(), ones.next());
        let n_zeros = values.iter().filter(|&&value| value == 0.0).count();
        let (Some(one), None, true) = (one, other, n_zeros + 1 == n_classes) else {
            let place = format!("{}, row {row}", array.place);
            let given = format!("{n_classes} columns that are not one 1 among 0");
            let allowed = "one label for each touch, or a column of 0 and 1 for each class";
            return Err(Error::input(place, given, allowed));
        };
        columns.push(one as f64);
    }
    (array.shape, array.kind) = (vec![n], ElementKind::Integer);
    array.elements = Elements::Numbers(columns);
    Ok(array)
}

/// Returns the values of an array that has one dimension, a single column, or a single row.
fn values(array: FileArray, allowed: &str) -> Result<Vec<KeyValue>> {
    if array.shape.iter().filter(|&&length| length != 1).count() > 1 || array.shape.is_empty() {
        let given = format!("an array of shape {:?}", array.shape);
        return Err(Error::input(array.place, given, allowed));
    }
    match array.elements {
        Elements::Texts(texts) => {
            let is_missing =
                |text: &String| text.trim().is_empty() || text == "nan" || text == "NaN";
            if let Some(position) = texts.iter().position(is_missing) {
                let place = format!("{}, position {position}", array.place);
                let given = format!("{:?}", texts[position]);
                return Err(Error::input(place, given, allowed));
            }
            Ok(texts.into_iter().map(KeyValue::Text).collect())
        }
        Elements::Numbers(numbers) => {
            let is_whole = |number: &f64| number.fract() == 0.0 && number.abs() < MAX_INTEGER;
            check_each(&array.place, &numbers, is_whole, allowed)?;
            let numbers = numbers.into_iter().map(|number| number as i64);
            Ok(numbers.map(KeyValue::Integer).collect())
        }
    }
}
