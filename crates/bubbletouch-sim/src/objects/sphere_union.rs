//! Unions of rigid spheres.

use super::{Sphere, SphereClusters};
use crate::error::{Error, Result};
use crate::geometry::{Aabb, Pose};
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// Union of rigid spheres in the frame of the object, metres. Clones share their data.
///
/// Invariant: at least one sphere, every centre finite, every radius finite and positive.
#[derive(Clone, Debug)]
pub struct SphereUnion {
    data: Arc<Data>,
}

#[derive(Debug)]
struct Data {
    spheres: Vec<Sphere>,
    /// Clusters of the spheres, computed on first use.
    clusters: OnceLock<SphereClusters>,
}

impl PartialEq for SphereUnion {
    fn eq(&self, other: &Self) -> bool {
        self.spheres() == other.spheres()
    }
}

impl SphereUnion {
    /// Creates a union of spheres and checks the invariant.
    ///
    /// # Errors
    /// If a sphere violates the invariant; the error names the first one.
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
        Ok(Self::from_spheres(spheres))
    }

    fn from_spheres(spheres: Vec<Sphere>) -> Self {
        let clusters = OnceLock::new();
        Self {
            data: Arc::new(Data { spheres, clusters }),
        }
    }

    /// Returns the spheres of the union in their order of construction.
    pub fn spheres(&self) -> &[Sphere] {
        &self.data.spheres
    }

    /// Returns the spheres in clusters of neighbours, computed on first use in about 100 ns per sphere.
    pub fn clusters(&self) -> &SphereClusters {
        let sort = || SphereClusters::from_spheres(self.spheres());
        self.data.clusters.get_or_init(sort)
    }

    /// Returns the number of spheres of the union.
    pub fn n_spheres(&self) -> usize {
        self.spheres().len()
    }

    /// Returns the bounding box of all spheres, metres.
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.spheres().iter().map(Sphere::bounds))
            .expect("a union has at least one sphere")
    }

    /// Returns the distance from a point to the farthest surface point of a sphere, metres. This distance is the radius of an enclosing ball around the
    /// point.
    pub fn reach_from(&self, point: DVec3) -> f64 {
        let reach = |sphere: &Sphere| sphere.center.distance(point) + sphere.radius;
        self.spheres().iter().map(reach).fold(0.0, f64::max)
    }

    /// Returns the union after a rigid motion.
    pub fn moved(&self, pose: &Pose) -> Self {
        let spheres = self
            .spheres()
            .iter()
            .map(|s| Sphere {
                center: pose.transform_point(s.center),
                radius: s.radius,
            })
            .collect();
        Self::from_spheres(spheres)
    }
}

impl SphereClusters {
    /// Groups the spheres of an object into clusters; takes about 100 ns per sphere.
    pub fn new(union: &SphereUnion) -> Self {
        Self::from_spheres(union.spheres())
    }
}
