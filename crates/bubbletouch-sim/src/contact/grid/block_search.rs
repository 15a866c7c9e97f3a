//! Bounds, in vectors of single precision, of the places on a grid where the triangles of a mesh can stop taxels.
//!
//! If a triangle stops a taxel of radius ρ, the centre of the taxel is at p + ρ d. The point p is on the triangle, and d is a direction of contact
//! ([`mesh_blocks`](crate::objects::mesh_blocks)). The taxel comes from below, so d points down. Normals that certainly point down, or up, determine the side
//! of the surface. If the side is not certain, d is any unit vector.
//!
//! The loops over lanes are short and without branches, and use `max` and `min` instead of comparisons. The compiler converts such loops to vector
//! instructions.
//!
//! All bounds are enlarged by `slack`, far more than the rounding of single precision, so they never exclude a contact.

#![expect(
    clippy::needless_range_loop,
    reason = "a loop over the lanes of several arrays is clearer with an index"
)]

use super::lines::{GridLines, Lines};
use crate::geometry::Pose;
use crate::objects::mesh_blocks::{Block, BlockNode, LANES, Lane, MeshBlocks};
use glam::{DMat3, DVec3};
use std::ops::Range;

/// Bound of the rounding errors of single precision, relative to the lengths in the scene. Each bound is computed from about ten numbers, each rounded by 6e-8.
const ROUNDING: f64 = 2e-6;

/// Transform of a mesh to the frame of a grid, and the limits of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockSearch {
    /// Rows of the rotation matrix.
    rows: [[f32; 3]; 3],
    /// Centre of the mesh in the frame of the grid, metres.
    center: [f32; 3],
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
    fn between(&self, low: &Lane, high: &Lane) -> [Lane; 2] {
        let mut ranges = [[0.0; LANES]; 2];
        for k in 0..LANES {
            let first = (low[k] - self.first) * self.density + 0.5;
            let last = (high[k] - self.first) * self.density + 0.5;
            ranges[0][k] = nearest_whole(first.max(0.0).min(self.n));
            ranges[1][k] = nearest_whole(last.max(0.0).min(self.n));
        }
        ranges
    }
}

/// Rounds a number from 0 to 2²² to the nearest whole number. Unlike `f32::round`, the function takes two vector instructions on any processor.
#[inline(always)]
fn nearest_whole(number: f32) -> f32 {
    /// Number 2²³, from which numbers in single precision have no fractions.
    const WHOLE: f32 = 8_388_608.0;
    (number + WHOLE) - WHOLE
}

/// Returns one bit for each lane whose value is negative.
#[inline(always)]
fn negative(values: &Lane) -> u32 {
    let mut bits = 0;
    for (lane, &value) in values.iter().enumerate() {
        bits |= u32::from(value < 0.0) << lane;
    }
    bits
}

/// Taxels that the triangles of each lane may stop, and a lower bound of their heights.
#[derive(Clone, Copy, Debug)]
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
    /// Removes lanes with one candidate and a positive value.
    #[inline(always)]
    fn remove_if_positive(&mut self, values: &Lane) {
        let mut kept = [0.0; LANES];
        for lane in 0..LANES {
            let n_columns = self.columns[1][lane] - self.columns[0][lane];
            let n_rows = self.rows[1][lane] - self.rows[0][lane];
            let is_one = (1.5 - n_columns).min(1.5 - n_rows);
            // Positive if the lane has one candidate and is to be removed.
            kept[lane] = -is_one.min(values[lane]);
        }
        self.lanes &= !negative(&kept);
    }

    /// Returns the columns and the rows of the candidates in a lane.
    #[inline(always)]
    pub fn rectangle(&self, lane: usize) -> [Range<usize>; 2] {
        [&self.columns, &self.rows]
            .map(|[first, last]| first[lane] as u32 as usize..last[lane] as u32 as usize)
    }
}

/// Bounds of the centres of stopped taxels.
struct Bounds {
    low: [Lane; 3],
    high: [Lane; 3],
    /// Highest points of the triangles, metres.
    top: Lane,
    /// Heights below which triangles count as behind the substrate, metres.
    back: Lane,
}

impl BlockSearch {
    pub fn new(
        blocks: &MeshBlocks,
        pose: &Pose,
        (reach, behind): (f64, f64),
        lines: &GridLines,
    ) -> Self {
        let rotation = DMat3::from_quat(pose.rotation);
        let center = pose.transform_point(blocks.center);
        let last = |lines: &Lines| lines.positions.last().copied().unwrap_or(0.0);
        let length = blocks.radius + center.length() + reach + last(&lines.x) + last(&lines.y);
        let row = |row: DVec3| row.to_array().map(|number| number as f32);
        Self {
            rows: [rotation.row(0), rotation.row(1), rotation.row(2)].map(row),
            center: row(center),
            reach: reach as f32,
            behind: behind as f32,
            slack: (ROUNDING * length) as f32,
            columns: LaneLines::new(&lines.x),
            rows_of_taxels: LaneLines::new(&lines.y),
        }
    }

    /// Returns the candidates of the children of a node below a limit, metres.
    #[inline(always)]
    pub fn node(&self, node: &BlockNode, limit: f32) -> Candidates {
        let axis = self.turned(&node.axis);
        let mut center = self.turned(&node.center);
        let mut half = [[0.0; LANES]; 3];
        for (k, half) in half.iter_mut().enumerate() {
            let [a, b, c] = self.rows[k].map(f32::abs);
            for lane in 0..LANES {
                center[k][lane] += self.center[k];
                half[lane] =
                    a * node.half[0][lane] + b * node.half[1][lane] + c * node.half[2][lane];
            }
        }
        let mut bottom = [0.0; LANES];
        for lane in 0..LANES {
            bottom[lane] = center[2][lane] - half[2][lane];
        }
        let (shift, spread) = self.directions(&axis[2], &node.spread, &bottom);
        let mut middle = center;
        let mut bounds = Bounds {
            low: center,
            high: center,
            top: center[2],
            back: center[2],
        };
        for k in 0..3 {
            for lane in 0..LANES {
                middle[k][lane] += shift[lane] * axis[k][lane];
                let wide = half[k][lane] + spread[lane] + self.slack;
                bounds.low[k][lane] = middle[k][lane] - wide;
                bounds.high[k][lane] = middle[k][lane] + wide;
            }
        }
        for lane in 0..LANES {
            bounds.top[lane] += half[2][lane];
            // Triangles that reach in front of the substrate are examined one by one.
            bounds.back[lane] = bounds.top[lane] + self.reach;
        }
        let mut candidates = self.candidates(&bounds, limit, node.used);
        let [x, y, _] = middle;
        self.rule_out_boxes(&mut candidates, (&[x, y], &node.half), &spread);
        candidates
    }

    /// Removes lanes with one candidate taxel that is beside the shadow of the bounding box, with the centre `middle` and enlarged by `spread`.
    ///
    /// Let a line have the direction u and contain the point o, and let a box around the origin have the half sizes h. The line misses the box if |o × u|
    /// exceeds `h_j |u_k| + h_k |u_j|` in a component i. In the frame of the mesh, u is the third row of the rotation matrix.
    #[inline(always)]
    fn rule_out_boxes(
        &self,
        candidates: &mut Candidates,
        (middle, half): (&[Lane; 2], &[Lane; 3]),
        spread: &Lane,
    ) {
        let [to_x, to_y, up] = self.rows;
        let [mut x, mut y] = self.first_candidates(candidates);
        for lane in 0..LANES {
            x[lane] -= middle[0][lane];
            y[lane] -= middle[1][lane];
        }
        let mut gap = [f32::NEG_INFINITY; LANES];
        for (j, k) in [(1, 2), (2, 0), (0, 1)] {
            let (along_x, along_y) = (
                to_x[j] * up[k] - to_x[k] * up[j],
                to_y[j] * up[k] - to_y[k] * up[j],
            );
            let (up_j, up_k) = (up[j].abs(), up[k].abs());
            for lane in 0..LANES {
                let cross = (along_x * x[lane] + along_y * y[lane]).abs();
                let reach = half[j][lane] * up_k + half[k][lane] * up_j;
                gap[lane] = gap[lane].max(cross - reach);
            }
        }
        for lane in 0..LANES {
            gap[lane] -= spread[lane] + 2.0 * self.slack;
        }
        candidates.remove_if_positive(&gap);
    }

    /// Returns the positions of the first candidate of each lane, metres.
    #[inline(always)]
    fn first_candidates(&self, candidates: &Candidates) -> [Lane; 2] {
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            x[lane] = self.columns.first + candidates.columns[0][lane] * self.columns.pitch;
        }
        for lane in 0..LANES {
            y[lane] =
                self.rows_of_taxels.first + candidates.rows[0][lane] * self.rows_of_taxels.pitch;
        }
        [x, y]
    }

    /// Returns the candidates of the triangles of a block below a limit, metres.
    #[inline(always)]
    pub fn block(&self, block: &Block, limit: f32) -> Candidates {
        let normal = self.turned(&block.normal);
        let mut corners = [[[0.0; LANES]; 3]; 3];
        for (turned, corner) in corners.iter_mut().zip(&block.corners) {
            *turned = self.turned(corner);
            for k in 0..3 {
                for lane in 0..LANES {
                    turned[k][lane] += self.center[k];
                }
            }
        }
        let [a, b, c] = &corners;
        let mut bottom = [0.0; LANES];
        for lane in 0..LANES {
            bottom[lane] = a[2][lane].min(b[2][lane]).min(c[2][lane]);
        }
        let (shift, spread) = self.directions(&normal[2], &block.spread, &bottom);
        let mut bounds = Bounds {
            low: *a,
            high: *a,
            top: [0.0; LANES],
            back: bottom,
        };
        for lane in 0..LANES {
            bounds.top[lane] = a[2][lane].max(b[2][lane]).max(c[2][lane]);
        }
        for k in 0..3 {
            for lane in 0..LANES {
                let (a, b, c) = (a[k][lane], b[k][lane], c[k][lane]);
                let low = a.min(b).min(c);
                let high = a.max(b).max(c);
                let (shift, wide) = (shift[lane] * normal[k][lane], spread[lane] + self.slack);
                // No direction is longer than one.
                let far = self.reach + self.slack;
                bounds.low[k][lane] = (low + shift - wide).max(low - far);
                bounds.high[k][lane] = (high + shift + wide).min(high + far);
            }
        }
        let mut candidates = self.candidates(&bounds, limit, block.used);
        self.rule_out(&mut candidates, &corners, &normal, (&shift, &spread));
        candidates
    }

    /// Removes lanes with one candidate taxel that is beside the triangle, moved by `shift` along its normal and widened by `spread`.
    #[inline(always)]
    fn rule_out(
        &self,
        candidates: &mut Candidates,
        [a, b, c]: &[[Lane; 3]; 3],
        normal: &[Lane; 3],
        (shift, spread): (&Lane, &Lane),
    ) {
        let [mut x, mut y] = self.first_candidates(candidates);
        let mut sign = [0.0; LANES];
        let mut gap = [f32::NEG_INFINITY; LANES];
        for lane in 0..LANES {
            x[lane] -= shift[lane] * normal[0][lane];
            y[lane] -= shift[lane] * normal[1][lane];
        }
        for lane in 0..LANES {
            // Positive if the triangle is counter-clockwise seen from above.
            let (ux, uy) = (b[0][lane] - a[0][lane], b[1][lane] - a[1][lane]);
            let (vx, vy) = (c[0][lane] - a[0][lane], c[1][lane] - a[1][lane]);
            sign[lane] = if ux * vy - uy * vx > 0.0 { 1.0 } else { -1.0 };
        }
        for (from, to) in [(a, b), (b, c), (c, a)] {
            for lane in 0..LANES {
                let (ex, ey) = (to[0][lane] - from[0][lane], to[1][lane] - from[1][lane]);
                let side = ey * (x[lane] - from[0][lane]) - ex * (y[lane] - from[1][lane]);
                // The length of the side is at most |ex| + |ey|.
                let wide = (spread[lane] + 2.0 * self.slack) * (ex.abs() + ey.abs());
                gap[lane] = gap[lane].max(sign[lane] * side - wide);
            }
        }
        candidates.remove_if_positive(&gap);
    }

    #[inline(always)]
    fn turned(&self, vectors: &[Lane; 3]) -> [Lane; 3] {
        let mut turned = [[0.0; LANES]; 3];
        for (turned, [a, b, c]) in turned.iter_mut().zip(self.rows) {
            for lane in 0..LANES {
                turned[lane] = a * vectors[0][lane] + b * vectors[1][lane] + c * vectors[2][lane];
            }
        }
        turned
    }

    /// Returns the length by which triangles are moved along their axes, and by which they are then enlarged, metres. `up` contains the vertical components
    /// of the axes, `bottom` the lowest points of the triangles. Triangles that may be behind the substrate are enlarged by the whole radius, because the
    /// search then evaluates all their parts.
    #[inline(always)]
    fn directions(&self, up: &Lane, spread: &Lane, bottom: &Lane) -> (Lane, Lane) {
        let (mut shift, mut wide) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let is_low = bottom[lane] - self.reach - self.slack < self.behind;
            let is_certain = (up[lane].abs() > spread[lane] + 1e-5) & !is_low;
            let side = if up[lane] < 0.0 {
                self.reach
            } else {
                -self.reach
            };
            shift[lane] = if is_certain { side } else { 0.0 };
            wide[lane] = if is_certain {
                self.reach * spread[lane]
            } else {
                self.reach
            };
        }
        (shift, wide)
    }

    #[inline(always)]
    fn candidates(&self, bounds: &Bounds, limit: f32, used: u32) -> Candidates {
        let columns = self.columns.between(&bounds.low[0], &bounds.high[0]);
        let rows = self.rows_of_taxels.between(&bounds.low[1], &bounds.high[1]);
        let [first_column, end_column] = &columns;
        let [first_row, end_row] = &rows;
        // Negative if there are candidates.
        let mut beside = [0.0; LANES];
        for lane in 0..LANES {
            let no_column = first_column[lane] - end_column[lane] + 0.5;
            let no_row = first_row[lane] - end_row[lane] + 0.5;
            beside[lane] = no_column.max(no_row);
        }
        let mut near = [0.0; LANES];
        for lane in 0..LANES {
            let hidden = self.behind - self.reach - self.slack - bounds.top[lane];
            near[lane] = beside[lane].max(hidden).max(bounds.low[2][lane] - limit);
        }
        let mut behind = [0.0; LANES];
        for lane in 0..LANES {
            behind[lane] = beside[lane].max(bounds.back[lane] - self.slack - self.behind);
        }
        Candidates {
            columns,
            rows,
            low: bounds.low[2],
            lanes: negative(&near) & used,
            behind: negative(&behind) & used,
        }
    }
}
