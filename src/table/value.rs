//! Value of one table entry.

use serde::Serialize;

/// Value of one table entry: a number or a word.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// Number in the unit of its column.
    Number(f64),
    /// Word or code, as written in the file.
    Word(String),
}
