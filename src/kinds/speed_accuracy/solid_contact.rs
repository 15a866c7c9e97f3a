//! Exact contact with a solid: marching along each taxel's axis through its distance function.
//!
//! The taxel's ball comes up from under its stroke. Nothing of the solid is nearer to the centre than the distance function says, so the
//! ball may go on by that less its radius; where it cannot, it touches. The remaining distance to its rest is the deflection.

use crate::geometry::Pose;
use crate::objects::Solid;
use crate::world::{Patch, Taxel};
use glam::DVec3;

/// Nearer than this is contact, metres.
const NEAR: f64 = 1e-9;
/// Steps of a taxel, at most; along a wall they become short. Fewer: grazed taxels are pushed too far.
const MOST_STEPS: usize = 2000;

/// Deflections (n_taxels, metres, at most the stroke) of a patch at rest beside a solid.
pub(super) fn press_solid(patch: &Patch, solid: &Solid, patch_from_object: &Pose) -> Vec<f64> {
    let object_from_patch = patch_from_object.inverse();
    let axis = object_from_patch.transform_vector(DVec3::Z);
    let centers = patch.layout().centers().iter().enumerate();
    let needed = centers.map(|(number, &rest)| {
        let rest = object_from_patch.transform_point(rest);
        deflection(patch.taxels().at(number), solid, rest, axis)
    });
    needed.collect()
}

fn deflection(taxel: &Taxel, solid: &Solid, rest: DVec3, axis: DVec3) -> f64 {
    let mut left = taxel.stroke;
    for _ in 0..MOST_STEPS {
        let free = solid.distance(rest - left * axis) - taxel.radius;
        if free < NEAR {
            break;
        }
        left -= free;
        if left <= 0.0 {
            return 0.0;
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Workspace, press_at_pose};
    use crate::objects::{Shape, Sphere, SphereUnion};
    use crate::world::Grid;

    #[test]
    fn marching_to_a_ball_is_the_closed_form() {
        let grid = Grid {
            nx: 24,
            ny: 20,
            pitch: 2e-3,
        };
        let taxel = Taxel {
            radius: 1e-3,
            stiffness: 100.0,
            damping: 0.0,
            stroke: 5e-3,
        };
        let patch = Patch::grid(grid, taxel).unwrap();
        let solid = Solid::of(Shape::Ball { diameter: 0.03 }).unwrap();
        let pose = Pose::from_translation(DVec3::new(3e-3, -2e-3, 0.0125));
        let marched = press_solid(&patch, &solid, &pose);
        let center = DVec3::ZERO;
        let ball = Sphere {
            center,
            radius: 0.015,
        };
        let ball = SphereUnion::new(vec![ball]).unwrap();
        let mut workspace = Workspace::new();
        press_at_pose(&patch, &[ball.into()], &[pose], &mut workspace);
        let pairs = marched.iter().zip(workspace.deflections());
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // A ball that grazes is held by its last steps.
        assert!(worst < 1e-6, "{worst}");
        assert!(marched.iter().filter(|d| **d > 0.0).count() > 20);
    }
}
