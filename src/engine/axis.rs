//! Axis of a sweep in a study file: one value or a list of values.

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{self, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::marker::PhantomData;

/// Values of a key that a study can sweep: one value or a list of values.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Axis<T> {
    /// Single value, such as `key = 2.0`.
    One(T),
    /// List of values, such as `key = [2.0, 4.0]`.
    Many(Vec<T>),
}

impl<T: Clone> Axis<T> {
    /// Returns all values of the key in their order; a single value gives a list of length 1.
    pub fn values(&self) -> Vec<T> {
        match self {
            Self::One(value) => vec![value.clone()],
            Self::Many(values) => values.clone(),
        }
    }

    /// Returns the values of a key that may be missing; a missing key has the single value `None`.
    pub fn optional_values(axis: &Option<Self>) -> Vec<Option<T>> {
        let values = axis.as_ref().map(Self::values);
        values.map_or(vec![None], |values| values.into_iter().map(Some).collect())
    }

    /// Returns the values of a key that may be missing, for settings under which the key acts. For other settings, a key that is given has the single value
    /// `idle`.
    pub fn active_values(axis: &Option<Self>, is_active: bool, idle: T) -> Vec<Option<T>> {
        match is_active {
            true => Self::optional_values(axis),
            false => vec![axis.as_ref().map(|_| idle)],
        }
    }
}

/// Deserialises one value or a list of values. The implementation is not derived, because an untagged enum does not report which value is wrong and what is
/// allowed.
impl<'de, T: Deserialize<'de>> Deserialize<'de> for Axis<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(AxisVisitor(PhantomData))
    }
}

struct AxisVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for AxisVisitor<T> {
    type Value = Axis<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a value or a list of values")
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> std::result::Result<Axis<T>, E> {
        T::deserialize(value.into_deserializer()).map(Axis::One)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> std::result::Result<Axis<T>, E> {
        T::deserialize(value.into_deserializer()).map(Axis::One)
    }

    fn visit_str<E: de::Error>(self, value: &str) -> std::result::Result<Axis<T>, E> {
        T::deserialize(value.into_deserializer()).map(Axis::One)
    }

    fn visit_map<A: MapAccess<'de>>(self, value: A) -> std::result::Result<Axis<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(value)).map(Axis::One)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> std::result::Result<Axis<T>, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(Axis::Many)
    }
}
