//! Area, volume and centroids of a mesh.

use super::TriangleMesh;
use glam::DVec3;

impl TriangleMesh {
    /// Returns the area of the mesh, the sum of its triangles' areas, m².
    pub fn area(&self) -> f64 {
        (0..self.n_triangles())
            .map(|t| self.triangle(t).area())
            .sum()
    }

    /// Returns the centroid of the mesh's surface, metres: the mean of the triangles' centroids, weighted by area.
    pub fn surface_centroid(&self) -> DVec3 {
        let mut area = 0.0;
        let mut moment = DVec3::ZERO;
        for t in 0..self.n_triangles() {
            let triangle = self.triangle(t);
            let [a, b, c] = triangle.0;
            area += triangle.area();
            moment += triangle.area() * (a + b + c) / 3.0;
        }
        if area > 0.0 {
            moment / area
        } else {
            self.bounds().center()
        }
    }

    /// Returns the volume that the mesh encloses, m³ (negative if the triangles face inwards), and the centroid of this volume, metres.
    ///
    /// The volume is computed by tetrahedra from the centroid of the surface, which is exact for a closed mesh. A hole is treated as closed by a cone whose
    /// apex is this centroid.
    pub fn volume_and_centroid(&self) -> (f64, DVec3) {
        let apex = self.surface_centroid();
        let (mut volume, mut moment) = (0.0, DVec3::ZERO);
        for t in 0..self.n_triangles() {
            let [a, b, c] = self.triangle(t).0.map(|corner| corner - apex);
            let part = a.dot(b.cross(c)) / 6.0;
            volume += part;
            moment += part * 0.25 * (a + b + c);
        }
        (
            volume,
            if volume == 0.0 {
                apex
            } else {
                apex + moment / volume
            },
        )
    }
}
