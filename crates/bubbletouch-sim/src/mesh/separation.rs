//! Separation test of two triangles.

use super::Triangle;
use glam::DVec3;

/// Largest gap between triangles that may be a rounding error, relative to their size.
const ROUNDING: f64 = 1e-12;

impl Triangle {
    /// Returns whether a plane certainly separates two triangles. The test uses their normals and the 9 products of their edges (separating axes). Returns
    /// false for triangles that touch or lie in one plane.
    pub fn is_apart(&self, other: &Self) -> bool {
        let origin = self.0[0];
        let [a, b] = [self, other].map(|triangle| triangle.0.map(|corner| corner - origin));
        let sizes = a.iter().chain(&b).map(|corner| corner.abs().max_element());
        let size = sizes.fold(0.0, f64::max) + ROUNDING * origin.abs().max_element();
        let between = |axis: DVec3| {
            let [(low_a, high_a), (low_b, high_b)] = [range(&a, axis), range(&b, axis)];
            (low_a - high_b).max(low_b - high_a) > ROUNDING * size * axis.length()
        };
        let [edges_a, edges_b] = [edges(&a), edges(&b)];
        if between(edges_a[0].cross(edges_a[1])) || between(edges_b[0].cross(edges_b[1])) {
            return true;
        }
        edges_a
            .iter()
            .any(|a| edges_b.iter().any(|b| between(a.cross(*b))))
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
    }
}
