//! Arrays of equal area and taxel density, for comparing layouts.
//!
//! An array has one taxel per square of side pitch, and its taxels cover the area of a square grid, n × n pitches. The number of taxels is within a few
//! per cent of n². In the patch frame the middle is at the origin, with its axis along +z.
//!
//! In every layout, the pitch is the side of a square whose area is the mean area per taxel. In a hexagonal lattice of this density, the distance to the
//! six neighbours exceeds the pitch (2.149 mm at a pitch of 2 mm). In a foveated grid, the distance varies over the array.

#[macro_use]
mod about;
mod lattice;

use crate::error::{Error, Result};
use crate::world::ImageShape;
use crate::world::{Grid, Layout};
use about::LayoutAbout;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

// The rest of the program refers to a layout only by its line here and the file that the line names.
array_layouts! {
    Grid grid "Rows and columns.";
    Foveated foveated "Rows and columns, half a pitch apart in the middle and two pitches apart at the edge.";
    Hexagonal hexagonal "Staggered rows: each taxel has six neighbours, 1.0746 pitches away.";
    Disc disc "The hexagonal lattice in a circle.";
    Cylinder cylinder "The grid bent around a cylinder along patch y.";
    Cap cap "Rings on a sphere, around its pole.";
}

impl ArrayLayout {
    /// Returns whether the layout has a radius of curvature.
    pub fn is_curved(self) -> bool {
        self.about().curved.is_some()
    }

    /// Returns whether the taxels lie in straight rows and columns, one pitch apart along the surface.
    pub fn is_image(self) -> bool {
        self.about().is_image
    }

    /// Returns the distance between neighbouring taxels, metres, if it differs from the pitch: √(2/√3) pitches in a hexagonal lattice. Returns `None` for other
    /// layouts, whose neighbours are about a pitch apart.
    pub fn neighbour_distance(self, pitch: f64) -> Option<f64> {
        self.about().neighbour_pitches.map(|n| n * pitch)
    }

    /// Returns the largest distance between neighbouring rows or columns of taxels, in pitches; about 1 if the density is the same everywhere.
    pub fn widest_pitches(self) -> f64 {
        self.about().widest_pitches
    }

    /// Returns the display name of the layout.
    pub fn words(self) -> &'static str {
        self.about().words
    }

    /// Returns the position of a taxel on a plane, metres: x and y in a flat layout, a projection otherwise. `radius` is the radius of curvature, metres.
    pub fn place_on_plane(self, center: DVec3, radius: f64) -> DVec2 {
        (self.about().place_on_plane)(center, radius)
    }

    /// Creates the taxels of the layout for the area of a square grid (nx = ny). `radius` is the radius of curvature at the centres of the taxels, metres;
    /// flat layouts ignore this value.
    ///
    /// # Errors
    /// If the grid is not square, or the layout does not fit around the radius. A cylinder covers at most half a turn, and a cap at most half a sphere.
    pub fn taxels(self, grid: &Grid, radius: f64) -> Result<Layout> {
        grid.check()?;
        let about = self.about();
        if grid.nx != grid.ny {
            let given = format!("{} × {} taxels", grid.nx, grid.ny);
            return Err(Error::input(about.words, given, "as many rows as columns"));
        }
        if let Some(curved) = &about.curved {
            let least = (curved.least_radius)(grid.nx as f64 * grid.pitch);
            // Rounding must not exclude a layout that fits exactly.
            if !(radius.is_finite() && radius >= least * (1.0 - 1e-9)) {
                let given = format!("a radius of {} mm", 1e3 * radius);
                let half = curved.half;
                let allowed = format!("at least {:.3} mm, where it is {half}", 1e3 * least);
                return Err(Error::input(about.words, given, allowed));
            }
        }
        (about.taxels)(grid, radius)
    }

    /// Returns the numbers of rows and columns if taxels are numbered row by row, else `None`.
    pub fn sides(self, grid: &Grid) -> Option<ImageShape> {
        (self.about().sides)(grid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::fixtures::grid;

    fn made(layout: ArrayLayout, n: usize, radius: f64) -> Layout {
        layout.taxels(&grid(n, n, 2e-3), radius).unwrap()
    }

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
            for &layout in ArrayLayout::ALL {
                let taxels = made(layout, n, 0.06);
                let share = taxels.n_taxels() as f64 / (n * n) as f64;
                let error = (share - 1.0).abs();
                assert!(error < 0.5 / n as f64 + 0.02, "{layout:?} {n}: {share}");
                let centers = taxels.centers().iter();
                let middle = centers.clone().sum::<DVec3>() / taxels.n_taxels() as f64;
                let aside = middle.truncate().length();
                assert!(aside < 1e-4, "{layout:?} {n}: {middle}");
                let highest = centers.map(|c| c.z).fold(f64::NEG_INFINITY, f64::max);
                assert!(highest.abs() < 2e-5, "{layout:?} {n}: {highest}");
                let is_up = taxels.axes().iter().all(|axis| axis.z >= -1e-12);
                assert!(is_up, "{layout:?} {n}");
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
        for (layout, message) in [
            (
                ArrayLayout::Cylinder,
                "cylinder: a radius of 5 mm; at least 6.366 mm, where it is half of the circle",
            ),
            (
                ArrayLayout::Cap,
                "sphere cap: a radius of 5 mm; at least 7.979 mm, where it is half a sphere",
            ),
        ] {
            let error = layout.taxels(&grid(10, 10, 2e-3), 5e-3).unwrap_err();
            assert_eq!(error.to_string(), message);
        }
    }
}
