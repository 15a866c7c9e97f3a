//! An axis of a sweep as it is written: one value, or a list of them.

use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::marker::PhantomData;

/// One value, or a list of them: an axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Axis<T> {
    /// `key = 2.0`
    One(T),
    /// `key = [2.0, 4.0]`
    Many(Vec<T>),
}

impl<T: Clone> Axis<T> {
    /// The values, in their order.
    pub fn values(&self) -> Vec<T> {
        match self {
            Self::One(value) => vec![value.clone()],
            Self::Many(values) => values.clone(),
        }
    }

    /// Those of a key that may be left out, which is one value.
    pub fn of(axis: &Option<Self>) -> Vec<Option<T>> {
        let values = axis.as_ref().map(Self::values);
        values.map_or(vec![None], |values| values.into_iter().map(Some).collect())
    }
}

/// Written out, because an untagged enum forgets which value was wrong and what would have been right.
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

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> std::result::Result<Axis<T>, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(Axis::Many)
    }
}

/// An axis of the number one.
pub(crate) fn one_value() -> Axis<usize> {
    Axis::One(1)
}
