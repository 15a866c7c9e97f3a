//! Laws of a skin that is pressed and then dragged: closed forms, mirror symmetry, and a path of many small steps.

use bubbletouch_sim::contact::{FrictionState, NormalForce, Press, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::Model;
use bubbletouch_sim::world::{ArrayLayout, Grid, Patch, Shear, Shears, Taxels};
use glam::{DVec2, DVec3};

use crate::mesh_shapes::cuboid;
use crate::scenes::{TAXEL, ball, mesh, pressed, touched};

const GRID: Grid = Grid {
    nx: 16,
    ny: 16,
    pitch: 2e-3,
};
const SHEAR: Shear = Shear {
    stiffness: 150.0,
    friction: 0.6,
};

fn skin(layout: ArrayLayout) -> Patch {
    let layout = layout.taxels(&GRID, 0.03).unwrap();
    Patch::new("skin", layout, Taxels::Equal(TAXEL)).unwrap()
}

/// Returns the forces on all taxels after a press and a slide.
fn forces(skin: &Patch, objects: &[Model], pose: Pose, motion: (f64, DVec3)) -> Vec<DVec3> {
    let mut friction = FrictionState::at_rest(skin, Shears::Equal(SHEAR)).unwrap();
    let mut workspace = Workspace::new();
    // Earlier presses must not affect the result.
    let before = (2e-3, DVec3::new(1e-3, 2e-3, 0.0));
    for (depth, slide) in [before, motion] {
        let state = Some(&mut friction);
        Press::new(skin, objects, &[pose], Until::Depth(depth))
            .slide(slide, state, &mut workspace)
            .unwrap();
    }
    friction.force3().to_vec()
}

#[test]
fn under_a_flat_face_tips_stick_until_they_carry_no_more_and_then_slip() {
    let skin = skin(ArrayLayout::Grid);
    let block = [mesh(cuboid(DVec3::new(0.1, 0.1, 0.01)))];
    let pose = Pose::from_translation(0.05 * DVec3::Z);
    let (depth, direction) = (2e-3, DVec2::from_angle(0.7));
    let pressed = TAXEL.stiffness * depth;
    for length in [0.0, 1e-5, 2e-4, 7.9e-4, 8.1e-4, 3e-3] {
        let motion = (depth, (length * direction).extend(0.0));
        let held = (SHEAR.stiffness * length).min(SHEAR.friction * pressed);
        let expected = (-held * direction).extend(pressed);
        for force in forces(&skin, &block, pose, motion) {
            let off = force.distance(expected);
            assert!(off < 1e-9, "{length} m: {force} for {expected}");
        }
    }
}

#[test]
fn a_slide_the_other_way_is_the_mirror_image() {
    for layout in [ArrayLayout::Grid, ArrayLayout::Cylinder] {
        let skin = skin(layout);
        let (objects, pose) = ([ball(0.02).into()], Pose::from_translation(0.05 * DVec3::Z));
        let slid = |x: f64| forces(&skin, &objects, pose, (3e-3, x * DVec3::X));
        let (there, back) = (slid(2e-3), slid(-2e-3));
        let mut n_sheared = 0;
        for (number, force) in there.iter().enumerate() {
            let (row, column) = (number / GRID.nx, number % GRID.nx);
            let mirrored = back[row * GRID.nx + (GRID.nx - 1 - column)];
            let expected = DVec3::new(-mirrored.x, mirrored.y, mirrored.z);
            assert!(force.distance(expected) < 1e-9, "{layout:?} {number}");
            n_sheared += usize::from(force.truncate().length() > 1e-3);
        }
        assert!(n_sheared > 20, "{n_sheared}");
    }
}

#[test]
fn the_shear_is_that_of_many_small_steps() {
    for (layout, radius) in [
        (ArrayLayout::Grid, 0.015),
        (ArrayLayout::Hexagonal, 0.03),
        (ArrayLayout::Cap, 0.01),
    ] {
        let skin = skin(layout);
        let objects = [ball(radius).into()];
        let start = Pose::from_translation(DVec3::new(1.3e-3, -0.7e-3, 0.06));
        let (depth, slide) = (3e-3, DVec3::new(3e-3, 1.5e-3, 0.0));
        let found = forces(&skin, &objects, start, (depth, slide));
        let mut friction = FrictionState::at_rest(&skin, Shears::Equal(SHEAR)).unwrap();
        let first = pressed(Press::new(&skin, &objects, &[start], Until::Depth(0.0))).travel();
        let mut to = |moved: DVec3| {
            let pose = Pose {
                translation: start.translation - moved,
                ..start
            };
            let contacts = touched(&skin, &objects, &[pose]).contacts;
            friction.step(&skin, &contacts, &[pose], NormalForce::Springs);
            friction.force3().to_vec()
        };
        let n = 2000;
        let parts = || (1..=n).map(|step| f64::from(step) / f64::from(n));
        for part in parts() {
            to((first + part * depth) * DVec3::Z);
        }
        let mut fine = Vec::new();
        for part in parts() {
            fine = to((first + depth) * DVec3::Z + part * slide);
        }
        let size = |forces: &mut dyn Iterator<Item = DVec3>| {
            let squares = forces.map(|force| force.truncate().length_squared());
            squares.sum::<f64>().sqrt()
        };
        let off = size(&mut found.iter().zip(&fine).map(|(a, b)| a - b));
        let share = off / size(&mut fine.iter().copied());
        assert!(share < 0.02, "{layout:?}: {share}");
        let normal = found.iter().zip(&fine).map(|(a, b)| (a.z - b.z).abs());
        assert!(normal.fold(0.0, f64::max) < 1e-12, "{layout:?}");
    }
}
