//! Descriptions of the keys of recognition studies; other kinds of studies use some of these keys.

use crate::error::Result;
use crate::inputs::check::Check;
use crate::inputs::keys::{AxisPlace, KeyAbout, find, keys};
use crate::inputs::range::Range::{
    self, Any, AtLeastOne, Between, Count, Finite, Fraction, NotNegative, Part, Positive,
    Unchecked, ZeroOrBetween,
};
use crate::inputs::range::{COUNT, MAX_COUNTED, SIDE, SURFACE_ERROR, TOUCHES};
use crate::inputs::sensor_errors::strength_keys;
use crate::inputs::toml_value::is_at;
use crate::inputs::units::MAX_FRAMES;
use crate::learning::classifiers::ClassifierKind;
use crate::learning::classifiers::parameters::{Parameter, declared};
use crate::sensing::{Ensemble, Selection};
use crate::table::Role;
use crate::table::Scale::{Linear, Log, Share, Words};
use bubbletouch_sim::features::Features;
use serde::Serialize;
use std::sync::LazyLock;

/// Maximum number of trials of a study, because the splits of all trials are kept in memory.
const MAX_TRIALS: usize = 100_000;
/// Maximum number of tilted copies of a training touch; further copies do not improve a classifier.
const MAX_COPIES: usize = 1000;
/// Maximum number of readings of a training touch. All readings are in memory together, and further readings do not improve training.
const MAX_READINGS: usize = 100;
/// Allowed tilt angles, degrees. Much larger tilts make no new part of the object touch the array.
const TILT: Range = Between(1e-12, 45.0, "above 0, at most 45");
/// Allowed slide distances, mm. At the upper bound of 1 km, a slide has far fewer steps than it passes taxels. Without a bound, squares of distances could
/// overflow.
const SLIDE: Range = Between(0.0, 1e6, "0 to 1000000");
/// Allowed noise standard deviations, as fractions of full scale. At the upper bound, nothing of the signal remains, and squares of features still fit into
/// f32.
const NOISE: Range = ZeroOrBetween(1e-12, 1000.0, "0, or 1e-12 to 1000");
/// Allowed penalties C. At the bounds, a classifier has no margin or no slack.
const PENALTY: Range = Between(1e-12, 1e12, "above 0, 1e-12 to 1e12");
/// Allowed multiples of the default kernel parameter γ.
const GAMMA: Range = Between(1e-12, 1e9, "above 0, 1e-12 to 1e9");

const OVER_TIME: &[(&str, &str)] = &[
    ("", "all frames"),
    ("deepest", "deepest frame"),
    ("summarised", "moments and course"),
];
const CHOSEN: &[(&str, &str)] = &[("", "chosen")];

/// Descriptions of the keys of a recognition study, without the strengths of sensor errors and the parameters of classifiers.
///
/// Roles: depth, slide, number and speed of presses are choices; pose and friction of the object are conditions. The split, its groups and recorded data are
/// conditions of the experiment: as a choice, the easiest split would always win.
const KEYS: &[KeyAbout] = keys! {
    "question": Never, Note, Unchecked;
    "expected": Never, Note, Unchecked;
    "seed": Never, Subject, Unchecked;
    "trials": Never, Subject, Count(1, MAX_TRIALS);
    "projections_per_split": Never, Note, Count(2, MAX_TRIALS);

    "objects.sets": Axes, Condition, Unchecked;
    "objects.names": Axes, Condition, Any;
    "objects.meshes": Axes, Condition, Unchecked;
    "objects.model": Axes, Condition, Any;
    "objects.unit": Axes, Condition, Any;
    "objects.surface_error_mm": Axes, Condition, SURFACE_ERROR;
    "objects.close_holes_mm": Axes, Condition, Positive;

    "skin.pitch_mm": Table, Choice, Positive, scale: Linear, gives_way: 3;
    "skin.size_mm": Table, Choice, Positive, title: "array size", scale: Linear, gives_way: 2;
    "skin.taxels": Table, Choice, SIDE, scale: Linear;
    "skin.layout": Axes, Choice, Any;
    "skin.curvature_radius_mm": Axes, Choice, Positive;
    "skin.sensed": Axes, Choice, Any, title: "sensed quantity";
    "skin.friction": Axes, Condition, NotNegative;
    "skin.shear_stiffness_n_per_m": Axes, Choice, Positive;
    "skin.taxel_radius_mm": Axes, Choice, Positive;
    "skin.stroke_mm": Axes, Choice, Positive;
    "skin.stiffness_n_per_m": Axes, Choice, Positive;
    "skin.damping_n_s_per_m": Axes, Choice, NotNegative;

    "touches.rest": Axes, Condition, Any;
    "touches.per_object": Axes, Choice, TOUCHES;
    "touches.offset_x_mm": Axes, Condition, Finite;
    "touches.offset_y_mm": Axes, Condition, Finite;
    "touches.yaw_deg": Axes, Condition, Finite;
    "touches.tilt_x_deg": Axes, Condition, Finite;
    "touches.tilt_y_deg": Axes, Condition, Finite;
    "touches.depth_mm": Axes, Choice, Positive;
    "touches.slide_mm": Axes, Choice, SLIDE;
    "touches.slide_deg": Axes, Choice, Finite;
    "touches.frames": Table, Choice, Count(1, MAX_FRAMES), title: "frames a touch", scale: Log, gives_way: 11;
    "touches.speed_mm_per_s": Axes, Choice, NotNegative;

    "human_touch.kinds": Axes, Condition, Any;
    "human_touch.per_kind": Axes, Choice, TOUCHES;
    "human_touch.arm_radius_mm": Axes, Choice, Positive;
    "human_touch.frames_hz": Axes, Choice, Positive;
    "human_touch.duration_s": Axes, Choice, Positive;

    "recorded.frames": Axes, Condition, Unchecked;
    "recorded.shear": Axes, Condition, Unchecked;
    "recorded.labels": Axes, Condition, Unchecked;
    "recorded.groups": Axes, Condition, Unchecked;
    "recorded.splits": Axes, Condition, Unchecked;
    "recorded.order": Axes, Condition, Unchecked;
    "recorded.columns": Axes, Choice, Unchecked;
    "recorded.grid": Axes, Condition, Unchecked;
    "recorded.layout": Axes, Condition, Unchecked;
    "recorded.lengths": Axes, Condition, Unchecked;
    "recorded.lengths_test": Axes, Condition, Unchecked;
    "recorded.resampled_frames": Axes, Choice, Count(1, MAX_FRAMES);
    "recorded.sensors": Axes, Condition, Unchecked;
    "recorded.sensor": Axes, Choice, Any;
    "recorded.frames_test": Axes, Condition, Unchecked;
    "recorded.shear_test": Axes, Condition, Unchecked;
    "recorded.labels_test": Axes, Condition, Unchecked;
    "recorded.groups_test": Axes, Condition, Unchecked;
    "recorded.names": Axes, Condition, Unchecked;
    "recorded.zero": Axes, Condition, Finite;
    "recorded.full_scale": Axes, Condition, Finite;
    "recorded.depths": Axes, Condition, Unchecked;
    "recorded.speed_mm_per_s": Axes, Condition, NotNegative;
    "recorded.frame_interval_s": Axes, Condition, Positive;
    "recorded.previous_touch": Axes, Condition, Any;

    "signal.steps": Axes, Choice, Unchecked;
    "signal.combine": Axes, Condition, Any;
    "signal.noise_std_full_scale": Table, Condition, NOISE, title: "noise", unit: "%", scale: Share, gives_way: 10;
    "signal.noise_std_mm": Table, Condition, NotNegative, title: "noise", scale: Linear;
    "signal.noise_std_n": Table, Condition, NotNegative, title: "noise", scale: Linear;
    "signal.smoothing_mm": Table, Choice, NotNegative, scale: Linear, gives_way: 9;
    "signal.test_sensor": Table, Condition, Any, scale: Words;

    "sensing.ensemble": Table, Choice, Any, scale: Words, names: Ensemble::NAMES;
    "sensing.ratio": Table, Choice, AtLeastOne, title: "compression", unit: ":1", scale: Log, gives_way: 1;
    "sensing.measurements": Table, Choice, COUNT, title: "m", scale: Log, gives_way: 1;
    "sensing.selection": Table, Choice, Any, title: "taxels selected by", scale: Words, names: Selection::NAMES;
    "sensing.readings_per_s": Axes, Choice, Positive;

    "recognition.features": Table, Choice, Any, scale: Words, names: Features::NAMES, gives_way: 13;
    "recognition.depth_window_full_scale": Table, Choice, Positive, title: "depth window", unit: "%", scale: Share;
    "recognition.tilt_augmentation": Table, Choice, Count(0, MAX_COPIES), scale: Linear;
    "recognition.tilt_augmentation_deg": Axes, Choice, TILT;
    "recognition.temporal_features": Table, Choice, Any, scale: Words, names: OVER_TIME, gives_way: 12;
    "recognition.classifier": Table, Choice, Any, scale: Words, names: ClassifierKind::NAMES;
    "recognition.multiclass": Axes, Choice, Any;
    "recognition.class_weight": Axes, Choice, Any;
    "recognition.solver": Axes, Choice, Any;
    "recognition.scaling": Axes, Choice, Any;
    "recognition.c": Table, Choice, PENALTY, title: "C", scale: Log, names: CHOSEN, gives_way: 4;
    "recognition.c_grid": Axes, Choice, PENALTY;
    "recognition.gamma_grid": Axes, Choice, GAMMA;
    "recognition.cv_folds": Axes, Choice, Count(2, MAX_COUNTED);
    "recognition.cv_touches": Axes, Choice, COUNT;
    "recognition.readings_per_touch": Axes, Choice, Count(1, MAX_READINGS);
    "recognition.solver_memory_gib": Axes, Choice, Positive;
    "recognition.train_touches": Table, Choice, COUNT, title: "training touches", scale: Log, gives_way: 5;
    "recognition.mislabelled_fraction": Table, Condition, Fraction, title: "mislabelled", unit: "%", scale: Share, gives_way: 6;
    "recognition.class_imbalance": Table, Condition, AtLeastOne, unit: ":1", scale: Log, gives_way: 7;
    "recognition.touches_per_decision": Table, Choice, COUNT, scale: Log, gives_way: 8;
    "recognition.next_touch": Table, Choice, Any, scale: Words;
    "recognition.split": Axes, Condition, Any, title: "poses held out";
    "recognition.test_fraction": Axes, Condition, Part;
    "recognition.folds": Axes, Condition, Count(2, MAX_COUNTED);
    "recognition.group_by": Axes, Condition, Any, title: "group held out";
    "recognition.group_by_mm": Axes, Condition, Positive;
    "recognition.group_by_deg": Axes, Condition, Positive;

    "test": Axes, Condition, Unchecked;
    "report.samples": Never, Note, Any;
    "report.pareto": Never, Note, Any;
    "report.confusion": Never, Note, Any;
    "report.predictions": Never, Note, Any;
    "report.metrics": Never, Note, Any;
    "report.published": Never, Note, Unchecked;
};

/// Returns the descriptions of all keys of a recognition study.
pub fn recognition_keys() -> &'static [KeyAbout] {
    static ALL: LazyLock<Vec<KeyAbout>> = LazyLock::new(|| {
        let (before, after) = KEYS.split_at(place_after("signal."));
        let place = place_after("recognition.readings_per_touch") - before.len();
        let (between, after) = after.split_at(place);
        [before, strength_keys(), between, &parameter_keys(), after].concat()
    });
    &ALL
}

/// Returns the descriptions of the parameters that classifiers declare.
fn parameter_keys() -> Vec<KeyAbout> {
    let about = |parameter: &'static Parameter| {
        let path = format!("recognition.{}", parameter.key).leak();
        let range = Range::Declared(parameter);
        KeyAbout::new(path, AxisPlace::Axes, Role::Choice, range)
    };
    declared().map(about).collect()
}

/// Returns the index after the last key whose name begins with `prefix`.
fn place_after(prefix: &str) -> usize {
    let place = KEYS.iter().rposition(|key| key.path.starts_with(prefix));
    place.map_or(0, |place| place + 1)
}

/// Returns the descriptions of the keys in `tables`, for a kind of study without `[axes]`; only keys in `axes` may have a list of values.
pub(crate) fn shared_keys(tables: &[&str], axes: &[&str]) -> Vec<KeyAbout> {
    let is_in = |tables: &[&str], path: &str| tables.iter().any(|table| is_at(path, table));
    let shared = recognition_keys().iter().copied();
    let shared = shared.filter(|key| is_in(tables, key.path));
    let without_axes = |key: KeyAbout| match key.axis {
        AxisPlace::Table if is_in(axes, key.path) => key,
        _ => KeyAbout {
            axis: AxisPlace::Never,
            ..key
        },
    };
    shared.map(without_axes).collect()
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
    /// Checks the keys of a table of a recognition study; returns the keys that the table contains.
    pub fn table(&self, name: &str, table: &impl Serialize) -> Result<toml::Table> {
        self.keys(name, table, recognition_keys())
    }

    /// Checks and returns the value of a numeric key of recognition studies.
    pub fn number(&self, path: &str, value: f64) -> Result<f64> {
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
