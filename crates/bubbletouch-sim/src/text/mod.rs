//! Text: reading of numbers, names and TOML, and their error messages.
//!
//! | module | input → output |
//! |---|---|
//! | [`toml_text`] | TOML → a value, or an error with file and line |
//! | [`toml_lines`] | a position or a key in TOML → its line |
//! | `toml_numbers` | TOML → an error if a number is out of the bounds of its unit |
//! | `xml` | XML → elements with typed attributes, or an error with file and line |
//! | [`numbers_csv`] | CSV → columns of numbers |
//! | [`in_range`] | a number → the number, or an error with the allowed range |
//! | [`spelling`] | an unknown name → the nearest known one |
//! | [`numbers`] | numbers → short text |
//! | [`encoding`] | bytes → text |
//! | [`note`] | a note → standard error |

pub mod encoding;
pub mod in_range;
pub mod note;
pub mod numbers;
pub mod numbers_csv;
pub mod spelling;
pub mod toml_lines;
mod toml_numbers;
pub mod toml_text;
pub(crate) mod xml;
