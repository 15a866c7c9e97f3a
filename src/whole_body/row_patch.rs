//! A patch that is a row of taxels repeated along a line: flat, or a part of a cylinder.

use crate::contact::Lines;
use crate::objects::Sphere;
use crate::world::{Extrusion, Taxel};
use glam::DVec2;
use std::ops::Range;

/// Columns in a bundle. More: columns are looked at in vain; fewer: bundles are.
pub(super) const BUNDLE: usize = 8;
/// What rounding may add to a reach, far above 1e-16 and far below what is felt.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Equal taxels in a row that is repeated, and what finds those that a sphere is near.
#[derive(Clone, Debug)]
pub(super) struct RowPatch {
    extrusion: Extrusion,
    taxel: Taxel,
    /// Of each bundle of columns, in their order.
    circles: Vec<Circle>,
    lines: Lines,
    /// Around all taxels from their rest centres back to the substrate, in the patch frame.
    ball: Sphere,
}

/// A circle in the plane across the rows.
#[derive(Clone, Copy, Debug)]
struct Circle {
    center: DVec2,
    radius: f64,
}

impl RowPatch {
    /// Taxels that are good ones.
    pub fn new(extrusion: Extrusion, taxel: Taxel) -> Self {
        let depth = taxel.stroke + taxel.radius;
        let columns: Vec<_> = extrusion.places().iter().zip(extrusion.axes()).collect();
        let ends = |column: &(&DVec2, &DVec2)| [*column.0, *column.0 - depth * *column.1];
        let circle = |columns: &[(&DVec2, &DVec2)]| Circle::around(columns.iter().flat_map(ends));
        let lines = Lines::at(extrusion.rows());
        let whole = circle(&columns);
        let (first, last) = (
            lines.positions[0],
            lines.positions[lines.positions.len() - 1],
        );
        let center = whole.center.extend(0.5 * (first + last));
        Self {
            ball: Sphere {
                center: extrusion.uvw_from_patch().transpose() * center,
                radius: whole.radius.hypot(0.5 * (last - first)),
            },
            circles: columns.chunks(BUNDLE).map(circle).collect(),
            extrusion,
            taxel,
            lines,
        }
    }

    /// Where the taxels rest.
    pub fn extrusion(&self) -> &Extrusion {
        &self.extrusion
    }

    /// What each of the taxels is.
    pub fn taxel(&self) -> &Taxel {
        &self.taxel
    }

    /// As [`BodyPatch::ball`](super::BodyPatch::ball).
    pub fn ball(&self) -> Sphere {
        self.ball
    }

    /// Bytes that it holds on the heap.
    pub fn n_bytes(&self) -> usize {
        size_of_val(self.extrusion.places())
            + size_of_val(self.extrusion.axes())
            + size_of_val(self.extrusion.rows())
            + size_of_val(&self.circles[..])
            + size_of_val(&self.lines.positions[..])
    }

    /// The rows.
    pub fn lines(&self) -> &Lines {
        &self.lines
    }

    /// Runs of neighbouring bundles that a circle of radius `reach` (with ρ in it) comes near; ranges of columns.
    #[inline(always)]
    pub fn each_run_near(&self, center: DVec2, reach: f64, mut visit: impl FnMut(Range<usize>)) {
        let n_columns = self.extrusion.places().len();
        let mut start = None;
        for (bundle, circle) in self.circles.iter().enumerate() {
            match (circle.is_near(center, reach), start) {
                (true, None) => start = Some(bundle * BUNDLE),
                (false, Some(from)) => {
                    visit(from..bundle * BUNDLE);
                    start = None;
                }
                _ => {}
            }
        }
        if let Some(from) = start {
            visit(from..n_columns);
        }
    }

    /// Whether a circle of radius `reach` (with ρ in it) comes near any bundle.
    #[inline(always)]
    pub fn is_near(&self, center: DVec2, reach: f64) -> bool {
        let mut circles = self.circles.iter();
        circles.any(|circle| circle.is_near(center, reach))
    }
}

impl Circle {
    fn around(points: impl Iterator<Item = DVec2> + Clone) -> Self {
        let center = points.clone().sum::<DVec2>() / points.clone().count() as f64;
        let distances = points.map(|point| point.distance(center));
        Self {
            center,
            radius: distances.fold(0.0, f64::max),
        }
    }

    #[inline(always)]
    fn is_near(&self, center: DVec2, reach: f64) -> bool {
        let reach = (self.radius + reach) * ROUNDING;
        self.center.distance_squared(center) <= reach * reach
    }
}
