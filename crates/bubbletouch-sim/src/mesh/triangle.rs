//! One triangle: its nearest point, bounding box, centroid and area, and the separation of two triangles.

use crate::geometry::Aabb;
use glam::DVec3;

/// Triangle, given by its three corners, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle(pub [DVec3; 3]);

/// Part of a triangle on which a point lies: the face, an edge or a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshFeature {
    /// Interior of the triangle.
    Face,
    /// Edge from corner k (0, 1 or 2) to the next corner.
    Edge(u8),
    /// Corner k (0, 1 or 2).
    Vertex(u8),
}

/// Smallest height of a triangle relative to its longest edge. A thinner triangle is replaced by its three edges, because the direction of its plane has a
/// relative error of 1e-16 / 1e-8. If larger, faces that taxels can touch are replaced by edges; if smaller, distances to such planes are rounding errors.
const SLIVER: f64 = 1e-8;

impl Triangle {
    /// Returns the bounding box of the triangle, metres.
    pub fn bounds(&self) -> Aabb {
        let [a, b, c] = self.0;
        Aabb {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
        }
    }

    /// Returns the centroid of the triangle, which is the mean of its corners, metres.
    pub fn middle(&self) -> DVec3 {
        let [a, b, c] = self.0;
        (a + b + c) / 3.0
    }

    /// Returns the normal vector of the triangle with twice the triangle's area as length, m². The normal points outwards if the corners are
    /// counter-clockwise seen from outside.
    pub fn double_area(&self) -> DVec3 {
        let [a, b, c] = self.0;
        (b - a).cross(c - a)
    }

    /// Returns the area of the triangle, m².
    pub fn area(&self) -> f64 {
        0.5 * self.double_area().length()
    }

    /// Returns the unit normal of the triangle; `None` if the triangle is too thin.
    pub fn normal(&self) -> Option<DVec3> {
        let n = self.double_area();
        let longest2 = self.longest_edge_squared();
        (n.length_squared() > (SLIVER * longest2).powi(2)).then(|| n.normalize())
    }

    /// Returns the squared length of the longest edge, m².
    pub fn longest_edge_squared(&self) -> f64 {
        let [a, b, c] = self.0;
        let ab = a.distance_squared(b);
        ab.max(b.distance_squared(c)).max(c.distance_squared(a))
    }

    /// Returns the two halves of the triangle, which is cut from the middle of its longest edge to the opposite corner.
    pub fn bisected(&self) -> [Self; 2] {
        let [a, b, c] = self.0;
        let (ab, bc, ca) = (
            a.distance_squared(b),
            b.distance_squared(c),
            c.distance_squared(a),
        );
        let (from, to, apex) = if ab >= bc && ab >= ca {
            (a, b, c)
        } else if bc >= ca {
            (b, c, a)
        } else {
            (c, a, b)
        };
        let middle = 0.5 * (from + to);
        [Self([from, middle, apex]), Self([middle, to, apex])]
    }

    /// Returns the point of the triangle nearest to `point`, and the part of the triangle on which the nearest point lies.
    pub fn closest(&self, point: DVec3) -> (DVec3, MeshFeature) {
        let [a, b, c] = self.0;
        let n = self.double_area();
        let n2 = n.length_squared();
        let is_sliver = n2 <= (SLIVER * self.longest_edge_squared()).powi(2);
        let mut nearest = (a, MeshFeature::Face);
        let mut best = f64::INFINITY;
        // The nearest point lies on an edge that has the point on its outer side, or in the interior if no edge has.
        for (k, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            let inner_side = n.cross(to - from).dot(point - from);
            if inner_side <= 0.0 || is_sliver {
                let (on_edge, feature) = closest_on_edge(from, to, k as u8, point);
                let distance2 = on_edge.distance_squared(point);
                if distance2 < best {
                    best = distance2;
                    nearest = (on_edge, feature);
                }
            }
        }
        if best.is_finite() {
            return nearest;
        }
        (point - n * ((point - a).dot(n) / n2), MeshFeature::Face)
    }

    /// Returns the position `along` at which the line `origin + along · direction` crosses the triangle. Returns `None` if the line misses the triangle or is
    /// parallel to its plane. \[MT\]
    pub fn crossed_at(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let [a, b, c] = self.0;
        let (ab, ac, from_a) = (b - a, c - a, origin - a);
        let p = direction.cross(ac);
        let determinant = ab.dot(p);
        let q = from_a.cross(ab);
        let (u, v) = (from_a.dot(p) / determinant, direction.dot(q) / determinant);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        inside
            .then(|| ac.dot(q) / determinant)
            .filter(|along| along.is_finite())
    }
}

/// Returns the point nearest to `point` on the edge between two corners, where `k` is the index of the edge.
fn closest_on_edge(from: DVec3, to: DVec3, k: u8, point: DVec3) -> (DVec3, MeshFeature) {
    let along = to - from;
    let t = (point - from).dot(along);
    let length2 = along.length_squared();
    if t <= 0.0 {
        return (from, MeshFeature::Vertex(k));
    }
    if t >= length2 {
        return (to, MeshFeature::Vertex((k + 1) % 3));
    }
    (from + along * (t / length2), MeshFeature::Edge(k))
}

/// Largest gap between triangles that may be a rounding error, relative to their size.
const ROUNDING: f64 = 1e-12;

impl Triangle {
    /// Returns whether a plane certainly separates two triangles. The test uses their normals and the 9 products of their edges (separating axes). Returns
    /// false for triangles that touch or lie in one plane.
    pub fn is_apart(&self, other: &Self) -> bool {
        let pair = Pair::new(self, other);
        let [one, two] = &pair.edges;
        pair.is_separated_along(one[0].cross(one[1]))
            || pair.is_separated_along(two[0].cross(two[1]))
            || one
                .iter()
                .any(|a| two.iter().any(|b| pair.is_separated_along(a.cross(*b))))
    }

    /// Returns whether a plane through an edge of either triangle, perpendicular to this triangle, certainly separates the triangles. For triangles in one
    /// plane the test is complete.
    pub fn is_beside(&self, other: &Self) -> bool {
        let pair = Pair::new(self, other);
        let normal = pair.edges[0][0].cross(pair.edges[0][1]);
        let mut edges = pair.edges.iter().flatten();
        edges.any(|edge| pair.is_separated_along(normal.cross(*edge)))
    }
}

/// Two triangles, relative to a corner of the first.
struct Pair {
    corners: [[DVec3; 3]; 2],
    edges: [[DVec3; 3]; 2],
    /// Gap along a unit axis that may be a rounding error, metres.
    rounding: f64,
}

impl Pair {
    fn new(one: &Triangle, two: &Triangle) -> Self {
        let origin = one.0[0];
        let corners = [one, two].map(|triangle| triangle.0.map(|corner| corner - origin));
        let sizes = corners
            .iter()
            .flatten()
            .map(|corner| corner.abs().max_element());
        let size = sizes.fold(0.0, f64::max) + ROUNDING * origin.abs().max_element();
        Self {
            edges: corners.map(|corners| edges(&corners)),
            corners,
            rounding: ROUNDING * size,
        }
    }

    fn is_separated_along(&self, axis: DVec3) -> bool {
        let [(low_a, high_a), (low_b, high_b)] =
            self.corners.each_ref().map(|corners| range(corners, axis));
        (low_a - high_b).max(low_b - high_a) > self.rounding * axis.length()
    }
}

fn edges([a, b, c]: &[DVec3; 3]) -> [DVec3; 3] {
    [b - a, c - b, a - c]
}

/// Returns the lowest and the highest position of a triangle's corners along an axis.
fn range(corners: &[DVec3; 3], axis: DVec3) -> (f64, f64) {
    let [a, b, c] = corners.map(|corner| corner.dot(axis));
    (a.min(b).min(c), a.max(b).max(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: Triangle = Triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);

    fn moved(by: DVec3) -> Triangle {
        // The triangle stands on the plane of `FLAT`, across it.
        let corners = [
            DVec3::new(0.2, 0.2, -0.5),
            DVec3::new(0.3, 0.2, -0.5),
            DVec3::new(0.2, 0.3, 0.5),
        ];
        Triangle(corners.map(|corner| corner + by))
    }

    #[test]
    fn triangles_are_apart_exactly_when_a_plane_lies_between_them() {
        for (by, is_apart) in [
            (DVec3::ZERO, false),
            (0.4 * DVec3::Z, false),
            (0.6 * DVec3::Z, true),
            (-0.6 * DVec3::Z, true),
            (0.6 * DVec3::X, true),
            (-0.31 * DVec3::X, true),
            (-0.2 * DVec3::X, false),
        ] {
            assert_eq!(FLAT.is_apart(&moved(by)), is_apart, "by {by}");
            assert_eq!(moved(by).is_apart(&FLAT), is_apart, "by {by}");
        }
        let beside = Triangle(FLAT.0.map(|corner| corner + 1e-6 * DVec3::Z));
        assert!(FLAT.is_apart(&beside));
        assert!(!FLAT.is_apart(&FLAT), "nothing is said of one plane");
        assert!(!FLAT.is_beside(&FLAT) && !FLAT.is_beside(&moved(DVec3::ZERO)));
        let across = Triangle(FLAT.0.map(|corner| DVec3::new(1.001, 1.0, 0.0) - corner));
        assert!(FLAT.is_beside(&across) && across.is_beside(&FLAT));
        let inside = Triangle(FLAT.0.map(|corner| DVec3::new(0.999, 1.0, 0.0) - corner));
        assert!(!FLAT.is_beside(&inside) && !inside.is_beside(&FLAT));
    }
}
