//! Lateral properties of a taxel: shear spring and friction.

use super::{Patch, PerTaxel};
use crate::error::Result;
use crate::text::in_range::{not_negative, positive};

/// Shear spring and friction of a taxel, optional for a [`Patch`]; without them taxels move along their axes only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shear {
    /// Shear stiffness k_t perpendicular to the taxel's axis, N/m, positive.
    pub stiffness: f64,
    /// Coefficient of friction μ between taxel and object, zero or positive.
    pub friction: f64,
}

impl Shear {
    /// Returns the largest shear displacement without slip, metres: μ f / k_t for a normal force f of `force` newtons.
    pub fn reach(&self, force: f64) -> f64 {
        self.friction * force / self.stiffness
    }

    /// Checks the shear stiffness and the coefficient of friction.
    ///
    /// # Errors
    /// If a property is out of its range; the error names the first one.
    pub fn check(&self) -> Result<()> {
        positive("shear stiffness", self.stiffness, "N/m")?;
        not_negative("friction coefficient", self.friction, "").map(drop)
    }
}

/// Shear springs of a patch: equal or one per taxel.
pub type Shears = PerTaxel<Shear>;

impl Shears {
    /// Checks that the shear springs fit a patch.
    ///
    /// # Errors
    /// If a property is out of its range (the error names its taxel, from 1), or the numbers of shear springs and taxels differ.
    pub fn check_on(&self, patch: &Patch) -> Result<()> {
        self.check(patch.name(), patch.n_taxels(), Shear::check)
    }
}
