//! Patch on a sphere: rings of taxels around the z axis.

use super::lanes::ball_around;
use crate::objects::Sphere;
use crate::world::Dome;

/// Equal taxels on a dome, with quantities precomputed for presses.
#[derive(Clone, Debug)]
pub(super) struct DomePatch {
    dome: Dome,
    /// Radius of the sphere that contains the substrate, metres.
    pub substrate: f64,
    /// Ball around all taxels, from their rest centres back to the substrate, in the patch frame.
    pub ball: Sphere,
}

impl DomePatch {
    /// Creates the patch. The substrate is at the height `behind`, metres, which must be above minus the dome's radius.
    pub fn new(dome: Dome, behind: f64) -> Self {
        let (outer, substrate) = (dome.radius(), dome.radius() + behind);
        let ends = dome
            .axes()
            .flat_map(|axis| [outer * axis, substrate * axis]);
        Self {
            ball: ball_around(ends),
            dome,
            substrate,
        }
    }

    /// Returns the dome with the rest centres and axes of the taxels.
    #[inline]
    pub fn dome(&self) -> &Dome {
        &self.dome
    }

    /// Returns the heap memory of the patch in bytes.
    pub fn n_bytes(&self) -> usize {
        size_of_val(self.dome.rings()) + size_of_val(self.dome.directions())
    }

    /// Returns the value of t = c·n (sphere centre along the taxel's axis), metres, above which a taxel is pushed.
    #[inline]
    pub fn least_along(&self, power: f64) -> f64 {
        let radius = self.dome.radius();
        match power {
            power if power < 0.0 => f64::NEG_INFINITY,
            power if power <= radius * radius => power.sqrt(),
            power => (radius * radius + power) / (2.0 * radius),
        }
    }
}
