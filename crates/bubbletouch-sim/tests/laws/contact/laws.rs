//! Laws of the contact stage, checked against a slow and simple oracle.

use crate::random_scenes::{Scene, TAXEL};
use crate::scans::scan;
use crate::time_loop::time_loop;
use bubbletouch_sim::contact::{Contact, Press, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Catalogue, MeshModel, Model, Sphere, SphereUnion, vertex_spheres};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{Grid, Patch, Phase, RestPoses, Touch, VelocityPlan};
use glam::{DQuat, DVec3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::slice::from_ref;

fn random_scene(rng: &mut ChaCha8Rng) -> (Scene, Vec<Pose>) {
    let grid = Grid {
        nx: rng.gen_range(1..40),
        ny: rng.gen_range(1..40),
        pitch: 10f64.powf(rng.gen_range(-3.5..-2.0)),
    };
    let scale = 10f64.powf(rng.gen_range(-3.0..-1.0));
    let objects: Vec<Model> = (0..rng.gen_range(1..4))
        .map(|_| {
            let spheres = (0..rng.gen_range(1..60)).map(|_| Sphere {
                center: scale * DVec3::from(rng.r#gen::<[f64; 3]>()) - DVec3::splat(0.5 * scale),
                radius: scale * rng.gen_range(0.001..0.5),
            });
            SphereUnion::new(spheres.collect()).unwrap().into()
        })
        .collect();
    let poses = objects.iter().map(|_| random_pose(rng, 0.02)).collect();
    let patch = Patch::grid(grid, TAXEL).unwrap();
    (Scene { patch, objects }, poses)
}

fn random_pose(rng: &mut ChaCha8Rng, distance: f64) -> Pose {
    let axis = DVec3::from(rng.r#gen::<[f64; 3]>()) - DVec3::splat(0.5);
    Pose::new(
        DQuat::from_scaled_axis(6.0 * axis),
        distance * (DVec3::from(rng.r#gen::<[f64; 3]>()) - DVec3::splat(0.5)),
    )
}

/// Compares every sphere with every taxel, using the equations in the documentation of the contact module. A sphere does not count for a taxel that would rest
/// on it lower than `behind`.
fn oracle(scene: &Scene, poses: &[Pose], travel: f64, behind: f64) -> Vec<f64> {
    let (grid, taxel) = scene.grid();
    let mut deflections = vec![0.0_f64; grid.n_taxels()];
    for (object, pose) in scene.objects.iter().zip(poses) {
        for sphere in object.spheres().unwrap().spheres() {
            let c = pose.transform_point(sphere.center);
            let reach = taxel.radius + sphere.radius;
            let h = c.z - travel;
            for row in 0..grid.ny {
                for column in 0..grid.nx {
                    let (dx, dy) = (c.x - grid.x(column), c.y - grid.y(row));
                    let q = reach * reach - (dx * dx + dy * dy);
                    if q > 0.0 && q.sqrt() + h >= behind {
                        let deflection = &mut deflections[row * grid.nx + column];
                        *deflection = deflection.max(q.sqrt() - h).min(taxel.stroke);
                    }
                }
            }
        }
    }
    deflections
}

fn assert_close(a: &[f64], b: &[f64], tolerance: f64, what: &str) {
    assert_eq!(a.len(), b.len());
    for (index, (x, y)) in a.iter().zip(b).enumerate() {
        assert!(
            (x - y).abs() <= tolerance,
            "{what}: taxel {index}: {x} and {y}"
        );
    }
}

#[test]
fn what_an_earlier_press_touched_is_wiped() {
    let mut rng = Seed::new(6).rng();
    let mut reused = Workspace::new();
    let grid = Grid {
        nx: 37,
        ny: 22,
        pitch: 2e-3,
    };
    let mut n_touched = 0;
    for case in 0..200 {
        let (mut scene, poses) = random_scene(&mut rng);
        scene.patch = Patch::grid(grid, TAXEL).unwrap();
        let depth = rng.gen_range(1e-4..1e-2);
        let mut fresh = Workspace::new();
        let contacts = [&mut reused, &mut fresh].map(|w| {
            Press::new(&scene.patch, &scene.objects, &poses, Until::Depth(depth))
                .run(w)
                .unwrap()
        });
        assert_eq!(contacts[0], contacts[1], "case {case}");
        assert_eq!(reused.deflections(), fresh.deflections(), "case {case}");
        n_touched += contacts[0].map_or(0, |contact| contact.n_touched);
    }
    assert!(n_touched > 1_000, "{n_touched}");
}

#[test]
fn first_contact_is_where_the_first_taxel_begins_to_move() {
    let mut rng = Seed::new(2).rng();
    let mut workspace = Workspace::new();
    let mut n_met = 0;
    for _ in 0..1000 {
        let (scene, poses) = random_scene(&mut rng);
        let press = Press::new(&scene.patch, &scene.objects, &poses, Until::Depth(0.0));
        let Some(Contact { travel: first, .. }) = press.run(&mut workspace).unwrap() else {
            assert!(workspace.deflections().iter().all(|&d| d == 0.0));
            continue;
        };
        n_met += 1;
        let before = Press::new(
            &scene.patch,
            &scene.objects,
            &poses,
            Until::Travel(first - 1e-9),
        )
        .run(&mut workspace)
        .unwrap()
        .unwrap_or_default();
        assert_eq!(before.n_touched, 0);
        let after = Press::new(
            &scene.patch,
            &scene.objects,
            &poses,
            Until::Travel(first + 1e-9),
        )
        .run(&mut workspace)
        .unwrap()
        .unwrap_or_default();
        assert!(after.n_touched > 0);
    }
    assert!(n_met > 300, "{n_met}");
}

#[test]
fn the_deepest_taxel_of_a_press_is_at_the_depth() {
    let mut rng = Seed::new(3).rng();
    let mut workspace = Workspace::new();
    for _ in 0..500 {
        let (scene, poses) = random_scene(&mut rng);
        let depth = rng.gen_range(1e-4..TAXEL.stroke);
        if Press::new(&scene.patch, &scene.objects, &poses, Until::Depth(depth))
            .run(&mut workspace)
            .unwrap()
            .is_some()
        {
            let deepest = workspace
                .deflections()
                .iter()
                .fold(0.0_f64, |a, &b| a.max(b));
            assert!((deepest - depth).abs() < 1e-15, "{deepest} for {depth}");
        }
    }
}

#[test]
fn the_direct_press_equals_the_time_loop_without_a_damper_however_deep() {
    let mut rng = Seed::new(5).rng();
    let mut workspace = Workspace::new();
    let mut n_through = 0;
    for case in 0..200 {
        let (scene, mut poses) = random_scene(&mut rng);
        for pose in &mut poses {
            pose.translation.z += 0.1;
        }
        // Steps of at most 1 mm, to a pose in front of the substrate and to a pose behind it.
        let speed = rng.gen_range(0.01..1.0);
        let approach = Phase {
            duration: 0.3,
            linear: DVec3::Z * speed,
            angular: DVec3::ZERO,
        };
        let patch_plan = VelocityPlan::new(Pose::IDENTITY, vec![approach]).unwrap();
        let fixed: Vec<VelocityPlan> = poses
            .iter()
            .map(|&pose| VelocityPlan::new(pose, vec![]).unwrap())
            .collect();
        let frames = time_loop(&scene, [from_ref(&patch_plan), &fixed], 1e-3, 300);
        let last = patch_plan.pose_at(300.0 * 1e-3).inverse();
        let finals: Vec<Pose> = poses.iter().map(|pose| last.compose(pose)).collect();
        let counted = Press::new(&scene.patch, &scene.objects, &finals, Until::Travel(0.0))
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default();
        assert_eq!(
            frames.deflections[299],
            workspace.deflections(),
            "case {case}: exactly"
        );
        let spring: Vec<f64> = frames.deflections[299].iter().map(|d| 100.0 * d).collect();
        assert_eq!(frames.forces[299], spring, "a spring alone");
        let there = Press::new(&scene.patch, &scene.objects, &finals, Until::Pose)
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default();
        n_through += usize::from(there.n_touched < counted.n_touched);
    }
    assert!(n_through > 50, "some go through for real: {n_through}");
}

#[test]
fn what_comes_up_from_behind_or_around_the_patch_does_not_press_in_the_time_loop() {
    let grid = Grid {
        nx: 5,
        ny: 5,
        pitch: 2e-3,
    };
    let ball = Sphere {
        center: DVec3::ZERO,
        radius: 0.01,
    };
    let scene = Scene {
        patch: Patch::grid(grid, TAXEL).unwrap(),
        objects: vec![SphereUnion::new(vec![ball]).unwrap().into()],
    };
    let still = VelocityPlan::new(Pose::IDENTITY, vec![]).unwrap();
    let go = |linear: DVec3| Phase {
        duration: 0.1,
        linear,
        angular: DVec3::ZERO,
    };
    // Path through the skin, 50 mm beyond it, out to its side, and back under it.
    let way = [go(-DVec3::Z), go(DVec3::X), go(-DVec3::X)];
    let start = Pose::from_translation(DVec3::new(0.0, 0.0, 0.05));
    let plan = VelocityPlan::new(start, way.to_vec()).unwrap();
    let frames = time_loop(&scene, [from_ref(&still), &[plan]], 1e-3, 300);
    let reads = |frame: usize, deflection: f64| {
        let mut taxels = frames.deflections[frame].iter();
        taxels.all(|read| *read == deflection)
    };
    assert!(reads(30, 0.0), "still in front");
    assert!(reads(99, TAXEL.stroke), "gone through");
    assert!(reads(199, 0.0), "beside");
    assert!(reads(299, 0.0), "under it again");
    // The top of the object is 1 mm behind the substrate.
    let below = Pose::from_translation(DVec3::new(0.0, 0.0, -0.05));
    let up = VelocityPlan::new(below, vec![go(0.32 * DVec3::Z)]).unwrap();
    let frames = time_loop(&scene, [from_ref(&still), &[up]], 1e-3, 100);
    assert!(
        frames.deflections[99].iter().all(|d| *d == 0.0),
        "from behind"
    );
}

#[test]
fn a_ball_pressed_on_the_array_leaves_its_cap() {
    let grid = Grid {
        nx: 33,
        ny: 33,
        pitch: 1e-3,
    };
    let (radius, depth) = (0.05, 2e-3);
    let ball = Sphere {
        center: DVec3::new(0.0, 0.0, 0.3),
        radius,
    };
    let scene = Scene {
        patch: Patch::grid(grid, TAXEL).unwrap(),
        objects: vec![SphereUnion::new(vec![ball]).unwrap().into()],
    };
    let mut workspace = Workspace::new();
    let contact = Press::new(
        &scene.patch,
        &scene.objects,
        &[Pose::IDENTITY],
        Until::Depth(depth),
    )
    .run(&mut workspace)
    .unwrap()
    .unwrap();
    assert!((contact.travel - (0.3 - radius - TAXEL.radius + depth)).abs() < 1e-15);
    let reach = radius + TAXEL.radius;
    for row in 0..33 {
        for column in 0..33 {
            let b2 = grid.x(column).powi(2) + grid.y(row).powi(2);
            let cap = ((reach * reach - b2).sqrt() - reach + depth).max(0.0);
            let got = workspace.deflections()[row * 33 + column];
            assert!((got - cap).abs() < 1e-15, "{got} and {cap}");
        }
    }
}

#[test]
fn saturation_is_counted_and_stops_at_the_stroke() {
    let grid = Grid {
        nx: 9,
        ny: 9,
        pitch: 2e-3,
    };
    let wall = Sphere {
        center: DVec3::new(0.0, 0.0, 10.0),
        radius: 10.0,
    };
    let scene = Scene {
        patch: Patch::grid(grid, TAXEL).unwrap(),
        objects: vec![SphereUnion::new(vec![wall]).unwrap().into()],
    };
    let mut workspace = Workspace::new();
    let at_stroke = Press::new(
        &scene.patch,
        &scene.objects,
        &[Pose::IDENTITY],
        Until::Depth(TAXEL.stroke),
    )
    .run(&mut workspace)
    .unwrap()
    .unwrap();
    assert_eq!(at_stroke.n_saturated, 0);
    let beyond = Press::new(
        &scene.patch,
        &scene.objects,
        &[Pose::IDENTITY],
        Until::Depth(0.02),
    )
    .run(&mut workspace)
    .unwrap()
    .unwrap();
    assert_eq!((beyond.n_touched, beyond.n_saturated), (81, 81));
    assert!(workspace.deflections().iter().all(|&d| d == TAXEL.stroke));
}

/// Depths of presses, metres, from nearly zero to 200 mm.
const DEPTHS: [f64; 12] = [
    0.0, 1e-4, 1e-3, 3e-3, 5e-3, 8e-3, 12e-3, 0.02, 0.03, 0.06, 0.12, 0.2,
];

/// Tests that the deflections never decrease with the depth. The object lies as modelled; a coarse, slightly tilted patch over its middle is pressed deeper and
/// deeper.
fn deeper_is_never_less(name: &str, model: &Model, workspace: &mut Workspace) {
    let grid = Grid {
        nx: 24,
        ny: 20,
        pitch: 5e-3,
    };
    let scene = Scene::of_one(&Patch::grid(grid, TAXEL).unwrap(), model);
    let rest = &RestPoses::AsModelled.poses(model)[0];
    let touch = Touch {
        rest: 0,
        offset: [1e-3, -2e-3],
        yaw: 0.3,
        tilt: [0.05, -0.02],
        depth: 0.0,
        indices: [None; 7],
    };
    let pose = touch.patch_from_object(rest);
    let mut before = vec![0.0; grid.n_taxels()];
    let (mut n_touched, mut n_saturated) = (0, 0);
    for depth in DEPTHS {
        let contact = Press::new(&scene.patch, &scene.objects, &[pose], Until::Depth(depth))
            .run(workspace)
            .unwrap();
        let contact = contact.unwrap_or_else(|| panic!("{name} is under the patch"));
        let now = workspace.deflections();
        let is_less = now.iter().zip(&before).any(|(now, before)| now < before);
        assert!(!is_less, "{name}: {depth} m deep");
        assert!(contact.n_touched >= n_touched && contact.n_saturated >= n_saturated);
        if depth > TAXEL.stroke {
            assert!(contact.n_saturated > 0, "{name}: {depth} m deep");
        }
        // The oracle is slow, so it is used only short of the stroke, past the stroke, and at the end.
        if model.spheres().is_some() && [3e-3, 0.02, 0.2].contains(&depth) {
            let expected = oracle(&scene, &[pose], contact.travel, f64::NEG_INFINITY);
            assert_close(now, &expected, 1e-12, name);
        }
        (n_touched, n_saturated) = (contact.n_touched, contact.n_saturated);
        before.copy_from_slice(now);
    }
    if rest.height < 0.15 {
        // The whole object has passed through the skin.
        assert_eq!(n_touched, n_saturated, "{name}");
    }
}

#[test]
fn no_object_of_the_catalogue_is_felt_less_the_deeper_it_is_pressed() {
    let mut workspace = Workspace::new();
    for object in Catalogue::builtin().unwrap().entries() {
        let built = object.build(2e-3).unwrap();
        deeper_is_never_less(&built.name, &built.model, &mut workspace);
    }
}

#[test]
fn no_scanned_object_is_felt_less_the_deeper_it_is_pressed_as_a_mesh_or_as_spheres() {
    let Some(folder) = crate::reference_data::folder("BUBBLETOUCH_YCB") else {
        return;
    };
    let mut workspace = Workspace::new();
    let mut n_meshes = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_none_or(|e| e != "ply") {
            continue;
        }
        let (name, mesh) = (path.display().to_string(), scan(&path));
        let spheres = vertex_spheres(&name, mesh.vertices()).unwrap();
        for model in [MeshModel::new(mesh).into(), Model::from(spheres)] {
            deeper_is_never_less(&name, &model, &mut workspace);
        }
        n_meshes += 1;
    }
    assert_eq!(n_meshes, 43);
}

#[test]
fn a_ball_leaves_taxel_by_taxel_on_its_way_through_the_substrate() {
    let grid = Grid {
        nx: 3,
        ny: 3,
        pitch: 2e-3,
    };
    let scene = |z| Scene {
        patch: Patch::grid(grid, TAXEL).unwrap(),
        objects: vec![
            SphereUnion::new(vec![Sphere {
                center: DVec3::new(0.0, 0.0, z),
                radius: 0.02,
            }])
            .unwrap()
            .into(),
        ],
    };
    let mut workspace = Workspace::new();
    let mut press = |z| {
        let scene = scene(z);
        let pose = [Pose::IDENTITY];
        Press::new(&scene.patch, &scene.objects, &pose, Until::Pose)
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default()
    };
    // With S = 21 mm, the substrate leaves the sphere at three heights: over the middle, the sides and the corners.
    let leaves = |b: f64| -0.006 - (0.021_f64.powi(2) - b * b).sqrt();
    let heights = [2e-3 * 2_f64.sqrt(), 2e-3, 0.0].map(leaves);
    for (height, n_left) in heights.into_iter().zip([9, 5, 1]) {
        assert_eq!(press(height + 1e-9).n_saturated, n_left, "{height} m");
        assert!(press(height - 1e-9).n_touched < n_left, "{height} m");
    }
    assert_eq!(press(heights[2] - 1e-9).n_touched, 0);
}
