//! Rigid spheres and their unions.

use super::sphere_mass::center_of_spheres;
use super::{Solid, SphereClusters};
use crate::error::{Error, Result};
use crate::geometry::{Aabb, Pose};
use crate::mesh::TriangleMesh;
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// Rigid sphere, given by centre and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre of the sphere, metres.
    pub center: DVec3,
    /// Radius of the sphere, metres, positive.
    pub radius: f64,
}

impl Sphere {
    /// Returns the sphere around a box, with the centre of the box.
    pub fn around(bounds: &Aabb) -> Self {
        Self {
            center: bounds.center(),
            radius: 0.5 * bounds.size().length(),
        }
    }

    /// Returns the sphere moved by a pose.
    pub fn placed(&self, pose: &Pose) -> Self {
        Self {
            center: pose.transform_point(self.center),
            ..*self
        }
    }

    /// Returns whether two spheres have a point in common.
    #[inline]
    pub fn meets(&self, other: &Self) -> bool {
        let reach = self.radius + other.radius;
        self.center.distance_squared(other.center) <= reach * reach
    }

    /// Returns the bounding box of the sphere, metres.
    pub fn bounds(&self) -> Aabb {
        Aabb {
            min: self.center - DVec3::splat(self.radius),
            max: self.center + DVec3::splat(self.radius),
        }
    }
}

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
    /// Bounding box of all spheres, metres.
    bounds: Aabb,
    /// Clusters of the spheres, computed on first use.
    clusters: OnceLock<SphereClusters>,
    /// Body that the spheres represent, and its pose in the frame of the object; `None` if the spheres are the body.
    body: Option<(Arc<Represented>, Pose)>,
    /// Centre of mass, computed on first use, metres.
    center_of_mass: OnceLock<DVec3>,
}

/// Homogeneous body that spheres represent.
#[derive(Clone, Debug)]
pub enum Represented {
    /// Union of shapes.
    Solid(Solid),
    /// Solid of a mesh.
    Mesh(TriangleMesh),
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
            let allowed = "at least one sphere";
            return Err(Error::input("sphere union", "no spheres", allowed));
        }
        for (index, sphere) in spheres.iter().enumerate() {
            let Sphere { center, radius } = sphere;
            let (given, allowed) = if !center.is_finite() {
                (format!("centre {center}"), "finite coordinates in metres")
            } else if !(radius.is_finite() && *radius > 0.0) {
                let allowed = "a finite positive radius in metres";
                (format!("radius {radius}"), allowed)
            } else {
                continue;
            };
            let place = format!("sphere {}", index + 1);
            return Err(Error::input(place, given, allowed));
        }
        Ok(Self::from_spheres(spheres, None))
    }

    fn from_spheres(spheres: Vec<Sphere>, body: Option<(Arc<Represented>, Pose)>) -> Self {
        let bounds = Aabb::around(spheres.iter().map(Sphere::bounds));
        Self {
            data: Arc::new(Data {
                bounds: bounds.expect("a union has at least one sphere"),
                spheres,
                clusters: OnceLock::new(),
                body,
                center_of_mass: OnceLock::new(),
            }),
        }
    }

    /// Returns the union as an approximation of a body in the same frame, whose centre of mass it then has.
    pub fn representing(&self, body: Represented) -> Self {
        let body = Some((Arc::new(body), Pose::IDENTITY));
        Self::from_spheres(self.spheres().to_vec(), body)
    }

    /// Returns the centre of mass of the homogeneous body that the spheres represent, or of their union as a homogeneous solid, metres; computed on first use.
    pub fn center_of_mass(&self) -> DVec3 {
        let data = &self.data;
        *data.center_of_mass.get_or_init(|| match &data.body {
            Some((body, pose)) => pose.transform_point(match &**body {
                Represented::Solid(solid) => solid.center_of_mass(),
                Represented::Mesh(mesh) => mesh.center_of_mass(),
            }),
            None => center_of_spheres(&data.spheres, &self.bounds()),
        })
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
        self.data.bounds
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
        let body = self.data.body.as_ref();
        let moved = body.map(|(body, place)| (body.clone(), pose.compose(place)));
        Self::from_spheres(spheres, moved)
    }
}

impl SphereClusters {
    /// Groups the spheres of an object into clusters; takes about 100 ns per sphere.
    pub fn new(union: &SphereUnion) -> Self {
        Self::from_spheres(union.spheres())
    }
}
