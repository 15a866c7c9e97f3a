//! What a taxel's tip does sideways: a shear spring, and how well it grips.

use super::{Patch, PerTaxel};
use crate::error::Result;
use crate::text::in_range::{not_negative, positive};

/// A taxel's shear spring and its friction; an option beside a [`Patch`], whose taxels slide along their axes without it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shear {
    /// k_t, N/m, positive: how stiff the tip is across its axis.
    pub stiffness: f64,
    /// μ, zero or positive: what the tip can carry across its axis, as a share of what presses it in.
    pub friction: f64,
}

impl Shear {
    /// How far the tip of a taxel that `force` newtons press in can be displaced before it slips, metres: μ f / k_t.
    pub fn reach(&self, force: f64) -> f64 {
        self.friction * force / self.stiffness
    }

    /// Whether it can be.
    ///
    /// # Errors
    /// The first property that is out of its range, by its name.
    pub fn check(&self) -> Result<()> {
        positive("shear stiffness", self.stiffness, "N/m")?;
        not_negative("friction coefficient", self.friction, "").map(drop)
    }
}

/// The shear springs of a patch.
pub type Shears = PerTaxel<Shear>;

impl Shears {
    /// Whether they fit a patch.
    ///
    /// # Errors
    /// The error names a property out of its range and its taxel (from 1), or the numbers of shear springs and taxels if they differ.
    pub fn check_on(&self, patch: &Patch) -> Result<()> {
        self.check(patch.name(), patch.n_taxels(), Shear::check)
    }
}
