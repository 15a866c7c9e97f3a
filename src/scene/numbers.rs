//! Value of a key: one number that applies to all elements, or a list with one number per element.

use crate::inputs::params::variants;
use serde::Deserialize;
use serde::de::{Deserializer, SeqAccess, Visitor};
use std::fmt;

variants! {
    /// One number for all taxels or times, or a list: `stiffness_n_per_m = 100.0` or `stiffness_n_per_m = [90.0, 110.0]`.
    pub untagged enum Numbers {
        /// One number that applies to all elements.
        One(f64),
        /// List with one number for each element.
        Each(Vec<f64>),
    }
}

// Implemented manually, because the error of serde's untagged enum only states that no variant matched.
impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumbersVisitor)
    }
}

struct NumbersVisitor;

impl<'de> Visitor<'de> for NumbersVisitor {
    type Value = Numbers;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a number, or a list of numbers")
    }

    fn visit_f64<E>(self, number: f64) -> Result<Numbers, E> {
        Ok(Numbers::One(number))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Numbers, E> {
        Ok(Numbers::One(number as f64))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Numbers, E> {
        Ok(Numbers::One(number as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Numbers, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = list.next_element()? {
            numbers.push(number);
        }
        Ok(Numbers::Each(numbers))
    }
}
