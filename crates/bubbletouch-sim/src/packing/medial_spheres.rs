//! Medial spheres: sphere models without a stated error, for comparison with packings.

use super::ball::Ball;
use super::packing_error::surface_points;
use super::target::{Body, Target};
use crate::error::Result;
use crate::mesh::Surface;
use crate::objects::{Sphere, SphereUnion};

/// Smallest radius of a sphere relative to the size of the mesh. Smaller spheres, which occur at sharp edges, are omitted.
const THINNEST: f64 = 1e-6;

/// Returns the largest spheres inside a closed mesh that touch the mesh at `n` points (Ma, Bae and Choi, 2012). The points are distributed uniformly over
/// its area. Points at which no sphere fits are omitted.
///
/// The spheres lie inside the mesh and touch it. Between the points, the distance from the mesh to the spheres is not bounded. Stolpner, Kry and Siddiqi
/// (2011) approximate shapes by such spheres.
///
/// # Errors
/// If `pack_mesh` would reject the mesh, or if no sphere remains.
pub fn medial_spheres(surface: &Surface, n: usize) -> Result<SphereUnion> {
    let size = surface.bounds().size().length();
    let target = Target::new(surface, Body::Solid, THINNEST * size)?;
    let spheres = surface_points(surface, n).into_iter();
    let spheres = spheres.filter_map(|(place, normal)| {
        let ball = Ball::largest(&target, place, -normal, 0.0, target.largest_radius())?;
        (ball.depth > THINNEST * size).then_some(Sphere {
            center: ball.center,
            radius: ball.depth,
        })
    });
    SphereUnion::new(spheres.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packing::brick::brick;
    use glam::DVec3;

    #[test]
    fn medial_spheres_of_a_box_touch_it_and_none_is_wider_than_the_box() {
        let surface = brick();
        let spheres = medial_spheres(&surface, 200).unwrap();
        assert_eq!(spheres.n_spheres(), 200);
        for sphere in spheres.spheres() {
            let depth = -surface.signed_distance(sphere.center);
            assert!((sphere.radius - depth).abs() < 1e-9, "{sphere:?}");
            assert!(sphere.radius <= 1.0 + 1e-9);
            // The sphere touches a second face, because its centre is on the medial axis.
            let to_faces = (DVec3::new(3.0, 2.0, 1.0) - sphere.center.abs()).to_array();
            let mut to_faces = [to_faces[0], to_faces[1], to_faces[2], 2.0 - to_faces[2]];
            to_faces.sort_by(f64::total_cmp);
            assert!((to_faces[1] - sphere.radius).abs() < 1e-6, "{sphere:?}");
        }
        assert!(medial_spheres(&surface, 0).is_err());
    }
}
