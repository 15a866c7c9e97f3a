//! Layouts that repeat one row of taxels along a straight line: grids, and parts of cylinders.
//!
//! An extrusion stores only one row and the positions of the rows, whereas a [`Layout`](super::Layout) needs 48 bytes per taxel. Bodies with millions
//! of taxels consist of extrusions.

use super::limits::{check_angle, check_count};
use super::ring::{Ring, ends_of_steps, n_steps};
use crate::error::Result;
use crate::text::in_range::{not_negative, positive};
use crate::world::Grid;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::TAU;

/// Row of taxels in the plane of the coordinates u and v, repeated along the coordinate w.
///
/// Taxel `row · n_columns + column` has its centre (at rest) at `places[column]` in the plane and at `rows[row]` along w; its axis is `axes[column]`, in the
/// plane. Invariant: there are as many axes as places (at least one), all finite. Axes are unit vectors, and rows ascend.
#[derive(Clone, Debug, PartialEq)]
pub struct Extrusion {
    places: Vec<DVec2>,
    axes: Vec<DVec2>,
    rows: Vec<f64>,
    uvw_from_patch: DMat3,
}

impl Extrusion {
    /// Returns the centres (at rest, metres) and the unit axes of all taxels, row by row.
    pub(crate) fn taxels(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let patch_from_uvw = self.uvw_from_patch.transpose();
        self.rows.iter().flat_map(move |&w| {
            let columns = self.places.iter().zip(&self.axes);
            columns.map(move |(place, axis)| {
                let (center, axis) = (place.extend(w), axis.extend(0.0));
                (patch_from_uvw * center, patch_from_uvw * axis)
            })
        })
    }

    /// Creates an extrusion with the taxels of a flat grid; the coordinates u, v, w are the patch's x, z, y.
    ///
    /// # Errors
    /// If the grid is invalid.
    pub fn grid(grid: &Grid) -> Result<Self> {
        grid.check()?;
        check_count("taxel grid", grid.nx as f64 * grid.ny as f64)?;
        Ok(Self {
            places: (0..grid.nx)
                .map(|column| DVec2::new(grid.x(column), 0.0))
                .collect(),
            axes: vec![DVec2::Y; grid.nx],
            rows: (0..grid.ny).map(|row| grid.y(row)).collect(),
            uvw_from_patch: DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y),
        })
    }

    /// Creates a grid bent around a cylinder. The arguments and the taxels equal those of the layout `cylinder`. The coordinates u, v, w are the patch's x,
    /// y, z.
    ///
    /// # Errors
    /// If an argument is out of its range, or the layout has too many taxels.
    pub fn cylinder(radius: f64, length: f64, arc: f64, pitch: f64) -> Result<Self> {
        positive("taxel pitch", pitch, "m")?;
        positive("cylinder radius", radius, "m")?;
        not_negative("cylinder length", length, "m")?;
        check_angle("cylinder arc", arc, TAU)?;
        let (around, along) = (arc * radius / pitch, length / pitch);
        check_count("cylinder layout", (around + 1.0) * (along + 1.0))?;
        let is_closed = (TAU - arc) * radius < 0.5 * pitch;
        let angles: Vec<f64> = if is_closed {
            let n = n_steps(TAU * radius, pitch).max(1);
            (0..n).map(|k| (k as f64 / n as f64 - 0.5) * TAU).collect()
        } else {
            let ends = ends_of_steps(n_steps(arc * radius, pitch));
            ends.map(|end| end * arc).collect()
        };
        let ring = |radius| Ring {
            radius,
            height: 0.0,
        };
        let place = |radius, &angle: &f64| ring(radius).place(angle).truncate();
        let axis = |angle| place(1.0, angle).normalize();
        Ok(Self {
            places: angles.iter().map(|angle| place(radius, angle)).collect(),
            axes: angles.iter().map(axis).collect(),
            rows: ends_of_steps(n_steps(length, pitch))
                .map(|end| end * length)
                .collect(),
            uvw_from_patch: DMat3::IDENTITY,
        })
    }

    /// Returns the centres (at rest) of the taxels in one row, in the plane of u and v, metres, shape (n_columns,).
    pub fn places(&self) -> &[DVec2] {
        &self.places
    }

    /// Returns the unit axes of the taxels in one row, pointing away from the substrate, in the plane of u and v, shape (n_columns,).
    pub fn axes(&self) -> &[DVec2] {
        &self.axes
    }

    /// Returns the positions of the rows along w, metres, ascending.
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// Returns the matrix that maps vectors of the patch frame to the coordinates u, v, w.
    pub fn uvw_from_patch(&self) -> DMat3 {
        self.uvw_from_patch
    }

    /// Returns the number of taxels of all rows.
    pub fn n_taxels(&self) -> usize {
        self.places.len() * self.rows.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Layout;
    use crate::world::fixtures::grid;

    #[test]
    fn a_grid_has_the_taxels_of_the_layout_of_that_grid() {
        let grid = grid(5, 3, 2e-3);
        let extrusion = Extrusion::grid(&grid).unwrap();
        let (layout, expected) = (Layout::from(extrusion), Layout::grid(&grid).unwrap());
        assert_eq!(layout.centers(), expected.centers());
        assert_eq!(layout.axes(), expected.axes());
    }
}
