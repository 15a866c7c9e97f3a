//! Value of one table entry.

use serde::Serialize;

/// Value of one table entry: a number or a word.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number.
    Number(f64),
    /// Word as in the file.
    Word(String),
}
