//! Objects at a pose in the frame of a skin, and the search for their spheres that may touch the skin.
//!
//! The search bounds the clusters of an object's spheres first, then the spheres of the remaining clusters, eight or sixteen at a time. What counts as near the
//! skin is given by its [`Region`].

use super::lanes::{SelectedLanes, least};
use crate::geometry::Pose;
use crate::mesh::Triangle;
use crate::objects::{Cluster, MAX_IN_CLUSTER, Sphere, SphereClusters};
use glam::{DMat3, DQuat, DVec3};

/// Pose of an object without contact, which keeps its index in a list: far from all skins, but with a finite squared distance.
pub const OUT_OF_REACH: Pose = Pose {
    rotation: DQuat::IDENTITY,
    translation: DVec3::new(0.0, 0.0, 1e100),
};

/// Number of clusters of spheres whose bounds are compared together: eight f64 values in a vector of 512 bits.
pub(crate) const LOOK: usize = 8;

/// Object at a pose in the frame of a skin.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ObjectAt {
    pub rotation: DMat3,
    /// Translation, metres.
    pub translation: DVec3,
    /// Length by which the object is enlarged, metres: the rounding of a mesh, plus the radius of equal taxels, which then count as points.
    pub reach: f64,
}

/// Sphere in the frame of a skin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedSphere {
    pub center: DVec3,
    /// Radius of the sphere plus the length by which its object is enlarged, metres.
    pub reach: f64,
}

impl ObjectAt {
    pub fn new(pose: &Pose, reach: f64) -> Self {
        Self {
            rotation: DMat3::from_quat(pose.rotation),
            translation: pose.translation,
            reach,
        }
    }

    /// Moves a point from the frame of the object to the frame of the skin.
    #[inline(always)]
    pub fn place(&self, point: DVec3) -> DVec3 {
        self.turn(point) + self.translation
    }

    /// Moves a point from the frame of the skin to the frame of the object.
    #[inline(always)]
    pub fn unplace(&self, point: DVec3) -> DVec3 {
        self.rotation.transpose() * (point - self.translation)
    }

    /// Turns a vector from the frame of the object to the frame of the skin.
    #[inline(always)]
    pub fn turn(&self, vector: DVec3) -> DVec3 {
        self.rotation * vector
    }

    /// Moves a triangle from the frame of the object to the frame of the skin, without enlarging it.
    #[inline(always)]
    pub fn triangle(&self, triangle: &Triangle) -> Triangle {
        let [a, b, c] = triangle.0;
        Triangle([self.place(a), self.place(b), self.place(c)])
    }

    /// Moves a sphere from the frame of the object to the frame of the skin, and enlarges it.
    #[inline(always)]
    pub fn sphere(&self, sphere: Sphere) -> PlacedSphere {
        PlacedSphere {
            center: self.place(sphere.center),
            reach: self.reach + sphere.radius,
        }
    }

    /// Returns the spheres of a cluster whose bounds are below a limit. The bound of the cluster must be below it, too.
    #[inline(always)]
    pub fn spheres_below(
        &self,
        cluster: &Cluster,
        region: &impl Region,
        limit: f64,
    ) -> SelectedLanes {
        if cluster.n_spheres == 1 {
            // The bound of the cluster is that of its sphere.
            return SelectedLanes::of_bits(1_u32);
        }
        let mut bounds = [f64::INFINITY; MAX_IN_CLUSTER];
        for (k, bound) in bounds.iter_mut().enumerate() {
            let of_sphere = region.sphere_bound(&self.sphere(cluster.at(k)));
            *bound = if k < cluster.n_spheres {
                of_sphere
            } else {
                f64::INFINITY
            };
        }
        SelectedLanes::below(&bounds, limit)
    }
}

/// Cluster of spheres in the frame of their object.
pub(crate) struct ClusterBox {
    /// Ball around the spheres, metres.
    pub ball: Sphere,
    /// Half sides of the box around the centres of the spheres, with the centre of the ball, metres.
    pub half: DVec3,
    /// Radius of the largest sphere, metres.
    pub largest: f64,
}

/// Region of a skin that objects may touch. Each search states the meaning of its bounds and its limit. A trait is used because closures would be compiled
/// without vector instructions.
pub(crate) trait Region {
    /// Returns the bound of a sphere. If a sphere inside another one is below the limit of a search, so is the other one.
    fn sphere_bound(&self, sphere: &PlacedSphere) -> f64;

    /// Returns the bound of a cluster of an object's spheres: below the limit of a search if one of the spheres is.
    #[inline(always)]
    fn cluster_bound(&self, object: &ObjectAt, cluster: &ClusterBox) -> f64 {
        self.sphere_bound(&object.sphere(cluster.ball))
    }
}

/// Bounds of the clusters of an object's spheres. The memory is reused by further searches.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClusterSearch {
    /// Bound of each cluster, followed by infinite bounds up to a whole number of looks.
    bounds: Vec<f64>,
}

impl ClusterSearch {
    /// Computes the bounds of the clusters of an object.
    #[inline(always)]
    pub fn lay(&mut self, object: ObjectAt, clusters: &SphereClusters, region: &impl Region) {
        let boxes = clusters.bounds();
        let n = boxes.len();
        self.bounds.resize(n.next_multiple_of(LOOK), f64::INFINITY);
        if let Some(last) = self.bounds.as_chunks_mut::<LOOK>().0.last_mut() {
            *last = [f64::INFINITY; LOOK];
        }
        // Slices of one length need no tests of indices in the loop.
        let bounds = &mut self.bounds[..n];
        let [x, y, z] = &boxes.middle;
        let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
        let [half_x, half_y, half_z] = &boxes.half;
        let (half_x, half_y, half_z) = (&half_x[..n], &half_y[..n], &half_z[..n]);
        let (radius, largest) = (&boxes.radius[..n], &boxes.largest[..n]);
        for k in 0..n {
            let ball = Sphere {
                center: DVec3::new(x[k], y[k], z[k]),
                radius: radius[k],
            };
            let cluster = ClusterBox {
                ball,
                half: DVec3::new(half_x[k], half_y[k], half_z[k]),
                largest: largest[k],
            };
            bounds[k] = region.cluster_bound(&object, &cluster);
        }
    }

    /// Returns the bounds of the clusters, eight at a time.
    #[inline(always)]
    pub fn looks(&self) -> &[[f64; LOOK]] {
        self.bounds.as_chunks().0
    }

    /// Returns the least bound of a cluster; infinite if all are.
    #[inline(always)]
    pub fn least(&self) -> f64 {
        let mut lowest = [f64::INFINITY; LOOK];
        for bounds in self.looks() {
            for k in 0..LOOK {
                lowest[k] = least(bounds[k], lowest[k]);
            }
        }
        lowest.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Returns the memory that the bounds use in bytes.
    pub fn n_bytes(&self) -> usize {
        self.bounds.capacity() * size_of::<f64>()
    }
}
