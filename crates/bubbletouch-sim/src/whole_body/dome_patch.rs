//! Patch on a sphere: rings of taxels around the z axis.

use super::lanes::ball_around;
use crate::objects::Sphere;
use crate::world::Dome;

/// Equal taxels on a dome, with quantities precomputed for presses.
#[derive(Clone, Debug)]
pub(super) struct DomePatch {
    /// Centres (at rest) and axes of the taxels.
    pub dome: Dome,
    /// Radius of the sphere that contains the substrate, metres.
    pub substrate: f64,
    /// Ball around all taxels (their centres at rest and the substrate below them), in the patch frame.
    pub ball: Sphere,
}

impl DomePatch {
    /// Creates the patch of a dome. The substrate is at the height `behind`, metres, which must be above minus the dome's radius.
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

    /// Returns the heap memory that the patch uses in bytes.
    pub fn n_bytes(&self) -> usize {
        size_of_val(self.dome.rings()) + size_of_val(self.dome.directions())
    }

    /// Returns the smallest coordinate of a sphere's centre along a taxel's axis, metres, for which the sphere pushes the taxel. `power` is the squared
    /// distance of the sphere's centre from the dome's centre minus the squared sum of radii.
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
