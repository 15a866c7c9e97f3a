//! One triangle: its nearest point, its box, its middle, its area.

use crate::geometry::Aabb;
use glam::DVec3;

/// Three corners, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle(pub [DVec3; 3]);

/// What part of a triangle a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// Its inside.
    Face,
    /// The edge from this corner (0, 1 or 2) to the next.
    Edge(u8),
    /// This corner (0, 1 or 2).
    Vertex(u8),
}

/// A triangle whose height is less than this share of its longest edge is taken for its three edges: its plane could not
/// be known to better than a share of 1e-16 / 1e-8 of its length. Larger: edges stand in for faces that are still felt;
/// smaller: distances to such planes are noise.
const SLIVER: f64 = 1e-8;

impl Triangle {
    /// The box around it.
    pub fn bounds(&self) -> Aabb {
        let [a, b, c] = self.0;
        Aabb {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
        }
    }

    /// The mean of the corners.
    pub fn middle(&self) -> DVec3 {
        let [a, b, c] = self.0;
        (a + b + c) / 3.0
    }

    /// Twice the area, along the outward normal of a counter-clockwise triangle; m².
    pub fn double_area(&self) -> DVec3 {
        let [a, b, c] = self.0;
        (b - a).cross(c - a)
    }

    /// Area, m².
    pub fn area(&self) -> f64 {
        0.5 * self.double_area().length()
    }

    /// The unit normal; `None` for a triangle too thin to have one.
    pub fn normal(&self) -> Option<DVec3> {
        let n = self.double_area();
        let longest2 = self.longest_edge_squared();
        (n.length_squared() > (SLIVER * longest2).powi(2)).then(|| n.normalize())
    }

    /// The square of the longest edge.
    pub fn longest_edge_squared(&self) -> f64 {
        let [a, b, c] = self.0;
        let ab = a.distance_squared(b);
        ab.max(b.distance_squared(c)).max(c.distance_squared(a))
    }

    /// Cut across the middle of the longest edge.
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

    /// The nearest point to `point`, and what it lies on.
    pub fn closest(&self, point: DVec3) -> (DVec3, Feature) {
        let [a, b, c] = self.0;
        let n = self.double_area();
        let n2 = n.length_squared();
        let is_sliver = n2 <= (SLIVER * self.longest_edge_squared()).powi(2);
        let mut nearest = (a, Feature::Face);
        let mut best = f64::INFINITY;
        // The nearest point lies on an edge that has the point on its outer side, or inside if there is none.
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
        (point - n * ((point - a).dot(n) / n2), Feature::Face)
    }

    /// How far along the line `origin + along · direction` it meets the triangle; `None` if it does not, or lies in its
    /// plane. \[MT\]
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

/// The nearest point of the edge with number `k`.
fn closest_on_edge(from: DVec3, to: DVec3, k: u8, point: DVec3) -> (DVec3, Feature) {
    let along = to - from;
    let t = (point - from).dot(along);
    let length2 = along.length_squared();
    if t <= 0.0 {
        return (from, Feature::Vertex(k));
    }
    if t >= length2 {
        return (to, Feature::Vertex((k + 1) % 3));
    }
    (from + along * (t / length2), Feature::Edge(k))
}
