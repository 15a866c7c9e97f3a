//! Numbers that may be infinite or none at all, in JSON, which has no words for them: `#[serde(with = "any_number")]` for fields of rows
//! that may hold such. Finite ones are JSON's own; the others are the words that a CSV file has.

use serde::de::{self, Deserialize, Deserializer};
use serde::{Serialize, Serializer};

#[derive(Serialize, serde::Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Words(String),
}

/// Writes a number, or its absence.
///
/// # Errors
/// Those of the serializer.
pub fn serialize<S: Serializer>(
    number: &Option<f64>,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    let written = number.map(|number| match number.is_finite() {
        true => Written::Number(number),
        false => Written::Words(number.to_string()),
    });
    written.serialize(serializer)
}

/// Reads it back.
///
/// # Errors
/// Words that are no number; those of the deserializer.
pub fn deserialize<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<f64>, D::Error> {
    let written = Option::<Written>::deserialize(deserializer)?;
    let number = written.map(|written| match written {
        Written::Number(number) => Ok(number),
        Written::Words(words) => words.parse().map_err(de::Error::custom),
    });
    number.transpose()
}
