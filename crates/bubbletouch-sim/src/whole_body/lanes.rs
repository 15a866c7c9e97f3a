//! Blocks of eight values: searches test eight balls at a time, and presses evaluate eight taxels at a time.

use crate::contact::lanes::SelectedLanes;
use crate::objects::{ClusterBounds, MAX_IN_CLUSTER, Sphere, SphereClusters};
use glam::{DMat3, DVec3};

/// Number of taxels or balls in a block: eight f64 values in a vector of 512 bits.
pub(super) const LANES: usize = 8;
/// Factor that covers rounding of a radius: far above 1e-16 and far below any measurable difference.
pub(super) const ROUNDING: f64 = 1.0 + 1e-9;
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

    /// Returns the indices of the balls whose distance from `center` is less than their radius plus `reach`, metres.
    #[inline(always)]
    pub fn near(&self, center: DVec3, reach: f64) -> SelectedLanes {
        let mut gaps = [0.0; LANES];
        for (k, gap) in gaps.iter_mut().enumerate() {
            let (dx, dy, dz) = (
                center.x - self.x[k],
                center.y - self.y[k],
                center.z - self.z[k],
            );
            let reach = (self.radius[k] + reach) * ROUNDING;
            *gap = dx * dx + dy * dy + dz * dz - reach * reach;
        }
        SelectedLanes::below(&gaps, 0.0)
    }
}

/// Transform from an object's frame to a patch frame, with the region of the patch where taxels can be pushed.
pub(super) struct View {
    /// Rows of the rotation matrix from the object's frame to the patch frame.
    rows: DMat3,
    translation: DVec3,
    /// Radius of the taxels, metres.
    taxel_radius: f64,
    /// Ball around all taxels (their centres at rest and the substrate below them), in the patch frame.
    ball: Sphere,
}

impl View {
    /// Creates the transform for an object at `rotation` and `translation`, and a patch with taxels of one radius inside `ball`.
    pub fn new(rotation: DMat3, translation: DVec3, taxel_radius: f64, ball: Sphere) -> Self {
        Self {
            rows: rotation.transpose(),
            translation,
            taxel_radius,
            ball,
        }
    }

    #[inline(always)]
    fn at(&self, place: DVec3) -> DVec3 {
        DVec3::new(
            self.rows.x_axis.dot(place) + self.translation.x,
            self.rows.y_axis.dot(place) + self.translation.y,
            self.rows.z_axis.dot(place) + self.translation.z,
        )
    }

    #[inline(always)]
    fn gap(&self, center: DVec3, reach: f64) -> f64 {
        let reach = (self.ball.radius + reach) * ROUNDING;
        let (dx, dy, dz) = (
            center.x - self.ball.center.x,
            center.y - self.ball.center.y,
            center.z - self.ball.center.z,
        );
        dx * dx + dy * dy + dz * dz - reach * reach
    }

    /// Writes for each cluster of spheres a bound of its distance from the patch, as a difference of squares, m². The bound is negative if a sphere of the
    /// cluster may touch the patch.
    #[inline(always)]
    pub fn lay_gaps(&self, bounds: &ClusterBounds, gaps: &mut [f64]) {
        let n = gaps.len();
        let [x, y, z] = &bounds.middle;
        let (x, y, z, radius) = (&x[..n], &y[..n], &z[..n], &bounds.radius[..n]);
        for k in 0..n {
            let center = self.at(DVec3::new(x[k], y[k], z[k]));
            gaps[k] = self.gap(center, radius[k] + self.taxel_radius);
        }
    }

    /// Returns the bounding ball of a cluster of spheres: its centre in the patch frame, and its radius plus the taxels' radius, metres.
    #[inline(always)]
    pub fn ball(&self, bounds: &ClusterBounds, cluster: usize) -> (DVec3, f64) {
        let [x, y, z] = &bounds.middle;
        let middle = DVec3::new(x[cluster], y[cluster], z[cluster]);
        (self.at(middle), bounds.radius[cluster] + self.taxel_radius)
    }

    /// Returns the spheres of a cluster in the patch frame.
    #[inline(always)]
    pub fn spheres(&self, object: &SphereClusters, cluster: usize) -> Placed {
        let cluster = object.cluster(cluster);
        let [x, y, z] = cluster.centers;
        let zeros = [0.0; MAX_IN_CLUSTER];
        let mut placed = Placed {
            x: zeros,
            y: zeros,
            z: zeros,
            reaches: zeros,
            gaps: zeros,
        };
        for k in 0..MAX_IN_CLUSTER {
            let center = self.at(DVec3::new(x[k], y[k], z[k]));
            let reach = cluster.radii[k] + self.taxel_radius;
            let gap = self.gap(center, reach);
            placed.gaps[k] = if k < cluster.n_spheres { gap } else { 1.0 };
            placed.x[k] = center.x;
            placed.y[k] = center.y;
            placed.z[k] = center.z;
            placed.reaches[k] = reach;
        }
        placed
    }
}

/// Spheres of a cluster in the patch frame, stored coordinate by coordinate, metres.
pub(super) struct Placed {
    x: [f64; MAX_IN_CLUSTER],
    y: [f64; MAX_IN_CLUSTER],
    z: [f64; MAX_IN_CLUSTER],
    /// Sum of the radii of taxel and sphere, for each sphere, metres.
    reaches: [f64; MAX_IN_CLUSTER],
    /// Bounds of the spheres' distances from the patch, m²; negative for spheres that may touch the patch.
    gaps: [f64; MAX_IN_CLUSTER],
}

impl Placed {
    /// Returns the indices of the spheres that may touch the patch.
    #[inline(always)]
    pub fn near(&self) -> SelectedLanes {
        SelectedLanes::below(&self.gaps, 0.0)
    }

    /// Returns the centre of one sphere, and the sum of the radii of taxel and sphere, metres.
    #[inline(always)]
    pub fn at(&self, k: usize) -> (DVec3, f64) {
        (DVec3::new(self.x[k], self.y[k], self.z[k]), self.reaches[k])
    }
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
