//! Spherical cap: rings of taxels on a sphere, around its pole.

use super::about::{Curved, LayoutAbout};
use crate::error::Result;
use crate::geometry::Pose;
use crate::world::{Grid, Layout};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

pub const ABOUT: LayoutAbout = LayoutAbout {
    curved: Some(Curved {
        least_radius: |side| side / TAU.sqrt(),
        half: "half a sphere",
    }),
    place_on_plane,
    ..LayoutAbout::new("sphere cap", taxels)
};

fn taxels(grid: &Grid, radius: f64) -> Result<Layout> {
    let (side, pitch) = (grid.nx as f64 * grid.pitch, grid.pitch);
    // The outermost taxels cover half a pitch beyond their ring.
    let whole = (1.0 - side * side / (TAU * radius * radius)).acos();
    let half_angle = (whole - 0.5 * pitch / radius).max(1e-9);
    let cap = Layout::sphere_cap(radius, half_angle, pitch)?;
    Ok(cap.moved(&Pose::from_translation(-radius * DVec3::Z)))
}

/// Returns the azimuthal equidistant projection of a taxel's centre: distances and directions from the middle are preserved.
fn place_on_plane(center: DVec3, radius: f64) -> DVec2 {
    let away = center.truncate();
    let angle = away.length().atan2(center.z + radius);
    away.normalize_or_zero() * radius * angle
}
