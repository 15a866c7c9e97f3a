//! Checks of `skin.sensed` and `touches.slide_mm`, and creation of the arrays with these settings.

use crate::error::Result;
use crate::inputs::check::Check;
use crate::inputs::units::MM;
use crate::studies::recognition::plan::sensed::Sensed;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use crate::studies::recognition::spec::scene::{SensedSpec, SkinSpec, TouchesSpec};
use crate::studies::recognition::spec::signal::StepSpec;
use crate::studies::recognition::spec::study::StudySpec;
use crate::world::Shear;
use glam::DVec2;

impl Check<'_> {
    /// Checks the keys of skins that read shear forces and of touches that slide.
    pub(crate) fn shear(&self, spec: &StudySpec) -> Result<()> {
        self.of_sensed(spec)?;
        let touches = &spec.touches;
        let slides = touches.slide_mm.is_some_and(|slide| slide > 0.0);
        if let Some(degrees) = touches.slide_deg
            && degrees != 0.0
            && !slides
            && !spec.axes.has("touches.slide_mm")
        {
            let given = format!("{degrees}, but touches do not slide");
            let allowed = "touches.slide_mm above 0 beside it, or no such key";
            return Err(self.error("touches.slide_deg", given, allowed));
        }
        let reads_shear = spec.skin.sensed == Some(SensedSpec::Shear);
        if touches.speed_mm_per_s > 0.0 && (slides || reads_shear) {
            let allowed = "0 where skin.sensed is shear, and where touches slide";
            return Err(self.error("touches.speed_mm_per_s", touches.speed_mm_per_s, allowed));
        }
        Ok(())
    }

    fn of_sensed(&self, spec: &StudySpec) -> Result<()> {
        let skin = &spec.skin;
        let sensed = skin.sensed.unwrap_or_default();
        if spec.human_touch.is_some() && sensed != SensedSpec::Deflection {
            let allowed = "no such key in a study of human touches";
            return Err(self.error("skin.sensed", "given", allowed));
        }
        let of_shear = [
            ("skin.friction", skin.friction),
            ("skin.shear_stiffness_n_per_m", skin.shear_stiffness_n_per_m),
        ];
        let may_read_shear = sensed == SensedSpec::Shear || spec.axes.has("skin.sensed");
        for (key, value) in of_shear {
            if let (Some(value), false) = (value, may_read_shear) {
                let given = format!("{value}, but the skin reads no shear");
                let allowed = "skin.sensed = \"shear\" beside it, or no such key";
                return Err(self.error(key, given, allowed));
            }
        }
        if sensed != SensedSpec::Deflection && spec.signal.steps.contains(&StepSpec::Force) {
            let allowed = "no such step where skin.sensed is a force from the first step on";
            return Err(self.error("signal.steps", "force", allowed));
        }
        Ok(())
    }

    /// Returns the arrays of a study, each with its measured quantity and its slide along the object.
    pub(crate) fn touching_arrays(
        &self,
        skin: &SkinSpec,
        touches: &TouchesSpec,
    ) -> Result<Vec<TaxelArray>> {
        let sensed = skin.sensed();
        let length = touches.slide_mm.unwrap_or(0.0) * MM;
        let direction = touches.slide_deg.unwrap_or(0.0).to_radians();
        let slide = length * DVec2::from_angle(direction);
        let arrays = self.arrays(skin)?.into_iter();
        arrays.map(|array| array.reading(sensed, slide)).collect()
    }
}

impl SkinSpec {
    /// Returns the quantity that the taxels of this skin read.
    pub(crate) fn sensed(&self) -> Sensed {
        match self.sensed.unwrap_or_default() {
            SensedSpec::Deflection => Sensed::Deflection,
            SensedSpec::Force => Sensed::Force,
            SensedSpec::Shear => Sensed::Shear(Shear {
                stiffness: self
                    .shear_stiffness_n_per_m
                    .unwrap_or(self.stiffness_n_per_m),
                friction: self.friction.unwrap_or(0.0),
            }),
        }
    }
}
