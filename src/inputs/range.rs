//! Ranges of the numbers that keys allow.

use crate::inputs::toml_value::number_value;
use crate::inputs::units::MAX_SIDE;
use crate::signal::Strength;
use crate::world::MAX_TOUCHES;
use bubbletouch_svm::classifiers::parameters::Parameter;
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// Smallest positive value that a key allows. Squares and reciprocals of smaller values approach the limits of f64; no quantity is measured in such small
/// values.
pub const MIN_POSITIVE: f64 = 1e-12;

/// Returns whether a number is at least [`MIN_POSITIVE`].
pub fn positive(value: f64) -> bool {
    value.is_finite() && value >= MIN_POSITIVE
}

/// Returns whether a number is zero or at least [`MIN_POSITIVE`].
pub fn not_negative(value: f64) -> bool {
    value == 0.0 || positive(value)
}

/// Set of numbers that a key of a study file allows.
#[derive(Clone, Copy, Debug)]
pub enum Range {
    /// Numbers above zero.
    Positive,
    /// Numbers that are at least 0.
    NotNegative,
    /// All finite numbers.
    Finite,
    /// Fractions from 0 to 1, including both ends.
    Fraction,
    /// Fractions between 0 and 1, excluding both ends.
    Part,
    /// Numbers that are at least 1.
    AtLeastOne,
    /// Integers between two bounds, including both.
    Count(usize, usize),
    /// Numbers between two bounds (inclusive), with a description in words.
    Between(f64, f64, &'static str),
    /// Zero, and the numbers between two positive bounds (inclusive), with a description in words.
    ZeroOrBetween(f64, f64, &'static str),
    /// Range of numbers that a classifier declares for a parameter.
    Declared(&'static Parameter),
    /// Range of numbers that a sensor error declares for a strength.
    Strength(&'static Strength),
    /// Any text or truth value is allowed. A list of them contains each value once.
    Any,
    /// Values that only the reader of the key checks, such as texts, files, vectors and tables.
    Unchecked,
}

impl Range {
    /// Returns whether the range contains a number.
    pub fn contains(self, value: f64) -> bool {
        match self {
            Self::NotNegative => not_negative(value),
            Self::Part => value > 0.0 && value < 1.0,
            Self::ZeroOrBetween(low, high, _) => value == 0.0 || (low..=high).contains(&value),
            Self::Strength(strength) => strength.is_allowed(value),
            _ => self
                .bounds()
                .is_none_or(|[low, high]| value.is_finite() && (low..=high).contains(&value)),
        }
    }

    /// Returns the default that a classifier declares for a parameter; `None` for other ranges, and for defaults that are no numbers.
    pub(crate) fn declared_default(self) -> Option<toml::Value> {
        match self {
            Self::Declared(parameter) => {
                let default = parameter.default_number()?;
                Some(number_value(default, parameter.is_integer))
            }
            _ => None,
        }
    }

    /// Returns the allowed numbers as text, for error messages.
    pub fn words(self) -> Cow<'static, str> {
        let words = match self {
            Self::Positive => "a positive number, at least 1e-12",
            Self::NotNegative => "zero or a positive number, at least 1e-12",
            Self::Finite => "a finite number",
            Self::Fraction => "a fraction, 0 to 1",
            Self::Part => "between 0 and 1",
            Self::AtLeastOne => "a number of at least 1",
            Self::Count(least, most) => {
                return format!("at least {least} and at most {most}").into();
            }
            Self::Declared(parameter) => return parameter.allowed().into(),
            Self::Strength(strength) => strength.allowed,
            Self::Between(.., words) | Self::ZeroOrBetween(.., words) => words,
            Self::Any | Self::Unchecked => "any value",
        };
        words.into()
    }

    /// Returns the keywords of a JSON Schema that bound the allowed numbers.
    pub fn keywords(self) -> Map<String, Value> {
        let Some([low, high]) = self.bounds() else {
            return Map::new();
        };
        let is_open = matches!(self, Self::Part);
        let number = |bound: f64| match bound.fract() == 0.0 && bound.abs() < 1e15 {
            true => json!(bound as i64),
            false => json!(bound),
        };
        let least = match low {
            _ if low <= f64::MIN => None,
            MIN_POSITIVE => Some(("exclusiveMinimum", number(0.0))),
            _ if is_open => Some(("exclusiveMinimum", number(low))),
            _ => Some(("minimum", number(low))),
        };
        let most = match high {
            _ if high >= f64::MAX => None,
            _ if is_open => Some(("exclusiveMaximum", number(high))),
            _ => Some(("maximum", number(high))),
        };
        let ends = least.into_iter().chain(most);
        ends.map(|(name, bound)| (name.to_owned(), bound)).collect()
    }

    /// Returns the smallest and the largest allowed number, which are infinite without a bound. Returns `None` for values other than numbers. The bounds of [`Part`](Self::Part) are not allowed themselves.
    pub fn bounds(self) -> Option<[f64; 2]> {
        Some(match self {
            Self::Positive => [MIN_POSITIVE, f64::INFINITY],
            Self::NotNegative => [0.0, f64::INFINITY],
            Self::Finite => [f64::NEG_INFINITY, f64::INFINITY],
            Self::Fraction | Self::Part => [0.0, 1.0],
            Self::AtLeastOne => [1.0, f64::INFINITY],
            Self::Count(least, most) => [least as f64, most as f64],
            Self::Between(low, high, _) => [low, high],
            Self::ZeroOrBetween(_, high, _) => [0.0, high],
            Self::Declared(parameter) => parameter.range,
            Self::Strength(strength) => strength.range,
            Self::Any | Self::Unchecked => return None,
        })
    }
}

/// Maximum value of keys that are counts, such as numbers of touches. Larger counts exceed memory or take too long.
pub const MAX_COUNTED: usize = 100_000_000;

/// Range of counts: 1 to the largest allowed count.
pub const COUNT: Range = Range::Count(1, MAX_COUNTED);

/// Allowed number of taxels along one side of an array.
pub const SIDE: Range = Range::Count(1, MAX_SIDE);

/// Allowed numbers of touches per object.
pub const TOUCHES: Range = Range::Count(1, MAX_TOUCHES);

/// Allowed distances between spheres and a surface, mm. Below a nanometre, rounding errors of coordinates are as large as the distance.
pub const SURFACE_ERROR: Range = Range::Between(1e-6, f64::MAX, "at least 1e-6 mm");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_contains_its_bounds_and_nothing_beyond() {
        let beyond = |bound: f64, sign: f64| bound + sign * 1e-3 * bound.abs().max(1e-12);
        for range in [
            Range::Positive,
            Range::Fraction,
            Range::AtLeastOne,
            COUNT,
            TOUCHES,
            SURFACE_ERROR,
            Range::ZeroOrBetween(1e-12, 1000.0, ""),
        ] {
            let [low, high] = range.bounds().unwrap();
            assert!(range.contains(low), "{range:?}");
            assert!(!range.contains(beyond(low, -1.0)), "{range:?}");
            assert!(!high.is_finite() || range.contains(high), "{range:?}");
            assert!(!range.contains(beyond(high, 1.0)), "{range:?}");
            assert!(!range.contains(f64::NAN) && !range.contains(f64::INFINITY));
        }
        assert!(!Range::Part.contains(0.0) && !Range::Part.contains(1.0));
        assert!(!Range::ZeroOrBetween(1e-12, 1.0, "").contains(1e-13));
        assert!(!Range::Finite.contains(f64::NAN));
    }
}
