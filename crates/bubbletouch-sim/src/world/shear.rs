//! Lateral properties of a taxel's tip: shear spring and friction.

use super::{Patch, PerTaxel};
use crate::error::Result;
use crate::text::in_range::{not_negative, positive};

/// Shear spring and friction of a taxel, optional for a [`Patch`]; without them taxels move along their axes only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shear {
    /// Shear stiffness k_t, N/m, positive: stiffness of the tip perpendicular to the taxel's axis.
    pub stiffness: f64,
    /// Coefficient of friction μ between tip and object, zero or positive.
    pub friction: f64,
}

impl Shear {
    /// Returns the largest displacement of the tip before it slips, metres: μ f / k_t for a normal force of `force` newtons.
    pub fn reach(&self, force: f64) -> f64 {
        self.friction * force / self.stiffness
    }

    /// Checks the properties.
    ///
    /// # Errors
    /// If a property is out of its range; the error names the first one.
    pub fn check(&self) -> Result<()> {
        positive("shear stiffness", self.stiffness, "N/m")?;
        not_negative("friction coefficient", self.friction, "").map(drop)
    }
}

/// Shear springs of a patch.
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
