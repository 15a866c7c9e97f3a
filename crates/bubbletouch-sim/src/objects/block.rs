//! Box with sharp or rounded edges: distance, surface and packing.

use super::Sphere;
use super::fit::{Fit, MAX_SPHERES};
use super::solid::Form;
use super::surface_patch::{SurfacePatch, frame};
use crate::geometry::Pose;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Axis-aligned box about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// Half of the edge lengths of the box, metres.
    pub half: DVec3,
    /// Radius of edges and corners, from zero to the smallest half edge length, metres.
    pub rounding: f64,
}

impl Form for Block {
    fn distance(&self, point: DVec3) -> f64 {
        let beyond = point.abs() - (self.half - DVec3::splat(self.rounding));
        let outside = beyond.max(DVec3::ZERO).length();
        outside + beyond.max_element().min(0.0) - self.rounding
    }

    fn support(&self, direction: DVec3) -> f64 {
        let core = self.half - DVec3::splat(self.rounding);
        core.dot(direction.abs()) + self.rounding * direction.length()
    }

    fn volume_and_center(&self) -> (f64, DVec3) {
        let (r, core) = (self.rounding, 2.0 * (self.half - self.rounding));
        let faces = core.x * core.y + core.y * core.z + core.z * core.x;
        let edges = core.element_sum();
        let volume = core.element_product() + 2.0 * r * faces + PI * r * r * edges;
        (volume + 4.0 / 3.0 * PI * r.powi(3), DVec3::ZERO)
    }

    /// Packs the box with spheres: first the corners, then rows along each edge, then rows on each face. The spacing of the rows on a face increases towards
    /// its middle.
    ///
    /// A ball of radius r that touches a flat face covers, after its enlargement, a disc of radius sqrt(h(2r + h)). Here h is the sum of both tolerances.
    /// This disc contains a square cell of half side sqrt(h(r + h/2)).
    fn pack(&self, fit: Fit, spheres: &mut Vec<Sphere>) {
        let edge = EdgeRow::new(self, fit);
        self.pack_corners(&edge, fit, spheres);
        for axis in 0..3 {
            self.pack_edges(axis, &edge, fit, spheres);
            Face::new(self, axis).pack(edge.width, fit, spheres);
        }
    }

    /// Returns six faces and, if the box is rounded, twelve edges and eight corners.
    fn patches(&self) -> Vec<SurfacePatch> {
        const SIGNS: [f64; 2] = [-1.0, 1.0];
        let core = self.half - DVec3::splat(self.rounding);
        let mut patches = Vec::new();
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let [up, right, ahead] = [axis, b, c].map(|k| DVec3::AXES[k]);
            for sign in SIGNS {
                let origin = sign * self.half[axis] * up;
                let half = DVec2::new(core[b], core[c]);
                patches.push(SurfacePatch::flat(origin, [right, sign * ahead], half));
            }
            if self.rounding == 0.0 {
                continue;
            }
            let line = [-core[axis], core[axis]].map(|z| DVec2::new(self.rounding, z));
            let angles = [0.0, std::f64::consts::FRAC_PI_2];
            for (y, z) in SIGNS.into_iter().flat_map(|y| SIGNS.map(|z| (y, z))) {
                let at = y * core[b] * right + z * core[c] * ahead;
                let pose = Pose::new(frame(y * right, z * ahead), at);
                if core[axis] > 0.0 {
                    patches.push(SurfacePatch::turned(line[0], line[1], angles).moved(&pose));
                }
                if axis == 2 {
                    patches.extend(SIGNS.map(|up| {
                        let sides = DVec3::new(y, z, up);
                        SurfacePatch::eighth_of_ball(sides * core, self.rounding, sides)
                    }));
                }
            }
        }
        patches
    }
}

impl Block {
    fn pack_corners(&self, edge: &EdgeRow, fit: Fit, spheres: &mut Vec<Sphere>) {
        let inner = self.half - DVec3::splat(edge.radius);
        // A round corner is the ball itself.
        let corner = if edge.is_round { fit.unswollen() } else { fit };
        for x in both_signs(inner.x) {
            for y in both_signs(inner.y) {
                for z in both_signs(inner.z) {
                    spheres.push(corner.swollen(DVec3::new(x, y, z), edge.radius));
                }
            }
        }
    }

    fn pack_edges(&self, axis: usize, edge: &EdgeRow, fit: Fit, spheres: &mut Vec<Sphere>) {
        let inner = self.half - DVec3::splat(edge.radius);
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        for along in cells(self.half[axis] - edge.corner, edge.half_spacing) {
            for y in both_signs(inner[b]) {
                for z in both_signs(inner[c]) {
                    spheres.push(fit.swollen(from_axis(axis, [along, y, z]), edge.radius));
                }
            }
        }
    }
}

/// Row of balls along an edge of a box, with the balls in its corners.
struct EdgeRow {
    /// Radius of the balls before enlargement, metres; their centres lie at this distance inside both faces.
    radius: f64,
    /// Whether the edge is round, so that the balls fill it.
    is_round: bool,
    /// Width of the strip that the row covers on each adjacent face, from the edge, metres.
    width: f64,
    /// Length along the edge that the ball in the corner covers, metres.
    corner: f64,
    /// Half the distance between balls along the edge, metres.
    half_spacing: f64,
}

/// Fraction of its squared disc radius that a ball in a round edge uses to cover the faces. The ball covers the edge with the remaining fraction. If smaller,
/// the faces need more spheres; if larger, the edge needs more spheres and protrudes.
const ACROSS: f64 = 0.1;

impl EdgeRow {
    /// Computes the radius and the spacing of the balls along an edge. At a sharp edge r = h covers the most: √2·h in either direction along the edge (2r² +
    /// y² ≤ (r + h)²), and 2h on the faces.
    fn new(block: &Block, fit: Fit) -> Self {
        let h = fit.reach();
        if block.rounding >= h {
            let radius = block.rounding;
            // Most of the reach of a ball is used along the edge, and little across the adjacent faces. This needs fewer balls, and the edge
            // itself is equally often below and above the spheres.
            let square = fit.disc_squared(radius);
            let across = ACROSS * square;
            // Without enlargement, the ball in the corner covers less of the strip's border.
            let corner = (fit.unswollen().disc_squared(radius) - across).sqrt();
            return Self {
                radius,
                is_round: true,
                width: radius + across.sqrt(),
                corner: radius + corner,
                half_spacing: (square - across).sqrt(),
            };
        }
        let radius = h.min(block.half.min_element());
        Self {
            radius,
            is_round: false,
            width: 2.0 * radius,
            corner: 2.0 * radius,
            half_spacing: ((radius + h).powi(2) - 2.0 * radius * radius).sqrt(),
        }
    }
}

/// Pair of opposite faces of a box.
struct Face {
    axis: usize,
    /// Half the thickness of the box between the two faces, metres, which limits the radius of a ball.
    depth: f64,
    /// Half side lengths of the face, metres.
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

    /// Places balls in rectangular rows from the border of the face inwards. A plain grid is used if balls are as large as the box is thick, or if fewer than
    /// two rows remain. `covered` is the width of the border that the rows along the edges cover, metres.
    fn pack(&self, mut covered: f64, fit: Fit, spheres: &mut Vec<Sphere>) {
        let h = fit.reach();
        loop {
            let left = self.half.map(|h| h - covered);
            if left[0] <= 0.0 || left[1] <= 0.0 || spheres.len() > MAX_SPHERES {
                return;
            }
            // Inset of the row whose balls touch the side faces: inset = covered + sqrt(h(inset + h/2)).
            let inset = covered + 0.5 * h + (covered * h + 0.75 * h * h).sqrt();
            let cell = inset - covered;
            if inset >= self.depth || left[0] <= cell || left[1] <= cell {
                return self.pack_grid(covered, left, fit, spheres);
            }
            let inner = self.half.map(|h| h - inset);
            let sides = left.map(|l| cells(l - 2.0 * cell, cell));
            for x in both_signs(inner[0]) {
                for y in both_signs(inner[1]) {
                    self.push([x, y], inset, fit, spheres);
                }
                for &y in &sides[1] {
                    self.push([x, y], inset, fit, spheres);
                }
            }
            for &x in &sides[0] {
                for y in both_signs(inner[1]) {
                    self.push([x, y], inset, fit, spheres);
                }
            }
            covered += 2.0 * cell;
        }
    }

    /// Places balls on a grid of equal cells in the middle of the face, inside a border of width `covered` (metres). `left` contains the half sides of the
    /// grid, metres. The smallest balls, which are the outermost, determine the number of cells.
    fn pack_grid(&self, covered: f64, left: [f64; 2], fit: Fit, spheres: &mut Vec<Sphere>) {
        let largest = (0.5 * fit.disc_squared(self.depth)).sqrt();
        let mut counts = left.map(|l| (l / largest).ceil());
        let cell = loop {
            let cell = [left[0] / counts[0], left[1] / counts[1]];
            let radius = self.depth.min(covered + cell[0].min(cell[1]));
            if cell[0].powi(2) + cell[1].powi(2) <= fit.disc_squared(radius) {
                break cell;
            }
            counts[usize::from(cell[1] > cell[0])] += 1.0;
        };
        for x in cells(left[0], cell[0]) {
            for y in cells(left[1], cell[1]) {
                let inset = (self.half[0] - x.abs()).min(self.half[1] - y.abs());
                self.push([x, y], inset.min(self.depth), fit, spheres);
            }
            if spheres.len() > MAX_SPHERES {
                return;
            }
        }
    }

    fn push(&self, [x, y]: [f64; 2], radius: f64, fit: Fit, spheres: &mut Vec<Sphere>) {
        for height in both_signs(self.depth - radius) {
            spheres.push(fit.swollen(from_axis(self.axis, [height, x, y]), radius));
        }
    }
}

/// Returns the centres of equal cells that cover the interval from −half to half and are no wider than 2 × `largest_half`; none if half ≤ 0.
fn cells(half: f64, largest_half: f64) -> Vec<f64> {
    // A remainder below a billionth of a cell is a rounding error, not a missing cell.
    let n = (half / largest_half - 1e-9).ceil().max(0.0);
    (0..n as usize)
        .take(MAX_SPHERES + 1)
        .map(|i| half * ((2.0 * i as f64 + 1.0) / n - 1.0))
        .collect()
}

/// Returns the point with the given coordinates along an axis and the two axes that follow cyclically.
fn from_axis(axis: usize, [a, b, c]: [f64; 3]) -> DVec3 {
    let coordinates = [[a, b, c], [c, a, b], [b, c, a]];
    DVec3::from_array(coordinates[axis])
}

/// Returns `x` and `−x`, or a single zero if `x` is zero.
fn both_signs(x: f64) -> impl Iterator<Item = f64> {
    let second = (x != 0.0).then_some(-x);
    std::iter::once(x).chain(second)
}
