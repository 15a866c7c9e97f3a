//! Checks of the values of keys. Each error contains the file, the key, the given value, and the allowed values.

use crate::error::{Error, Result};
use crate::inputs::memory::{check_memory, machine_memory};
use crate::inputs::toml_value::{number, value_at};
use crate::inputs::units::{MAX_FRAMES, MAX_SIDE, MM, millimetres};
use crate::world::MAX_TOUCHES;
use serde::Serialize;
use std::borrow::Cow;

/// Minimum positive value of a key. Squares and reciprocals of smaller values approach the limits of f64; no quantity has such small values.
pub const MIN_POSITIVE: f64 = 1e-12;

pub fn positive(value: f64) -> bool {
    value.is_finite() && value >= MIN_POSITIVE
}

pub fn not_negative(value: f64) -> bool {
    value == 0.0 || positive(value)
}

/// Maximum number of values of one axis. A longer list indicates a mistake, and the search for duplicates compares all pairs of values.
pub const MAX_VALUES: usize = 10_000;

/// Maximum value of keys that are counts. Larger counts exceed the memory or take too long.
const MAX_COUNTED: usize = 100_000_000;

/// Maximum number of readings per training touch. All are in memory together, and more readings do not improve training.
const MAX_READINGS: usize = 100;

/// Maximum number of configurations of a study; all are created before the first one runs.
const MAX_CONFIGURATIONS: f64 = 1e6;

/// Range of allowed numbers for a key.
#[derive(Clone, Copy)]
pub enum Range {
    /// Numbers above zero.
    Positive,
    /// Numbers of at least zero.
    NotNegative,
    /// All finite numbers.
    Finite,
    /// Fractions from 0 to 1, including both ends.
    Fraction,
    /// Fractions between 0 and 1, excluding both ends.
    Part,
    /// Numbers of at least one.
    AtLeastOne,
    /// Integers between two bounds, including both.
    Count(usize, usize),
    /// Numbers that a predicate allows, with a description in words.
    Of(fn(f64) -> bool, &'static str),
    /// Texts, or numbers that are checked elsewhere.
    Any,
}

impl Range {
    /// Returns whether a number is in the range, and a description of the range.
    fn allows(self, value: f64) -> (bool, Cow<'static, str>) {
        let (is_allowed, words) = match self {
            Self::Positive => (positive(value), "a positive number, at least 1e-12"),
            Self::NotNegative => (
                not_negative(value),
                "zero or a positive number, at least 1e-12",
            ),
            Self::Finite => (value.is_finite(), "a finite number"),
            Self::Fraction => ((0.0..=1.0).contains(&value), "a fraction, 0 to 1"),
            Self::Part => (value > 0.0 && value < 1.0, "between 0 and 1"),
            Self::AtLeastOne => (value.is_finite() && value >= 1.0, "a number of at least 1"),
            Self::Count(least, most) => {
                let is_allowed = (least as f64..=most as f64).contains(&value);
                let words = format!("at least {least} and at most {most}");
                return (is_allowed, words.into());
            }
            Self::Of(is_allowed, words) => (is_allowed(value), words),
            Self::Any => (true, "any value"),
        };
        (is_allowed, words.into())
    }
}

/// Maximum number of copies per touch; more copies do not improve a classifier.
const MAX_COPIES: usize = 1000;
/// Allowed tilt angles of copies, degrees. For much larger tilts, the change of the readings is not a plane.
const TILT: Range = Range::Of(|deg| deg > 0.0 && deg <= 45.0, "above 0, at most 45");
/// Allowed slide distances, mm. Upper limit 1 km: a longer slide passes far more taxels than it has steps, and squares of very large distances overflow.
const SLIDE: Range = Range::Of(|mm| (0.0..=1e6).contains(&mm), "0 to 1000000");
pub const COUNT: Range = Range::Count(1, MAX_COUNTED);

/// Allowed distances between spheres and a surface, mm. Below a nanometre, the rounding errors of coordinates are as large.
pub const SURFACE_ERROR: Range = Range::Of(|mm| mm >= 1e-6, "at least 1e-6 mm");
/// Allowed noise as a fraction of full scale. At the upper bound, no signal remains, and squares of features still fit into f32.
pub const NOISE: Range = Range::Of(
    |share| not_negative(share) && share <= 1000.0,
    "0, or 1e-12 to 1000",
);
/// Allowed penalties C. At the bounds, no margin or no slack remains.
const PENALTY: Range = Range::Of(|c| positive(c) && c <= 1e12, "above 0, 1e-12 to 1e12");
/// Allowed kernel parameters γ. At the upper bound, a kernel of degree 20 over 10,000 features is finite in f64.
const GAMMA: Range = Range::Of(|c| positive(c) && c <= 1e9, "above 0, 1e-12 to 1e9");
/// Allowed constants c₀ of the polynomial kernel, whose maximum degree is 20.
const COEF0: Range = Range::Of(|c| (0.0..=1e6).contains(&c), "0 to 1e6");

/// Allowed numbers of touches per object.
pub const TOUCHES: Range = Range::Count(1, MAX_TOUCHES);

/// Keys of the tables that several kinds of studies share, with their allowed numbers. A list must contain values and no duplicates.
const KEYS: [(&str, Range); 59] = [
    ("objects.surface_error_mm", SURFACE_ERROR),
    ("objects.close_holes_mm", Range::Positive),
    ("objects.names", Range::Any),
    ("skin.pitch_mm", Range::Positive),
    ("skin.size_mm", Range::Positive),
    ("skin.taxels", Range::Count(1, MAX_SIDE)),
    ("skin.curvature_radius_mm", Range::Positive),
    ("skin.friction", Range::NotNegative),
    ("skin.shear_stiffness_n_per_m", Range::Positive),
    ("skin.taxel_radius_mm", Range::Positive),
    ("skin.stroke_mm", Range::Positive),
    ("skin.stiffness_n_per_m", Range::Positive),
    ("skin.damping_n_s_per_m", Range::NotNegative),
    ("touches.per_object", TOUCHES),
    ("touches.slide_mm", SLIDE),
    ("touches.slide_deg", Range::Finite),
    ("touches.frames", Range::Count(1, MAX_FRAMES)),
    ("touches.speed_mm_per_s", Range::NotNegative),
    ("human_touch.kinds", Range::Any),
    ("human_touch.per_kind", TOUCHES),
    ("human_touch.arm_radius_mm", Range::Positive),
    ("human_touch.frames_hz", Range::Positive),
    ("human_touch.duration_s", Range::Positive),
    ("signal.noise_std_full_scale", NOISE),
    ("signal.noise_std_mm", Range::NotNegative),
    ("signal.noise_std_n", Range::NotNegative),
    ("signal.smoothing_mm", Range::NotNegative),
    ("signal.test_sensor", Range::Any),
    ("sensing.ensemble", Range::Any),
    ("sensing.ratio", Range::AtLeastOne),
    ("sensing.measurements", COUNT),
    ("recognition.features", Range::Any),
    ("recognition.depth_window_full_scale", Range::Positive),
    ("recognition.tilt_augmentation", Range::Count(0, MAX_COPIES)),
    ("recognition.tilt_augmentation_deg", TILT),
    ("recognition.temporal_features", Range::Any),
    ("recognition.classifier", Range::Any),
    ("recognition.c", PENALTY),
    ("recognition.c_grid", PENALTY),
    ("recognition.gamma", GAMMA),
    ("recognition.gamma_grid", GAMMA),
    ("recognition.cv_folds", Range::Count(2, MAX_COUNTED)),
    ("recognition.cv_touches", COUNT),
    (
        "recognition.readings_per_touch",
        Range::Count(1, MAX_READINGS),
    ),
    ("recognition.degree", Range::Count(1, 20)),
    ("recognition.coef0", COEF0),
    ("recognition.n_neighbours", COUNT),
    ("recognition.n_trees", COUNT),
    ("recognition.max_depth", COUNT),
    ("recognition.solver_memory_gib", Range::Positive),
    ("recognition.train_touches", COUNT),
    ("recognition.mislabelled_fraction", Range::Fraction),
    ("recognition.class_imbalance", Range::AtLeastOne),
    ("recognition.touches_per_decision", COUNT),
    ("recognition.next_touch", Range::Any),
    ("recognition.test_fraction", Range::Part),
    ("recognition.folds", Range::Count(2, MAX_COUNTED)),
    ("recognition.group_by_mm", Range::Positive),
    ("recognition.group_by_deg", Range::Positive),
];

/// Checker of the keys of one file.
pub struct Check<'a> {
    /// Name of the study file in error messages.
    pub place: &'a str,
}

impl Check<'_> {
    pub fn error(&self, key: &str, given: impl ToString, allowed: impl ToString) -> Error {
        Error::input(format!("{}, key {key}", self.place), given, allowed)
    }

    /// Checks the keys of a table that several kinds of studies share; returns the keys that the table contains.
    pub fn table(&self, name: &str, table: &impl Serialize) -> Result<toml::Table> {
        let key = |path: &'static str| path.strip_prefix(name)?.strip_prefix('.');
        let keys = KEYS
            .into_iter()
            .filter_map(|(path, range)| Some((key(path)?, range)));
        self.keys(name, table, keys)
    }

    /// Checks the keys of a table; dots separate the names of nested tables. Each number must be in its range; each list must contain values and no
    /// duplicates.
    pub fn keys<'k>(
        &self,
        name: &str,
        table: &impl Serialize,
        keys: impl IntoIterator<Item = (&'k str, Range)>,
    ) -> Result<toml::Table> {
        let table = toml::Table::try_from(table).expect("every field of a study has a TOML form");
        for (key, range) in keys {
            let Some(value) = value_at(&table, key) else {
                continue;
            };
            let path = &format!("{name}.{key}");
            let one = std::slice::from_ref(value);
            let values = value.as_array().map_or(one, |values| &values[..]);
            let words: Vec<&str> = values.iter().filter_map(|value| value.as_str()).collect();
            let numbers: Vec<f64> = values.iter().filter_map(number).collect();
            match words.is_empty() {
                false => self.list(path, words).map(drop)?,
                // Two values with equal text in tables would be indistinguishable.
                true if path.ends_with("_mm") => {
                    let shown = numbers.iter().map(|&mm| millimetres(mm * MM));
                    self.list(path, shown.collect()).map(drop)?;
                }
                true => self.list(path, numbers.clone()).map(drop)?,
            }
            for number in numbers {
                if let (false, allowed) = range.allows(number) {
                    return Err(self.error(path, number, allowed));
                }
            }
        }
        Ok(table)
    }

    pub fn value(
        &self,
        key: &str,
        value: f64,
        is_allowed: fn(f64) -> bool,
        allowed: &str,
    ) -> Result<f64> {
        if is_allowed(value) {
            return Ok(value);
        }
        Err(self.error(key, value, allowed))
    }

    /// Checks that a count is between 1 and `most`.
    pub fn count(&self, key: &str, count: usize, most: usize) -> Result<usize> {
        match count {
            0 => Err(self.error(key, 0, "at least 1")),
            count if count <= most => Ok(count),
            count => Err(self.error(key, count, format!("at most {most}"))),
        }
    }

    /// Checks that the number of configurations (the product of all axis lengths) is within the limit.
    pub fn configurations(&self, n: f64) -> Result<()> {
        if n <= MAX_CONFIGURATIONS {
            return Ok(());
        }
        // Beyond this value, not all digits are exact.
        let given = if n < 1e15 {
            format!("{n:.0} configurations")
        } else {
            format!("{n:.1e} configurations")
        };
        let allowed = format!(
            "at most {MAX_CONFIGURATIONS}, all combinations of the values of its axes: fewer values, or several studies"
        );
        Err(Error::input(self.place, given, allowed))
    }

    /// Checks that a number of bytes fits into the machine's memory; `what` describes the data in the error.
    pub fn memory(&self, key: &str, given: impl ToString, bytes: f64, what: &str) -> Result<()> {
        check_memory(bytes, machine_memory(), what)
            .map_err(|allowed| self.error(key, given, allowed))
    }

    /// Checks that an axis has values and no duplicates; a duplicate would repeat configurations.
    pub fn list<T: Clone + PartialEq + std::fmt::Debug>(
        &self,
        key: &str,
        values: Vec<T>,
    ) -> Result<Vec<T>> {
        if values.is_empty() {
            return Err(self.error(key, "an empty list", "at least one value"));
        }
        if values.len() > MAX_VALUES {
            let allowed = format!("at most {MAX_VALUES} values");
            return Err(self.error(key, format!("{} values", values.len()), allowed));
        }
        for (index, value) in values.iter().enumerate() {
            if values[..index].contains(value) {
                return Err(self.error(key, format!("{value:?} twice"), "each value once"));
            }
        }
        Ok(values)
    }
}
