//! Cylinder: a grid of taxels bent around a cylinder.

use super::about::{Curved, LayoutAbout};
use crate::geometry::Pose;
use crate::world::Layout;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::PI;

pub const ABOUT: LayoutAbout = LayoutAbout {
    sides: |grid| Some(grid.shape()),
    is_image: true,
    curved: Some(Curved {
        least_radius: |side| side / PI,
        half: "half of the circle",
    }),
    ..LayoutAbout::new("cylinder", |grid, radius| {
        Ok(Layout::bent_grid(grid, radius)?.moved(&up(radius)))
    })
};

/// Returns the pose that moves a cylinder around z so that its middle at +x reaches the origin. Afterwards the axis of the middle taxel is along z, and the
/// rings of taxels are along y.
fn up(radius: f64) -> Pose {
    let rotation = DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y);
    Pose {
        translation: -radius * DVec3::Z,
        rotation: DQuat::from_mat3(&rotation),
    }
}
