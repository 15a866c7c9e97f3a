//! Specification of the readings of untouched taxels.

use crate::files::file_path;
use crate::inputs::params::variants;
use serde::de::{IntoDeserializer, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::path::PathBuf;

variants! {
    /// Readings of untouched taxels, written as `zero = 100.0` or `zero = "zero.npy"`.
    pub untagged enum ZeroSpec {
        /// Common reading of all untouched taxels.
        One(f64),
        /// File with one reading for each taxel: an array with the taxel axes of `frames`, or a list in row-major order.
        Each(PathBuf),
    }
}

impl ZeroSpec {
    /// Returns the path of the file with the readings; `None` for a common reading.
    pub fn path(&self) -> Option<&PathBuf> {
        match self {
            Self::One(_) => None,
            Self::Each(path) => Some(path),
        }
    }

    /// Returns a mutable reference to the path of the file with the readings; `None` for a common reading.
    pub fn path_mut(&mut self) -> Option<&mut PathBuf> {
        match self {
            Self::One(_) => None,
            Self::Each(path) => Some(path),
        }
    }
}

impl Default for ZeroSpec {
    fn default() -> Self {
        Self::One(0.0)
    }
}

impl<'de> Deserialize<'de> for ZeroSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        /// Visitor that deserialises a `zero` key: either a number or a path.
        struct NumberOrPath;
        impl Visitor<'_> for NumberOrPath {
            type Value = ZeroSpec;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("a number, or the path of a file with a number for each taxel")
            }

            fn visit_f64<E: serde::de::Error>(
                self,
                number: f64,
            ) -> std::result::Result<ZeroSpec, E> {
                Ok(ZeroSpec::One(number))
            }

            fn visit_i64<E: serde::de::Error>(
                self,
                number: i64,
            ) -> std::result::Result<ZeroSpec, E> {
                Ok(ZeroSpec::One(number as f64))
            }

            fn visit_u64<E: serde::de::Error>(
                self,
                number: u64,
            ) -> std::result::Result<ZeroSpec, E> {
                Ok(ZeroSpec::One(number as f64))
            }

            fn visit_str<E: serde::de::Error>(
                self,
                path: &str,
            ) -> std::result::Result<ZeroSpec, E> {
                file_path(path.into_deserializer()).map(ZeroSpec::Each)
            }
        }
        deserializer.deserialize_any(NumberOrPath)
    }
}
