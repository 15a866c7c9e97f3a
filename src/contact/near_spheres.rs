//! The spheres of an object that are where a skin is: by clusters, so that most of a large object is never looked at.

use crate::geometry::Pose;
use crate::objects::{Sphere, SphereUnion};
use crate::world::{LEAF, Leaf};
use glam::{DMat3, DVec3};

/// An object's spheres in the patch frame.
pub(super) struct PlacedUnion<'a> {
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

    /// A sphere by its number.
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

    /// The clusters that may count by the balls around them.
    pub fn clusters(&self) -> impl Iterator<Item = (usize, Sphere)> {
        let bounds = self.union.clusters().bounds();
        (0..bounds.len()).map(|cluster| (cluster, self.place(bounds.ball(cluster))))
    }

    /// The numbers of the spheres of a cluster.
    pub fn of(&self, cluster: usize) -> &'a [u32] {
        self.union.clusters().numbers(cluster)
    }

    /// The numbers of the spheres of those clusters that may count, ascending.
    pub fn gather(&self, mut may_count: impl FnMut(&Sphere) -> bool, numbers: &mut Vec<u32>) {
        numbers.clear();
        for (cluster, ball) in self.clusters() {
            if may_count(&ball) {
                numbers.extend_from_slice(self.of(cluster));
            }
        }
        numbers.sort_unstable();
    }
}

/// How far a sphere (in the patch frame) needs the taxels of a leaf to be pushed, metres, zero or less if it does not meet them; and its height
/// along their axes, metres.
///
/// The order of the operations is that of `needed_anywhere`, lane by lane.
#[inline(always)]
pub(super) fn needed_of_leaf(leaf: &Leaf, sphere: &Sphere) -> [[f64; LEAF]; 2] {
    let [mut needed, mut heights] = [[0.0; LEAF]; 2];
    let DVec3 { x, y, z } = sphere.center;
    for k in 0..LEAF {
        let from = DVec3::new(
            leaf.centers[0][k] - x,
            leaf.centers[1][k] - y,
            leaf.centers[2][k] - z,
        );
        let along =
            |of: &[[f64; LEAF]; 3]| from.x * of[0][k] + from.y * of[1][k] + from.z * of[2][k];
        let height = -along(&leaf.axes);
        let [dx, dy] = [along(&leaf.across[0]), along(&leaf.across[1])];
        let reach = leaf.radii[k] + sphere.radius;
        let q = reach * reach - dy * dy - dx * dx;
        let depth = q.max(0.0).sqrt() - height;
        needed[k] = if q > 0.0 { depth } else { 0.0 };
        heights[k] = height;
    }
    [needed, heights]
}
