//! Centres (at rest) and axes of the taxels of a skin.

use super::limits::check_count;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::world::{Dome, Extrusion, Grid};
use glam::{DMat3, DVec3};
use std::sync::OnceLock;

/// Largest deviation of a given axis's length from one; axes written with two digits deviate less. If larger, vectors are accepted that are not unit vectors;
/// if smaller, typical files are refused.
const MAX_LENGTH_ERROR: f64 = 0.01;

/// Largest deviation of a unit vector's length from one due to rounding of its coordinates.
const UNIT_ROUNDING: f64 = 1e-9;

/// Arrangement of taxels: their centres (at rest) and axes, in the patch frame.
///
/// Invariant: there are as many axes as centres, all finite, and axes are unit vectors. A layout that follows a rule (a grid, an [`Extrusion`] or a
/// [`Dome`]) stores only the rule. The centres and axes (48 bytes per taxel) are computed on demand.
///
/// | family | shape | taxels |
/// |---|---|---|
/// | [`grid`](Self::grid) | rectangle, square cells | nx · ny |
/// | [`hexagonal`](Self::hexagonal) | rectangle, rows staggered | nx · ny |
/// | [`disc`](Self::disc) | round | about 2π r² / (√3 pitch²) |
/// | [`annulus`](Self::annulus) | ring | about its area / pitch² |
/// | [`cylinder`](Self::cylinder) | forearm, finger | about arc · radius · length / pitch² |
/// | [`sphere_cap`](Self::sphere_cap) | fingertip, elbow | about its area / pitch² |
/// | [`draped`](Self::draped) | outer surface of a triangle mesh | about its area / pitch² |
#[derive(Clone, Debug)]
pub struct Layout {
    rule: Rule,
    places: OnceLock<Places>,
    /// Numbers of rows and columns, if the taxels are numbered row by row.
    sides: Option<[usize; 2]>,
    n_left_out: usize,
}

/// Rule by which the taxels of a layout are arranged, from which their centres and axes are computed.
#[derive(Clone, Debug)]
pub(crate) enum Rule {
    /// Rows and columns in a plane.
    Grid(Grid),
    /// One row of taxels repeated along a line.
    Rows(Extrusion),
    /// Rings on a sphere.
    Dome(Dome),
    /// No rule: arbitrary positions and axes.
    None,
}

#[derive(Clone, Debug, PartialEq)]
struct Places {
    centers: Vec<DVec3>,
    axes: Vec<DVec3>,
}

/// Layouts are equal if they have equal taxels in equal order.
impl PartialEq for Layout {
    fn eq(&self, other: &Self) -> bool {
        self.places() == other.places()
    }
}

impl Layout {
    /// Creates a layout from arbitrary centres of taxels at rest (metres) and axes (unit, away from the substrate). Axes are normalised, because files
    /// contain few digits.
    ///
    /// # Errors
    /// If the two lists differ in length, or a centre or an axis is invalid; the error contains the first such taxel (from 1). An axis is invalid if its length
    /// differs from one by more than 1 %.
    pub fn new(centers: Vec<DVec3>, mut axes: Vec<DVec3>) -> Result<Self> {
        if centers.len() != axes.len() {
            let given = format!("{} places with {} axes", centers.len(), axes.len());
            let allowed = "one axis a taxel";
            return Err(Error::input("layout", given, allowed));
        }
        check_count("layout", centers.len() as f64)?;
        for (index, (center, axis)) in centers.iter().zip(&mut axes).enumerate() {
            let place = || format!("layout, taxel {}", index + 1);
            if !center.is_finite() {
                let given = format!("centre {center}");
                let allowed = "finite coordinates in metres";
                return Err(Error::input(place(), given, allowed));
            }
            let length = axis.length();
            if !(axis.is_finite() && (length - 1.0).abs() <= MAX_LENGTH_ERROR) {
                let given = format!("axis {axis} of length {length}");
                let allowed = "a vector of length one, within 1 %";
                return Err(Error::input(place(), given, allowed));
            }
            *axis = unit_axis(*axis);
        }
        Ok(Self::of_places(Places { centers, axes }))
    }

    /// Creates a grid of taxels in the plane z = 0, row by row (patch y, ascending); the method `as_grid` returns this grid.
    ///
    /// # Errors
    /// If the grid is invalid.
    pub fn grid(grid: &Grid) -> Result<Self> {
        grid.check()?;
        check_count("taxel grid", grid.nx as f64 * grid.ny as f64)?;
        Ok(Self {
            sides: Some([grid.ny, grid.nx]),
            ..Self::of_rule(Rule::Grid(*grid))
        })
    }

    /// Returns the layout with its taxels numbered row by row, in an image with the given numbers of rows and columns.
    ///
    /// # Errors
    /// If the number of taxels differs from the number of pixels.
    pub fn with_sides(self, [n_rows, n_columns]: [usize; 2]) -> Result<Self> {
        if n_rows.checked_mul(n_columns) != Some(self.n_taxels()) {
            let given = format!("{n_rows} × {n_columns} for {} taxels", self.n_taxels());
            return Err(Error::input("layout sides", given, "one pixel a taxel"));
        }
        Ok(Self {
            sides: Some([n_rows, n_columns]),
            ..self
        })
    }

    /// Returns the numbers of rows and columns of the image that the taxels form. The taxels are numbered row by row. Returns `None` if the layout has no such
    /// image.
    pub fn sides(&self) -> Option<[usize; 2]> {
        self.sides
    }

    /// Returns the number of taxels of the layout.
    pub fn n_taxels(&self) -> usize {
        match &self.rule {
            Rule::Grid(grid) => grid.n_taxels(),
            Rule::Rows(rows) => rows.n_taxels(),
            Rule::Dome(dome) => dome.n_taxels(),
            Rule::None => self.centers().len(),
        }
    }

    /// Returns the number of taxels that a draped layout omitted because a ray along their axis would hit the mesh again; 0 for other layouts.
    pub fn n_left_out(&self) -> usize {
        self.n_left_out
    }

    pub(crate) fn with_left_out(self, n_left_out: usize) -> Self {
        Self { n_left_out, ..self }
    }

    /// Returns the centres of the taxels at rest, metres, shape (n_taxels,).
    pub fn centers(&self) -> &[DVec3] {
        &self.places().centers
    }

    /// Returns the unit axes of the taxels, pointing away from the substrate, shape (n_taxels,).
    pub fn axes(&self) -> &[DVec3] {
        &self.places().axes
    }

    fn places(&self) -> &Places {
        self.places.get_or_init(|| match &self.rule {
            Rule::Grid(grid) => grid.taxels().collect(),
            Rule::Rows(rows) => rows.taxels().collect(),
            Rule::Dome(dome) => dome.taxels().collect(),
            Rule::None => unreachable!("places without a rule are there from the start"),
        })
    }

    /// Returns the rule by which the taxels are arranged.
    pub(crate) fn rule(&self) -> &Rule {
        &self.rule
    }

    /// Returns the rotation from one taxel's frame to the patch frame. Its columns are x and y (perpendicular to the taxel's axis) and z (the axis).
    ///
    /// If the axis points above the patch's xy plane, the frame is the patch frame after the smallest rotation that aligns the patch's z with the axis.
    /// Otherwise the frame consists of x and −y of the patch, rotated by the smallest rotation from −z to the axis. The taxels of a flat skin therefore
    /// have the patch's x and y, and frames on a dome vary as little as their axes. Frames are discontinuous only where axes cross the xy plane.
    ///
    /// # Panics
    /// If the taxel does not exist.
    pub fn frame(&self, taxel: usize) -> DMat3 {
        let axis = self.axes()[taxel];
        let (x, y) = axis.any_orthonormal_pair();
        DMat3::from_cols(x, y, axis)
    }

    /// Returns the grid from which the layout was created; `None` for other layouts.
    pub fn as_grid(&self) -> Option<&Grid> {
        match &self.rule {
            Rule::Grid(grid) => Some(grid),
            _ => None,
        }
    }

    /// Returns the layout after a rigid motion in the patch frame. The result is no longer a grid, but keeps the numbers of rows and columns.
    #[must_use]
    pub fn moved(&self, pose: &Pose) -> Self {
        let taxels = self.centers().iter().zip(self.axes());
        let moved = Self::of_taxels(taxels.map(|(&center, &axis)| {
            let axis = (pose.rotation * axis).normalize();
            (pose.transform_point(center), axis)
        }));
        Self {
            sides: self.sides,
            ..moved.with_left_out(self.n_left_out)
        }
    }

    /// Creates a layout from taxels whose axes are all unit vectors.
    pub(crate) fn of_taxels(taxels: impl IntoIterator<Item = (DVec3, DVec3)>) -> Self {
        Self::of_places(taxels.into_iter().collect())
    }

    fn of_places(places: Places) -> Self {
        Self {
            places: places.into(),
            ..Self::of_rule(Rule::None)
        }
    }

    fn of_rule(rule: Rule) -> Self {
        Self {
            rule,
            places: OnceLock::new(),
            sides: None,
            n_left_out: 0,
        }
    }
}

/// Returns the unit vector in the direction of `axis`. If `axis` is a unit vector up to rounding, it is returned bitwise unchanged. A layout therefore keeps
/// its bits when it is written and read again.
pub fn unit_axis(axis: DVec3) -> DVec3 {
    match (axis.length() - 1.0).abs() <= UNIT_ROUNDING {
        true => axis,
        false => axis.normalize(),
    }
}

impl FromIterator<(DVec3, DVec3)> for Places {
    fn from_iter<T: IntoIterator<Item = (DVec3, DVec3)>>(taxels: T) -> Self {
        let (centers, axes) = taxels.into_iter().unzip();
        Self { centers, axes }
    }
}

impl From<Extrusion> for Layout {
    fn from(rows: Extrusion) -> Self {
        Self::of_rule(Rule::Rows(rows))
    }
}

impl From<Dome> for Layout {
    fn from(dome: Dome) -> Self {
        Self::of_rule(Rule::Dome(dome))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use crate::world::fixtures::{grid, vector};
    use glam::DQuat;

    #[test]
    fn a_grid_lies_as_the_grid_says_and_remembers_it() {
        let grid = grid(3, 2, 2e-3);
        let layout = Layout::grid(&grid).unwrap();
        assert_eq!(layout.as_grid(), Some(&grid));
        assert_eq!(layout.centers()[5], DVec3::new(2e-3, 1e-3, 0.0));
        assert!(layout.axes().iter().all(|&axis| axis == DVec3::Z));
    }

    #[test]
    fn frames_are_the_patchs_turned_the_least() {
        let mut rng = Seed::new(3).named("frames").rng();
        let axes = (0..200).map(|_| vector(&mut rng).normalize_or(DVec3::X));
        let axes: Vec<DVec3> = axes.collect();
        let layout = Layout::new(vec![DVec3::ZERO; 200], axes.clone()).unwrap();
        for (taxel, &axis) in axes.iter().enumerate() {
            let (pole, x, y) = match axis.z > 0.0 {
                true => (DVec3::Z, DVec3::X, DVec3::Y),
                false => (-DVec3::Z, DVec3::X, -DVec3::Y),
            };
            let least = DQuat::from_rotation_arc(pole, axis);
            let expected = DMat3::from_cols(least * x, least * y, axis);
            assert!(layout.frame(taxel).abs_diff_eq(expected, 1e-12), "{axis}");
            assert!((layout.frame(taxel).determinant() - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn axes_of_few_digits_are_normalised_and_others_keep_their_bits() {
        let third = DVec3::splat(1.0).normalize();
        let written = [
            DVec3::splat(0.5774),
            third,
            0.991 * DVec3::Y,
            1.009 * DVec3::Y,
        ];
        let layout = Layout::new(vec![DVec3::ZERO; 4], written.to_vec()).unwrap();
        let axes = layout.axes();
        assert!((axes[0] - third).length() < 1e-15 && axes[1] == third);
        assert_eq!(axes[2..], [DVec3::Y, DVec3::Y]);
        for length in [0.989, 1.011, 0.0, f64::INFINITY] {
            let given = vec![DVec3::Z, length * DVec3::X];
            let error = Layout::new(vec![DVec3::ZERO; 2], given).unwrap_err();
            let error = error.to_string();
            assert!(error.starts_with("layout, taxel 2: axis "), "{error}");
        }
    }
}
