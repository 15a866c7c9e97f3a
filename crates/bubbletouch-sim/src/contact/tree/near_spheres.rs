//! Search for the spheres of an object near a skin, by clusters, so that most spheres of a large object are skipped.

use crate::contact::law;
use crate::geometry::Pose;
use crate::objects::{Sphere, SphereUnion};
use crate::world::{LEAF, Leaf};
use glam::{DMat3, DVec3};

/// Spheres of an object, with their pose in the patch frame.
pub(crate) struct PlacedUnion<'a> {
    union: &'a SphereUnion,
    rotation: DMat3,
    translation: DVec3,
}

impl<'a> PlacedUnion<'a> {
    pub fn new(union: &'a SphereUnion, pose: &Pose) -> Self {
        Self {
            union,
            rotation: DMat3::from_quat(pose.rotation),
            translation: pose.translation,
        }
    }

    /// Returns the sphere with the given index in the object, in the patch frame.
    #[inline(always)]
    pub fn at(&self, number: u32) -> Sphere {
        self.place(self.union.spheres()[number as usize])
    }

    #[inline(always)]
    fn place(&self, sphere: Sphere) -> Sphere {
        Sphere {
            center: self.rotation * sphere.center + self.translation,
            ..sphere
        }
    }

    /// Returns the indices of all clusters of spheres, with their bounding balls in the patch frame.
    pub fn clusters(&self) -> impl Iterator<Item = (usize, Sphere)> {
        let bounds = self.union.clusters().bounds();
        (0..bounds.len()).map(|cluster| (cluster, self.place(bounds.ball(cluster))))
    }

    /// Returns the indices of the spheres of a cluster.
    pub fn cluster(&self, cluster: usize) -> &'a [u32] {
        self.union.clusters().numbers(cluster)
    }

    /// Collects the indices of the spheres in those clusters for whose bounding ball `may_count` returns true; ascending.
    pub fn gather(&self, mut may_count: impl FnMut(&Sphere) -> bool, numbers: &mut Vec<u32>) {
        numbers.clear();
        for (cluster, ball) in self.clusters() {
            if may_count(&ball) {
                numbers.extend_from_slice(self.cluster(cluster));
            }
        }
        numbers.sort_unstable();
    }
}

/// Returns the deflection that contact with a sphere requires, metres; at most 0 if the sphere misses the taxel or lies behind its substrate. `from` is the
/// vector from the sphere's centre to the taxel's centre. `frame` contains two unit vectors perpendicular to the axis, and the axis. `reach` is the sum of
/// both radii, metres, and `behind` the substrate's height along the axis.
///
/// The operations have the order of the grid kernel, so that the two kernels return equal bits on a grid.
#[inline(always)]
pub(crate) fn needed_along(from: DVec3, frame: [DVec3; 3], reach: f64, behind: f64) -> f64 {
    let [across_x, across_y, axis] = frame;
    let (dx, dy, height) = (from.dot(across_x), from.dot(across_y), -from.dot(axis));
    let q = reach * reach - dy * dy - dx * dx;
    law::needed(q, height, behind)
}

/// Returns the deflections that contact with a sphere (in the patch frame) requires of the taxels in a leaf of the taxel tree, metres.
#[inline(always)]
pub(crate) fn needed_of_leaf(leaf: &Leaf, sphere: &Sphere) -> [f64; LEAF] {
    let mut needed = [0.0; LEAF];
    for (k, needed) in needed.iter_mut().enumerate() {
        let from = leaf.vector(&leaf.centers, k) - sphere.center;
        let frame = [
            leaf.vector(&leaf.across[0], k),
            leaf.vector(&leaf.across[1], k),
            leaf.vector(&leaf.axes, k),
        ];
        let reach = leaf.radii[k] + sphere.radius;
        *needed = needed_along(from, frame, reach, leaf.behind[k]);
    }
    needed
}
