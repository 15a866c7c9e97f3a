//! Closed polygon in a plane: the profile of a lathe, or the outline of a prism.

use glam::DVec2;

/// Straight edge of a polygon; the inside is on its left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub start: DVec2,
    /// Unit vector from the start to the end of the edge.
    pub along: DVec2,
    /// Unit normal of the edge, pointing into the polygon.
    pub inward: DVec2,
    pub length: f64,
}

impl Edge {
    fn new(start: DVec2, end: DVec2) -> Self {
        let length = (end - start).length();
        let along = (end - start) / length;
        Self {
            start,
            along,
            inward: along.perp(),
            length,
        }
    }

    /// Returns the point of the edge at a distance from its start, metres.
    pub fn point(&self, distance: f64) -> DVec2 {
        self.start + distance * self.along
    }

    fn end(&self) -> DVec2 {
        self.point(self.length)
    }

    fn nearest(&self, point: DVec2) -> DVec2 {
        let along = (point - self.start).dot(self.along);
        self.point(along.clamp(0.0, self.length))
    }

    /// Returns the radius at which a disc that touches the point `foot` and grows along `inward` first touches this edge. Infinite if the disc never touches
    /// the edge.
    ///
    /// The disc through a point q has the radius |q − foot|² / 2 n·(q − foot), where n is `inward`. Along a line this radius is quasi-convex. Its minimum on
    /// the edge therefore lies where the disc is tangent to the line, or at an end of the edge.
    fn tangent_radius(&self, foot: DVec2, inward: DVec2) -> f64 {
        let height = (foot - self.start).dot(self.inward);
        let towards = self.inward * height.signum();
        let radius = height.abs() / (1.0 - inward.dot(towards));
        let touch = (foot + radius * inward - self.start).dot(self.along);
        if radius.is_finite() && (0.0..=self.length).contains(&touch) {
            return radius;
        }
        let through = |q: DVec2| {
            let ahead = inward.dot(q - foot);
            if ahead > 1e-9 * self.length {
                0.5 * (q - foot).length_squared() / ahead
            } else {
                f64::INFINITY
            }
        };
        through(self.start).min(through(self.end()))
    }
}

/// Simple polygon, counter-clockwise, with the edges that belong to the surface.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    vertices: Vec<DVec2>,
    pub edges: Vec<Edge>,
}

impl Outline {
    /// Creates the polygon with counter-clockwise vertices. Edges for which `is_surface(start, end)` is true belong to the surface of the solid.
    pub fn new(vertices: &[DVec2], is_surface: impl Fn(DVec2, DVec2) -> bool) -> Self {
        let mut vertices = vertices.to_vec();
        if area(&vertices) < 0.0 {
            vertices.reverse();
        }
        let edges = closed_pairs(&vertices)
            .filter(|&(start, end)| is_surface(start, end))
            .map(|(start, end)| Edge::new(start, end))
            .collect();
        Self { vertices, edges }
    }

    /// Returns the signed distance to the nearest edge of the surface, metres, negative inside the polygon.
    pub fn distance(&self, point: DVec2) -> f64 {
        let (_, foot) = self.nearest(point);
        let distance = (point - foot).length();
        match self.contains(point) {
            true => -distance,
            false => distance,
        }
    }

    /// Returns the index of the edge of the surface nearest to a point, and the nearest point on this edge.
    pub fn nearest(&self, point: DVec2) -> (usize, DVec2) {
        let mut best = (f64::INFINITY, 0, point);
        for (index, edge) in self.edges.iter().enumerate() {
            let foot = edge.nearest(point);
            let distance = (point - foot).length();
            if distance < best.0 {
                best = (distance, index, foot);
            }
        }
        (best.1, best.2)
    }

    /// Returns the corners of the polygon, counter-clockwise.
    pub fn vertices(&self) -> &[DVec2] {
        &self.vertices
    }

    /// Returns the support function of the polygon: the largest v·direction over its corners v.
    pub fn support(&self, direction: DVec2) -> f64 {
        let heights = self.vertices.iter().map(|corner| corner.dot(direction));
        heights.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns the corners with the smallest and the largest coordinates of the rectangle around the polygon.
    pub fn bounds(&self) -> [DVec2; 2] {
        let around = |by: fn(DVec2, DVec2) -> DVec2| self.vertices.iter().copied().reduce(by);
        [DVec2::min, DVec2::max].map(|by| around(by).unwrap_or_default())
    }

    /// Returns the radius of the largest inscribed disc that touches the edge with the index `edge` at `foot`.
    pub fn tangent_radius(&self, edge: usize, foot: DVec2) -> f64 {
        let inward = self.edges[edge].inward;
        let others = self.edges.iter().enumerate().filter(|&(i, _)| i != edge);
        others
            .map(|(_, other)| other.tangent_radius(foot, inward))
            .fold(f64::INFINITY, f64::min)
    }

    /// Returns whether the polygon contains a point, by the even-odd rule along a ray towards +x.
    fn contains(&self, point: DVec2) -> bool {
        let crossed = closed_pairs(&self.vertices).filter(|(a, b)| {
            (a.y > point.y) != (b.y > point.y)
                && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
        });
        crossed.count() % 2 == 1
    }
}

/// Returns the reason why the vertices do not form a simple polygon with sides of at least `shortest`; `None` if they do.
pub(super) fn polygon_fault(vertices: &[DVec2], shortest: f64) -> Option<String> {
    if vertices.len() < 3 {
        return Some(format!("{} corners", vertices.len()));
    }
    let pairs: Vec<_> = closed_pairs(vertices).collect();
    if let Some(at) = pairs.iter().position(|(a, b)| a.distance(*b) < shortest) {
        return Some(format!("corner {} repeated", at + 1));
    }
    let n = pairs.len();
    for i in 0..n {
        for j in i + 1..n {
            let neighbours = j == i + 1 || (i == 0 && j == n - 1);
            if !neighbours && cross(pairs[i], pairs[j]) {
                return Some(format!("side {} crosses side {}", i + 1, j + 1));
            }
        }
    }
    (area(vertices) == 0.0).then(|| "an outline without area".to_string())
}

fn closed_pairs(vertices: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().copied().zip(next.copied())
}

fn area(vertices: &[DVec2]) -> f64 {
    0.5 * closed_pairs(vertices)
        .map(|(a, b)| a.perp_dot(b))
        .sum::<f64>()
}

fn cross(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> bool {
    let side = |(p, q): (DVec2, DVec2), x: DVec2| (q - p).perp_dot(x - p);
    side(a, b.0) * side(a, b.1) <= 0.0 && side(b, a.0) * side(b, a.1) <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn l_shape() -> Outline {
        let corners = [[0., 0.], [4., 0.], [4., 1.], [1., 1.], [1., 3.], [0., 3.]];
        Outline::new(&corners.map(DVec2::from), |_, _| true)
    }

    #[test]
    fn the_tangent_disc_touches_the_outline_and_stays_inside() {
        let outline = l_shape();
        for (index, edge) in outline.edges.iter().enumerate() {
            for k in 1..50 {
                let foot = edge.point(edge.length * f64::from(k) / 50.0);
                let radius = outline.tangent_radius(index, foot);
                let center = foot + radius * edge.inward;
                assert!(
                    (outline.distance(center) + radius).abs() < 1e-12,
                    "edge {index}, step {k}: radius {radius}"
                );
                let larger = foot + 1.001 * radius * edge.inward;
                assert!(outline.distance(larger) > -1.001 * radius + 1e-6 * radius);
            }
        }
    }

    #[test]
    fn both_walking_directions_give_the_same_distance() {
        let outline = l_shape();
        let mut backwards = outline.vertices().to_vec();
        backwards.reverse();
        let reversed = Outline::new(&backwards, |_, _| true);
        for k in 0..400 {
            let point = DVec2::new(0.3 * f64::from(k % 20) - 1.0, 0.3 * f64::from(k / 20) - 1.0);
            assert_eq!(outline.distance(point), reversed.distance(point));
        }
    }

    #[test]
    fn a_bow_tie_is_not_a_polygon() {
        let bow = [[0., 0.], [1., 1.], [1., 0.], [0., 1.]].map(DVec2::from);
        assert_eq!(polygon_fault(&bow, 1e-9).unwrap(), "side 1 crosses side 3");
        assert!(polygon_fault(l_shape().vertices(), 1e-9).is_none());
    }
}
