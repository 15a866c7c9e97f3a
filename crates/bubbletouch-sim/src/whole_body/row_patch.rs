//! A patch that is a row of taxels repeated along a line: flat, or a part of a cylinder.

use super::lanes::{Balls, FAR, LANES, ball_around, filled};
use crate::contact::Lines;
use crate::objects::Sphere;
use crate::world::Extrusion;
use glam::DVec2;

/// Equal taxels in a row that is repeated, and what finds those that a sphere is near.
#[derive(Clone, Debug)]
pub(super) struct RowPatch {
    extrusion: Extrusion,
    /// Height of the substrate, metres.
    behind: f64,
    bundles: Vec<Bundle>,
    circles: Vec<Balls>,
    lines: Lines,
    /// Around all taxels from their rest centres back to the substrate: u, v, w.
    ball: Sphere,
}

/// Neighbouring columns, coordinate by coordinate: rest centres (metres) and axes. The last one is filled up with some far away.
#[derive(Clone, Debug)]
pub(super) struct Bundle {
    pub u: [f64; LANES],
    pub v: [f64; LANES],
    pub axis_u: [f64; LANES],
    pub axis_v: [f64; LANES],
}

impl RowPatch {
    /// Taxels with their substrate at the height `behind`, metres.
    pub fn new(extrusion: Extrusion, behind: f64) -> Self {
        let columns = extrusion.places().iter().copied();
        let columns: Vec<_> = columns.zip(extrusion.axes().iter().copied()).collect();
        let lines = Lines::at(extrusion.rows());
        let (first, last) = (
            lines.positions[0],
            lines.positions[lines.positions.len() - 1],
        );
        // From the rest centres back to the substrate, across the rows.
        let ends = |&(place, axis): &(DVec2, DVec2)| {
            [place, place + behind * axis].map(|end: DVec2| end.extend(0.0))
        };
        let circle = |columns: &[_]| ball_around(columns.iter().flat_map(ends));
        let circles: Vec<Sphere> = columns.chunks(LANES).map(circle).collect();
        let whole = circle(&columns);
        let center = whole.center.with_z(0.5 * (first + last));
        Self {
            ball: Sphere {
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

    /// Where the taxels rest.
    pub fn extrusion(&self) -> &Extrusion {
        &self.extrusion
    }

    /// Height of the substrate, metres.
    #[inline(always)]
    pub fn behind(&self) -> f64 {
        self.behind
    }

    /// As [`BodyPatch::ball`](super::BodyPatch::ball).
    pub fn ball(&self) -> Sphere {
        Sphere {
            center: self.extrusion.uvw_from_patch().transpose() * self.ball.center,
            ..self.ball
        }
    }

    /// The same ball with its centre as u, v, w.
    pub fn ball_in_uvw(&self) -> Sphere {
        self.ball
    }

    /// Bytes that it holds on the heap.
    pub fn n_bytes(&self) -> usize {
        size_of_val(self.extrusion.places())
            + size_of_val(self.extrusion.axes())
            + size_of_val(self.extrusion.rows())
            + size_of_val(&self.bundles[..])
            + size_of_val(&self.circles[..])
            + size_of_val(&self.lines.positions[..])
    }

    /// The rows.
    pub fn lines(&self) -> &Lines {
        &self.lines
    }

    /// The bundles of columns.
    pub fn bundles(&self) -> &[Bundle] {
        &self.bundles
    }

    /// Circles around them across the rows, as balls with their middles at w = 0.
    pub fn circles(&self) -> &[Balls] {
        &self.circles
    }
}

impl Bundle {
    fn new(columns: &[(DVec2, DVec2)]) -> Self {
        // Everything is in front of them: what is behind a substrate takes a slower way.
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
