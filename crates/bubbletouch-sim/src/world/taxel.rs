//! A taxel, and a rectangular grid of them.

use crate::error::{Error, Result};
use crate::text::in_range::{not_negative, positive};
use glam::DVec3;

/// One sensing element: a sphere on a spring and damper, sliding along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taxel {
    /// ρ, metres, positive.
    pub radius: f64,
    /// k, N/m, positive.
    pub stiffness: f64,
    /// c, N·s/m, zero or positive.
    pub damping: f64,
    /// s, metres, positive: how far it can be pushed in before it is saturated.
    pub stroke: f64,
}

impl Taxel {
    /// Height of the substrate above the rest centre, along the axis, metres: −s − ρ. The contact law (`contact::law`) ignores what is behind.
    pub fn substrate(&self) -> f64 {
        -self.stroke - self.radius
    }

    /// Whether it can be.
    ///
    /// # Errors
    /// The first property that is out of its range, by its name.
    pub fn check(&self) -> Result<()> {
        positive("taxel radius", self.radius, "m")?;
        positive("taxel stiffness", self.stiffness, "N/m")?;
        positive("taxel stroke", self.stroke, "m")?;
        not_negative("taxel damping", self.damping, "N·s/m").map(drop)
    }
}

/// A rectangular grid of rest positions, centred on the patch's origin.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Grid {
    /// Columns, along patch x.
    pub nx: usize,
    /// Rows, along patch y.
    pub ny: usize,
    /// Metres between neighbours, positive.
    #[serde(rename = "pitch_m")]
    pub pitch: f64,
}

impl Grid {
    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        self.nx * self.ny
    }

    /// x of a column, metres: `(column − (nx − 1)/2) · pitch`.
    pub fn x(&self, column: usize) -> f64 {
        (column as f64 - 0.5 * (self.nx as f64 - 1.0)) * self.pitch
    }

    /// y of a row, metres: `(row − (ny − 1)/2) · pitch`.
    pub fn y(&self, row: usize) -> f64 {
        (row as f64 - 0.5 * (self.ny as f64 - 1.0)) * self.pitch
    }

    /// Rest centres and axes, row (patch y, ascending) by row.
    pub(super) fn taxels(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let rows = (0..self.ny).map(|row| self.y(row));
        rows.flat_map(move |y| {
            (0..self.nx).map(move |column| (DVec3::new(self.x(column), y, 0.0), DVec3::Z))
        })
    }

    /// Whether it can be.
    ///
    /// # Errors
    /// The first property that is out of its range, by its name.
    pub fn check(&self) -> Result<()> {
        if self.nx == 0 || self.ny == 0 {
            return Err(Error::input(
                "taxel grid",
                format!("{} × {} taxels", self.nx, self.ny),
                "at least one taxel each way",
            ));
        }
        positive("taxel pitch", self.pitch, "m").map(drop)
    }
}
