//! What a taxel's tip does sideways: a shear spring, and how well it grips.

use super::taxel::check_positive;
use super::{Patch, PerTaxel};
use crate::error::{Error, Result};

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
        check_positive("shear stiffness", self.stiffness, "N/m")?;
        if self.friction.is_finite() && self.friction >= 0.0 {
            return Ok(());
        }
        Err(Error::input(
            "friction coefficient",
            self.friction,
            "zero or a positive number",
        ))
    }
}

/// The shear springs of a patch.
pub type Shears = PerTaxel<Shear>;

impl Shears {
    /// Whether they fit a patch.
    ///
    /// # Errors
    /// The error names a property out of its range and its taxel (from 1), or the numbers of shear springs and taxels if they differ.
    pub fn check(&self, patch: &Patch) -> Result<()> {
        match self {
            Self::Equal(equal) => equal.check(),
            Self::Each(each) if each.len() != patch.n_taxels() => Err(Error::input(
                format!("skin patch {}", patch.name()),
                format!(
                    "{} shear springs for {} taxels",
                    each.len(),
                    patch.n_taxels()
                ),
                "one a taxel, or one for all",
            )),
            Self::Each(each) => {
                for (index, shear) in each.iter().enumerate() {
                    let place = || format!("taxel {}, ", index + 1);
                    shear.check().map_err(|error| error.under(place()))?;
                }
                Ok(())
            }
        }
    }
}
