//! A sphere over a flat grid, and the taxels under it, row by row.

use super::grid_lines::GridLines;
use crate::geometry::Pose;
use crate::objects::Sphere;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// A sphere in the patch frame, its radius grown by the taxel's: the taxel is then a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedSphere {
    pub center: DVec3,
    /// S = ρ + R.
    pub reach: f64,
}

/// What rounding may add to a reach, far above 1e-16 and far below what is felt.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Footprints of at most so many columns are looked at as squares. More: taxels beside large spheres are looked at in vain; fewer: the
/// ends of short rows are computed in vain.
const SQUARE: usize = 10;

/// What is needed is compared before its root is taken: a square that is less than this share of the least that counts has a root
/// that does not, however both are rounded. Larger: rounding decides; smaller: roots in vain.
const ALMOST: f64 = 1.0 - 1e-12;

/// An object's frame seen from the patch.
pub(super) struct View {
    /// Rows of the rotation.
    rows: DMat3,
    translation: DVec3,
    /// ρ.
    taxel_radius: f64,
    /// The outermost taxels' |x| and |y|.
    half_size: [f64; 2],
}

impl View {
    /// Of an object at `patch_from_object` from a grid with taxels of one radius.
    pub fn new(taxel_radius: f64, lines: &GridLines, pose: &Pose) -> Self {
        let last = |positions: &[f64]| positions.last().copied().unwrap_or(0.0);
        Self {
            rows: DMat3::from_quat(pose.rotation).transpose(),
            translation: pose.translation,
            taxel_radius,
            half_size: [last(&lines.x.positions), last(&lines.y.positions)],
        }
    }

    /// The sphere in the patch frame; `None` if it meets no taxel before `travel` or its shadow misses the patch.
    #[inline]
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

impl PlacedSphere {
    /// The travel at which the sphere meets the taxel nearest to its axis, its first; infinite if it passes between all.
    pub fn first_touch(&self, lines: &GridLines) -> f64 {
        let DVec3 { x, y, z } = self.center;
        let (dx, dy) = (x - lines.x.nearest(x), y - lines.y.nearest(y));
        let q = self.reach * self.reach - (dx * dx + dy * dy);
        if q > 0.0 { z - q.sqrt() } else { f64::INFINITY }
    }

    /// Raises the deflections to what the sphere needs with its centre at a height over the grid.
    pub fn raise(&self, lines: &GridLines, height: f64, deflections: &mut [f64]) {
        self.each_row(lines, height, |taxels, places, row_reach2| {
            for (deflection, x) in deflections[taxels].iter_mut().zip(places) {
                let dx = x - self.center.x;
                let q = row_reach2 - dx * dx;
                let needed = if q > 0.0 { q.sqrt() - height } else { 0.0 };
                *deflection = deflection.max(needed);
            }
        });
    }

    /// Raises the deflections to what the sphere needs with its centre where it is, and marks those that it has raised.
    pub fn raise_and_mark<M: Copy>(
        &self,
        lines: &GridLines,
        deflections: &mut [f64],
        mark: M,
        marks: &mut [M],
    ) {
        let height = self.center.z;
        self.each_row(lines, height, |taxels, places, row_reach2| {
            let taxels = deflections[taxels.clone()]
                .iter_mut()
                .zip(&mut marks[taxels]);
            for ((deflection, marked), x) in taxels.zip(places) {
                let dx = x - self.center.x;
                let q = row_reach2 - dx * dx;
                let bar = (height + *deflection).max(0.0);
                if q > bar * bar * ALMOST {
                    let needed = q.sqrt() - height;
                    if needed > *deflection {
                        *deflection = needed;
                        *marked = mark;
                    }
                }
            }
        });
    }

    /// Visits the rows of the footprint: taxels, their x, and S² − dy².
    ///
    /// The footprint is where the sphere needs more than zero: `b² < S² − max(h, 0)²`. Ranges are rounded outwards, those of small
    /// footprints to a square; the comparison with S in the innermost loop is what decides.
    #[inline]
    fn each_row(
        &self,
        lines: &GridLines,
        height: f64,
        mut visit: impl FnMut(Range<usize>, &[f64], f64),
    ) {
        let reach2 = self.reach * self.reach;
        let lift = height.max(0.0);
        let footprint = (reach2 - lift * lift).max(0.0);
        let half_width = footprint.sqrt();
        let n_columns = lines.x.positions.len();
        let square = lines.x.within(self.center.x, half_width);
        let is_wide = square.len() > SQUARE;
        for row in lines.y.within(self.center.y, half_width) {
            let dy = lines.y.positions[row] - self.center.y;
            let columns = match is_wide {
                true => {
                    let half_width = (footprint - dy * dy).max(0.0).sqrt();
                    lines.x.within(self.center.x, half_width)
                }
                false => square.clone(),
            };
            let first = row * n_columns;
            let taxels = first + columns.start..first + columns.end;
            visit(taxels, &lines.x.positions[columns], reach2 - dy * dy);
        }
    }
}
