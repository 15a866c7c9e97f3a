//! Area, volume and centroids of a mesh.

use super::enclosed::Enclosed;
use super::{TriangleMesh, Welded};
use glam::DVec3;

/// Volume relative to area^(3/2) below which a mesh counts as a surface without volume. A ball has 0.094, a plate of 100 × 100 × 0.1 mm 0.0004.
const HOLLOW: f64 = 1e-4;

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

    /// Returns the centre of mass of the homogeneous solid of the mesh, metres. A mesh without volume, such as a single surface, is treated as a surface of
    /// constant density.
    pub fn center_of_mass(&self) -> DVec3 {
        let (volume, center) = self.volume_and_centroid();
        match volume.abs() > HOLLOW * self.area().powf(1.5) {
            true => center,
            false => self.surface_centroid(),
        }
    }

    /// Returns the volume of the solid of the mesh, m³ (negative if the triangles face inwards), and the centroid of this volume, metres.
    ///
    /// The result is exact for a closed mesh; closed parts that overlap count once. A hole is treated as closed by a cone whose apex is the centroid of the
    /// surface; overlapping parts of a mesh with holes count several times.
    pub fn volume_and_centroid(&self) -> (f64, DVec3) {
        let apex = self.surface_centroid();
        let mut enclosed = Enclosed::default();
        for t in 0..self.n_triangles() {
            enclosed.add(self.triangle(t).0.map(|corner| corner - apex), 1.0);
        }
        let welded = Welded::new(self);
        if enclosed.volume != 0.0 && welded.n_unbalanced() == 0 {
            let sign = enclosed.volume.signum();
            enclosed = Enclosed::of_solid(self, &welded, apex, sign);
        }
        let Enclosed { volume, moment } = enclosed;
        match volume == 0.0 {
            true => (volume, apex),
            false => (volume, apex + moment / volume),
        }
    }
}
