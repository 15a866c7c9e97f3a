//! Curved layouts around the z axis of the patch frame, for forearms, fingers and elbows.

use super::layout::Layout;
use super::limits::{check_angle, check_count};
use super::ring::{Ring, n_steps};
use crate::error::Result;
use crate::text::in_range::positive;
use crate::world::{Extrusion, Grid};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

impl Layout {
    /// Creates a grid bent around a cylinder. Rings of taxels surround the z axis, in ascending order; each is numbered from its right to its left end. Axes
    /// point away from the z axis.
    ///
    /// - `radius`: distance of the taxels' centres (at rest) from the axis of the cylinder, metres.
    /// - `length`: distance between the first and the last ring, metres, not negative; the middle is at z = 0.
    /// - `arc`: angle, radians, above 0 to 2π, with its middle at +x. There is a taxel at either end. If the remaining gap is less than half a pitch, the ring
    ///   is closed.
    /// - `pitch`: distance along the surface, metres, adjusted to whole numbers of rings and columns. A length or an arc
    ///   shorter than 0.75 pitches has one ring or column, in its middle.
    ///
    /// # Errors
    /// If an argument is out of its range, or the layout has more than `MAX_TAXELS` taxels.
    pub fn cylinder(radius: f64, length: f64, arc: f64, pitch: f64) -> Result<Self> {
        Ok(Self::from(Extrusion::cylinder(radius, length, arc, pitch)?))
    }

    /// Creates a rectangular grid bent around a cylinder. `radius` is the distance of the taxels' centres (at rest) from the cylinder's axis, metres. Rows
    /// become rings; columns run along z.
    ///
    /// # Errors
    /// If `cylinder` fails for these arguments.
    pub fn bent_grid(grid: &Grid, radius: f64) -> Result<Self> {
        let side = |n: usize| (n - 1) as f64 * grid.pitch;
        let arc = side(grid.nx) / radius;
        Self::cylinder(radius, side(grid.ny), arc.max(1e-9), grid.pitch)
    }

    /// Creates rings of taxels on a sphere around the origin, from its pole at +z outwards; axes point away from the centre.
    ///
    /// - `radius`: distance of the taxels' centres (at rest) from the centre of the sphere, metres.
    /// - `half_angle`: angle from the pole to the last ring, radians, above 0 to π; π/2 is half a sphere, π a whole one.
    /// - `pitch`: distance along the surface, metres, adjusted to whole numbers of rings and of taxels per ring. A cap
    ///   smaller than 0.75 pitches from its pole to its end has one taxel, at the pole.
    ///
    /// # Errors
    /// If an argument is out of its range, or the layout has more than `MAX_TAXELS` taxels.
    pub fn sphere_cap(radius: f64, half_angle: f64, pitch: f64) -> Result<Self> {
        positive("taxel pitch", pitch, "m")?;
        positive("cap radius", radius, "m")?;
        check_angle("cap half angle", half_angle, PI)?;
        let area = TAU * radius * radius * (1.0 - half_angle.cos());
        check_count("cap layout", (area / (pitch * pitch)).max(1.0))?;
        let n_rings = n_steps(radius * half_angle, pitch);
        let rings = (0..=n_rings).map(|ring| {
            let (sin, cos) = (half_angle * ring as f64 / n_rings.max(1) as f64).sin_cos();
            Ring {
                // The sine must not be negative at the far pole.
                radius: radius * sin.max(0.0),
                height: radius * cos,
            }
        });
        let places = rings.flat_map(|ring| ring.places(pitch));
        Ok(Self::of_taxels(
            places.map(|place| normalized((place, place))),
        ))
    }
}

fn normalized((place, axis): (DVec3, DVec3)) -> (DVec3, DVec3) {
    (place, axis.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::nearest_distances;

    #[test]
    fn neighbours_on_a_cylinder_are_about_a_pitch_away() {
        for (radius, length, arc, n) in [
            (0.0407, 0.252, TAU, 64 * 64),
            (0.01, 0.03, PI, 17 * 16),
            (0.05, 0.0, 1.0, 26),
        ] {
            let pitch = if n == 64 * 64 { 4e-3 } else { 2e-3 };
            let layout = Layout::cylinder(radius, length, arc, pitch).unwrap();
            assert_eq!(layout.n_taxels(), n);
            for distance in nearest_distances(layout.centers()) {
                assert!((distance / pitch - 1.0).abs() < 0.05, "{distance}");
            }
            for (center, axis) in layout.centers().iter().zip(layout.axes()) {
                assert!((center.truncate().length() - radius).abs() < 1e-15);
                assert!((*center - radius * *axis).truncate().length() < 1e-15);
                assert!(center.z.abs() <= 0.5 * length + 1e-15 && axis.z == 0.0);
            }
            let ends = [layout.centers()[0].y, layout.centers()[n - 1].y];
            if arc < TAU {
                assert!((ends[0] + ends[1]).abs() < 1e-15, "the middle is at +x");
                assert!((ends[1] - radius * (0.5 * arc).sin()).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn neighbours_on_a_cap_are_about_a_pitch_away() {
        for (half_angle, radius) in [(0.5 * PI, 0.02), (1.0, 0.05), (PI, 0.03), (0.1, 0.2)] {
            let pitch = 2e-3;
            let layout = Layout::sphere_cap(radius, half_angle, pitch).unwrap();
            for distance in nearest_distances(layout.centers()) {
                let share = distance / pitch;
                assert!((0.9..1.1).contains(&share), "{half_angle}: {share}");
            }
            let area = TAU * radius * radius * (1.0 - half_angle.cos());
            let n = layout.n_taxels() as f64;
            assert!((0.8..1.35).contains(&(n * pitch * pitch / area)), "{n}");
            for (center, axis) in layout.centers().iter().zip(layout.axes()) {
                assert!((*center - radius * *axis).length() < 1e-15);
                assert!(axis.z >= half_angle.cos() - 1e-12);
            }
        }
    }

    #[test]
    fn what_is_smaller_than_a_pitch_has_one_ring_one_column_or_one_taxel() {
        for (radius, length, arc, n) in [
            (0.01, 1e-4, 1e-4, 1),
            (0.01, 0.0, PI, 32),
            (1e-5, 5e-3, TAU, 6),
        ] {
            let layout = Layout::cylinder(radius, length, arc, 1e-3).unwrap();
            assert_eq!(layout.n_taxels(), n);
        }
        let pole = Layout::sphere_cap(0.01, 1e-3, 1e-3).unwrap();
        assert_eq!(pole.centers(), [DVec3::new(0.0, 0.0, 0.01)]);
    }

    #[test]
    fn a_cylinder_that_leaves_no_gap_for_a_taxel_is_closed() {
        let closed = Layout::cylinder(0.02, 0.0, TAU - 0.01, 2e-3).unwrap();
        assert_eq!(closed, Layout::cylinder(0.02, 0.0, TAU, 2e-3).unwrap());
        let open = Layout::cylinder(0.02, 0.0, TAU - 0.2, 2e-3).unwrap();
        let gap = open.centers()[0].distance(open.centers()[open.n_taxels() - 1]);
        assert!((gap - 4e-3).abs() < 1e-4, "{gap}");
    }
}
