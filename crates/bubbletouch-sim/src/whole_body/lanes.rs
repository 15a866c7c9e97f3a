//! Blocks of eight values: searches test eight balls at a time, and presses evaluate eight taxels at a time.

use crate::contact::lanes::SelectedLanes;
use crate::contact::object_at::{PlacedSphere, Region};
use crate::objects::Sphere;
use crate::world::RADIUS_ROUNDING;
use glam::DVec3;

/// Number of taxels or balls in a block: eight f64 values in a vector of 512 bits.
pub(super) const LANES: usize = 8;
/// Coordinate of padding entries in a block, metres: so far away that no sphere touches them.
pub(super) const FAR: f64 = 1e100;

/// Eight balls, stored coordinate by coordinate, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balls {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
    radius: [f64; LANES],
}

impl Balls {
    /// Creates blocks of eight balls, in order; the last block is padded with balls far away.
    pub fn blocks(balls: &[Sphere]) -> Vec<Self> {
        let nowhere = Sphere {
            center: DVec3::splat(FAR),
            radius: 0.0,
        };
        let block = |balls: &[Sphere]| {
            let of = |value| filled(balls, &nowhere, value);
            Self {
                x: of(|ball: &Sphere| ball.center.x),
                y: of(|ball| ball.center.y),
                z: of(|ball| ball.center.z),
                radius: of(|ball| ball.radius),
            }
        };
        balls.chunks(LANES).map(block).collect()
    }

    /// Returns the indices of the balls that a sphere touches.
    #[inline(always)]
    pub fn near(&self, sphere: &PlacedSphere) -> SelectedLanes {
        let mut gaps = [0.0; LANES];
        for (k, bound) in gaps.iter_mut().enumerate() {
            let own = DVec3::new(self.x[k], self.y[k], self.z[k]);
            *bound = gap(sphere.center - own, self.radius[k] + sphere.reach);
        }
        SelectedLanes::below(&gaps, 0.0)
    }
}

/// The bound of a sphere is the squared distance of its centre from the ball around all taxels, minus the squared sum of the radii, m²; negative if the sphere
/// may touch the patch.
impl Region for Sphere {
    #[inline(always)]
    fn sphere_bound(&self, sphere: &PlacedSphere) -> f64 {
        gap(self.center - sphere.center, self.radius + sphere.reach)
    }
}

/// Returns a value that is negative for two balls that touch. `away` is the distance of their centres, and `reach` the sum of their radii, metres.
#[inline(always)]
fn gap(away: DVec3, reach: f64) -> f64 {
    let reach = reach * RADIUS_ROUNDING;
    away.length_squared() - reach * reach
}

/// Returns the value of each item (at most a block of items), padded with the value of `behind`.
pub(super) fn filled<T>(items: &[T], behind: &T, value: fn(&T) -> f64) -> [f64; LANES] {
    let mut values = [value(behind); LANES];
    for (lane, item) in values.iter_mut().zip(items) {
        *lane = value(item);
    }
    values
}

/// Returns a ball that contains the given points (at least one), centred at their mean.
pub(super) fn ball_around(points: impl Iterator<Item = DVec3> + Clone) -> Sphere {
    let center = points.clone().sum::<DVec3>() / points.clone().count() as f64;
    let distances = points.map(|point| point.distance(center));
    Sphere {
        center,
        radius: distances.fold(0.0, f64::max),
    }
}
