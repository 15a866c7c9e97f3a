//! The spheres of an object that are where a skin is: by clusters, so that most of a large object is never looked at.

use crate::geometry::Pose;
use crate::objects::{Sphere, SphereUnion};
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
    #[inline]
    pub fn at(&self, number: u32) -> Sphere {
        self.place(self.union.spheres()[number as usize])
    }

    #[inline]
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
