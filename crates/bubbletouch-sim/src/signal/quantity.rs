//! Physical quantity of a frame.

use crate::world::Taxel;

/// Physical quantity of the numbers of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Deflection, metres.
    Deflection,
    /// Force, newtons.
    Force,
}

impl Quantity {
    /// Shown value = stored value × this: deflections are shown in millimetres.
    pub fn factor(self) -> f64 {
        match self {
            Self::Deflection => 1e3,
            Self::Force => 1.0,
        }
    }

    /// The value of a taxel at its stroke: metres or newtons.
    pub fn full_scale(self, taxel: &Taxel) -> f64 {
        match self {
            Self::Deflection => taxel.stroke,
            Self::Force => taxel.stroke * taxel.stiffness,
        }
    }

    /// The unit of the shown value.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Deflection => "mm",
            Self::Force => "N",
        }
    }

    /// The name of the shown value.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deflection => "deflection",
            Self::Force => "force",
        }
    }
}
