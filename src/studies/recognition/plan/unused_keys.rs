//! Keys without effect: each key that acts only together with other keys, and the checks that a given value acts.

use crate::engine::axes::StudyAxes;
use crate::inputs::toml_value::{is_at, number, table_of, value_at};
use crate::learning::data::temporal_features::TemporalFeatures;
use crate::studies::prelude::*;
use crate::studies::recognition::plan::combinations::{
    is_curved, reads_shear, senses_force, slides,
};
use crate::studies::recognition::plan::tested::TABLES;
use crate::studies::recognition::spec::{STIFFNESS, key};
use crate::world::Spread;
use toml::Table;

/// Keys whose values have an effect only together with other keys.
struct KeyUse {
    keys: &'static [&'static str],
    /// Function that returns whether the values have an effect with the other keys of the plan.
    has_effect: fn(&Plan) -> bool,
    /// Names of the other keys that are needed, or of their tables. If one of these keys is an axis, the value may have an effect in another configuration.
    beside: &'static [&'static str],
    /// Reason why the value has no effect, for the error message.
    reason: &'static str,
    allowed: &'static str,
}

/// Declares the keys that may have no effect: keys that act under one condition, the keys that it depends on, the reason why they do not act, and what is allowed.
macro_rules! key_uses {
    ($([$($key:literal),+] beside [$($beside:literal),*] if $has_effect:expr => $reason:literal, $allowed:expr;)*) => {
        const USES: &[KeyUse] = &[$(KeyUse {
            keys: &[$($key),+],
            has_effect: $has_effect,
            beside: &[$($beside),*],
            reason: $reason,
            allowed: $allowed,
        }),*];
    };
}

const OF_FORCE: &str = "skin.sensed = \"force\" or \"force\" among signal.steps beside it";
const DRAWN: &str = "no such key, or { uniform = [low, high] } of such a key of [touches]";

key_uses! {
    ["touches.slide_deg"] beside ["touches.slide_mm"] if |plan| slides(&plan.spec)
        => "touches do not slide", "touches.slide_mm above 0 beside it, or no such key";
    ["skin.curvature_radius_mm"] beside ["skin.layout"] if |plan| is_curved(&plan.spec)
        => "the layout is flat", "no such key, or a curved skin.layout beside it";
    ["skin.damping_n_s_per_m"] beside ["skin.sensed", "signal.steps"] if reads_force
        => "no force is read", OF_FORCE;
    ["skin.damping_n_s_per_m"] beside ["touches.speed_mm_per_s", "recorded.speed_mm_per_s"] if |plan| plan.speed > 0.0
        => "every touch is read at rest", "a touches.speed_mm_per_s above 0 beside it";
    ["skin.friction", "skin.shear_stiffness_n_per_m"] beside ["skin.sensed"] if |plan| reads_shear(&plan.spec)
        => "the skin reads no shear", "skin.sensed = \"shear\" beside it, or no such key";
    ["skin.friction", "skin.shear_stiffness_n_per_m"] beside ["touches.slide_mm", "skin.layout"] if |plan| is_recorded(plan) || rubs(&plan.spec)
        => "tips stay where they first touch", "a touches.slide_mm above 0 or a curved skin.layout beside it";
    ["skin.stiffness_n_per_m"] beside ["skin.sensed", "signal.steps"] if |plan| is_recorded(plan) || reads_force(plan)
        => "no force is read", OF_FORCE;
    ["touches.speed_mm_per_s"] beside ["skin.damping_n_s_per_m", "signal.steps"] if |plan| {
        let needs_motion = |step: &StepSpec| matches!(step, StepSpec::Error(error) if error.about().needs_motion);
        let mut steps = plan.spec.signal.steps.iter();
        plan.spec.skin.damping_n_s_per_m > 0.0 || steps.any(needs_motion)
    } => "the skin has no damper and is not scanned", "a skin.damping_n_s_per_m above 0 or \"scan\" among signal.steps beside it";
    ["signal.combine"] beside [] if |plan| {
        let axes = plan.spec.signal.axes.given();
        axes.filter(|(.., axis)| axis.values().len() > 1).count() > 1
    } => "fewer than two keys of [signal] have several values", "no such key, or two axes in [signal]";
    ["sensing.ratio", "sensing.measurements"] beside ["sensing.ensemble"] if |plan| {
        let counts = plan.spec.sensing.measurements.iter().flat_map(Axis::values);
        let is_all = |m: usize| plan.arrays.iter().all(|array| array.n_values() == m);
        compresses(plan) || plan.spec.sensing.ratio.is_none() && counts.into_iter().all(is_all)
    } => "every ensemble of the study measures all values of a frame", "no such key, or another sensing.ensemble beside it";
    ["recognition.depth_window_full_scale", "recognition.tilt_augmentation"] beside ["recognition.features"] if has_images
        => "no features of the study are of images", "features of images, or no such key";
    ["recognition.tilt_augmentation_deg"] beside ["recognition.tilt_augmentation"] if |plan| plan.spec.recognition.has_copies()
        => "no touch is copied", "a recognition.tilt_augmentation above 0 beside it";
    ["recognition.temporal_features"] beside ["touches.frames"] if |plan| {
        let values = Axis::optional_values(&plan.spec.recognition.temporal_features);
        values != [Some(TemporalFeatures::Deepest)] || plan.frames.iter().any(|&n| n > 1)
    } => "every touch is one frame", "touches.frames of 2 or more beside it, or no such key";
    ["recognition.cv_folds"] beside ["recognition.c_grid", "recognition.gamma_grid", "recognition.next_touch"] if |plan| plan.spec.recognition.is_open() || plan.spec.recognition.is_informed()
        => "nothing is chosen by folds", "c_grid, gamma_grid or next_touch = \"most_informative\" beside it";
    ["recognition.cv_touches"] beside ["recognition.c_grid", "recognition.gamma_grid"] if |plan| plan.spec.recognition.is_open()
        => "nothing is chosen by folds", "c_grid or gamma_grid beside it, or no such key";
    ["recognition.readings_per_touch"] beside ["signal"] if |plan| {
        let mut conditions = plan.conditions().into_iter();
        conditions.any(|condition| condition.is_random_by_reading())
    } => "all readings of a touch are equal", "a signal.noise_std_full_scale above 0, drift or pink noise beside it";
    ["recognition.next_touch"] beside ["recognition.touches_per_decision"] if |plan| {
        let counts = plan.spec.recognition.touches_per_decision.values();
        counts.into_iter().any(|k| k > 1)
    } => "one touch has no next", "a recognition.touches_per_decision of 2 or more beside it, or \"random\"";
    ["recognition.group_by_mm"] beside ["touches", "recognition.group_by"] if |plan| groups_drawn(plan, |axis| !is_angle(axis))
        => "no offset or depth that defines the groups is drawn", DRAWN;
    ["recognition.group_by_deg"] beside ["touches", "recognition.group_by"] if |plan| groups_drawn(plan, is_angle)
        => "no angle that defines the groups is drawn", DRAWN;
}

/// Returns whether the frames are recorded. Such a study may describe its skin completely.
fn is_recorded(plan: &Plan) -> bool {
    plan.spec.recorded.is_some()
}

/// Returns whether taxels move along the object. On a flat array that is pressed straight on, no taxel does.
fn rubs(spec: &StudySpec) -> bool {
    slides(spec) || is_curved(spec)
}

/// Returns whether the study reads forces.
fn reads_force(plan: &Plan) -> bool {
    senses_force(&plan.spec) || plan.spec.signal.steps.contains(&StepSpec::Force)
}

/// Returns whether an ensemble of the study compresses frames.
fn compresses(plan: &Plan) -> bool {
    let mut ensembles = plan.spec.sensing.ensemble.values().into_iter();
    ensembles.any(|ensemble| !ensemble.about().is_whole_frame)
}

/// Returns whether some features of the study are of images.
fn has_images(plan: &Plan) -> bool {
    let mut features = plan.spec.recognition.all_features().into_iter();
    features.any(|features| features.of_image().is_some())
}

fn is_angle(axis: TouchAxis) -> bool {
    matches!(axis, TouchAxis::Yaw | TouchAxis::TiltX | TouchAxis::TiltY)
}

/// Returns whether the groups of the split depend on an axis of drawn values that a predicate selects.
fn groups_drawn(plan: &Plan, is_selected: fn(TouchAxis) -> bool) -> bool {
    let spreads = plan.placement.spreads();
    let mut drawn = spreads
        .iter()
        .filter(|(_, spread)| matches!(spread, Spread::Uniform { .. }));
    let axes = plan.group_by.map_or(&[][..], |groups| groups.kind.axes());
    drawn.any(|(axis, _)| is_selected(*axis) && axes.contains(axis))
}

/// Returns whether a key in `names`, or a key of a table in `names`, is an axis. Names of keys of test touches start with `table`.
fn has_axis(axes: &StudyAxes, table: &str, names: &[&str]) -> bool {
    let keys = axes.axes.iter().flat_map(|axis| axis.keys());
    let mut keys = keys.into_iter();
    keys.any(|key| {
        let key = key.strip_prefix(table);
        key.is_some_and(|key| names.iter().any(|name| is_at(key, name)))
    })
}

impl Check<'_> {
    /// Checks that keys have an effect. One value of an axis that uses a key suffices. A key that training touches and test touches share has an effect if it has
    /// one in either; all other keys must have an effect with the training touches. A key of `[test]` must have an effect in test touches.
    pub(crate) fn unused_keys(&self, plan: &Plan) -> Result<()> {
        self.sticking_shear(plan)?;
        let axes = &plan.spec.axes;
        let of_test = plan.tested.as_deref().map(|tested| ("test.", tested));
        let plans = [("", plan)].into_iter().chain(of_test);
        let plans: Vec<_> = plans
            .map(|(prefix, plan)| (prefix, plan, table_of(&plan.spec)))
            .collect();
        let each = USES.iter();
        for (key_use, key) in each.flat_map(|one| one.keys.iter().map(move |key| (one, key))) {
            let is_of_touches = TABLES.iter().any(|table| is_at(key, table));
            let n_plans = if is_of_touches { plans.len() } else { 1 };
            let unused = plans[..n_plans].iter().map(|(prefix, plan, table)| {
                let value = key_use.unused(key, (plan, table), (axes, prefix))?;
                Some((format!("{prefix}{key}"), value))
            });
            let mut unused: Vec<Option<(String, String)>> = unused.collect();
            if value_at(&plan.spec.test, key).is_none() {
                // Training touches and test touches share the value.
                let acts_in_one = unused.contains(&None);
                unused.retain(|_| !acts_in_one);
            }
            if let Some((path, value)) = unused.into_iter().flatten().next() {
                let given = format!("{value}, but {}", key_use.reason);
                return Err(self.error(&path, given, key_use.allowed));
            }
        }
        Ok(())
    }

    /// Checks that the springs, the dampers and the speed have an effect in a study of another kind than recognition. `of_force` states which keys make the
    /// study read forces.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn used_springs(
        &self,
        (skin, touches): (&SkinSpec, &TouchesSpec),
        reads_force: bool,
        of_force: &str,
    ) -> Result<()> {
        let (stiffness, damping) = (skin.stiffness_n_per_m, skin.damping_n_s_per_m);
        let speed = touches.speed_mm_per_s;
        let keys = [
            ("skin.stiffness_n_per_m", stiffness, STIFFNESS),
            ("skin.damping_n_s_per_m", damping, 0.0),
            ("touches.speed_mm_per_s", speed, 0.0),
        ];
        for (key, given, default) in keys {
            if !reads_force && given != default {
                return Err(self.error(key, format!("{given}, but no force is read"), of_force));
            }
        }
        if damping > 0.0 && speed == 0.0 {
            let given = format!("{damping}, but every touch is read at rest");
            let allowed = "a touches.speed_mm_per_s above 0 beside it";
            return Err(self.error("skin.damping_n_s_per_m", given, allowed));
        }
        if speed > 0.0 && damping == 0.0 {
            let given = format!("{speed}, but the skin has no damper");
            let allowed = "a skin.damping_n_s_per_m above 0 beside it";
            return Err(self.error("touches.speed_mm_per_s", given, allowed));
        }
        Ok(())
    }

    /// Returns an error if taxels read shear and move along the object, but have no friction.
    fn sticking_shear(&self, plan: &Plan) -> Result<()> {
        let sticks = !is_recorded(plan) && reads_shear(&plan.spec) && rubs(&plan.spec);
        match sticks && plan.spec.skin.friction.is_none() {
            true => Err(self.error("skin.sensed", "shear", "skin.friction beside it")),
            false => Ok(()),
        }
    }
}

impl KeyUse {
    /// Returns the first value of one of the keys in a study that differs from the usual value, if no value has an effect. Returns `None` if the values have an effect, or
    /// may have one because another key is an axis. Other keys of test touches may be axes of `of_test`.
    fn unused(
        &self,
        path: &str,
        (plan, study): (&Plan, &Table),
        (axes, of_test): (&StudyAxes, &str),
    ) -> Option<String> {
        let acts = || {
            (self.has_effect)(plan)
                || has_axis(axes, "", self.beside)
                || has_axis(axes, of_test, self.beside)
        };
        let (value, about) = (value_at(study, path)?, key(path));
        let one = std::slice::from_ref(value);
        let mut values = value.as_array().map_or(one, Vec::as_slice).iter();
        let given = values.find(|value| !about.is_usual(value))?;
        let words = || number(given).map_or_else(|| given.to_string(), |n| n.to_string());
        (!acts()).then(words)
    }
}
