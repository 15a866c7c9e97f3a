//! A box, sharp or with rounded edges: its distance, its surface, its spheres.

use super::Sphere;
use super::pack::MAX_SPHERES;
use glam::DVec3;

/// An axis-aligned box about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// Half of each edge length.
    pub half: DVec3,
    /// Radius of its edges and corners, zero to the smallest half.
    pub rounding: f64,
}

impl Block {
    pub fn distance(&self, point: DVec3) -> f64 {
        let beyond = point.abs() - (self.half - DVec3::splat(self.rounding));
        let outside = beyond.max(DVec3::ZERO).length();
        outside + beyond.max_element().min(0.0) - self.rounding
    }

    /// Largest p·direction over the box.
    pub fn support(&self, direction: DVec3) -> f64 {
        let core = self.half - DVec3::splat(self.rounding);
        core.dot(direction.abs()) + self.rounding * direction.length()
    }

    /// Corner balls, a row along each edge, then on each face rows that widen towards its middle.
    ///
    /// A ball of tangent radius r, inflated by e, covers a flat face to 2·sqrt(e(r + e)) around its foot: a square cell of
    /// half side sqrt(2e(r + e)).
    pub fn pack(&self, tolerance: f64, spheres: &mut Vec<Sphere>) {
        let edge = EdgeRow::new(self, tolerance);
        self.pack_corners(&edge, tolerance, spheres);
        for axis in 0..3 {
            self.pack_edges(axis, &edge, tolerance, spheres);
            Face::new(self, axis).pack(edge.width, tolerance, spheres);
        }
    }

    fn pack_corners(&self, edge: &EdgeRow, e: f64, spheres: &mut Vec<Sphere>) {
        let inner = self.half - DVec3::splat(edge.radius);
        for x in both_signs(inner.x) {
            for y in both_signs(inner.y) {
                for z in both_signs(inner.z) {
                    spheres.push(Sphere {
                        center: DVec3::new(x, y, z),
                        radius: edge.radius + e,
                    });
                }
            }
        }
    }

    fn pack_edges(&self, axis: usize, edge: &EdgeRow, e: f64, spheres: &mut Vec<Sphere>) {
        let inner = self.half - DVec3::splat(edge.radius);
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        for along in cells(self.half[axis] - edge.width, edge.half_spacing) {
            for y in both_signs(inner[b]) {
                for z in both_signs(inner[c]) {
                    let mut center = DVec3::ZERO;
                    center[axis] = along;
                    center[b] = y;
                    center[c] = z;
                    spheres.push(Sphere {
                        center,
                        radius: edge.radius + e,
                    });
                }
            }
        }
    }

    pub fn surface_points(&self, spacing: f64, points: &mut Vec<DVec3>) {
        let n = (2.0 * self.half / spacing).ceil().max(DVec3::splat(4.0));
        let at = |axis: usize, i: usize| self.half[axis] * (2.0 * i as f64 / n[axis] - 1.0);
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for i in 0..=n[b] as usize {
                for j in 0..=n[c] as usize {
                    for side in [-1.0, 1.0] {
                        let mut point = DVec3::ZERO;
                        point[axis] = side * self.half[axis];
                        point[b] = at(b, i);
                        point[c] = at(c, j);
                        points.push(self.onto_surface(point));
                    }
                }
            }
        }
    }

    /// From a point of the sharp box to the nearest point of the rounded one.
    fn onto_surface(&self, point: DVec3) -> DVec3 {
        let core = self.half - DVec3::splat(self.rounding);
        let nearest = point.clamp(-core, core);
        let out = point - nearest;
        if out == DVec3::ZERO {
            return point;
        }
        nearest + self.rounding * out.normalize()
    }
}

/// The balls along the edges and in the corners of a box.
struct EdgeRow {
    /// Tangent radius; the centres lie this far inside both faces.
    radius: f64,
    /// How far from the edge the row covers each face.
    width: f64,
    /// Half the distance between balls along the edge.
    half_spacing: f64,
}

impl EdgeRow {
    /// At a sharp edge r = 2e covers the most: the edge to 2·sqrt(2)·e each way (2r² + y² ≤ (r + 2e)²), the faces to 4e.
    fn new(block: &Block, e: f64) -> Self {
        if block.rounding >= 2.0 * e {
            let radius = block.rounding;
            let half_spacing = (2.0 * e * (radius + e)).sqrt();
            return Self {
                radius,
                width: radius + half_spacing,
                half_spacing,
            };
        }
        let radius = (2.0 * e).min(block.half.min_element());
        Self {
            radius,
            width: 2.0 * radius,
            half_spacing: ((radius + 2.0 * e).powi(2) - 2.0 * radius * radius).sqrt(),
        }
    }
}

/// The two faces of a box across one axis.
struct Face {
    axis: usize,
    /// Half of the box along the axis: no ball is larger.
    depth: f64,
    /// Half sides of the face.
    half: [f64; 2],
}

impl Face {
    fn new(block: &Block, axis: usize) -> Self {
        Self {
            axis,
            depth: block.half[axis],
            half: [block.half[(axis + 1) % 3], block.half[(axis + 2) % 3]],
        }
    }

    /// Rectangular rows from the border inwards; a plain grid once balls are as large as the box is thick, or when
    /// less than two rows are left. `covered` is the width of the border that the edges' rows cover.
    fn pack(&self, mut covered: f64, e: f64, spheres: &mut Vec<Sphere>) {
        loop {
            let left = self.half.map(|h| h - covered);
            if left[0] <= 0.0 || left[1] <= 0.0 || spheres.len() > MAX_SPHERES {
                return;
            }
            // The row whose balls touch the side faces: inset = covered + sqrt(2e(inset + e)).
            let inset = covered + e + (2.0 * covered * e + 3.0 * e * e).sqrt();
            let cell = inset - covered;
            if inset >= self.depth || left[0] <= cell || left[1] <= cell {
                return self.pack_grid(covered, left, e, spheres);
            }
            let inner = self.half.map(|h| h - inset);
            let sides = left.map(|l| cells(l - 2.0 * cell, cell));
            for x in both_signs(inner[0]) {
                for y in both_signs(inner[1]) {
                    self.push([x, y], inset, e, spheres);
                }
                for &y in &sides[1] {
                    self.push([x, y], inset, e, spheres);
                }
            }
            for &x in &sides[0] {
                for y in both_signs(inner[1]) {
                    self.push([x, y], inset, e, spheres);
                }
            }
            covered += 2.0 * cell;
        }
    }

    /// Equal cells, as many as the outermost and so smallest balls need.
    fn pack_grid(&self, covered: f64, left: [f64; 2], e: f64, spheres: &mut Vec<Sphere>) {
        let largest = (2.0 * e * (self.depth + e)).sqrt();
        let mut counts = left.map(|l| (l / largest).ceil());
        let cell = loop {
            let cell = [left[0] / counts[0], left[1] / counts[1]];
            let radius = self.depth.min(covered + cell[0].min(cell[1]));
            if cell[0].powi(2) + cell[1].powi(2) <= 4.0 * e * (radius + e) {
                break cell;
            }
            counts[usize::from(cell[1] > cell[0])] += 1.0;
        };
        for x in cells(left[0], cell[0]) {
            for y in cells(left[1], cell[1]) {
                let inset = (self.half[0] - x.abs()).min(self.half[1] - y.abs());
                self.push([x, y], inset.min(self.depth), e, spheres);
            }
            if spheres.len() > MAX_SPHERES {
                return;
            }
        }
    }

    fn push(&self, [x, y]: [f64; 2], radius: f64, e: f64, spheres: &mut Vec<Sphere>) {
        for height in both_signs(self.depth - radius) {
            let mut center = DVec3::ZERO;
            center[self.axis] = height;
            center[(self.axis + 1) % 3] = x;
            center[(self.axis + 2) % 3] = y;
            spheres.push(Sphere {
                center,
                radius: radius + e,
            });
        }
    }
}

/// Middles of the equal cells, no wider than 2 × `largest_half`, that cover −half … half; none for half ≤ 0.
fn cells(half: f64, largest_half: f64) -> Vec<f64> {
    // Less than a billionth of a cell is rounding, not a missing cell.
    let n = (half / largest_half - 1e-9).ceil().max(0.0);
    (0..n as usize)
        .take(MAX_SPHERES + 1)
        .map(|i| half * ((2.0 * i as f64 + 1.0) / n - 1.0))
        .collect()
}

/// `x` and `−x`, or one zero.
fn both_signs(x: f64) -> impl Iterator<Item = f64> {
    let second = (x != 0.0).then_some(-x);
    std::iter::once(x).chain(second)
}
