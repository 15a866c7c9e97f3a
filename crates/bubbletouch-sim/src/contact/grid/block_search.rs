//! Bounds, in vectors of single precision, of the places on a grid where the triangles of a mesh can stop taxels.
//!
//! If a triangle stops a taxel of radius ρ, the centre of the taxel is at p + ρ d. The point p is on the triangle, and d is a direction of contact
//! ([`mesh_blocks`](crate::objects::mesh_blocks)). The taxel comes from below, so d points down. Normals that certainly point down, or up, determine the side
//! of the surface. If the side is not certain, d is any unit vector.
//!
//! Each function has one loop over the lanes without branches, whose long body is not unrolled. The compiler converts such loops to vector instructions.
//!
//! All bounds are enlarged by `slack`, far more than the rounding of single precision, so they never exclude a contact.

use super::lines::{GridLines, Lines};
use super::pair_batch::Pair;
use crate::contact::lanes::{least, most};
use crate::contact::mesh::directions::{Directions, SINGLE_ROUNDING, half_shadow};
use crate::contact::object_at::ObjectAt;
use crate::objects::mesh_blocks::{
    ALL_SIDES, Block, BlockNode, INNER_SIDES, LANES, Lane, MeshBlocks, OUTER_SIDES, STACK, vector,
};
use glam::{BVec3, Mat3, Vec3};
use std::ops::Range;

/// Transform of a mesh to the frame of a grid, and the limits of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockSearch {
    rotation: Mat3,
    /// Centre of the mesh in the frame of the grid, metres.
    center: Vec3,
    /// Sum of a taxel's radius and the rounding of the mesh, metres.
    reach: f32,
    /// Height of the substrate, metres; −∞ if triangles count at any height.
    behind: f32,
    slack: f32,
    columns: LaneLines,
    rows_of_taxels: LaneLines,
}

/// Places of the lines of a grid in single precision.
#[derive(Clone, Copy, Debug)]
struct LaneLines {
    first: f32,
    /// Lines per metre.
    density: f32,
    /// Distance between lines, metres.
    pitch: f32,
    n: f32,
}

impl LaneLines {
    fn new(lines: &Lines) -> Self {
        Self {
            first: lines.positions.first().copied().unwrap_or(0.0) as f32,
            density: lines.density() as f32,
            pitch: lines.density().recip() as f32,
            n: lines.positions.len() as f32,
        }
    }

    /// Returns the first line at or above `low` and the line after the last line at or below `high`. The results are whole numbers, rounded outwards up to the
    /// slack of the bounds.
    #[inline(always)]
    fn between(&self, low: f32, high: f32) -> [f32; 2] {
        let line = |place: f32| {
            let line = (place - self.first) * self.density + 0.5;
            nearest_whole(least(most(line, 0.0), self.n))
        };
        [line(low), line(high)]
    }

    /// Returns the place of a line, metres.
    #[inline(always)]
    fn at(&self, line: f32) -> f32 {
        self.first + line * self.pitch
    }
}

/// Bit of a triangle whose parts may all stop taxels at any place.
const ANY_PART: u32 = 1 << 3;

/// Number 2²³, from which numbers in single precision have no fractions.
const WHOLE: f32 = 8_388_608.0;

/// Rounds a number from 0 to 2²² to the nearest whole number. Unlike `f32::round`, the function takes two vector instructions on any processor.
#[inline(always)]
fn nearest_whole(number: f32) -> f32 {
    (number + WHOLE) - WHOLE
}

/// Converts a whole number from 0 to 2²² to an integer.
#[inline(always)]
fn integer(number: f32) -> u32 {
    (number + WHOLE).to_bits() & 0x7f_ffff
}

/// Taxels that the triangles of each lane may stop, and a lower bound of their heights.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Candidates {
    /// First column, and the column after the last; whole numbers.
    columns: [Lane; 2],
    rows: [Lane; 2],
    /// Lower bounds of the heights at which taxels are stopped, metres.
    pub low: Lane,
    /// One bit for each lane with candidates.
    pub lanes: u32,
    /// One bit for each lane whose triangles may lie behind the substrates of taxels.
    pub behind: u32,
}

impl Candidates {
    const NONE: Self = Self {
        columns: [[0.0; LANES]; 2],
        rows: [[0.0; LANES]; 2],
        low: [0.0; LANES],
        lanes: 0,
        behind: 0,
    };

    /// Returns the columns and the rows of the candidates in a lane.
    #[inline(always)]
    pub fn rectangle(&self, lane: usize) -> [Range<usize>; 2] {
        let range =
            |[first, last]: &[Lane; 2]| first[lane] as u32 as usize..last[lane] as u32 as usize;
        [range(&self.columns), range(&self.rows)]
    }
}

/// Triangles of a block in the frame of the grid.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct PlacedBlock {
    /// Candidates of the triangles. Lanes with few candidates are omitted from `lanes`.
    pub candidates: Candidates,
    /// Largest number of candidates among the triangles with few candidates.
    pub n_few: u32,
    /// Column and row of the candidate that is tested next.
    next: [Lane; 2],
    /// Row after the last candidate of triangles with few candidates; zero for other triangles.
    end: Lane,
    /// Corners, metres.
    corners: [[Lane; 3]; 3],
    /// Vector (x, y) by which the face is moved, metres: the radius along the normal that points down; zero if the triangle is steep.
    moved: [Lane; 2],
    /// −1 if the triangle is clockwise seen from above, otherwise 1.
    sign: Lane,
    /// Bits of the sides beyond which the triangle may stop taxels, or [`ANY_PART`].
    sides: [u32; LANES],
    /// Distance beside the moved triangle, metres, from which taxels are not stopped.
    wide: Lane,
    /// Height at which the plane of the face stops a taxel at the first corner of the moved triangle, metres, and its slope along x and y.
    height: Lane,
    slope: [Lane; 2],
    /// Distances of the lower and the upper bound of a taxel's height from this height, metres; infinite if the triangle is steep. The upper bound is valid for
    /// taxels under the face, and is infinite if the triangle may be behind the substrate.
    below: Lane,
    above: Lane,
}

/// One candidate of each triangle of a block.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Tested {
    pub columns: [u32; LANES],
    pub rows: [u32; LANES],
    pub taxels: [u32; LANES],
    pub x: Lane,
    pub y: Lane,
    /// Lower bounds of the heights at which the triangles stop the taxels, metres.
    pub low: Lane,
    /// Upper bounds of these heights, metres; infinite if a triangle may not stop the taxel.
    pub high: Lane,
    /// One bit for each triangle that may stop the taxel.
    pub lanes: u32,
    /// One bit for each triangle whose face certainly stops the taxel.
    pub faces: u32,
}

impl Tested {
    /// Returns the pair of the triangle in a lane and its taxel. The first triangle of the block has the index `first`.
    #[inline(always)]
    pub fn pair(&self, first: u32, lane: usize) -> Pair {
        Pair {
            triangle: first + lane as u32,
            taxel: self.taxels[lane],
            row: self.rows[lane],
            column: self.columns[lane],
            low: self.low[lane],
        }
    }
}

/// Pairs of taxels and triangles in the frame of the grid.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(super) struct PlacedPairs {
    /// Corners of the triangles, metres, and the vectors by which the faces are moved.
    corners: [[Lane; 3]; 3],
    moved: [Lane; 2],
    sign: Lane,
    /// Positions of the taxels, metres.
    x: Lane,
    y: Lane,
    /// Bounds of the heights at which the triangles stop the taxels, metres.
    pub low: Lane,
    pub high: Lane,
    pub pairs: [Pair; LANES],
    pub n: usize,
}

impl PlacedPairs {
    /// Adds the pair of the triangle in a lane of a block and its tested taxel if `is_wanted`, without a branch, because the processor cannot predict it.
    #[inline(always)]
    pub fn add(
        &mut self,
        (pair, is_wanted): (Pair, bool),
        (placed, tested): (&PlacedBlock, &Tested),
        lane: usize,
    ) {
        let to = self.n % LANES;
        for k in 0..3 {
            for axis in 0..3 {
                self.corners[k][axis][to] = placed.corners[k][axis][lane];
            }
        }
        self.moved[0][to] = placed.moved[0][lane];
        self.moved[1][to] = placed.moved[1][lane];
        self.sign[to] = placed.sign[lane];
        (self.x[to], self.y[to]) = (tested.x[lane], tested.y[lane]);
        self.low[to] = pair.low;
        self.pairs[to] = pair;
        self.n += usize::from(is_wanted);
    }
}

/// Bounds of the centres of taxels that the triangles of one lane stop.
struct Bounds {
    low: Vec3,
    high: Vec3,
    /// Highest point of the triangles, metres.
    top: f32,
    /// Height below which triangles count as behind the substrate, metres.
    back: f32,
}

/// Candidates of one lane.
struct Found {
    columns: [f32; 2],
    rows: [f32; 2],
    /// Whether there are candidates that the triangles of the lane may stop below the limit.
    is_wanted: bool,
    /// Whether triangles may lie behind the substrates of the candidates.
    is_behind: bool,
    /// Whether there is only one candidate.
    is_one: bool,
}

impl BlockSearch {
    pub fn new(blocks: &MeshBlocks, object: &ObjectAt, behind: f64, lines: &GridLines) -> Self {
        let (center, reach) = (object.place(blocks.center), object.reach);
        let last = |lines: &Lines| lines.positions.last().copied().unwrap_or(0.0);
        let length = blocks.radius + center.length() + reach + last(&lines.x) + last(&lines.y);
        Self {
            rotation: object.rotation.as_mat3(),
            center: center.as_vec3(),
            reach: reach as f32,
            behind: behind as f32,
            slack: (SINGLE_ROUNDING * length) as f32,
            columns: LaneLines::new(&lines.x),
            rows_of_taxels: LaneLines::new(&lines.y),
        }
    }

    /// Returns whether certainly no triangle of the mesh is behind the substrate.
    #[inline(always)]
    pub fn is_in_front(&self, blocks: &MeshBlocks) -> bool {
        let behind = self.behind + self.reach + 2.0 * self.slack;
        let up = self.rotation.row(2);
        let mut stack = [0_u32; STACK];
        let mut n_waiting = usize::from(behind > f32::NEG_INFINITY);
        while n_waiting > 0 {
            n_waiting -= 1;
            let node = &blocks.nodes[(stack[n_waiting] / 2) as usize];
            let mut lanes = 0;
            for lane in 0..LANES {
                let half = up.abs().dot(vector(&node.half, lane));
                let low = self.center.z + up.dot(vector(&node.center, lane)) - half;
                lanes |= u32::from(low < behind) << lane;
            }
            lanes &= node.used;
            while lanes != 0 {
                let child = node.children[lanes.trailing_zeros() as usize];
                lanes &= lanes - 1;
                if child % 2 == 1 {
                    return false;
                }
                stack[n_waiting] = child;
                n_waiting += 1;
            }
        }
        true
    }

    /// Returns the candidates of the children of a node below a limit, metres.
    #[inline(always)]
    pub fn node(&self, node: &BlockNode, limit: f32) -> Candidates {
        let Mat3 {
            x_axis,
            y_axis,
            z_axis,
        } = self.rotation;
        let (to_x, to_y) = (self.rotation.row(0), self.rotation.row(1));
        let up = self.rotation.row(2);
        let absolute = Mat3::from_cols(x_axis.abs(), y_axis.abs(), z_axis.abs());
        let mut candidates = Candidates::NONE;
        let (mut lanes, mut behind) = (0, 0);
        for lane in 0..LANES {
            let axis = self.rotation * vector(&node.axis, lane);
            let center = self.placed(vector(&node.center, lane));
            let own = vector(&node.half, lane);
            let half = absolute * own;
            let Directions {
                shift,
                both,
                spread,
                ..
            } = self.directions(axis.z, node.spread[lane], center.z - half.z);
            let middle = center + shift * axis;
            let wide = (both * axis.abs() + spread).min(Vec3::splat(self.reach));
            let wide = half + wide + self.slack;
            let (low, top) = (middle - wide, center.z + half.z);
            let bounds = Bounds {
                low,
                high: middle + wide,
                top,
                // Triangles that reach in front of the substrate are examined one by one.
                back: top + self.reach,
            };
            let found = self.find(&bounds, limit);
            // A single candidate may be beside the shadow of the bounding box, enlarged by `spread`. In the frame of the mesh, the direction of the line is the
            // third row of the rotation matrix.
            let x = self.columns.at(found.columns[0]) - middle.x;
            let y = self.rows_of_taxels.at(found.rows[0]) - middle.y;
            let gap = (to_x.cross(up) * x + to_y.cross(up) * y).abs() - half_shadow(own, up);
            let gap = most(most(gap.x, gap.y), gap.z);
            let spread = if both > 0.0 { self.reach } else { spread };
            let is_missed = found.is_one & (gap > spread + 2.0 * self.slack);
            for k in 0..2 {
                candidates.columns[k][lane] = found.columns[k];
                candidates.rows[k][lane] = found.rows[k];
            }
            candidates.low[lane] = low.z;
            lanes |= u32::from(found.is_wanted & !is_missed) << lane;
            behind |= u32::from(found.is_behind) << lane;
        }
        candidates.lanes = lanes & node.used;
        candidates.behind = behind & node.used;
        candidates
    }

    /// Places the triangles of a block, and finds their candidates below a limit, metres. Triangles with at most `few` candidates have few candidates.
    #[inline(always)]
    pub fn block(&self, block: &Block, (limit, few): (f32, u32), placed: &mut PlacedBlock) {
        let (mut lanes, mut behind, mut n_few) = (0, 0, 0);
        let [a, b, c] = &block.corners;
        for lane in 0..LANES {
            let normal = self.rotation * vector(&block.normal, lane);
            let a = self.placed(vector(a, lane));
            let b = self.placed(vector(b, lane));
            let c = self.placed(vector(c, lane));
            let (lowest, highest) = (a.min(b).min(c), a.max(b).max(c));
            let Directions {
                shift,
                both,
                spread,
                is_low,
            } = self.directions(normal.z, block.spread[lane], lowest.z);
            // No direction is longer than one.
            let far = self.reach + self.slack;
            let (moved, wide) = (shift * normal, both * normal.abs() + (spread + self.slack));
            let low = (lowest + moved - wide).max(lowest - far);
            let high = (highest + moved + wide).min(highest + far);
            let bounds = Bounds {
                low,
                high,
                top: highest.z,
                back: lowest.z,
            };
            let found = self.find(&bounds, limit);
            set(&mut placed.corners[0], lane, a);
            set(&mut placed.corners[1], lane, b);
            set(&mut placed.corners[2], lane, c);
            placed.sign[lane] = if normal.z > 0.0 { 1.0 } else { -1.0 };
            let is_certain = shift != 0.0;
            // A ball that touches the triangle at a point is at most as far from the plane of the triangle as from the point. Its centre is therefore not below
            // the plane moved down by the radius.
            let steepness = 1.0 / normal.z;
            let is_flat = normal.z.abs() > 1e-3;
            // Without certain directions, the distance from the moved triangle is at most the diameter of a taxel.
            let wide = if is_certain & is_flat {
                spread
            } else {
                2.0 * self.reach
            };
            placed.wide[lane] = wide + 2.0 * self.slack;
            placed.height[lane] = a.z - self.reach * normal.z.abs();
            let side = if normal.z < 0.0 {
                self.reach
            } else {
                -self.reach
            };
            for k in 0..2 {
                let slope = -normal[k] * steepness;
                placed.slope[k][lane] = if is_flat { slope } else { 0.0 };
                placed.moved[k][lane] = if is_flat { side * normal[k] } else { 0.0 };
            }
            // The plane is evaluated at most this far from the first corner. The rounding of the normal tilts the plane by up to 1e-6 |1/n_z|.
            let far = (high.x - low.x) + (high.y - low.y) + 4.0 * self.reach;
            let error = (4.0 * self.slack + 1e-6 * far * steepness.abs()) * steepness.abs();
            placed.below[lane] = if is_flat { error } else { f32::INFINITY };
            placed.above[lane] = if is_flat & !is_low {
                error
            } else {
                f32::INFINITY
            };
            let side = if normal.z < 0.0 {
                OUTER_SIDES
            } else {
                INNER_SIDES
            };
            let sides = block.sides[lane] >> if is_certain { side } else { ALL_SIDES };
            placed.sides[lane] = if is_flat & !is_low {
                sides & 7
            } else {
                ANY_PART
            };
            let n_columns = found.columns[1] - found.columns[0];
            let n_rows = found.rows[1] - found.rows[0];
            let n = integer(n_columns * n_rows);
            let has_few = found.is_wanted & (n <= few);
            placed.next[0][lane] = found.columns[0];
            placed.next[1][lane] = found.rows[0];
            placed.end[lane] = if has_few { found.rows[1] } else { 0.0 };
            n_few = n_few.max(if has_few { n } else { 0 });
            for k in 0..2 {
                placed.candidates.columns[k][lane] = found.columns[k];
                placed.candidates.rows[k][lane] = found.rows[k];
            }
            placed.candidates.low[lane] = low.z;
            lanes |= u32::from(found.is_wanted & !has_few) << lane;
            behind |= u32::from(found.is_behind) << lane;
        }
        placed.n_few = n_few;
        placed.candidates.lanes = lanes & block.used;
        placed.candidates.behind = behind & block.used;
    }

    /// Tests the next candidate of each triangle with few candidates. The triangle may stop the taxel below `limit`, metres, if the taxel is under the face, moved
    /// by the radius, or at most `wide` beyond a side that the triangle evaluates.
    #[inline(always)]
    pub fn test(&self, block: &Block, placed: &mut PlacedBlock, limit: f32, tested: &mut Tested) {
        let (mut lanes, mut faces) = (0, 0);
        let n_of_row = self.columns.n as u32;
        for lane in 0..LANES {
            let (column, row) = (placed.next[0][lane], placed.next[1][lane]);
            let is_candidate = row < placed.end[lane];
            let is_last_of_row = column + 1.5 > placed.candidates.columns[1][lane];
            placed.next[0][lane] = if is_last_of_row {
                placed.candidates.columns[0][lane]
            } else {
                column + 1.0
            };
            placed.next[1][lane] = if is_last_of_row { row + 1.0 } else { row };
            let (x, y) = (self.columns.at(column), self.rows_of_taxels.at(row));
            (tested.x[lane], tested.y[lane]) = (x, y);
            let (x, y) = (x - placed.moved[0][lane], y - placed.moved[1][lane]);
            let (mut gap, mut outside) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
            let mut beyond_one = f32::NEG_INFINITY;
            let sides = placed.sides[lane];
            let mut is_open = sides & ANY_PART != 0;
            for k in 0..3 {
                let ([x0, y0, _], [x1, y1, _]) = (&placed.corners[k], &placed.corners[(k + 1) % 3]);
                let (from_x, from_y) = (x0[lane], y0[lane]);
                let (ex, ey) = (x1[lane] - from_x, y1[lane] - from_y);
                let side = ey * (x - from_x) - ex * (y - from_y);
                // The length of the side is at most |ex| + |ey|.
                let length = ex.abs() + ey.abs();
                let beyond = placed.sign[lane] * side;
                gap = most(gap, beyond - placed.wide[lane] * length);
                let slack = 2.0 * self.slack * length;
                outside = most(outside, beyond + slack);
                beyond_one = most(beyond_one, beyond - slack);
                is_open |= (beyond + slack >= 0.0) & (sides >> k & 1 != 0);
            }
            let [first, _, _] = &placed.corners;
            let height = placed.height[lane]
                + placed.slope[0][lane] * (x - first[0][lane])
                + placed.slope[1][lane] * (y - first[1][lane]);
            let is_face = (outside < 0.0) & (placed.above[lane] < f32::INFINITY);
            let above = if is_face {
                placed.above[lane]
            } else {
                f32::INFINITY
            };
            let low = most(placed.candidates.low[lane], height - placed.below[lane]);
            tested.low[lane] = low;
            tested.high[lane] = height + above;
            tested.columns[lane] = integer(column);
            tested.rows[lane] = integer(row);
            tested.taxels[lane] = integer(row) * n_of_row + integer(column);
            is_open |= beyond_one <= 0.0;
            lanes |= u32::from(is_candidate & is_open & (gap <= 0.0) & (low < limit)) << lane;
            faces |= u32::from(is_face) << lane;
        }
        tested.lanes = lanes & block.used;
        tested.faces = faces;
    }

    /// Bounds the heights at which triangles stop taxels that are not certainly under their faces.
    ///
    /// The point p of the farthest side at which the taxel touches the side gives both bounds. A ball that rises cannot pass p. The triangle is on one side of
    /// the plane that touches the ball at p, up to the distance of a corner behind this plane. The plane, moved by this distance, stops the ball first. Both
    /// bounds are valid for any point p of the triangle.
    #[inline(always)]
    pub fn bound(&self, batch: &mut PlacedPairs, is_in_front: bool) {
        let reach2 = self.reach * self.reach;
        let error = 4.0 * self.reach * self.slack;
        for lane in 0..LANES {
            let (x, y) = (batch.x[lane], batch.y[lane]);
            let (mut from, mut edge) = (Vec3::ZERO, Vec3::ZERO);
            let (mut farthest, mut ground2) = (0.0, 0.0);
            for k in 0..3 {
                let a = vector(&batch.corners[k], lane);
                let e = vector(&batch.corners[(k + 1) % 3], lane) - a;
                let beyond =
                    e.y * (x - batch.moved[0][lane] - a.x) - e.x * (y - batch.moved[1][lane] - a.y);
                // Squares of distances are compared, because they need no square roots.
                let distance2 = batch.sign[lane] * beyond * beyond.abs();
                let length2 = e.x * e.x + e.y * e.y;
                let is_farther = (k == 0) | (distance2 * ground2 > farthest * length2);
                farthest = if is_farther { distance2 } else { farthest };
                ground2 = if is_farther { length2 } else { ground2 };
                let is_farther = BVec3::splat(is_farther);
                from = Vec3::select(is_farther, a, from);
                edge = Vec3::select(is_farther, e, edge);
            }
            // A vertical side is treated as slightly inclined.
            let whole2 = ground2 + edge.z * edge.z;
            let ground2 = ground2 + 1e-7 * whole2;
            let (to_x, to_y) = (x - from.x, y - from.y);
            let cross = edge.x * to_y - edge.y * to_x;
            let along = edge.x * to_x + edge.y * to_y;
            let inverse = 1.0 / (ground2 * whole2);
            let inverse2 = whole2 * inverse;
            let r2 = most(reach2 - cross * cross * inverse2, 0.0);
            let ahead = edge.z * (r2 * ground2 * ground2 * inverse).sqrt();
            // Not a number for a side without length; then the first corner.
            let part = least(most((along - ahead) * inverse2, 0.0), 1.0);
            let height = from.z + part * edge.z;
            let (dx, dy) = (part * edge.x - to_x, part * edge.y - to_y);
            let beside2 = dx * dx + dy * dy;
            let q = reach2 - beside2;
            let r = most(q, error).sqrt();
            let mut lowest = f32::INFINITY;
            for k in 0..3 {
                let c = vector(&batch.corners[k], lane);
                lowest = least(lowest, (c.x - x) * dx + (c.y - y) * dy + c.z * r);
            }
            // The length of (dx, dy, r) times the radius is at most the mean of their squares.
            let far =
                0.5 * (reach2 + beside2 + r * r) + 3.0 * self.slack * (dx.abs() + dy.abs() + r);
            let low = most(batch.low[lane], (lowest - far) / r);
            batch.low[lane] = low;
            let is_stopped = (q > error) & is_in_front;
            // The lower bound may exclude a contact that belongs to a neighbour.
            let high = most(height + self.slack + error / r - r, low + self.slack);
            batch.high[lane] = if is_stopped { high } else { f32::INFINITY };
        }
    }

    /// Moves a point from the frame of the mesh to the frame of the grid.
    #[inline(always)]
    fn placed(&self, point: Vec3) -> Vec3 {
        self.rotation * point + self.center
    }

    /// Returns the directions of contact of the triangles of a lane. `up` is the vertical component of the axis, `bottom` the lowest point of the triangles.
    #[inline(always)]
    fn directions(&self, up: f32, spread: f32, bottom: f32) -> Directions {
        let taxel = (self.reach, self.behind);
        Directions::new((up, spread), bottom, taxel, (0.0, self.slack))
    }

    #[inline(always)]
    fn find(&self, bounds: &Bounds, limit: f32) -> Found {
        let columns = self.columns.between(bounds.low.x, bounds.high.x);
        let rows = self.rows_of_taxels.between(bounds.low.y, bounds.high.y);
        let (n_columns, n_rows) = (columns[1] - columns[0], rows[1] - rows[0]);
        let is_under = (n_columns > 0.5) & (n_rows > 0.5);
        let is_in_front = self.behind - self.reach - self.slack < bounds.top;
        Found {
            columns,
            rows,
            is_wanted: is_under & is_in_front & (bounds.low.z < limit),
            is_behind: is_under & (bounds.back - self.slack < self.behind),
            is_one: (n_columns < 1.5) & (n_rows < 1.5),
        }
    }
}

#[inline(always)]
fn set([x, y, z]: &mut [Lane; 3], lane: usize, vector: Vec3) {
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
}
