//! Sphere over a flat grid, and the taxels under it, row by row.

use super::grid_values::{BLOCK, GridValues, WIDE};
use super::lines::{GridLines, Lines};
use crate::contact::lanes::least;
use crate::contact::law::{self, beats, indent};
use crate::contact::object_at::{ClusterBox, ObjectAt, PlacedSphere, Region};
use crate::world::RADIUS_ROUNDING;
use glam::DVec3;
use std::ops::Range;

/// Region of a flat grid. The bound of a sphere is the travel before which it meets no taxel, metres. The bound of a cluster is infinite if its projection misses
/// the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridRegion {
    /// Largest |x| and largest |y| of a taxel centre, metres.
    half_size: [f64; 2],
}

impl GridRegion {
    /// Creates the region of a grid with the given lines.
    pub fn new(lines: &GridLines) -> Self {
        let last = |lines: &Lines| lines.positions.last().copied().unwrap_or(0.0);
        Self {
            half_size: [last(&lines.x), last(&lines.y)],
        }
    }

    /// Returns whether a projection with a radius of `reach`, metres, misses the grid.
    #[inline(always)]
    pub fn misses(&self, center: DVec3, reach: f64) -> bool {
        let [half_x, half_y] = self.half_size;
        (center.x.abs() >= half_x + reach) | (center.y.abs() >= half_y + reach)
    }
}

impl Region for GridRegion {
    #[inline(always)]
    fn cluster_bound(&self, object: &ObjectAt, cluster: &ClusterBox) -> f64 {
        let center = object.place(cluster.ball.center);
        let beside = (object.reach + cluster.ball.radius) * RADIUS_ROUNDING;
        let below = object.rotation.row(2).abs().dot(cluster.half);
        let below = (below + cluster.largest + object.reach) * RADIUS_ROUNDING;
        // For spheres of different sizes the bounding ball is the tighter bound.
        let start = center.z - least(beside, below);
        if self.misses(center, beside) {
            f64::INFINITY
        } else {
            start
        }
    }

    #[inline(always)]
    fn sphere_bound(&self, sphere: &PlacedSphere) -> f64 {
        sphere.center.z - sphere.reach
    }
}

/// Returns `value - numbers[k]` for each index k.
#[inline(always)]
fn less<const N: usize>(value: f64, numbers: &[f64; N]) -> [f64; N] {
    let mut differences = [0.0; N];
    for k in 0..N {
        differences[k] = value - numbers[k];
    }
    differences
}

impl PlacedSphere {
    /// Returns the travel at which the sphere first touches a taxel, metres. This is the taxel nearest to the sphere's axis. The travel is infinite if the
    /// sphere passes between taxels.
    #[inline(always)]
    pub fn first_touch(&self, lines: &GridLines) -> f64 {
        let DVec3 { x, y, z } = self.center;
        let (dx, dy) = (x - lines.x.nearest(x), y - lines.y.nearest(y));
        let q = self.reach * self.reach - (dx * dx + dy * dy);
        if q > 0.0 {
            -law::deflection(q, z)
        } else {
            f64::INFINITY
        }
    }

    /// Raises each deflection to the deflection that contact with the sphere requires if its centre is at `height` above the grid, metres.
    #[inline(always)]
    pub fn indent(&self, lines: &GridLines, height: f64, deflections: &mut GridValues) {
        let reach2 = self.reach * self.reach;
        let lift = height.max(0.0);
        let footprint = (reach2 - lift * lift).max(0.0);
        let half_width = footprint.sqrt();
        let columns = lines.x.within(self.center.x, half_width);
        let rows = lines.y.within(self.center.y, half_width);
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        deflections.cover(&rows, &columns);
        let first = columns.start / BLOCK * BLOCK;
        match (columns.end - first).div_ceil(BLOCK) {
            1 => self.indent_square::<1>(lines, rows, first, height, deflections),
            2 => self.indent_square::<2>(lines, rows, first, height, deflections),
            3 => self.indent_square::<3>(lines, rows, first, height, deflections),
            _ => self.indent_rows(lines, rows, footprint, height, deflections),
        }
    }

    /// Raises deflections by a sphere whose centre is below the substrate's height `behind`, metres. The sphere pushes only taxels whose substrate is inside
    /// it.
    #[cold]
    pub fn indent_through(
        &self,
        lines: &GridLines,
        height: f64,
        behind: f64,
        deflections: &mut GridValues,
    ) {
        let gap = behind - height;
        let reach2 = self.reach * self.reach;
        let half_width = (reach2 - gap * gap).max(0.0).sqrt();
        let columns = lines.x.within(self.center.x, half_width);
        let rows = lines.y.within(self.center.y, half_width);
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        deflections.cover(&rows, &columns);
        for row in rows {
            let dy = lines.y.positions[row] - self.center.y;
            let taxels = deflections.row(row, columns.clone()).iter_mut();
            for (deflection, x) in taxels.zip(&lines.x.positions[columns.clone()]) {
                let dx = x - self.center.x;
                let q = reach2 - dy * dy - dx * dx;
                *deflection = deflection.max(law::needed(q, height, behind));
            }
        }
    }

    /// Raises the deflections of N blocks of columns in each row, beginning at column `first`.
    #[inline(always)]
    fn indent_square<const N: usize>(
        &self,
        lines: &GridLines,
        rows: Range<usize>,
        first: usize,
        height: f64,
        deflections: &mut GridValues,
    ) {
        let reach2 = self.reach * self.reach;
        let mut dx2 = [[f64::INFINITY; BLOCK]; N];
        let places = &lines.x.positions[first..];
        let places = &places[..places.len().min(N * BLOCK)];
        for k in 0..places.len() {
            let dx = places[k] - self.center.x;
            dx2[k / BLOCK][k % BLOCK] = dx * dx;
        }
        for row in rows {
            let dy = lines.y.positions[row] - self.center.y;
            let row_reach2 = reach2 - dy * dy;
            let blocks: &mut [[f64; BLOCK]; N] = deflections.blocks(row, first);
            for block in 0..N {
                let squares = less(row_reach2, &dx2[block]);
                indent(&squares, &[height; BLOCK], &mut blocks[block]);
            }
        }
    }

    /// Raises the deflections of all columns that the sphere's footprint covers, row by row. The footprint is wider than a block of columns.
    #[inline(always)]
    fn indent_rows(
        &self,
        lines: &GridLines,
        rows: Range<usize>,
        footprint: f64,
        height: f64,
        deflections: &mut GridValues,
    ) {
        let reach2 = self.reach * self.reach;
        let last = lines.x.positions.len() - WIDE;
        for row in rows {
            let dy = lines.y.positions[row] - self.center.y;
            let half_width = (footprint - dy * dy).max(0.0).sqrt();
            let columns = lines.x.within(self.center.x, half_width);
            let row_reach2 = reach2 - dy * dy;
            let mut next = columns.start;
            while next < columns.end {
                // The last block of a row overlaps the one before.
                let first = next.min(last);
                let mut dx2 = [0.0; WIDE];
                let places = &lines.x.positions[first..first + WIDE];
                for k in 0..WIDE {
                    let dx = places[k] - self.center.x;
                    dx2[k] = dx * dx;
                }
                let squares = less(row_reach2, &dx2);
                let taxels = deflections.wide_block(row, first);
                if beats(&squares, &[height; WIDE], taxels) {
                    indent(&squares, &[height; WIDE], taxels);
                }
                next = first + WIDE;
            }
        }
    }
}
