//! Quantities that the taxels of an array measure: `skin.sensed` and `touches.slide_mm`, and the arrays with these settings.

use crate::studies::prelude::*;
use crate::world::Shear;
use glam::DVec2;

/// Quantity that a taxel reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub enum Sensed {
    /// Deflection, metres; a step of the signal chain may convert it to a force.
    #[default]
    Deflection,
    /// Force along the taxel's axis, newtons.
    Force,
    /// Forces along and across the taxel's axis, newtons: three channels. The second and third channels are along x and y of the taxel's frame. Springs with
    /// the given parameters produce the forces across the axis.
    Shear(Shear),
}

impl Sensed {
    /// Returns the number of values that each taxel reads.
    pub fn n_channels(&self) -> usize {
        match self {
            Self::Deflection | Self::Force => 1,
            Self::Shear(_) => 3,
        }
    }

    /// Returns the name of the quantity for texts, such as `force`.
    pub fn words(&self) -> &'static str {
        match self {
            Self::Deflection => "deflection",
            Self::Force => "force",
            Self::Shear(_) => "force and shear",
        }
    }
}

/// Returns the random seed for one of the channels (quantities) that a taxel reads. The first channel has the seed `named` itself.
pub(crate) fn of_channel(named: &Seed, channel: usize) -> Seed {
    match channel {
        0 => *named,
        _ => named.named("channel").numbered(channel as u64),
    }
}

impl Check<'_> {
    /// Returns the array of a study, with its measured quantity and its slide along the object.
    pub(crate) fn touching_array(
        &self,
        skin: &SkinSpec,
        touches: &TouchesSpec,
    ) -> Result<TaxelArray> {
        let length = touches.slide_mm.unwrap_or(0.0) * MM;
        let direction = touches.slide_deg.unwrap_or(0.0).to_radians();
        let slide = length * DVec2::from_angle(direction);
        Ok(self.array(skin)?.sliding(slide))
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
