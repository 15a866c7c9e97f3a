//! Serialisation of optional numbers that may be infinite or NaN: `#[serde(with = "any_number")]`. Finite numbers are JSON numbers; all other values are texts
//! as in CSV files.

use serde::de::{self, Deserialize, Deserializer};
use serde::{Serialize, Serializer};

#[derive(Serialize, serde::Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Words(String),
}

/// Serialises an optional number, which may be infinite or NaN.
///
/// # Errors
/// If the serializer fails.
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

/// Deserialises an optional number that may be infinite or NaN.
///
/// # Errors
/// If a text is not a number, or the deserializer fails.
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
