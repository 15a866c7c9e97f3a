//! A patch on a sphere: rings of taxels around the z axis.

use super::lanes::ball_around;
use crate::objects::Sphere;
use crate::world::Dome;

/// Equal taxels on a dome.
#[derive(Clone, Debug)]
pub(super) struct DomePatch {
    dome: Dome,
    /// Of the sphere that the substrate is on, metres.
    pub substrate: f64,
    /// Around all taxels from their rest centres back to the substrate, in the patch frame.
    pub ball: Sphere,
}

impl DomePatch {
    /// Taxels with their substrate at the height `behind`, metres, above minus the dome's radius.
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

    /// Where the taxels rest.
    #[inline]
    pub fn dome(&self) -> &Dome {
        &self.dome
    }

    /// Bytes that it holds on the heap.
    pub fn n_bytes(&self) -> usize {
        size_of_val(self.dome.rings()) + size_of_val(self.dome.directions())
    }

    /// Above which t a taxel is pushed, metres.
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
