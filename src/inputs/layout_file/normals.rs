//! Computation of surface normals of a mesh at the positions of taxels.

use crate::error::{Error, Result};
use crate::mesh::{Surface, TriangleMesh};
use glam::DVec3;

/// Maximum distance between a taxel and the surface that provides its normal, metres. A larger distance indicates that taxels and mesh have different frames or
/// units.
const MAX_DISTANCE: f64 = 5e-3;

/// Returns the outward unit normal of the mesh surface at the point nearest to each taxel. `rows` contains the number of each taxel's row in the file.
pub(super) fn surface_normals(
    place: &str,
    (points, rows): (&[DVec3], &[usize]),
    mesh: &TriangleMesh,
) -> Result<Vec<DVec3>> {
    let surface = Surface::new(mesh.clone());
    let normal = |(point, row): (&DVec3, &usize)| {
        let closest = surface.closest(*point, f64::INFINITY);
        let near = closest.filter(|closest| closest.distance <= MAX_DISTANCE);
        let Some(near) = near else {
            let distance = closest.map_or(f64::INFINITY, |closest| closest.distance);
            let given = format!("a point {:.1} mm from the mesh", 1e3 * distance);
            let allowed = "points on the mesh, within 5 mm, in the frame of the mesh";
            return Err(Error::input(format!("{place}, row {row}"), given, allowed));
        };
        Ok(surface.pseudonormal(&near).normalize_or_zero())
    };
    points.iter().zip(rows).map(normal).collect()
}
