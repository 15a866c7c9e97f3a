//! Physical quantity of a frame: deflection or force.

use crate::world::Taxel;

/// Physical quantity that the numbers of a frame represent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Deflection of each taxel, metres.
    Deflection,
    /// Force of each taxel, newtons.
    Force,
}

impl Quantity {
    /// Returns the factor that converts stored values to displayed values: 1000 for deflections (metres to millimetres), 1 for forces.
    pub fn factor(self) -> f64 {
        match self {
            Self::Deflection => 1e3,
            Self::Force => 1.0,
        }
    }

    /// Returns the value of a taxel pressed to the end of its stroke: its deflection in metres or its force in newtons.
    pub fn full_scale(self, taxel: &Taxel) -> f64 {
        match self {
            Self::Deflection => taxel.stroke,
            Self::Force => taxel.stroke * taxel.stiffness,
        }
    }

    /// Returns the unit of displayed values: mm for deflections, N for forces.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Deflection => "mm",
            Self::Force => "N",
        }
    }

    /// Returns the name of the quantity in charts: `deflection` or `force`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deflection => "deflection",
            Self::Force => "force",
        }
    }
}
