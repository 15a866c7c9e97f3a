//! Lateral properties of a taxel: shear spring and friction.

use super::{Patch, PerTaxel};
use crate::error::Result;
use crate::text::in_range::{not_negative, positive};

/// Shear spring and friction of a taxel, optional for a [`Patch`]; without shear springs, taxels move only along their axes.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Shear {
    /// Stiffness of the shear spring perpendicular to the taxel's axis, N/m, positive.
    pub stiffness: f64,
    /// Coefficient of friction between taxel and object, zero or positive.
    pub friction: f64,
}

impl Shear {
    /// Returns the largest shear displacement without slip, metres, for a normal force in newtons: friction coefficient times force, divided by the shear
    /// stiffness.
    pub fn reach(&self, force: f64) -> f64 {
        self.friction * force / self.stiffness
    }

    /// Returns an error if the shear stiffness or the coefficient of friction is out of range.
    ///
    /// # Errors
    /// If a property is out of its range; the error names the first one.
    pub fn check(&self) -> Result<()> {
        positive("shear stiffness", self.stiffness, "N/m")?;
        not_negative("friction coefficient", self.friction, "").map(drop)
    }
}

/// Shear springs of a patch: equal for all taxels, or one per taxel.
pub type Shears = PerTaxel<Shear>;

impl Shears {
    /// Returns an error unless there is one shear spring, or one per taxel of the patch, and each is valid.
    ///
    /// # Errors
    /// If a property is out of its range (the error names its taxel, from 1), or the numbers of shear springs and taxels differ.
    pub fn check_on(&self, patch: &Patch) -> Result<()> {
        self.check(patch.name(), patch.n_taxels(), Shear::check)
    }
}
