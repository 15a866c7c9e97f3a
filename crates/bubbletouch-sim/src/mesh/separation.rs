//! Separation test of two triangles.

use super::Triangle;
use glam::DVec3;

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
