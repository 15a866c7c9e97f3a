//! Arrays of taxels that can be compared: as many an area as a square grid, on as large a surface.

use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::world::{Grid, Layout};
use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Neighbours in a hexagonal lattice with a taxel an area of 1 are this far apart: √(2/√3).
const HEXAGONAL: f64 = 1.074_569_931_823_542;
/// Its rows are this far apart: that times √3/2.
const ROWS: f64 = 0.930_604_859_102_1;

/// How the taxels of an array lie, with a taxel on each square of a pitch and together on the area of a square grid, n × n pitches: within a
/// few of a hundred as many taxels. In the patch frame the middle is at the origin with its axis along +z.
///
/// The pitch of an array is the side of a square with the area per taxel, in every layout. In a hexagonal lattice of that density the six
/// neighbours of a taxel are [farther away](Self::neighbour_distance): 2.149 mm at a pitch of 2 mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArrayLayout {
    /// Rows and columns.
    #[default]
    Grid,
    /// Staggered rows: each taxel has six neighbours, 1.0746 pitches away.
    Hexagonal,
    /// The same lattice in a circle.
    Disc,
    /// The grid bent around a cylinder along patch y.
    Cylinder,
    /// Rings on a sphere, around its pole.
    Cap,
}

impl ArrayLayout {
    /// Whether it has a radius of curvature.
    pub fn is_curved(self) -> bool {
        matches!(self, Self::Cylinder | Self::Cap)
    }

    /// The distance between neighbours in a lattice whose pitch is another length, metres: √(2/√3) pitches in a hexagonal lattice; `None`
    /// in other layouts, whose neighbours are about a pitch apart.
    pub fn neighbour_distance(self, pitch: f64) -> Option<f64> {
        matches!(self, Self::Hexagonal | Self::Disc).then_some(HEXAGONAL * pitch)
    }

    /// What people call it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Grid => "square grid",
            Self::Hexagonal => "hexagonal",
            Self::Disc => "hexagonal disc",
            Self::Cylinder => "cylinder",
            Self::Cap => "sphere cap",
        }
    }

    /// Its taxels instead of those of a square grid (nx = ny); `radius`: of curvature, to the rest centres, metres; of no use to a flat one.
    ///
    /// # Errors
    /// A grid that is not square; a radius around which it does not fit: a cylinder at most half around, a cap at most half a sphere.
    pub fn taxels(self, grid: &Grid, radius: f64) -> Result<Layout> {
        grid.check()?;
        let (n, pitch) = (grid.nx, grid.pitch);
        if grid.nx != grid.ny {
            let given = format!("{n} × {} taxels", grid.ny);
            return Err(Error::input(self.words(), given, "as many rows as columns"));
        }
        let side = n as f64 * pitch;
        let neighbour = HEXAGONAL * pitch;
        match self {
            Self::Grid => Layout::grid(grid),
            Self::Hexagonal => {
                let (rows, columns) = hexagonal_sides(n);
                Layout::hexagonal(columns, rows, neighbour)
            }
            Self::Disc => Layout::disc(side / PI.sqrt(), neighbour),
            Self::Cylinder => {
                self.check_radius(side / PI, radius)?;
                Ok(Layout::bent_grid(grid, radius)?.moved(&up(radius)))
            }
            Self::Cap => {
                self.check_radius(side / TAU.sqrt(), radius)?;
                // The outermost taxels feel half a pitch beyond their ring.
                let whole = (1.0 - side * side / (TAU * radius * radius)).acos();
                let half_angle = (whole - 0.5 * pitch / radius).max(1e-9);
                let cap = Layout::sphere_cap(radius, half_angle, pitch)?;
                Ok(cap.moved(&Pose::from_translation(-radius * DVec3::Z)))
            }
        }
    }

    /// Its rows and columns, row after row, instead of those of a square grid; `None` of rings and of discs.
    pub fn sides(self, grid: &Grid) -> Option<(usize, usize)> {
        match self {
            Self::Grid | Self::Cylinder => Some((grid.ny, grid.nx)),
            Self::Hexagonal => Some(hexagonal_sides(grid.nx)),
            Self::Disc | Self::Cap => None,
        }
    }

    fn check_radius(self, least: f64, radius: f64) -> Result<()> {
        // What fits exactly is not refused for its last bit.
        if radius.is_finite() && radius >= least * (1.0 - 1e-9) {
            return Ok(());
        }
        let given = format!("a radius of {} mm", 1e3 * radius);
        let half = match self {
            Self::Cap => "half a sphere",
            _ => "half of the circle",
        };
        let allowed = format!("at least {:.3} mm, where it is {half}", 1e3 * least);
        Err(Error::input(self.words(), given, allowed))
    }
}

/// Rows and columns on the area of n × n pitches.
fn hexagonal_sides(n: usize) -> (usize, usize) {
    let side = |step: f64| (n as f64 / step).round().max(1.0) as usize;
    (side(ROWS), side(HEXAGONAL))
}

/// Puts the middle of a cylinder around z, at +x, to the origin, its axis along z and its rings along y.
fn up(radius: f64) -> Pose {
    let rotation = DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y);
    Pose {
        translation: -radius * DVec3::Z,
        rotation: DQuat::from_mat3(&rotation),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(layout: ArrayLayout, n: usize, radius: f64) -> Layout {
        let pitch = 2e-3;
        let grid = Grid {
            nx: n,
            ny: n,
            pitch,
        };
        layout.taxels(&grid, radius).unwrap()
    }

    const ALL: [ArrayLayout; 5] = [
        ArrayLayout::Grid,
        ArrayLayout::Hexagonal,
        ArrayLayout::Disc,
        ArrayLayout::Cylinder,
        ArrayLayout::Cap,
    ];

    #[test]
    fn neighbours_of_a_hexagonal_lattice_are_as_far_apart_as_it_says() {
        for layout in [ArrayLayout::Hexagonal, ArrayLayout::Disc] {
            let taxels = made(layout, 12, 0.0);
            let centers = taxels.centers();
            let distances = centers[1..].iter().map(|other| other.distance(centers[0]));
            let nearest = distances.fold(f64::INFINITY, f64::min);
            let distance = layout.neighbour_distance(2e-3).unwrap();
            assert!((nearest - distance).abs() < 1e-12 && (distance - 2.149e-3).abs() < 1e-6);
        }
        assert_eq!(ArrayLayout::Grid.neighbour_distance(2e-3), None);
    }

    #[test]
    fn all_have_about_as_many_taxels_with_the_middle_at_the_origin() {
        for n in [8, 16, 32, 64] {
            for layout in ALL {
                let taxels = made(layout, n, 0.06);
                let share = taxels.n_taxels() as f64 / (n * n) as f64;
                assert!(
                    (share - 1.0).abs() < 0.5 / n as f64 + 0.02,
                    "{layout:?} {n}: {share}"
                );
                let centers = taxels.centers().iter();
                let middle = centers.clone().sum::<DVec3>() / taxels.n_taxels() as f64;
                assert!(
                    middle.truncate().length() < 1e-4,
                    "{layout:?} {n}: {middle}"
                );
                let highest = centers.map(|c| c.z).fold(f64::NEG_INFINITY, f64::max);
                assert!(highest.abs() < 2e-5, "{layout:?} {n}: {highest}");
                assert!(
                    taxels.axes().iter().all(|axis| axis.z >= -1e-12),
                    "{layout:?} {n}"
                );
            }
        }
    }

    #[test]
    fn a_bent_grid_is_the_grid_in_the_limit_of_a_large_radius() {
        let flat = made(ArrayLayout::Grid, 12, 0.0);
        let bent = made(ArrayLayout::Cylinder, 12, 1e3);
        assert_eq!(bent.n_taxels(), flat.n_taxels());
        for (bent, flat) in bent.centers().iter().zip(flat.centers()) {
            assert!(bent.distance(*flat) < 1e-6, "{bent} for {flat}");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let grid = Grid {
            nx: 10,
            ny: 10,
            pitch: 2e-3,
        };
        let refused =
            |layout: ArrayLayout, radius| layout.taxels(&grid, radius).unwrap_err().to_string();
        assert_eq!(
            refused(ArrayLayout::Cylinder, 5e-3),
            "cylinder: a radius of 5 mm; at least 6.366 mm, where it is half of the circle"
        );
        assert_eq!(
            refused(ArrayLayout::Cap, 5e-3),
            "sphere cap: a radius of 5 mm; at least 7.979 mm, where it is half a sphere"
        );
    }
}
