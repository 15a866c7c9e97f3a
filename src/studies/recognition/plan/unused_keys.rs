//! Checks for keys of `[skin]` and `[signal]` that have no effect in a study.

use crate::engine::axes::CombineSpec;
use crate::error::Result;
use crate::inputs::check::Check;
use crate::studies::recognition::spec::scene::SensedSpec;
use crate::studies::recognition::spec::signal::StepSpec;
use crate::studies::recognition::spec::study::StudySpec;

impl Check<'_> {
    /// Checks that the keys of dampers, friction and `signal.combine` have an effect. A key counts as used if one value of an axis or the separate test touches
    /// use it.
    pub fn unused_keys(&self, spec: &StudySpec) -> Result<()> {
        if !spec.test.is_empty() {
            return Ok(());
        }
        self.used_damper(spec)?;
        self.used_friction(spec)?;
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

    /// Checks that the taxels' damper has an effect. A damper acts on moving taxels, and so affects only forces that are read during the press.
    fn used_damper(&self, spec: &StudySpec) -> Result<()> {
        let (skin, touches, axes) = (&spec.skin, &spec.touches, &spec.axes);
        let sensed = skin.sensed.unwrap_or_default();
        let reads_force = sensed != SensedSpec::Deflection
            || spec.signal.steps.contains(&StepSpec::Force)
            || ["skin.sensed", "signal.steps"]
                .iter()
                .any(|key| axes.has(key));
        let of_force = "skin.sensed = \"force\" or \"force\" among signal.steps beside it";
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
                false => of_force,
            };
            return Err(self.error("skin.damping_n_s_per_m", given, allowed));
        }
        Ok(())
    }

    /// Checks that the taxels' friction has an effect. Friction acts only on taxels that move along the object. On a flat array that is pressed straight on, no
    /// taxel does.
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
