//! Flat layouts: taxels in the plane z = 0 with their axes along +z.

use super::layout::Layout;
use super::limits::check_count;
use super::ring::{Ring, ends_of_steps, n_steps};
use crate::error::{Error, Result};
use crate::text::in_range::positive;
use glam::DVec3;

/// Distance between rows of a hexagonal lattice, in pitches: √3 / 2.
const ROWS: f64 = 0.866_025_403_784_438_6;

impl Layout {
    /// Creates `ny` rows of `nx` taxels, with every other row shifted by half a pitch. Each inner taxel has six neighbours at exactly `pitch` metres.
    /// Taxels are numbered row by row (patch y, ascending) and centred on the origin.
    ///
    /// # Errors
    /// If the pitch is not positive, or the number of taxels is zero or exceeds `MAX_TAXELS`.
    pub fn hexagonal(nx: usize, ny: usize, pitch: f64) -> Result<Self> {
        positive("taxel pitch", pitch, "m")?;
        check_count("hexagonal layout", nx as f64 * ny as f64)?;
        let middle = |n: usize| 0.5 * (n as f64 - 1.0);
        let taxels = (0..ny).flat_map(|row| {
            // A single row of taxels is not shifted.
            let stagger = if ny == 1 { 0.0 } else { 0.25 };
            let shift = if row % 2 == 0 { -stagger } else { stagger };
            let y = (row as f64 - middle(ny)) * ROWS * pitch;
            (0..nx).map(move |column| {
                let x = (column as f64 - middle(nx) + shift) * pitch;
                (DVec3::new(x, y, 0.0), DVec3::Z)
            })
        });
        Ok(Self::of_taxels(taxels))
    }

    /// Creates the part of a hexagonal lattice within `radius` metres of the origin, row by row. The nearest neighbours of each taxel are exactly `pitch`
    /// metres away. A radius below the pitch yields a single taxel at the origin.
    ///
    /// # Errors
    /// If a length is not positive, or the disc has more than `MAX_TAXELS` taxels.
    pub fn disc(radius: f64, pitch: f64) -> Result<Self> {
        positive("taxel pitch", pitch, "m")?;
        positive("disc radius", radius, "m")?;
        // Rounding must not exclude a point on the rim.
        let reach = radius / pitch * (1.0 + 1e-9);
        check_count(
            "disc layout",
            (std::f64::consts::PI / ROWS * reach * reach).max(1.0),
        )?;
        let last_row = (reach / ROWS) as i64;
        let taxels = (-last_row..=last_row).flat_map(|row| {
            let y = row as f64 * ROWS;
            let shift = 0.5 * row.rem_euclid(2) as f64;
            let half_width = (reach * reach - y * y).max(0.0).sqrt();
            let first = (-half_width - shift).ceil() as i64;
            let last = (half_width - shift).floor() as i64;
            (first..=last).map(move |column| {
                let place = DVec3::new(column as f64 + shift, y, 0.0);
                (pitch * place, DVec3::Z)
            })
        });
        Ok(Self::of_taxels(taxels))
    }

    /// Creates rings of taxels around the origin, from the `inner` to the `outer` radius (metres). Taxels are numbered ring by ring, from +x towards +y.
    ///
    /// The pitch is adjusted to whole numbers of rings and of taxels per ring: rings are between 0.75 and 1.5
    /// pitches apart. An annulus narrower than 0.75 pitches is a single ring in the middle.
    ///
    /// # Errors
    /// If a length is not positive, the radii are not in ascending order, or a ring has more than `MAX_TAXELS` taxels.
    pub fn annulus(inner: f64, outer: f64, pitch: f64) -> Result<Self> {
        positive("taxel pitch", pitch, "m")?;
        positive("annulus inner radius", inner, "m")?;
        positive("annulus outer radius", outer, "m")?;
        if inner > outer {
            let given = format!("inner radius {inner} m, outer radius {outer} m");
            let allowed = "an inner radius that is not larger than the outer one";
            return Err(Error::input("annulus layout", given, allowed));
        }
        let width = outer - inner;
        let area = std::f64::consts::PI * (inner + outer) * width.max(pitch);
        check_count("annulus layout", (area / (pitch * pitch)).max(1.0))?;
        let rings = ends_of_steps(n_steps(width, pitch)).map(|end| Ring {
            radius: 0.5 * (inner + outer) + end * width,
            height: 0.0,
        });
        let taxels = rings.flat_map(|ring| ring.places(pitch).map(|place| (place, DVec3::Z)));
        Ok(Self::of_taxels(taxels))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::nearest_distances;

    #[test]
    fn neighbours_on_hexagonal_lattices_are_exactly_a_pitch_away() {
        let layouts = [
            Layout::hexagonal(12, 9, 2e-3).unwrap(),
            Layout::hexagonal(1, 2, 2e-3).unwrap(),
            Layout::disc(0.02, 2e-3).unwrap(),
        ];
        for layout in layouts {
            for distance in nearest_distances(layout.centers()) {
                assert!((distance - 2e-3).abs() < 1e-15, "{distance}");
            }
            let centers = || layout.centers().iter().copied();
            let ends = centers().fold(DVec3::INFINITY, DVec3::min)
                + centers().fold(DVec3::NEG_INFINITY, DVec3::max);
            assert!(ends.length() < 1e-15, "centred: {ends}");
        }
        assert_eq!(Layout::hexagonal(12, 9, 2e-3).unwrap().n_taxels(), 108);
    }

    #[test]
    fn a_disc_holds_every_place_of_its_lattice_within_the_radius() {
        // In a hexagonal lattice a point has 6 neighbours at 1, 6 at √3, 6 at 2 and 12 at √7 pitches.
        for (radius, n) in [(0.5, 1), (1.0, 7), (1.8, 13), (2.0, 19), (2.7, 31)] {
            assert_eq!(Layout::disc(radius, 1.0).unwrap().n_taxels(), n, "{radius}");
        }
        let n = Layout::disc(0.1, 1e-3).unwrap().n_taxels() as f64;
        let expected = std::f64::consts::TAU * 1e4 / 3f64.sqrt();
        assert!((n / expected - 1.0).abs() < 0.005, "{n} of {expected}");
    }

    #[test]
    fn the_rings_of_an_annulus_line_its_rims_at_about_the_pitch() {
        for (inner, outer) in [(5e-3, 20e-3), (5e-3, 8.4e-3), (3e-3, 3.2e-3), (4e-3, 4e-3)] {
            let pitch = 2e-3;
            let layout = Layout::annulus(inner, outer, pitch).unwrap();
            for distance in nearest_distances(layout.centers()) {
                let share = distance / pitch;
                assert!((0.75..1.1).contains(&share), "{inner} {outer}: {share}");
            }
            let radii: Vec<f64> = layout.centers().iter().map(|c| c.length()).collect();
            let is_wide = outer - inner >= 0.75 * pitch;
            let smallest = radii.iter().fold(f64::INFINITY, |a, &b| a.min(b));
            let largest = radii.iter().fold(0.0_f64, |a, &b| a.max(b));
            if is_wide {
                assert!((smallest - inner).abs() < 1e-15 && (largest - outer).abs() < 1e-15);
            } else {
                assert!((largest - smallest).abs() < 1e-15, "one ring");
            }
        }
    }
}
