//! Generalised winding number of an open or closed surface around a point.
//!
//! The winding number is the sum of the solid angles of all triangles divided by 4π \[GWN\]. The number is 1 inside a closed mesh, 0 outside, and intermediate
//! near a hole. A distant part of the mesh is approximated by one dipole, its area vector A at its centre c \[FWN\]: `A·(c − x) / (4π |c − x|³)`.

use super::{Bvh, Triangle};
use glam::DVec3;
use std::f64::consts::PI;

/// Distance beyond which a group of triangles is replaced by a dipole, in multiples of the group's radius. If larger, queries are slower; if smaller, the
/// error exceeds a tenth on real meshes.
const FAR: f64 = 2.5;

/// Tree for fast winding numbers: one dipole for each node of a [`Bvh`].
#[derive(Clone, Debug)]
pub(super) struct WindingTree {
    dipoles: Vec<Dipole>,
}

#[derive(Clone, Copy, Debug)]
struct Dipole {
    /// Mean of the triangles' centroids, weighted by their areas, metres.
    center: DVec3,
    /// Area vector of the triangles, the sum of area times unit normal, m².
    area: DVec3,
    /// Squared distance beyond which the dipole replaces the triangles of the node, m².
    far2: f64,
}

impl WindingTree {
    pub fn new(bvh: &Bvh) -> Self {
        let tree = bvh.tree();
        let mut moments = vec![Moments::default(); tree.n_nodes()];
        // Children come after their parents.
        for node in (0..tree.n_nodes()).rev() {
            moments[node] = match tree.children(node) {
                Some([a, b]) => moments[a].plus(moments[b]),
                None => bvh
                    .leaf(node)
                    .iter()
                    .map(Moments::new)
                    .fold(Moments::default(), Moments::plus),
            };
        }
        let dipole = |(node, m): (usize, &Moments)| {
            let bounds = tree.node_bounds(node);
            let center = match m.area > 0.0 {
                true => m.first / m.area,
                false => bounds.center(),
            };
            let radius = (center - bounds.min).max(bounds.max - center).length();
            Dipole {
                center,
                area: m.vector,
                far2: (FAR * radius).powi(2),
            }
        };
        Self {
            dipoles: moments.iter().enumerate().map(dipole).collect(),
        }
    }

    /// Returns the winding number of the mesh around a point, with an error of about 0.1.
    pub fn winding_number(&self, bvh: &Bvh, point: DVec3) -> f64 {
        self.solid_angle(bvh, 0, point) / (4.0 * PI)
    }

    fn solid_angle(&self, bvh: &Bvh, node: usize, point: DVec3) -> f64 {
        let dipole = &self.dipoles[node];
        let away = dipole.center - point;
        let distance2 = away.length_squared();
        if distance2 > dipole.far2 {
            return dipole.area.dot(away) / (distance2 * distance2.sqrt());
        }
        match bvh.tree().children(node) {
            Some(children) => children
                .map(|child| self.solid_angle(bvh, child, point))
                .into_iter()
                .sum(),
            None => bvh.leaf(node).iter().map(|t| solid_angle(t, point)).sum(),
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    area: f64,
    /// Sum of area times centroid over the triangles.
    first: DVec3,
    /// Sum of area times unit normal over the triangles.
    vector: DVec3,
}

impl Moments {
    fn new(triangle: &Triangle) -> Self {
        let vector = 0.5 * triangle.double_area();
        let area = vector.length();
        let [a, b, c] = triangle.0;
        Self {
            area,
            first: area * (a + b + c) / 3.0,
            vector,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            area: self.area + other.area,
            first: self.first + other.first,
            vector: self.vector + other.vector,
        }
    }
}

/// Returns the solid angle of a triangle seen from a point; positive if the point is behind the triangle's front \[VS\].
pub(super) fn solid_angle(triangle: &Triangle, point: DVec3) -> f64 {
    let [a, b, c] = triangle.0.map(|corner| corner - point);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    2.0 * volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
}
