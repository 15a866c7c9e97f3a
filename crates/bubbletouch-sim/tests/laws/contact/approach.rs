//! Laws of presses along a path: comparison with every part of every object, the time loop, and paths through the skin.

use crate::every_part::{Behind, by_every_part};
use crate::scans::scan;
use crate::scenes::{
    N_FAMILIES, Scene, TAXEL, assert_close, ball, direction, grid, is_flat, mesh, pressed,
    pressed_in, random_object, random_patch, rng, skin, union,
};
use crate::time_loop::time_loop;
use bubbletouch_sim::contact::{Row, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::TriangleMesh;
use bubbletouch_sim::objects::{Catalogue, Model, SphereUnion, vertex_spheres};
use bubbletouch_sim::world::{
    ArrayLayout, Grid, Layout, Phase, RestPoses, Taxel, Taxels, Touch, VelocityPlan,
};
use glam::{DQuat, DVec3};
use rand::Rng;
use std::slice::from_ref;

const GRID: Grid = Grid {
    nx: 16,
    ny: 16,
    pitch: 2e-3,
};

/// The presses of one patch share a workspace, because an unchanged grid keeps a memory of the press before.
#[test]
fn presses_from_the_front_in_one_workspace_push_as_far_as_every_part_says() {
    let (mut n_touched, mut n_deep, mut n_by_mesh, mut n_edges) = (0, 0, 0, 0);
    for case in (0..160).filter(|case| is_flat(*case)) {
        let mut rng = rng("front", case);
        let patch = random_patch(&mut rng, case);
        let mut workspace = Workspace::new();
        for number in 0..8 {
            let objects = (0..rng.gen_range(1..3)).map(|_| random_object(&mut rng, &patch));
            let (objects, poses) = objects.unzip();
            let scene = Scene {
                patch: patch.clone(),
                objects,
                poses,
            };
            let place = format!("case {case}, press {number}");
            let met = pressed_in(&mut workspace, scene.press(Until::Depth(0.0)));
            let depth = 5e-3 * 10f64.powf(rng.gen_range(-3.0..1.0));
            let deep = pressed_in(&mut workspace, scene.press(Until::Depth(depth)));
            assert_eq!(met.contact.is_some(), deep.contact.is_some(), "{place}");
            let lowered = |travel: f64| {
                let there = scene.moved(&Pose::from_translation(-travel * DVec3::Z));
                by_every_part(&there, Behind::Counts)
            };
            let Some(contact) = deep.contact else {
                let expected = lowered(1.0);
                assert!(
                    expected.iter().all(|taxel| taxel.deflection == 0.0),
                    "{place}"
                );
                continue;
            };
            let first = met.travel();
            assert_eq!(contact.travel, first + depth, "{place}");
            let [before, after] = [-1e-9, 1e-9].map(|off| {
                let press = scene.press(Until::Travel(first + off));
                pressed_in(&mut workspace, press).counts().n_touched
            });
            assert!(before == 0 && after > 0, "{place}");
            // The press to the travel after a press to another depth is the press to the depth.
            let travelled = pressed_in(&mut workspace, scene.press(Until::Travel(contact.travel)));
            assert_eq!(travelled, deep, "{place}");
            for (taxel, expected) in lowered(contact.travel).iter().enumerate() {
                let found = deep.deflections[taxel];
                n_touched += usize::from(found > 0.0);
                n_by_mesh += usize::from(expected.is_by_mesh);
                if (found - expected.deflection).abs() > expected.tolerance {
                    let text = format!("{place}, taxel {taxel}: {found} for {expected:?}");
                    assert!(expected.is_by_mesh, "{text}");
                    n_edges += 1;
                }
            }
            n_deep += contact.n_saturated;
        }
    }
    let found = format!("{n_touched} {n_deep}, {n_edges} of {n_by_mesh}");
    assert!(n_touched > 8_000 && n_deep > 2_000, "{found}");
    assert!(n_edges < n_by_mesh / 1000, "{found}");
}

/// Tests arbitrary contents of the row, rows of zeros, and all remainders of the row length by the kernel's block size.
#[test]
fn a_press_into_a_row_leaves_the_frame_and_nothing_else_there() {
    let (mut workspace, mut into) = (Workspace::new(), Workspace::new());
    let mut n_touched = [0; 4];
    for case in 0..400 {
        let family = if case % 5 == 0 { 1 } else { N_FAMILIES * case };
        let scene = Scene::random("row", family);
        let mut rng = rng("row's goal", case);
        let goal = match case % 4 {
            0 => Until::Pose,
            1 => Until::Depth(1e-3),
            2 => Until::Travel(rng.gen_range(-0.02..0.02)),
            _ => Until::Force(1e-3),
        };
        let press = scene.press(goal);
        let pressed = press.run(&mut workspace).unwrap();
        let n = scene.patch.n_taxels();
        for before in [f64::NAN, 0.0] {
            let (mut doubles, mut singles) = (vec![before; n], vec![before as f32; n]);
            for row in [Row::Double(&mut doubles), Row::Single(&mut singles)] {
                let same = match before == 0.0 {
                    true => press.write_onto_zeros(row, &mut into),
                    false => press.write(row, &mut into),
                };
                assert_eq!(same.unwrap(), pressed, "case {case}");
                assert_eq!(into.deflections(), workspace.deflections(), "case {case}");
            }
            assert_eq!(doubles, workspace.deflections(), "case {case}");
            let rounded = doubles.iter().map(|double| *double as f32);
            assert!(singles.into_iter().eq(rounded), "case {case}");
        }
        n_touched[case as usize % 4] += usize::from(pressed.is_some_and(|c| c.n_touched > 0));
    }
    assert!(n_touched.iter().all(|n| *n > 20), "{n_touched:?}");
}

#[test]
fn first_contact_along_any_direction_is_that_of_the_nearest_part() {
    let mut n_met = [0; 2];
    for case in 0..180 {
        let scene = Scene::random("first contact", case);
        let (layout, taxels) = (scene.patch.layout(), scene.patch.taxels());
        let aside = direction(&mut rng("aside", case));
        let along = (layout.axes()[0] + 0.7 * aside).normalize();
        let found = pressed(scene.press(Until::Depth(0.0)).along(along));
        // Far past the objects, taxels of any stroke along the direction of travel are deflected by the way past first contact.
        let travel = 2.0;
        let n = layout.n_taxels();
        let long = (0..n).map(|taxel| Taxel {
            stroke: 1e3,
            ..*taxels.at(taxel)
        });
        let places = Layout::new(layout.centers().to_vec(), vec![along; n]).unwrap();
        let patch = skin(places, Taxels::Each(long.collect()));
        let there = scene.moved(&Pose::from_translation(-travel * along));
        let expected = by_every_part(&Scene { patch, ..there }, Behind::Counts).into_iter();
        let deepest = expected
            .max_by(|a, b| a.deflection.total_cmp(&b.deflection))
            .unwrap();
        let Some(contact) = found.contact else {
            assert_eq!(deepest.deflection, 0.0, "case {case}");
            continue;
        };
        n_met[usize::from(deepest.is_by_mesh)] += 1;
        let error = (contact.travel - (travel - deepest.deflection)).abs();
        assert!(
            error < deepest.tolerance,
            "case {case}: {contact:?} for {deepest:?}"
        );
    }
    assert!(n_met.iter().all(|&n| n > 30), "{n_met:?}");
}

#[test]
fn what_was_pressed_goes_on_being_pressed_behind_the_substrate() {
    let skin = skin(ArrayLayout::Cap.taxels(&GRID, 0.03).unwrap(), TAXEL);
    let scene = Scene::new(skin, ball(0.5e-3), Pose::from_translation(0.05 * DVec3::Z));
    let touch = pressed(
        scene
            .press(Until::Depth(3.0 * TAXEL.stroke))
            .with_contacts(),
    );
    assert!(touch.counts().n_saturated >= 1);
    let there = scene.moved(&Pose::from_translation(-touch.travel() * DVec3::Z));
    assert_eq!(
        there.touched().counts().n_touched,
        0,
        "without its way it is behind"
    );
}

/// Divides each triangle into four.
fn refined(mesh: &TriangleMesh) -> TriangleMesh {
    let triangles = (0..mesh.n_triangles()).flat_map(|number| {
        let [a, b, c] = mesh.triangle(number).0;
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| 0.5 * (from + to));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    });
    let corners: Vec<DVec3> = triangles.flatten().collect();
    let triangles = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    TriangleMesh::new("refined", corners, triangles.collect()).unwrap()
}

/// Law: an object that has been pressed through the skin hands its taxels from part to part, of any size, while it slides and turns behind the substrate. Steps
/// of any length lose no taxel.
#[test]
fn an_object_behind_the_skin_keeps_its_taxels_whatever_its_parts() {
    let plate = TriangleMesh::cuboid("plate", 2e-3 * DVec3::new(12.0, 9.0, 0.4)).unwrap();
    let meshes = [&plate, &refined(&plate), &refined(&refined(&plate))].map(|m| mesh(m.clone()));
    let place = |k: i32| 3e-3 * DVec3::new(f64::from(k % 9 - 4), f64::from(k / 9 - 3), 0.0);
    let balls = Model::from(union((0..63).map(place), 2e-3));
    let still = VelocityPlan::new(Pose::IDENTITY, vec![]).unwrap();
    let through = Phase {
        duration: 0.1,
        linear: -0.2 * DVec3::Z,
        angular: DVec3::ZERO,
    };
    let slide = Phase {
        duration: 0.2,
        linear: DVec3::new(0.03, -0.02, 0.0),
        // A level plate has vertical sides. The edges of inclined sides leave a taxel one after the other.
        angular: 0.4 * DVec3::Z,
    };
    let start = Pose {
        rotation: DQuat::from_rotation_z(0.2),
        translation: DVec3::new(0.3e-3, 0.2e-3, 9e-3),
    };
    let plan = [VelocityPlan::new(start, vec![through, slide]).unwrap()];
    for patch in [
        grid(14, 14, 2e-3),
        skin(Layout::disc(0.014, 2e-3).unwrap(), TAXEL),
    ] {
        for (dt, n_frames) in [(1e-3, 300), (2e-2, 15)] {
            let read = |object: &Model| {
                let scene = Scene::new(patch.clone(), object.clone(), Pose::IDENTITY);
                time_loop(&scene, [from_ref(&still), &plan], dt, n_frames).deflections
            };
            let n_touched = |frame: &[f64]| frame.iter().filter(|d| **d > 0.0).count();
            let [coarse, fine, finest] = meshes.each_ref().map(read);
            for (frame, deflections) in coarse.iter().enumerate() {
                assert_close(
                    deflections,
                    &fine[frame],
                    1e-12,
                    &format!("{dt} s, {frame}"),
                );
                assert_close(
                    deflections,
                    &finest[frame],
                    1e-12,
                    &format!("{dt} s, {frame}"),
                );
            }
            // The plate has slid by a third of its width.
            for frames in [coarse, read(&balls)] {
                let [n, n_left] =
                    [0.1, 0.3].map(|t: f64| n_touched(&frames[(t / dt).round() as usize - 1]));
                assert!(
                    n > 60 && n_left > n / 2 && n_left < n,
                    "{dt} s: {n_left} of {n}"
                );
            }
        }
    }
}

#[test]
fn the_direct_press_equals_the_time_loop_without_a_damper_however_deep() {
    let (mut n_through, mut n_cases) = (0, 0);
    for case in 0..200 {
        let mut scene = Scene::on_grid("time loop", case);
        let is_of_spheres = scene.is_of_spheres();
        // Large spheres do not go through the skin.
        for object in &mut scene.objects {
            let Some(union) = object.spheres() else {
                continue;
            };
            let spheres = union.spheres().iter().copied();
            let small = spheres.filter(|sphere| sphere.radius < 0.03).collect();
            *object = SphereUnion::new(small).unwrap().into();
        }
        let scene = scene.moved(&Pose::from_translation(0.1 * DVec3::Z));
        // Steps of at most 1 mm, to a pose in front of the substrate and to a pose behind it.
        let speed = rng("speed", case).gen_range(0.01..1.0);
        let approach = Phase {
            duration: 0.3,
            linear: DVec3::Z * speed,
            angular: DVec3::ZERO,
        };
        let patch_plan = VelocityPlan::new(Pose::IDENTITY, vec![approach]).unwrap();
        let poses = scene.poses.iter();
        let fixed: Vec<_> = poses
            .map(|&pose| VelocityPlan::new(pose, vec![]).unwrap())
            .collect();
        let frames = time_loop(&scene, [from_ref(&patch_plan), &fixed], 1e-3, 300);
        let last = scene.moved(&patch_plan.pose_at(300.0 * 1e-3).inverse());
        let counted = pressed(last.press(Until::Travel(0.0)));
        let tolerance = if is_of_spheres { 0.0 } else { 1e-12 };
        let name = format!("case {case}");
        assert_close(
            &frames.deflections[299],
            &counted.deflections,
            tolerance,
            &name,
        );
        let stiffness = |taxel: usize| scene.patch.taxels().at(taxel).stiffness;
        let deflections = frames.deflections[299].iter().enumerate();
        let spring = deflections.map(|(taxel, d)| stiffness(taxel) * d);
        assert!(
            frames.forces[299].iter().copied().eq(spring),
            "a spring alone"
        );
        let there = pressed(last.press(Until::Pose));
        n_through += usize::from(there.counts().n_touched < counted.counts().n_touched);
        n_cases += 1;
    }
    assert!(
        n_through > 10 && n_cases > 50,
        "{n_through} of {n_cases} go through for real"
    );
}

#[test]
fn what_comes_up_from_behind_or_around_the_patch_does_not_press_in_the_time_loop() {
    let scene = Scene::new(grid(5, 5, 2e-3), ball(0.01), Pose::IDENTITY);
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

/// Depths of presses, metres, from nearly zero to 200 mm.
const DEPTHS: [f64; 12] = [
    0.0, 1e-4, 1e-3, 3e-3, 5e-3, 8e-3, 12e-3, 0.02, 0.03, 0.06, 0.12, 0.2,
];

/// Tests that the deflections never decrease with the depth. The object lies as modelled; a coarse, slightly tilted patch over its middle is pressed deeper and
/// deeper.
fn deeper_is_never_less(name: &str, model: &Model, workspace: &mut Workspace) {
    let rest = &RestPoses::AsModelled.poses(model)[0];
    let touch = Touch {
        rest: 0,
        offset: [1e-3, -2e-3],
        yaw: 0.3,
        tilt: [0.05, -0.02],
        depth: 0.0,
        indices: [None; 7],
    };
    let scene = Scene::new(
        grid(24, 20, 5e-3),
        model.clone(),
        touch.patch_from_object(rest),
    );
    let mut before = pressed_in(workspace, scene.press(Until::Depth(0.0)));
    for depth in DEPTHS {
        let now = pressed_in(workspace, scene.press(Until::Depth(depth)));
        assert!(now.contact.is_some(), "{name} is under the patch");
        let mut pairs = now.deflections.iter().zip(&before.deflections);
        assert!(
            pairs.all(|(now, before)| now >= before),
            "{name}: {depth} m deep"
        );
        let (counts, fewer) = (now.counts(), before.counts());
        assert!(counts.n_touched >= fewer.n_touched && counts.n_saturated >= fewer.n_saturated);
        assert!(
            depth <= TAXEL.stroke || counts.n_saturated > 0,
            "{name}: {depth} m deep"
        );
        // The oracle is slow, so it is used only short of the stroke, past the stroke, and at the end.
        if model.spheres().is_some() && [3e-3, 0.02, 0.2].contains(&depth) {
            let there = scene.moved(&Pose::from_translation(-counts.travel * DVec3::Z));
            let expected = by_every_part(&there, Behind::Counts).into_iter();
            let expected: Vec<f64> = expected.map(|taxel| taxel.deflection).collect();
            assert_close(&now.deflections, &expected, 1e-12, name);
        }
        before = now;
    }
    if rest.height < 0.15 {
        // The whole object has passed through the skin.
        assert_eq!(
            before.counts().n_touched,
            before.counts().n_saturated,
            "{name}"
        );
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
        let (name, scanned) = (path.display().to_string(), scan(&path));
        let spheres = vertex_spheres(&name, scanned.vertices()).unwrap();
        for model in [mesh(scanned), Model::from(spheres)] {
            deeper_is_never_less(&name, &model, &mut workspace);
        }
        n_meshes += 1;
    }
    assert_eq!(n_meshes, 43);
}
