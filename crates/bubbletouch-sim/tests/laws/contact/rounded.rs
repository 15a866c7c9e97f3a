//! Laws of rounded meshes: capsules against spheres and closed forms, and any rounded mesh against larger taxels.

use crate::mesh_shapes::{cuboid, icosphere};
use crate::random_scenes::{TAXEL, random_pose, rng};
use bubbletouch_sim::contact::{Press, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{MeshModel, Model, Sphere, SphereUnion};
use bubbletouch_sim::world::{Grid, Layout, Patch, Taxel, Taxels};
use glam::{DQuat, DVec3};
use rand::Rng;

fn grid() -> Patch {
    let grid = Grid {
        nx: 14,
        ny: 11,
        pitch: 2e-3,
    };
    Patch::grid(grid, TAXEL).unwrap()
}

fn fingertip(taxel: Taxel) -> Patch {
    let layout = Layout::sphere_cap(0.015, 1.4, 3e-3).unwrap();
    Patch::new("fingertip", layout, Taxels::Equal(taxel)).unwrap()
}

/// Returns the deflections of a patch at a pose, computed with and without contacts, which are equal up to rounding.
fn at_pose(patch: &Patch, model: &Model, pose: &Pose) -> Vec<f64> {
    let (objects, poses) = (std::slice::from_ref(model), std::slice::from_ref(pose));
    let mut workspace = Workspace::new();
    Press::new(patch, objects, poses, Until::Pose)
        .run(&mut workspace)
        .unwrap();
    let deflections = workspace.deflections().to_vec();
    Press::new(patch, objects, poses, Until::Pose)
        .with_contacts()
        .run(&mut workspace)
        .unwrap();
    assert!(largest_difference(&deflections, workspace.deflections()) < 1e-12);
    deflections
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

fn ball(center: DVec3, radius: f64) -> Model {
    let sphere = Sphere { center, radius };
    SphereUnion::new(vec![sphere]).unwrap().into()
}

#[test]
fn a_capsule_without_length_is_a_sphere() {
    let mut n_touched = 0;
    for case in 0..400 {
        let mut rng = rng("capsule as ball", case);
        let radius = rng.gen_range(1e-3..2e-2);
        let capsule: Model = MeshModel::capsule(radius, 0.0).unwrap().into();
        // The poses include objects that cross the skin or lie behind the substrate.
        let distance = rng.gen_range(0.0..2.5e-2);
        let pose = random_pose(&mut rng, distance);
        for patch in [grid(), fingertip(TAXEL)] {
            let found = at_pose(&patch, &capsule, &pose);
            let exact = at_pose(&patch, &ball(DVec3::ZERO, radius), &pose);
            assert!(largest_difference(&found, &exact) < 1e-12, "case {case}");
            n_touched += exact.iter().filter(|d| **d > 0.0).count();
        }
    }
    assert!(n_touched > 5_000, "{n_touched}");
}

#[test]
fn a_capsule_is_the_spheres_along_its_segment() {
    const N: usize = 4001;
    let mut n_touched = 0;
    for case in 0..60 {
        let mut rng = rng("capsule as balls", case);
        let (radius, length) = (rng.gen_range(2e-3..1e-2), rng.gen_range(1e-3..5e-2));
        let center = |k: usize| length * (k as f64 / (N - 1) as f64 - 0.5) * DVec3::Z;
        let spheres = (0..N).map(|k| Sphere {
            center: center(k),
            radius,
        });
        let spheres: Model = SphereUnion::new(spheres.collect()).unwrap().into();
        let capsule: Model = MeshModel::capsule(radius, length).unwrap().into();
        let low = radius - 2e-3;
        let at = DVec3::new(rng.gen_range(-0.01..0.01), rng.gen_range(-0.01..0.01), low);
        let pose = Pose::new(random_pose(&mut rng, 0.0).rotation, at);
        let patch = grid();
        let (found, below) = (
            at_pose(&patch, &capsule, &pose),
            at_pose(&patch, &spheres, &pose),
        );
        for (found, below) in found.iter().zip(&below) {
            // Spheres at a distance d differ from the capsule by at most d² / 8 (ρ + R) along its normal. At a steep contact, the deflection differs more.
            assert!(found >= &(below - 1e-14), "case {case}: {found} {below}");
            let missing = (length / (N - 1) as f64).powi(2) / (8.0 * (radius + TAXEL.radius));
            let is_steep = found - below > 30.0 * missing;
            assert!(!is_steep || *below == 0.0, "case {case}: {found} {below}");
            n_touched += usize::from(*found > 0.0);
        }
    }
    assert!(n_touched > 2_000, "{n_touched}");
}

#[test]
fn a_lying_capsule_has_a_closed_form() {
    let (radius, length) = (8e-3, 0.02);
    let capsule: Model = MeshModel::capsule(radius, length).unwrap().into();
    let turn = DQuat::from_rotation_arc(DVec3::Z, DVec3::X);
    let height = 6e-3;
    let patch = grid();
    let found = at_pose(&patch, &capsule, &Pose::new(turn, height * DVec3::Z));
    for (found, center) in found.iter().zip(patch.layout().centers()) {
        let beyond = (center.x.abs() - 0.5 * length).max(0.0);
        let q = (radius + TAXEL.radius).powi(2) - beyond * beyond - center.y * center.y;
        let exact = if q > 0.0 {
            (q.sqrt() - height).clamp(0.0, TAXEL.stroke)
        } else {
            0.0
        };
        assert!((found - exact).abs() < 1e-15, "{found} {exact}");
    }
}

#[test]
fn taxels_on_a_rounded_mesh_are_larger_taxels_on_the_mesh() {
    let mut n_touched = 0;
    for case in 0..80 {
        let mut rng = rng("rounded", case);
        let mesh = match case % 3 {
            0 => cuboid(DVec3::new(0.01, 0.006, rng.gen_range(1e-3..1e-2))),
            1 => icosphere(0.01, 2),
            _ => MeshModel::capsule(1e-3, 0.02).unwrap().mesh().clone(),
        };
        let rounding = rng.gen_range(1e-4..5e-3);
        let rounded: Model = MeshModel::rounded(mesh.clone(), rounding).unwrap().into();
        let bare: Model = MeshModel::new(mesh).into();
        let [low, high] = [rounded.bounds(), bare.bounds()].map(|bounds| bounds.size());
        assert!((low - high - 2.0 * rounding).length() < 1e-15);
        // The substrates are equally far behind.
        let large = Taxel {
            radius: TAXEL.radius + rounding,
            ..TAXEL
        };
        let turn = random_pose(&mut rng, 0.0).rotation;
        let pose = Pose::new(turn, DVec3::new(0.0, 0.0, 0.03));
        let depth = rng.gen_range(1e-4..TAXEL.stroke);
        let press = |taxel: Taxel, model: &Model, is_flat: bool| {
            let patch = match is_flat {
                true => Patch::grid(*grid().layout().as_grid().unwrap(), taxel).unwrap(),
                false => fingertip(taxel),
            };
            let mut workspace = Workspace::new();
            let objects = std::slice::from_ref(model);
            let contact = Press::new(&patch, objects, &[pose], Until::Depth(depth))
                .run(&mut workspace)
                .unwrap()
                .unwrap();
            let travelled = Press::new(&patch, objects, &[pose], Until::Travel(contact.travel))
                .run(&mut Workspace::new())
                .unwrap()
                .unwrap_or_default();
            assert_eq!(travelled.n_touched, contact.n_touched);
            let deflections = workspace.deflections().to_vec();
            let moved = Pose::new(turn, pose.translation - contact.travel * DVec3::Z);
            let pushed = at_pose(&patch, model, &moved);
            // A fingertip travels along directions other than its taxels' axes.
            if is_flat {
                assert!(largest_difference(&pushed, &deflections) < 1e-12);
            }
            Press::new(&patch, objects, &[moved], Until::Pose)
                .with_contacts()
                .run(&mut workspace)
                .unwrap();
            for contact in workspace.contacts() {
                let axis = patch.layout().axes()[contact.taxel];
                let center = patch.layout().centers()[contact.taxel] - contact.needed * axis;
                let distance = center.distance(contact.point);
                assert!(
                    (distance - taxel.radius).abs() < 1e-9,
                    "case {case}: {distance}"
                );
            }
            (contact.travel, deflections, pushed)
        };
        for is_flat in [true, false] {
            let (travel, deflections, pushed) = press(TAXEL, &rounded, is_flat);
            let larger = press(large, &bare, is_flat);
            assert!((travel - larger.0).abs() < 1e-12, "case {case}");
            assert!(
                largest_difference(&deflections, &larger.1) < 1e-12,
                "case {case}"
            );
            assert!(
                largest_difference(&pushed, &larger.2) < 1e-12,
                "case {case}"
            );
            n_touched += deflections.iter().filter(|d| **d > 0.0).count();
        }
    }
    assert!(n_touched > 3_000, "{n_touched}");
}

#[test]
fn a_rounded_box_rests_on_its_rounded_faces_and_bad_sizes_are_refused() {
    let half = DVec3::new(0.03, 0.02, 0.01);
    let rounded: Model = MeshModel::rounded(cuboid(half), 5e-3).unwrap().into();
    let poses = bubbletouch_sim::world::RestPoses::Stable.poses(&rounded);
    let height = 0.5 * poses[0].height;
    assert!((height - 0.015).abs() < 1e-9, "{height}");
    let patch = grid();
    let found = at_pose(&patch, &rounded, &Pose::from_translation(0.0149 * DVec3::Z));
    assert!(found.iter().all(|d| (d - 1.1e-3).abs() < 1e-15));
    // The substrate is inside the box, in its rounding below, or above the box.
    for (height, deflection) in [(0.0, 5e-3), (0.008, 5e-3), (-0.0219, 5e-3), (-0.0221, 0.0)] {
        let found = at_pose(&patch, &rounded, &Pose::from_translation(height * DVec3::Z));
        assert!(
            found.iter().all(|d| *d == deflection),
            "{height}: {found:?}"
        );
    }
    for bad in [-1e-9, f64::NAN, f64::INFINITY] {
        assert!(MeshModel::rounded(cuboid(half), bad).is_err());
        assert!(MeshModel::capsule(0.01, bad).is_err() && MeshModel::capsule(bad, 0.01).is_err());
    }
}
