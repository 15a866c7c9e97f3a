//! Sphere over a flat grid, and the taxels under it, row by row.

use super::deflection_grid::{BLOCK, DeflectionGrid, WIDE};
use super::lines::GridLines;
use crate::contact::law::{self, beats, indent};
use crate::geometry::Pose;
use crate::objects::{Cluster, ClusterBounds, MAX_IN_CLUSTER, Sphere};
use glam::{DMat3, DVec3};
use std::ops::Range;

/// Sphere in the patch frame whose radius is enlarged by the taxel's radius, so that a taxel can be treated as a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedSphere {
    pub center: DVec3,
    /// Sum of the radii of taxel and sphere, metres.
    pub reach: f64,
}

/// Factor that covers rounding of a radius: far above 1e-16 and far below any measurable difference.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Largest number of columns for which a sphere's footprint on the grid is treated as a square. If larger, taxels beside large spheres are computed
/// needlessly; if smaller, taxels at the ends of short rows are.
const SQUARE: usize = 10;

/// Transform from an object's frame to the patch frame, used to select the spheres that can press the grid.
#[derive(Clone, Debug)]
pub(crate) struct View {
    /// Rows of the rotation matrix from the object's frame to the patch frame.
    rows: DMat3,
    translation: DVec3,
    /// Radius of the taxels, metres.
    taxel_radius: f64,
    /// Largest |x| and largest |y| of a taxel centre, metres.
    half_size: [f64; 2],
}

impl View {
    /// Creates the transform for an object at the pose `patch_from_object`, and for a grid whose taxels have one radius.
    pub fn new(taxel_radius: f64, lines: &GridLines, pose: &Pose) -> Self {
        let last = |positions: &[f64]| positions.last().copied().unwrap_or(0.0);
        Self {
            rows: DMat3::from_quat(pose.rotation).transpose(),
            translation: pose.translation,
            taxel_radius,
            half_size: [last(&lines.x.positions), last(&lines.y.positions)],
        }
    }

    /// Writes, for each cluster of spheres, a travel before which no sphere of the cluster meets a taxel, metres. The travel is infinite if the cluster's
    /// projection misses the patch.
    #[inline(always)]
    pub fn lay_starts(&self, bounds: &ClusterBounds, starts: &mut [f64]) {
        let n = starts.len();
        let [x, y, z] = &bounds.middle;
        let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
        let [wide, deep, high] = &bounds.half;
        let (wide, deep, high) = (&wide[..n], &deep[..n], &high[..n]);
        let (radius, largest) = (&bounds.radius[..n], &bounds.largest[..n]);
        let [half_x, half_y] = self.half_size;
        let up = self.rows.z_axis.abs();
        for k in 0..n {
            let middle = DVec3::new(x[k], y[k], z[k]);
            let beside = (self.taxel_radius + radius[k]) * ROUNDING;
            let at_x = self.rows.x_axis.dot(middle) + self.translation.x;
            let at_y = self.rows.y_axis.dot(middle) + self.translation.y;
            let at_z = self.rows.z_axis.dot(middle) + self.translation.z;
            let below = up.dot(DVec3::new(wide[k], deep[k], high[k]));
            let below = (below + largest[k] + self.taxel_radius) * ROUNDING;
            // For spheres of different sizes the bounding ball is the tighter bound.
            let below = if beside < below { beside } else { below };
            let is_beside = (at_x.abs() >= half_x + beside) | (at_y.abs() >= half_y + beside);
            starts[k] = if is_beside {
                f64::INFINITY
            } else {
                at_z - below
            };
        }
    }

    /// Returns, for each sphere of a cluster, the travel before which the sphere meets no taxel, metres.
    #[inline(always)]
    pub fn starts(&self, cluster: &Cluster) -> [f64; MAX_IN_CLUSTER] {
        let [x, y, z] = cluster.centers;
        let mut starts = [f64::INFINITY; MAX_IN_CLUSTER];
        for (k, start) in starts.iter_mut().enumerate() {
            let center = DVec3::new(x[k], y[k], z[k]);
            let reach = self.taxel_radius + cluster.radii[k];
            let its = self.rows.z_axis.dot(center) + self.translation.z - reach;
            *start = if k < cluster.n_spheres {
                its
            } else {
                f64::INFINITY
            };
        }
        starts
    }

    /// Returns the sphere in the patch frame; `None` if the sphere meets no taxel before `travel` or its projection misses the patch.
    #[inline(always)]
    pub fn place(&self, sphere: &Sphere, travel: f64) -> Option<PlacedSphere> {
        let reach = self.taxel_radius + sphere.radius;
        let z = self.rows.z_axis.dot(sphere.center) + self.translation.z;
        if z - reach >= travel {
            return None;
        }
        let x = self.rows.x_axis.dot(sphere.center) + self.translation.x;
        let y = self.rows.y_axis.dot(sphere.center) + self.translation.y;
        let [half_x, half_y] = self.half_size;
        let beside = reach * ROUNDING;
        (x.abs() < half_x + beside && y.abs() < half_y + beside).then_some(PlacedSphere {
            center: DVec3::new(x, y, z),
            reach,
        })
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
    pub fn indent(&self, lines: &GridLines, height: f64, deflections: &mut DeflectionGrid) {
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
        deflections: &mut DeflectionGrid,
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
        deflections: &mut DeflectionGrid,
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
        deflections: &mut DeflectionGrid,
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

    /// Raises the deflection of each taxel that the sphere pushes further, and writes `mark` for these taxels. A sphere wholly behind the substrate, whose
    /// height is `behind`, pushes no taxel.
    ///
    /// The footprint is the region where contact with the sphere requires a deflection above zero: `b² < S² − max(h, 0)²`. S is the sum of the radii, b the
    /// distance from the taxel's axis, and h the height of the sphere's centre. Ranges of columns are rounded outwards, small footprints to a square. The
    /// comparison with S in the innermost loop decides exactly.
    pub fn indent_and_mark<M: Copy>(
        &self,
        lines: &GridLines,
        behind: f64,
        deflections: &mut [f64],
        (mark, marks): (M, &mut [M]),
    ) {
        let DVec3 { x, y, z: height } = self.center;
        let reach2 = self.reach * self.reach;
        let lift = height.max(0.0);
        let footprint = (reach2 - lift * lift).max(0.0);
        let half_width = footprint.sqrt();
        let square = lines.x.within(x, half_width);
        for row in lines.y.within(y, half_width) {
            let dy = lines.y.positions[row] - y;
            let mut columns = square.clone();
            if square.len() > SQUARE {
                let half_width = (footprint - dy * dy).max(0.0).sqrt();
                columns = lines.x.within(x, half_width);
            }
            let first = row * lines.x.positions.len();
            let taxels = first + columns.start..first + columns.end;
            let marked = deflections[taxels.clone()]
                .iter_mut()
                .zip(&mut marks[taxels]);
            for ((deflection, marked), place) in marked.zip(&lines.x.positions[columns]) {
                let dx = place - x;
                let q = reach2 - dy * dy - dx * dx;
                if !law::is_in_front(q, height, behind) {
                    continue;
                }
                if law::may_exceed(q, height, *deflection) {
                    let needed = law::deflection(q, height);
                    if needed > *deflection {
                        *deflection = needed;
                        *marked = mark;
                    }
                }
            }
        }
    }
}
