//! Contact of pairs of a taxel and a triangle, many pairs at once in vectors of double precision.
//!
//! The formulas are in [`triangle`](crate::contact::law::triangle). The numbers of the pairs are stored in columns. The loops over pairs have no branches, and the compiler converts them to vector instructions.

use super::lines::GridLines;
use crate::contact::lanes::least;
use crate::contact::law::triangle::{SweptEdge, SweptFace};
use crate::contact::object_at::ObjectAt;
use crate::objects::mesh_blocks::ContactTriangle;
use glam::{DVec2, DVec3};

/// Maximum number of pairs in a batch. If larger, more pairs are evaluated whose taxels are already stopped below; if smaller, vectors are used less well.
pub(super) const PAIRS: usize = 32;
/// Number of f64 values in the widest vectors.
const WIDTH: usize = 8;
/// One number for each pair.
pub(super) type Column = [f64; PAIRS];
type Vectors = [Column; 3];

/// Bit of [`FacePairs::parts`] for triangles that may be behind the substrates of their taxels.
pub(super) const MAY_BE_BEHIND: u64 = 1 << 6;

/// Taxel and a triangle that may stop it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    /// Index of the triangle in the order of the blocks.
    pub triangle: u32,
    /// Index of the taxel, and its row and column.
    pub taxel: u32,
    pub row: u32,
    pub column: u32,
    /// Lower bound of the height at which the triangle stops the taxel, metres.
    pub low: f32,
}

/// List of pairs to which pairs are added without branches, because the processor cannot predict them.
#[derive(Clone, Debug, Default)]
pub(super) struct PairList {
    /// Pairs of the list, and memory for more pairs.
    pub pairs: Vec<Pair>,
    pub n: usize,
}

impl PairList {
    /// Allocates memory for `n` more pairs.
    #[inline(always)]
    pub fn reserve(&mut self, n: usize) {
        if self.pairs.len() < self.n + n {
            self.pairs.resize(2 * (self.n + n), Pair::default());
        }
    }

    /// Adds a pair if `is_wanted`; memory for the pair must be reserved.
    #[inline(always)]
    pub fn add(&mut self, pair: Pair, is_wanted: bool) {
        self.pairs[self.n] = pair;
        self.n += usize::from(is_wanted);
    }
}

/// Pairs of taxels and triangles, whose faces are evaluated first.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(super) struct FacePairs {
    x: Column,
    y: Column,
    /// Heights at which taxels are stopped by triangles evaluated before, metres.
    limit: Column,
    corners: [Vectors; 3],
    normal: Vectors,
    spread: Column,
    side_spread: Vectors,
    /// Bits of the edges and corners of the triangles; after the evaluation, only of the edges and corners that may stop the taxels, and [`MAY_BE_BEHIND`].
    pub parts: [u64; PAIRS],
    /// Heights at which the faces stop the taxels, metres; infinite if the face does not stop the taxel.
    pub heights: Column,
    pub pairs: [Pair; PAIRS],
    pub n: usize,
}

impl FacePairs {
    /// Adds a pair if `is_wanted`, without a branch, because the processor cannot predict it.
    #[inline(always)]
    pub fn add(&mut self, pair: Pair, is_wanted: bool) {
        self.pairs[self.n % PAIRS] = pair;
        self.n += usize::from(is_wanted);
    }

    /// Copies the numbers of all pairs into columns. Reading many triangles one after the other hides the latency of memory.
    #[inline(always)]
    fn read(&mut self, triangles: &[ContactTriangle], lines: &GridLines, heights: &[f64]) {
        for lane in 0..self.n.min(PAIRS) {
            let pair = self.pairs[lane];
            let triangle = &triangles[pair.triangle as usize];
            let face = &triangle.face;
            for k in 0..3 {
                set(&mut self.corners[k], lane, triangle.corners[k]);
                self.side_spread[k][lane] = f64::from(face.side_spread[k]);
            }
            set(&mut self.normal, lane, face.normal);
            self.spread[lane] = face.spread;
            self.parts[lane] = u64::from(face.parts);
            self.x[lane] = lines.x.positions[pair.column as usize];
            self.y[lane] = lines.y.positions[pair.row as usize];
            self.limit[lane] = heights[pair.taxel as usize];
        }
    }

    /// Evaluates the faces of pairs whose taxels are certainly under the faces.
    #[inline(always)]
    pub fn evaluate_under(
        &mut self,
        (triangles, object): (&[ContactTriangle], &ObjectAt),
        lines: &GridLines,
    ) {
        for lane in 0..self.n.min(PAIRS) {
            let pair = self.pairs[lane];
            let triangle = &triangles[pair.triangle as usize];
            set(&mut self.corners[0], lane, triangle.corners[0]);
            set(&mut self.normal, lane, triangle.face.normal);
            self.x[lane] = lines.x.positions[pair.column as usize];
            self.y[lane] = lines.y.positions[pair.row as usize];
        }
        let n = self.n.next_multiple_of(WIDTH).min(PAIRS);
        for lane in 0..n {
            let corner = object.place(get(&self.corners[0], lane));
            let normal = object.turn(get(&self.normal, lane));
            let at = DVec2::new(self.x[lane], self.y[lane]);
            let face = SweptFace::new(&[corner; 3], normal, object.reach);
            self.heights[lane] = face.height(at);
        }
    }

    /// Evaluates the faces of all pairs. If a taxel is under the face, no edge or corner is lower. Otherwise edges and corners that have the taxel on their outer
    /// side remain in `parts`.
    ///
    /// Faces extend by `slack` metres beyond their sides. Bounds are enlarged by `slack`, far more than rounding errors. Triangles that reach below the height
    /// `behind` minus the radius, metres, may be behind substrates.
    #[inline(always)]
    pub fn evaluate(
        &mut self,
        (triangles, object): (&[ContactTriangle], &ObjectAt),
        (lines, heights): (&GridLines, &[f64]),
        (slack, behind): (f64, f64),
    ) {
        self.read(triangles, lines, heights);
        let n = self.n.next_multiple_of(WIDTH).min(PAIRS);
        let reach = object.reach;
        for lane in 0..n {
            let [a, b, c] = &self.corners;
            let (a, b) = (object.place(get(a, lane)), object.place(get(b, lane)));
            let c = object.place(get(c, lane));
            let normal = object.turn(get(&self.normal, lane));
            let at = DVec2::new(self.x[lane], self.y[lane]);
            let face = SweptFace::new(&[a, b, c], normal, reach);
            let is_steep = face.is_steep();
            let slope = face.sign * normal.z;
            let is_certain = slope > self.spread[lane] + 1e-6;
            let (mut is_near, mut outside) = (true, 0);
            for k in 0..3 {
                let [side, length] = face.side(k, at);
                // Distance beyond the side at which the taxel touches neither the side nor its corners.
                let side_spread = if is_certain {
                    self.side_spread[k][lane]
                } else {
                    2.0
                };
                is_near &= side >= -(reach * side_spread + slack) * length;
                outside |= u64::from((side < -slack * length) | is_steep) << k;
            }
            // Corner k is the end of side k − 1.
            let corners = (outside | (outside << 1) | (outside >> 2)) & 7;
            let beside = outside | (corners << 3);

            let lowest = least(least(a.z, b.z), c.z);
            let height = face.height(at);
            // No contact with the triangle is below the plane of the face, moved down by the radius.
            let is_lower = height - slack / slope < self.limit[lane];
            let is_wanted = (is_near & is_lower) | is_steep;
            let is_behind = lowest - reach < behind;
            let parts = if is_wanted {
                self.parts[lane] & beside
            } else {
                0
            };
            self.parts[lane] = if is_behind { MAY_BE_BEHIND } else { parts };
            let is_under = (outside == 0) & !is_behind;
            self.heights[lane] = if is_under { height } else { f64::INFINITY };
        }
    }
}

/// Pairs of taxels and edges of triangles.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(super) struct EdgePairs {
    x: Column,
    y: Column,
    ends: [Vectors; 2],
    normals: [Vectors; 2],
    /// Heights at which the edges stop the taxels, metres; infinite if an edge does not stop its taxel.
    pub heights: Column,
    pub pairs: [Pair; PAIRS],
    pub n: usize,
}

impl EdgePairs {
    /// Adds the side `side` of a triangle for the taxel of a pair at the position `at`.
    #[inline(always)]
    pub fn add(&mut self, pair: Pair, at: DVec2, (triangle, side): (&ContactTriangle, usize)) {
        let lane = self.n % PAIRS;
        self.pairs[lane] = pair;
        (self.x[lane], self.y[lane]) = (at.x, at.y);
        set(&mut self.ends[0], lane, triangle.corners[side]);
        set(&mut self.ends[1], lane, triangle.corners[(side + 1) % 3]);
        set(&mut self.normals[0], lane, triangle.face.normal);
        set(&mut self.normals[1], lane, triangle.face.across[side]);
        self.n += 1;
    }

    /// Evaluates all pairs.
    #[inline(always)]
    pub fn evaluate(&mut self, object: &ObjectAt) {
        let n = self.n.next_multiple_of(WIDTH).min(PAIRS);
        for lane in 0..n {
            let from = object.place(get(&self.ends[0], lane));
            let to = object.place(get(&self.ends[1], lane));
            let normals = [
                object.turn(get(&self.normals[0], lane)),
                object.turn(get(&self.normals[1], lane)),
            ];
            let edge = SweptEdge::new(from, to, object.reach, &normals);
            self.heights[lane] = edge.height(DVec2::new(self.x[lane], self.y[lane]));
        }
    }
}

#[inline(always)]
fn set([x, y, z]: &mut Vectors, lane: usize, vector: DVec3) {
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
}

#[inline(always)]
fn get([x, y, z]: &Vectors, lane: usize) -> DVec3 {
    DVec3::new(x[lane], y[lane], z[lane])
}
