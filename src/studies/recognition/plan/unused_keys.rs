//! Keys without effect: each key that acts only together with other keys, and the checks that a given value acts.

use crate::inputs::toml_value::{is_at, number, table_of, value_at};
use crate::learning::classifiers::parameters;
use crate::learning::data::temporal_features::TemporalFeatures;
use crate::studies::prelude::*;
use crate::studies::recognition::plan::combinations::{
    is_curved, reads_shear, rubs, senses_force, slides,
};
use crate::studies::recognition::plan::tested::TABLES;
use crate::studies::recognition::spec::{PoseSplit, STIFFNESS, key as about};
use crate::world::Spread;
use std::collections::HashSet;
use toml::Table;

/// Keys whose values have an effect only together with other keys.
struct KeyUse {
    keys: &'static [&'static str],
    /// Function that returns whether the values have an effect with the other keys of the plan.
    has_effect: fn(&Plan) -> bool,
    /// Reason why the value has no effect, for the error message.
    reason: &'static str,
    allowed: &'static str,
}

/// Declares the keys that may have no effect: keys that act under one condition, the condition, the reason why they do not act, and what is allowed.
macro_rules! key_uses {
    ($([$($key:literal),+] if $has_effect:expr => $reason:literal, $allowed:expr;)*) => {
        const USES: &[KeyUse] = &[$(KeyUse {
            keys: &[$($key),+],
            has_effect: $has_effect,
            reason: $reason,
            allowed: $allowed,
        }),*];
    };
}

const OF_FORCE: &str = "skin.sensed = \"force\" or \"force\" among signal.steps beside it";
const DRAWN: &str = "no such key, or { uniform = [low, high] } of such a key of [touches]";

key_uses! {
    ["touches.slide_deg"] if |plan| slides(&plan.spec)
        => "touches do not slide", "touches.slide_mm above 0 beside it, or no such key";
    ["skin.curvature_radius_mm"] if |plan| is_curved(&plan.spec)
        => "the layout is flat", "no such key, or a curved skin.layout beside it";
    ["skin.damping_n_s_per_m"] if reads_force
        => "no force is read", OF_FORCE;
    ["skin.damping_n_s_per_m"] if |plan| plan.speed > 0.0
        => "every touch is read at rest", "a touches.speed_mm_per_s above 0 beside it";
    ["skin.friction", "skin.shear_stiffness_n_per_m"] if |plan| reads_shear(&plan.spec)
        => "the skin reads no shear", "skin.sensed = \"shear\" beside it, or no such key";
    ["skin.friction", "skin.shear_stiffness_n_per_m"] if |plan| is_recorded(plan) || rubs(&plan.spec)
        => "tips stay where they first touch", "a touches.slide_mm above 0 or a curved skin.layout beside it";
    ["skin.stiffness_n_per_m"] if |plan| is_recorded(plan) || reads_force(plan)
        => "no force is read", OF_FORCE;
    ["touches.speed_mm_per_s"] if |plan| {
        let needs_motion = |step: &StepSpec| matches!(step, StepSpec::Error(error) if error.about().needs_motion);
        let mut steps = plan.spec.signal.steps.iter();
        plan.spec.skin.damping_n_s_per_m > 0.0 || steps.any(needs_motion)
    } => "the skin has no damper and is not scanned", "a skin.damping_n_s_per_m above 0 or \"scan\" among signal.steps beside it";
    ["sensing.selection"] if |plan| {
        let ensembles = plan.spec.sensing.ensemble.values().into_iter();
        ensembles.flat_map(|ensemble| plan.spec.sensing.selections(ensemble)).any(|method| method.is_some())
    } => "no ensemble of the study selects taxels", "\"selected\" among sensing.ensemble, or no such key";
    ["recognition.test_fraction"] if |plan| plan.spec.recognition.split == PoseSplit::Random
        => "the split says what is held out", "no such key, or split = \"random\"";
    ["signal.combine"] if |plan| {
        let axes = plan.spec.signal.axes.given();
        axes.filter(|(.., axis)| axis.values().len() > 1).count() > 1
    } => "fewer than two keys of [signal] have several values", "no such key, or two axes in [signal]";
    ["sensing.ratio", "sensing.measurements"] if |plan| {
        let counts = plan.spec.sensing.measurements.iter().flat_map(Axis::values);
        let is_all = |m: usize| plan.array.n_values() == m;
        compresses(plan) || plan.spec.sensing.ratio.is_none() && counts.into_iter().all(is_all)
    } => "every ensemble of the study measures all values of a frame", "no such key, or another sensing.ensemble beside it";
    ["recognition.depth_window_full_scale", "recognition.tilt_augmentation"] if has_images
        => "no features of the study are of images", "features of images, or no such key";
    ["recognition.tilt_augmentation_deg"] if |plan| plan.spec.recognition.has_copies()
        => "no touch is copied", "a recognition.tilt_augmentation above 0 beside it";
    ["recognition.temporal_features"] if |plan| {
        let values = Axis::optional_values(&plan.spec.recognition.temporal_features);
        values != [Some(TemporalFeatures::Deepest)] || plan.frames.iter().any(|&n| n > 1)
    } => "every touch is one frame", "touches.frames of 2 or more beside it, or no such key";
    ["recognition.cv_folds"] if |plan| plan.spec.recognition.is_open() || plan.spec.recognition.is_informed()
        => "nothing is chosen by folds", "c_grid, gamma_grid or next_touch = \"most_informative\" beside it";
    ["recognition.cv_touches"] if |plan| plan.spec.recognition.is_open()
        => "nothing is chosen by folds", "c_grid or gamma_grid beside it, or no such key";
    ["recognition.readings_per_touch"] if |plan| {
        let mut conditions = plan.conditions().into_iter();
        conditions.any(|condition| condition.is_random_by_reading())
    } => "all readings of a touch are equal", "a signal.noise_std_full_scale above 0, drift or pink noise beside it";
    ["recognition.next_touch"] if |plan| {
        let counts = plan.spec.recognition.touches_per_decision.values();
        counts.into_iter().any(|k| k > 1)
    } => "one touch has no next", "a recognition.touches_per_decision of 2 or more beside it, or \"random\"";
    ["recognition.group_by_mm"] if |plan| groups_drawn(plan, |axis| !is_angle(axis))
        => "no offset or depth that defines the groups is drawn", DRAWN;
    ["recognition.group_by_deg"] if |plan| groups_drawn(plan, is_angle)
        => "no angle that defines the groups is drawn", DRAWN;
}

/// Returns whether the frames are recorded. Such a study may describe its skin completely.
fn is_recorded(plan: &Plan) -> bool {
    plan.spec.recorded.is_some()
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

/// Key of a variant whose value differs from the usual value: its path, and the error if the value has no effect in the variant.
type GivenKey = (String, Option<Error>);

impl Check<'_> {
    /// Returns the first key that has no effect in any variant of a study: the index of the variant that gives it, and the error.
    pub(crate) fn unused_key<'a>(
        &self,
        variants: impl IntoIterator<Item = &'a Plan>,
    ) -> Option<(usize, Error)> {
        let mut acting: HashSet<String> = HashSet::new();
        let mut unused: Vec<(String, usize, Error)> = Vec::new();
        for (number, plan) in variants.into_iter().enumerate() {
            for (path, error) in self.given_keys(plan) {
                match error {
                    None => drop(acting.insert(path)),
                    Some(error) if unused.iter().all(|(known, ..)| *known != path) => {
                        unused.push((path, number, error));
                    }
                    Some(_) => {}
                }
            }
        }
        let mut unused = unused.into_iter();
        let (_, number, error) = unused.find(|(path, ..)| !acting.contains(path))?;
        Some((number, error))
    }

    /// Returns the keys of a variant that may have no effect. One value of a list that has an effect suffices. A key that training touches and test touches
    /// share has an effect if it has one in either; all other keys must have an effect with the training touches. A key of `[test]` must have an effect in
    /// test touches.
    fn given_keys(&self, plan: &Plan) -> Vec<GivenKey> {
        let study = table_of(&plan.spec);
        let mut given = self.parameters(plan, &study);
        let of_test = plan.tested.as_deref();
        let of_test = of_test.map(|tested| (tested, table_of(&tested.spec)));
        let mut known = HashSet::new();
        let keys = USES.iter().flat_map(|one| one.keys);
        for key in keys.filter(|key| known.insert(**key)) {
            let own = self.given_key("", key, (plan, &study));
            let is_of_touches = TABLES.iter().any(|table| is_at(key, table));
            let tested = of_test.as_ref().filter(|_| is_of_touches);
            let tested =
                tested.and_then(|(tested, table)| self.given_key("test.", key, (tested, table)));
            let is_shared = value_at(&plan.spec.test, key).is_none();
            match (own, tested) {
                (Some((path, _)), Some((_, None))) if is_shared => given.push((path, None)),
                (own, _) if is_shared => given.extend(own),
                (own, tested) => given.extend(own.into_iter().chain(tested)),
            }
        }
        given
    }

    /// Returns a key whose value differs from the usual one, with the error if one of the conditions under which it acts is not met.
    fn given_key(
        &self,
        prefix: &str,
        key: &str,
        (plan, study): (&Plan, &Table),
    ) -> Option<GivenKey> {
        let value = value_at(study, key)?;
        let one = std::slice::from_ref(value);
        let mut values = value.as_array().map_or(one, Vec::as_slice).iter();
        let given = values.find(|value| !about(key).is_usual(value))?;
        let path = format!("{prefix}{key}");
        let mut uses = USES.iter().filter(|one| one.keys.contains(&key));
        let unmet = uses.find(|one| !(one.has_effect)(plan));
        let error = unmet.map(|one| {
            let value = number(given).map_or_else(|| given.to_string(), |n| n.to_string());
            let given = format!("{value}, but {}", one.reason);
            self.error(&path, given, one.allowed)
        });
        Some((path, error))
    }

    /// Returns the parameters of classifiers whose values differ from the usual ones, each with the error if no classifier uses it.
    fn parameters(&self, plan: &Plan, study: &Table) -> Vec<GivenKey> {
        let kinds = plan.spec.recognition.kinds();
        let given = parameters::keys().filter_map(|key| {
            let path = format!("recognition.{key}");
            let value = value_at(study, &path)?;
            if about(&path).is_usual(value) {
                return None;
            }
            let error = || {
                let given = format!("{value}, but no classifier of the study uses it");
                let users = parameters::users(key);
                let allowed = format!("{users} among recognition.classifier, or no such key");
                self.error(&path, given, allowed)
            };
            let acts = kinds.iter().any(|kind| kind.uses(key));
            let error = (!acts).then(error);
            Some((path, error))
        });
        given.collect()
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
}
