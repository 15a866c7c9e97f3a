//! Patch made of a row of taxels repeated along a line: flat, or a part of a cylinder.

use super::lanes::{Balls, FAR, LANES, ball_around, filled};
use crate::contact::Lines;
use crate::contact::lanes::largest;
use crate::contact::law::{beats, indent, squares_in_front};
use crate::objects::Sphere;
use crate::world::Extrusion;
use glam::{DVec2, DVec3};

/// Equal taxels in a row that is repeated along a line, with the structures that find the taxels near a sphere.
#[derive(Clone, Debug)]
pub(super) struct RowPatch {
    /// Centres (at rest) and axes of the taxels.
    pub extrusion: Extrusion,
    /// Height of the substrate relative to the taxels' centres at rest, metres.
    pub behind: f64,
    /// Bundles of neighbouring columns of taxels.
    pub bundles: Vec<Bundle>,
    /// Bounding circles of the bundles in the plane perpendicular to the rows, stored as balls with their centres at w = 0.
    pub circles: Vec<Balls>,
    /// Positions of the rows along the line of repetition.
    pub lines: Lines,
    /// Ball around all taxels (their centres at rest and the substrate below them), in the coordinates u, v (across the rows) and w (along them).
    pub ball_in_uvw: Sphere,
}

/// Bundle of neighbouring columns: centres of the taxels at rest (metres) and axes, stored coordinate by coordinate. The last bundle is padded with columns
/// far away.
#[derive(Clone, Debug)]
pub(super) struct Bundle {
    pub u: [f64; LANES],
    pub v: [f64; LANES],
    pub axis_u: [f64; LANES],
    pub axis_v: [f64; LANES],
}

impl RowPatch {
    /// Creates the patch of an extrusion. The substrate is at the height `behind`, metres, relative to the taxels' centres at rest.
    pub fn new(extrusion: Extrusion, behind: f64) -> Self {
        let columns = extrusion.places().iter().copied();
        let columns: Vec<_> = columns.zip(extrusion.axes().iter().copied()).collect();
        let lines = Lines::at(extrusion.rows());
        let (first, last) = (
            lines.positions[0],
            lines.positions[lines.positions.len() - 1],
        );
        // Segment of a column, from the rest centre back to the substrate, in the plane across the rows.
        let ends = |&(place, axis): &(DVec2, DVec2)| {
            [place, place + behind * axis].map(|end: DVec2| end.extend(0.0))
        };
        let circle = |columns: &[_]| ball_around(columns.iter().flat_map(ends));
        let circles: Vec<Sphere> = columns.chunks(LANES).map(circle).collect();
        let whole = circle(&columns);
        let center = whole.center.with_z(0.5 * (first + last));
        Self {
            ball_in_uvw: Sphere {
                center,
                radius: whole.radius.hypot(0.5 * (last - first)),
            },
            bundles: columns.chunks(LANES).map(Bundle::new).collect(),
            circles: Balls::blocks(&circles),
            extrusion,
            behind,
            lines,
        }
    }

    /// Returns the bounding ball of the patch, in the patch frame.
    pub fn ball(&self) -> Sphere {
        Sphere {
            center: self.extrusion.uvw_from_patch().transpose() * self.ball_in_uvw.center,
            ..self.ball_in_uvw
        }
    }

    /// Returns the heap memory that the patch uses in bytes.
    pub fn n_bytes(&self) -> usize {
        size_of_val(self.extrusion.places())
            + size_of_val(self.extrusion.axes())
            + size_of_val(self.extrusion.rows())
            + size_of_val(&self.bundles[..])
            + size_of_val(&self.circles[..])
            + size_of_val(&self.lines.positions[..])
    }
}

impl Bundle {
    fn new(columns: &[(DVec2, DVec2)]) -> Self {
        // Everything is in front of the padding, because a sphere behind a substrate takes a slower path.
        let nowhere = (DVec2::splat(FAR), DVec2::NEG_X);
        let of = |value| filled(columns, &nowhere, value);
        Self {
            u: of(|(place, _)| place.x),
            v: of(|(place, _)| place.y),
            axis_u: of(|(_, axis)| axis.x),
            axis_v: of(|(_, axis)| axis.y),
        }
    }
}

/// Position of a sphere relative to the columns of a bundle; equal for all rows.
#[derive(Clone, Debug)]
pub(super) struct SphereOverBundle {
    /// For each column, the squared sum of the radii of taxel and sphere minus the squared distance of the sphere from the column's axis, m².
    pub squares: [f64; LANES],
    /// Height of the sphere along the axis of each column, metres.
    pub heights: [f64; LANES],
}

impl SphereOverBundle {
    /// Returns the sphere's position relative to the columns. Also returns the square of the largest distance along the rows, m², at which the sphere pushes
    /// a taxel from the front. The square is zero or less if the sphere pushes no taxel.
    #[inline(always)]
    pub fn new(bundle: &Bundle, center: DVec3, reach: f64) -> (Self, f64) {
        let (mut squares, mut heights, mut spares) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let (du, dv) = (center.x - bundle.u[k], center.y - bundle.v[k]);
            let beside = du * bundle.axis_v[k] - dv * bundle.axis_u[k];
            let height = du * bundle.axis_u[k] + dv * bundle.axis_v[k];
            let square = reach * reach - beside * beside;
            let above = height.max(0.0);
            squares[k] = square;
            heights[k] = height;
            spares[k] = square - above * above;
        }
        (Self { squares, heights }, largest(&spares))
    }

    /// Raises the deflections of the taxels in one row of the bundle. `along2` is the squared distance along the rows from the sphere to this row, m².
    #[inline(always)]
    pub fn push(&self, along2: f64, is_small: bool, taxels: &mut [f64; LANES]) {
        let mut squares = self.squares;
        for square in &mut squares {
            *square -= along2;
        }
        if is_small || beats(&squares, &self.heights, taxels) {
            indent(&squares, &self.heights, taxels);
        }
    }

    /// Returns for each column the value `squares` − `along2`, m², from which deflections are computed. The value is −1 if the sphere does not push the
    /// column's taxel, whose substrate has the height `behind`.
    #[inline(always)]
    pub fn through(&self, along2: f64, behind: f64) -> [f64; LANES] {
        let mut squares = self.squares;
        for square in &mut squares {
            *square -= along2;
        }
        squares_in_front(&squares, &self.heights, behind)
    }
}
