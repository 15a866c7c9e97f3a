//! Region of a mesh that a draped layout covers, and test for positions that can carry a taxel.

use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::mesh::{Bvh, TriangleMesh};
use glam::DVec3;

/// Distance between a taxel and the start of its ray, relative to the mesh's size. If larger, nearer walls do not stop the ray; if smaller, the taxel's own
/// triangle stops the ray.
const AHEAD: f64 = 1e-6;
/// Lateral offset of a ray, relative to the mesh's size, so that rays through symmetric meshes do not hit edges.
const ASIDE: f64 = 1e-8;

/// Region of a mesh's surface. A point belongs to the region if all given conditions hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrapeRegion {
    /// Box that contains the region; metres, in the mesh's frame.
    pub bounds: Option<Aabb>,
    /// Plane that bounds the region, given by a point (metres) and a normal of any length. The region lies on the side to which the normal points.
    pub beyond: Option<(DVec3, DVec3)>,
    /// Indices of the triangles that make up the region.
    pub triangles: Option<Vec<usize>>,
}

impl DrapeRegion {
    /// Returns an error if the region does not fit the mesh.
    ///
    /// # Errors
    /// If a number is not finite, a box is empty, a normal is zero, or a triangle does not exist in the mesh.
    pub fn check(&self, mesh: &TriangleMesh) -> Result<()> {
        let refuse = |given: String, allowed: &str| Err(Error::input("region", given, allowed));
        if let Some(Aabb { min, max }) = self.bounds
            && !(min.is_finite() && max.is_finite() && min.cmple(max).all())
        {
            let given = format!("a box from {min} m to {max} m");
            return refuse(given, "finite corners, the least first");
        }
        if let Some((point, normal)) = self.beyond
            && !(point.is_finite() && normal.is_finite() && normal != DVec3::ZERO)
        {
            let given = format!("a plane at {point} m with normal {normal}");
            return refuse(given, "finite numbers, and a normal that is not zero");
        }
        let n = mesh.n_triangles();
        match self.triangles.iter().flatten().find(|&&number| number >= n) {
            Some(number) => refuse(format!("triangle {number}"), &format!("0 to {}", n - 1)),
            None => Ok(()),
        }
    }

    /// Returns for each triangle of a mesh whether the region allows taxels on it.
    pub(crate) fn mask(&self, mesh: &TriangleMesh) -> Vec<bool> {
        let mut mask = vec![self.triangles.is_none(); mesh.n_triangles()];
        for &number in self.triangles.iter().flatten() {
            mask[number] = true;
        }
        mask
    }

    /// Returns whether a point lies in the box and on the allowed side of the plane of this region.
    pub(crate) fn contains(&self, place: DVec3) -> bool {
        let is_in_box =
            |bounds: Aabb| place.cmpge(bounds.min).all() && place.cmple(bounds.max).all();
        let is_beyond = |(point, normal): (DVec3, DVec3)| (place - point).dot(normal) >= 0.0;
        self.bounds.is_none_or(is_in_box) && self.beyond.is_none_or(is_beyond)
    }
}

/// Ray casting from points on the surface of a mesh, to find the outer surface.
pub(crate) struct Rays {
    bvh: Bvh,
    /// Diagonal of the mesh's bounding box, metres.
    size: f64,
}

impl Rays {
    pub fn new(mesh: &TriangleMesh) -> Self {
        let bvh = Bvh::new(mesh);
        let size = bvh.bounds().size().length();
        Self { bvh, size }
    }

    /// Returns whether a ray from a point on the surface along a unit direction hits no triangle of the mesh.
    pub fn is_free(&self, place: DVec3, direction: DVec3) -> bool {
        let (x, y) = direction.any_orthonormal_pair();
        let origin = place + ASIDE * self.size * (0.8 * x + 0.6 * y);
        let range = AHEAD * self.size..f64::INFINITY;
        self.bvh.first_hit(origin, direction, range).is_none()
    }
}
