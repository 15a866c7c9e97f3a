//! A union of rigid spheres.

use super::{Sphere, SphereClusters};
use crate::error::{Error, Result};
use crate::geometry::{Aabb, Pose};
use glam::DVec3;
use std::sync::OnceLock;

/// A union of rigid spheres in the object's frame.
///
/// Invariant: at least one sphere, every centre finite, every radius finite and positive.
#[derive(Clone, Debug)]
pub struct SphereUnion {
    spheres: Vec<Sphere>,
    /// Of these spheres; made when they are first asked for.
    clusters: OnceLock<Box<SphereClusters>>,
}

impl PartialEq for SphereUnion {
    fn eq(&self, other: &Self) -> bool {
        self.spheres == other.spheres
    }
}

impl SphereUnion {
    /// Checks the invariant.
    ///
    /// # Errors
    /// The error names the first offending sphere.
    pub fn new(spheres: Vec<Sphere>) -> Result<Self> {
        if spheres.is_empty() {
            return Err(Error::input(
                "sphere union",
                "no spheres",
                "at least one sphere",
            ));
        }
        for (index, sphere) in spheres.iter().enumerate() {
            let place = || format!("sphere {}", index + 1);
            if !sphere.center.is_finite() {
                return Err(Error::input(
                    place(),
                    format!("centre {}", sphere.center),
                    "finite coordinates in metres",
                ));
            }
            if !(sphere.radius.is_finite() && sphere.radius > 0.0) {
                return Err(Error::input(
                    place(),
                    format!("radius {}", sphere.radius),
                    "a finite positive radius in metres",
                ));
            }
        }
        Ok(Self::of(spheres))
    }

    fn of(spheres: Vec<Sphere>) -> Self {
        let clusters = OnceLock::new();
        Self { spheres, clusters }
    }

    /// The spheres, in their order of construction.
    pub fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }

    /// The spheres in clusters of neighbours: sorted at the first call, about 100 ns a sphere, and kept.
    pub fn clusters(&self) -> &SphereClusters {
        let sort = || Box::new(SphereClusters::from_spheres(&self.spheres));
        self.clusters.get_or_init(sort)
    }

    /// How many spheres.
    pub fn n_spheres(&self) -> usize {
        self.spheres.len()
    }

    /// The box around all spheres, metres.
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.spheres.iter().map(Sphere::bounds))
            .expect("a union has at least one sphere")
    }

    /// From a point to the farthest point of a sphere, metres: the radius of a ball about the point around them all.
    pub fn reach_from(&self, point: DVec3) -> f64 {
        let reach = |sphere: &Sphere| sphere.center.distance(point) + sphere.radius;
        self.spheres.iter().map(reach).fold(0.0, f64::max)
    }

    /// The same union after a rigid motion.
    pub fn moved(&self, pose: &Pose) -> Self {
        let spheres = self
            .spheres
            .iter()
            .map(|s| Sphere {
                center: pose.transform_point(s.center),
                radius: s.radius,
            })
            .collect();
        Self::of(spheres)
    }
}

impl SphereClusters {
    /// Sorts the spheres of an object into clusters; about 100 ns per sphere.
    pub fn new(union: &SphereUnion) -> Self {
        Self::from_spheres(&union.spheres)
    }
}
