//! Descriptions of the keys of recognition studies; other kinds of studies use some of these keys.

use crate::inputs::keys::{AxisPlace, find};
use crate::inputs::range::Range::{self, Between};
use crate::inputs::toml_value::{is_at, table_of, value_at};
use crate::studies::prelude::*;

/// Maximum number of trials of a study, because the splits of all trials are kept in memory.
pub(super) const MAX_TRIALS: usize = 100_000;
/// Maximum number of tilted copies of a training touch; further copies do not improve a classifier.
pub(super) const MAX_COPIES: usize = 1000;
/// Maximum number of readings of a training touch. All readings are in memory together, and further readings do not improve training.
pub(super) const MAX_READINGS: usize = 100;
/// Allowed tilt angles, degrees. Much larger tilts make no new part of the object touch the array.
pub(super) const TILT: Range = Between(1e-12, 45.0, "above 0, at most 45");
/// Allowed slide distances, mm. At the upper bound of 1 km, a slide has far fewer steps than it passes taxels. Without a bound, squares of distances could
/// overflow.
pub(super) const SLIDE: Range = Between(0.0, 1e6, "0 to 1000000");
/// Allowed penalties C. At the bounds, a classifier has no margin or no slack.
pub(super) const PENALTY: Range = Between(1e-12, 1e12, "above 0, 1e-12 to 1e12");
/// Allowed multiples of the default kernel parameter γ.
pub(super) const GAMMA: Range = Between(1e-12, 1e9, "above 0, 1e-12 to 1e9");

pub(super) const OVER_TIME: &[(&str, &str)] = &[
    ("", "all frames"),
    ("deepest", "deepest frame"),
    ("summarised", "moments and course"),
];
pub(super) const CHOSEN: &[(&str, &str)] = &[("", "chosen")];

/// Returns the descriptions of all keys of a recognition study.
///
/// Roles: depth, slide, number and speed of presses are choices; pose and friction of the object are conditions. The split, its groups and recorded data are
/// conditions of the experiment: as a choice, the easiest split would always win.
pub fn recognition_keys() -> &'static [KeyAbout] {
    keys_of::<StudySpec>()
}

/// Returns the descriptions of the keys of a kind of study without `[axes]`; only the keys of `lists` (tables and keys) may have a list of values.
pub(crate) fn keys_without_axes(keys: &[KeyAbout], lists: &[&str]) -> Vec<KeyAbout> {
    let has_list = |path: &str| lists.iter().any(|list| is_at(path, list));
    let without_axes = |key: &KeyAbout| match key.axis {
        AxisPlace::Table if has_list(key.path) => *key,
        _ => KeyAbout {
            axis: AxisPlace::Never,
            ..*key
        },
    };
    keys.iter().map(without_axes).collect()
}

/// Returns the description of a key of a recognition study.
///
/// # Panics
/// If there is no such key.
pub(crate) fn key(path: &str) -> &'static KeyAbout {
    let found = find(recognition_keys(), path);
    found.unwrap_or_else(|| panic!("{path} is a key of recognition studies"))
}

impl Check<'_> {
    /// Checks the keys of a table of a recognition study.
    pub(crate) fn table(&self, name: &str, table: &(impl Serialize + 'static)) -> Result<()> {
        self.keys(name, table, recognition_keys())
    }

    /// Checks that a table contains only keys that all kinds of studies use, unless the value of another key has the effect of the absent key.
    pub(crate) fn of_all_kinds(
        &self,
        name: &str,
        table: &impl Serialize,
        allowed: &str,
    ) -> Result<()> {
        let table = table_of(table);
        let is_given = |key: &&KeyAbout| {
            let own = key.path.strip_prefix(name);
            let own = own.and_then(|own| own.strip_prefix('.'));
            let value = own.and_then(|own| value_at(&table, own));
            value.is_some_and(|value| !key.is_usual(value))
        };
        let mut others = recognition_keys().iter();
        let other = others.find(|key| key.of_all_kinds != Some(true) && is_given(key));
        other.map_or(Ok(()), |key| Err(self.error(key.path, "given", allowed)))
    }

    /// Checks and returns the value of a numeric key of recognition studies.
    pub(crate) fn number(&self, path: &str, value: f64) -> Result<f64> {
        let range = key(path).range;
        match range.contains(value) {
            true => Ok(value),
            false => Err(self.error(path, value, range.words())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_that_give_way_to_others_have_ranks_of_their_own_but_measurements_and_ratio() {
        let ranked = recognition_keys()
            .iter()
            .filter(|key| key.gives_way.is_some());
        let mut ranked: Vec<&KeyAbout> = ranked.collect();
        ranked.sort_by_key(|key| key.gives_way);
        let mut ranks: Vec<u8> = ranked.iter().filter_map(|key| key.gives_way).collect();
        assert_eq!(ranks.remove(1), 1);
        assert_eq!(ranked[0].path, "sensing.ratio");
        assert_eq!(ranks, (1..=ranks.len() as u8).collect::<Vec<_>>());
        // Numbers that follow from others give way first; choices of the study itself last.
        assert_eq!(ranked[1].path, "sensing.measurements");
        assert_eq!(ranked[ranks.len()].path, "recognition.features");
        assert!(
            ranked
                .iter()
                .all(|key| key.column("a").gives_way == key.gives_way)
        );
    }
}
