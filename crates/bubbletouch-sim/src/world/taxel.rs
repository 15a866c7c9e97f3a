//! Taxel, and rectangular grid of taxels.

use crate::error::{Error, Result};
use crate::text::in_range::{not_negative, positive};
use glam::DVec3;

/// Sensing element: a sphere on a spring and damper that slides along one axis.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Taxel {
    /// Radius of the taxel's sphere, metres, positive.
    pub radius: f64,
    /// Stiffness of the spring, N/m, positive.
    pub stiffness: f64,
    /// Damping of the damper, N·s/m, zero or positive.
    pub damping: f64,
    /// Stroke, metres, positive: the deflection at which the taxel is saturated.
    pub stroke: f64,
}

impl Taxel {
    /// Returns the height of the substrate along the axis, relative to the taxel's centre at rest, metres: minus the sum of stroke and radius. The contact
    /// law ignores objects behind the substrate.
    pub fn substrate(&self) -> f64 {
        -self.stroke - self.radius
    }

    /// Returns an error if a property of the taxel is out of range.
    ///
    /// # Errors
    /// If a property is out of its range; the error names the first one.
    pub fn check(&self) -> Result<()> {
        positive("taxel radius", self.radius, "m")?;
        positive("taxel stiffness", self.stiffness, "N/m")?;
        positive("taxel stroke", self.stroke, "m")?;
        not_negative("taxel damping", self.damping, "N·s/m").map(drop)
    }
}

/// Shape of an image of taxels: numbers of rows and columns. The values of an image are listed row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
pub struct ImageShape {
    /// Number of rows, along patch y.
    pub ny: usize,
    /// Number of columns, along patch x.
    pub nx: usize,
}

impl ImageShape {
    /// Returns the shape of a list of `n` values without neighbours: one row.
    pub fn row(n: usize) -> Self {
        Self { ny: 1, nx: n }
    }

    /// Returns the number of values of an image.
    pub fn n_values(self) -> usize {
        self.ny * self.nx
    }
}

/// Rectangular grid of taxels, centred on the patch's origin.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Grid {
    /// Number of columns, along patch x.
    pub nx: usize,
    /// Number of rows, along patch y.
    pub ny: usize,
    /// Distance between neighbouring taxels, metres, positive.
    #[serde(rename = "pitch_m")]
    pub pitch: f64,
}

impl Grid {
    /// Returns the shape of an image of the grid.
    pub fn shape(&self) -> ImageShape {
        ImageShape {
            ny: self.ny,
            nx: self.nx,
        }
    }

    /// Returns the number of taxels of the grid.
    pub fn n_taxels(&self) -> usize {
        self.nx * self.ny
    }

    /// Returns the x coordinate of a column, metres: `(column − (nx − 1)/2) · pitch`.
    pub fn x(&self, column: usize) -> f64 {
        (column as f64 - 0.5 * (self.nx as f64 - 1.0)) * self.pitch
    }

    /// Returns the y coordinate of a row, metres: `(row − (ny − 1)/2) · pitch`.
    pub fn y(&self, row: usize) -> f64 {
        (row as f64 - 0.5 * (self.ny as f64 - 1.0)) * self.pitch
    }

    /// Returns the centres (at rest, metres) and the axes of the grid's taxels, row by row (patch y, ascending).
    pub(super) fn taxels(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let rows = (0..self.ny).map(|row| self.y(row));
        rows.flat_map(move |y| {
            (0..self.nx).map(move |column| (DVec3::new(self.x(column), y, 0.0), DVec3::Z))
        })
    }

    /// Returns an error if the size or the pitch of the grid is out of range.
    ///
    /// # Errors
    /// If a property is out of its range; the error names the first one.
    pub fn check(&self) -> Result<()> {
        if self.nx == 0 || self.ny == 0 {
            let given = format!("{} × {} taxels", self.nx, self.ny);
            let allowed = "at least one taxel each way";
            return Err(Error::input("taxel grid", given, allowed));
        }
        positive("taxel pitch", self.pitch, "m").map(drop)
    }
}
