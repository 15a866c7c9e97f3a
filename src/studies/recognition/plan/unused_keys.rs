//! Checks for keys that have no effect in a study.

use crate::engine::axes::{CombineSpec, StudyAxes};
use crate::engine::axis::Axis;
use crate::error::Result;
use crate::inputs::check::Check;
use crate::inputs::toml_value::{is_at, value_at};
use crate::studies::recognition::plan::learning::DEFAULT_TILT_DEG;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::spec::scene::{STIFFNESS, SensedSpec, SkinSpec, TouchesSpec};
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
const STICKS: &str = "tips stay where they first touch";
const RUBS: &str = "a touches.slide_mm above 0 or a curved skin.layout beside it";
const ENSEMBLE: &str = "no such key, or another sensing.ensemble beside it";

/// Keys that may have no effect.
const USES: [KeyUse; 12] = [
    KeyUse {
        key: "skin.damping_n_s_per_m",
        given: damping,
        has_effect: |plan| reads_force(&plan.spec),
        beside: &["skin.sensed", "signal.steps"],
        reason: "no force is read",
        allowed: OF_FORCE,
    },
    KeyUse {
        key: "skin.damping_n_s_per_m",
        given: damping,
        has_effect: |plan| plan.speed > 0.0,
        beside: &["touches.speed_mm_per_s", "recorded.speed_mm_per_s"],
        reason: "every touch is read at rest",
        allowed: "a touches.speed_mm_per_s above 0 beside it",
    },
    KeyUse {
        key: "skin.friction",
        given: |plan| of_simulation(plan, plan.spec.skin.friction),
        has_effect: |plan| rubs(&plan.spec),
        beside: &["touches.slide_mm", "skin.layout"],
        reason: STICKS,
        allowed: RUBS,
    },
    KeyUse {
        key: "skin.shear_stiffness_n_per_m",
        given: |plan| of_simulation(plan, plan.spec.skin.shear_stiffness_n_per_m),
        has_effect: |plan| rubs(&plan.spec),
        beside: &["touches.slide_mm", "skin.layout"],
        reason: STICKS,
        allowed: RUBS,
    },
    KeyUse {
        key: "skin.stiffness_n_per_m",
        given: |plan| {
            let given = plan.spec.skin.stiffness_n_per_m;
            of_simulation(plan, Some(given)).filter(|&given| given != STIFFNESS)
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
        given: |plan| {
            let given = plan.spec.recognition.tilt_augmentation_deg;
            given.filter(|&degrees| degrees != DEFAULT_TILT_DEG)
        },
        has_effect: |plan| plan.spec.recognition.has_copies(),
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

/// Returns the damping coefficient of the taxels if it is positive.
fn damping(plan: &Plan) -> Option<f64> {
    Some(plan.spec.skin.damping_n_s_per_m).filter(|&damping| damping > 0.0)
}

/// Returns the value of a key in a study that simulates its frames. A study of recorded frames may describe the skin completely.
fn of_simulation(plan: &Plan, value: Option<f64>) -> Option<f64> {
    value.filter(|_| plan.spec.recorded.is_none())
}

/// Returns whether taxels move along the object. On a flat array that is pressed straight on, no taxel does.
fn rubs(spec: &StudySpec) -> bool {
    let layout = spec.skin.layout.as_ref();
    spec.touches.slide_mm.is_some_and(|slide| slide > 0.0)
        || layout.is_some_and(|layout| layout.is_curved())
        || spec.axes.has("touches.slide_mm")
        || spec.axes.has("skin.layout")
}

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
    /// one in either. A key of `[test]` must have an effect in test touches.
    pub(crate) fn unused_keys(&self, plan: &Plan) -> Result<()> {
        self.sticking_shear(&plan.spec)?;
        for key_use in &USES {
            let KeyUse { key, given, .. } = key_use;
            let own_value = given(plan).filter(|_| !key_use.acts(plan, &plan.spec.axes, ""));
            let Some(tested) = plan.tested.as_deref() else {
                self.refuse_unused(key_use, "", own_value)?;
                continue;
            };
            let of_test = given(tested).filter(|_| !key_use.acts(tested, &plan.spec.axes, "test."));
            match value_at(&plan.spec.test, key) {
                Some(_) => {
                    self.refuse_unused(key_use, "", own_value)?;
                    self.refuse_unused(key_use, "test.", of_test)?;
                }
                None => self.refuse_unused(key_use, "", own_value.and(of_test))?,
            }
        }
        let signal = &plan.spec.signal;
        let several = signal.axes.given();
        let several = several.filter(|(.., axis)| axis.values().len() > 1);
        if signal.combine == CombineSpec::OneAtATime && several.count() < 2 {
            let given = "one_at_a_time, but fewer than two keys of [signal] have several values";
            let allowed = "no such key, or two axes in [signal]";
            return Err(self.error("signal.combine", given, allowed));
        }
        Ok(())
    }

    /// Returns an error if `unused` is the value of a key without effect; `table` is `test.` for a key of `[test]`.
    fn refuse_unused(&self, key_use: &KeyUse, table: &str, unused: Option<f64>) -> Result<()> {
        let KeyUse {
            key,
            reason,
            allowed,
            ..
        } = key_use;
        match unused {
            None => Ok(()),
            Some(given) => {
                let given = format!("{given}, but {reason}");
                Err(self.error(&format!("{table}{key}"), given, allowed))
            }
        }
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
    fn sticking_shear(&self, spec: &StudySpec) -> Result<()> {
        let reads_shear = spec.skin.sensed == Some(SensedSpec::Shear);
        if spec.recorded.is_none() && reads_shear && rubs(spec) && spec.skin.friction.is_none() {
            return Err(self.error("skin.sensed", "shear", "skin.friction beside it"));
        }
        Ok(())
    }
}

impl KeyUse {
    /// Returns whether the key has an effect in a plan, or may have one because another key is an axis. Other keys of test touches may be axes of `table`.
    fn acts(&self, plan: &Plan, axes: &StudyAxes, table: &str) -> bool {
        (self.has_effect)(plan)
            || has_axis(axes, "", self.beside)
            || has_axis(axes, table, self.beside)
    }
}
