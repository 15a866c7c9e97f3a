//! Checks for keys that have no effect in a study.

use crate::engine::axes::{CombineSpec, StudyAxes};
use crate::engine::axis::Axis;
use crate::error::Result;
use crate::inputs::check::Check;
use crate::inputs::defaults::number;
use crate::inputs::toml_value::is_at;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::spec::scene::{SensedSpec, SkinSpec, TouchesSpec};
use crate::studies::recognition::spec::signal::StepSpec;
use crate::studies::recognition::spec::study::StudySpec;
use crate::world::{Spread, TouchAxis};

/// A key whose values have an effect only together with other keys.
struct KeyUse {
    key: &'static str,
    /// Function that returns the value of the key, if this value may have no effect without other keys.
    given: fn(&Plan) -> Option<f64>,
    /// Function that returns whether the value has an effect with the other keys of the plan.
    has_effect: fn(&Plan) -> bool,
    /// Names of the other keys that are needed, or of their tables. If one of these keys is an axis, the value may have an effect in another configuration.
    beside: &'static [&'static str],
    /// Reason why the value has no effect, for the error message.
    reason: &'static str,
    allowed: &'static str,
}

const OF_FORCE: &str = "skin.sensed = \"force\" or \"force\" among signal.steps beside it";
const WHOLE_FRAMES: &str = "every ensemble of the study measures all values of a frame";
const ENSEMBLE: &str = "no such key, or another sensing.ensemble beside it";

/// Keys that may have no effect.
const USES: [KeyUse; 8] = [
    KeyUse {
        key: "skin.stiffness_n_per_m",
        given: |plan| {
            let given = plan.spec.skin.stiffness_n_per_m;
            // A study of recorded frames may describe the skin completely.
            (plan.spec.recorded.is_none() && given != number::<100>()).then_some(given)
        },
        has_effect: |plan| reads_force(&plan.spec),
        beside: &["skin.sensed", "signal.steps"],
        reason: "no force is read",
        allowed: OF_FORCE,
    },
    KeyUse {
        key: "touches.speed_mm_per_s",
        given: |plan| Some(plan.spec.touches.speed_mm_per_s).filter(|&speed| speed > 0.0),
        has_effect: |plan| {
            let needs_motion = |step: &StepSpec| matches!(step, StepSpec::Error(error) if error.about().needs_motion);
            plan.spec.skin.damping_n_s_per_m > 0.0
                || plan.spec.signal.steps.iter().any(needs_motion)
        },
        beside: &["skin.damping_n_s_per_m", "signal.steps"],
        reason: "the skin has no damper and is not scanned",
        allowed: "a skin.damping_n_s_per_m above 0 or \"scan\" among signal.steps beside it",
    },
    KeyUse {
        key: "recognition.readings_per_touch",
        given: |plan| {
            let given = plan.spec.recognition.readings_per_touch;
            given.filter(|&n| n > 1).map(|n| n as f64)
        },
        has_effect: |plan| {
            let mut conditions = plan.conditions().into_iter();
            conditions.any(|condition| condition.is_random_by_reading())
        },
        beside: &["signal"],
        reason: "all readings of a touch are equal",
        allowed: "a signal.noise_std_full_scale above 0, drift or pink noise beside it",
    },
    KeyUse {
        key: "sensing.ratio",
        given: |plan| {
            let ratios = plan.spec.sensing.ratio.iter().flat_map(Axis::values);
            ratios.into_iter().find(|&ratio| ratio != 1.0)
        },
        has_effect: compresses,
        beside: &["sensing.ensemble"],
        reason: WHOLE_FRAMES,
        allowed: ENSEMBLE,
    },
    KeyUse {
        key: "sensing.measurements",
        given: |plan| {
            let counts = plan.spec.sensing.measurements.iter().flat_map(Axis::values);
            let is_all = |m: usize| plan.arrays.iter().all(|array| array.n_values() == m);
            counts.into_iter().find(|&m| !is_all(m)).map(|m| m as f64)
        },
        has_effect: compresses,
        beside: &["sensing.ensemble"],
        reason: WHOLE_FRAMES,
        allowed: ENSEMBLE,
    },
    KeyUse {
        key: "recognition.tilt_augmentation_deg",
        given: |plan| plan.spec.recognition.tilt_augmentation_deg,
        has_effect: |plan| {
            let copies = &plan.spec.recognition.tilt_augmentation;
            copies.iter().flat_map(Axis::values).any(|n| n > 0)
        },
        beside: &["recognition.tilt_augmentation"],
        reason: "no touch is copied",
        allowed: "a recognition.tilt_augmentation above 0 beside it",
    },
    KeyUse {
        key: "recognition.group_by_mm",
        given: |plan| plan.spec.recognition.group_by_mm,
        has_effect: |plan| groups_drawn(plan, |axis| !is_angle(axis)),
        beside: &["touches", "recognition.group_by"],
        reason: "no offset or depth that defines the groups is drawn",
        allowed: "no such key, or { uniform = [low, high] } of such a key of [touches]",
    },
    KeyUse {
        key: "recognition.group_by_deg",
        given: |plan| plan.spec.recognition.group_by_deg,
        has_effect: |plan| groups_drawn(plan, is_angle),
        beside: &["touches", "recognition.group_by"],
        reason: "no angle that defines the groups is drawn",
        allowed: "no such key, or { uniform = [low, high] } of such a key of [touches]",
    },
];

/// Returns whether the study reads forces.
fn reads_force(spec: &StudySpec) -> bool {
    spec.skin.sensed.unwrap_or_default() != SensedSpec::Deflection
        || spec.signal.steps.contains(&StepSpec::Force)
}

/// Returns whether an ensemble of the study compresses frames.
fn compresses(plan: &Plan) -> bool {
    let mut ensembles = plan.spec.sensing.ensemble.values().into_iter();
    ensembles.any(|ensemble| !ensemble.about().is_whole_frame)
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

/// Returns whether a key in `names`, or a key of a table in `names`, is an axis.
fn has_axis(axes: &StudyAxes, names: &[&str]) -> bool {
    let keys = axes.axes.iter().flat_map(|axis| axis.keys());
    let mut keys = keys.into_iter();
    keys.any(|key| names.iter().any(|name| is_at(&key, name)))
}

impl Check<'_> {
    /// Checks that keys have an effect. One value of an axis that uses a key suffices, as do separate test touches.
    pub fn unused_keys(&self, plan: &Plan) -> Result<()> {
        let spec = &plan.spec;
        if !spec.test.is_empty() {
            return Ok(());
        }
        self.used_damper(spec)?;
        self.used_friction(spec)?;
        for KeyUse {
            key,
            given,
            has_effect,
            beside,
            reason,
            allowed,
        } in &USES
        {
            if let Some(given) = given(plan)
                && !has_effect(plan)
                && !has_axis(&spec.axes, beside)
            {
                return Err(self.error(key, format!("{given}, but {reason}"), allowed));
            }
        }
        let signal = &spec.signal;
        let several = signal.axes.given();
        let several = several.filter(|(.., axis)| axis.values().len() > 1);
        if signal.combine == CombineSpec::OneAtATime && several.count() < 2 {
            let given = "one_at_a_time, but fewer than two keys of [signal] have several values";
            let allowed = "no such key, or two axes in [signal]";
            return Err(self.error("signal.combine", given, allowed));
        }
        Ok(())
    }

    /// Checks that the springs, the dampers and the speed have an effect in a study of another kind than recognition. `of_force` states which keys make the
    /// study read forces.
    pub fn used_springs(
        &self,
        (skin, touches): (&SkinSpec, &TouchesSpec),
        reads_force: bool,
        of_force: &str,
    ) -> Result<()> {
        let (stiffness, damping) = (skin.stiffness_n_per_m, skin.damping_n_s_per_m);
        let speed = touches.speed_mm_per_s;
        let keys = [
            ("skin.stiffness_n_per_m", stiffness, number::<100>()),
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

    /// Returns an error if the taxels have a damper that has no effect in the study. A damper acts on moving taxels, and so affects only forces that are read
    /// during the press.
    fn used_damper(&self, spec: &StudySpec) -> Result<()> {
        let (skin, touches, axes) = (&spec.skin, &spec.touches, &spec.axes);
        let reads_force = reads_force(spec) || has_axis(axes, &["skin.sensed", "signal.steps"]);
        let speed = spec
            .recorded
            .as_ref()
            .map_or(touches.speed_mm_per_s, |r| r.speed_mm_per_s);
        let moves = speed > 0.0
            || axes.has("touches.speed_mm_per_s")
            || axes.has("recorded.speed_mm_per_s");
        if skin.damping_n_s_per_m > 0.0 && !(reads_force && moves) {
            let given = match reads_force {
                true => format!(
                    "{}, but every touch is read at rest",
                    skin.damping_n_s_per_m
                ),
                false => format!("{}, but no force is read", skin.damping_n_s_per_m),
            };
            let allowed = match reads_force {
                true => "a touches.speed_mm_per_s above 0 beside it",
                false => OF_FORCE,
            };
            return Err(self.error("skin.damping_n_s_per_m", given, allowed));
        }
        Ok(())
    }

    /// Returns an error if the taxels have friction that has no effect in the study. Friction acts only on taxels that move along the object. On a flat array
    /// that is pressed straight on, no taxel does.
    fn used_friction(&self, spec: &StudySpec) -> Result<()> {
        let (skin, axes) = (&spec.skin, &spec.axes);
        let rubs = spec.touches.slide_mm.is_some_and(|slide| slide > 0.0)
            || skin
                .layout
                .as_ref()
                .is_some_and(|layout| layout.is_curved())
            || ["touches.slide_mm", "skin.layout"]
                .iter()
                .any(|key| axes.has(key));
        // A study of recorded frames may describe the skin completely.
        if spec.recorded.is_some() {
            return Ok(());
        }
        let of_shear = [
            ("skin.friction", skin.friction),
            ("skin.shear_stiffness_n_per_m", skin.shear_stiffness_n_per_m),
        ];
        for (key, value) in of_shear {
            if let (Some(value), false) = (value, rubs) {
                let given = format!("{value}, but tips stay where they first touch");
                let allowed = "a touches.slide_mm above 0 or a curved skin.layout beside it";
                return Err(self.error(key, given, allowed));
            }
        }
        let reads_shear = skin.sensed == Some(SensedSpec::Shear);
        if reads_shear && rubs && skin.friction.is_none() {
            return Err(self.error("skin.sensed", "shear", "skin.friction beside it"));
        }
        Ok(())
    }
}
