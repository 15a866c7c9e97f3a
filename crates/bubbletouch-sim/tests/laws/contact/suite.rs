//! Laws of contact for all press functions on shared random scenes: layouts of all families, spheres from a micrometre to a metre, and meshes of all kinds.
//! Contacts occur at edges, at the stroke, grazing, and behind the substrate.

use crate::counting::allocations;
use crate::every_part::{Behind, by_every_part};
use crate::mesh_shapes::{icosphere, inside_out};
use crate::scenes::{
    N_FAMILIES, Pressed, Scene, TAXEL, assert_close, ball, mesh, pressed, pressed_in,
    random_layout, random_pose, rng, skin, union,
};
use bubbletouch_sim::contact::{Instructions, Press, Until, Workspace, Wrench, spring_load};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::TriangleMesh;
use bubbletouch_sim::objects::{MeshModel, Model, Sphere, SphereClusters, SphereUnion};
use bubbletouch_sim::skin::{
    self as skins, ReadOptions, Skin, SkinPoses, SkinReading, SkinRelations,
};
use bubbletouch_sim::whole_body::{BodyState, WholeBody};
use bubbletouch_sim::world::{Grid, Layout, Patch, Taxel};
use glam::{DQuat, DVec3};
use rand::Rng;

const N_CASES: u64 = 360;

/// Returns the patch without the rule of its layout: its taxels are pressed one by one.
fn loose(patch: &Patch) -> Patch {
    let (centers, axes) = (patch.layout().centers(), patch.layout().axes());
    let layout = Layout::new(centers.to_vec(), axes.to_vec()).unwrap();
    skin(layout, patch.taxels().clone())
}

/// Function that presses a patch on objects at their poses and returns the deflections; `None` for unsupported scenes.
type Way = fn(&Scene) -> Option<Vec<f64>>;

const WAYS: [(&str, Way); 4] = [
    ("at a pose", |scene| {
        Some(pressed(scene.press(Until::Pose)).deflections)
    }),
    ("with contacts", |scene| Some(scene.touched().deflections)),
    ("taxels one by one", |scene| {
        let scene = Scene {
            patch: loose(&scene.patch),
            ..scene.clone()
        };
        Some(pressed(scene.press(Until::Pose)).deflections)
    }),
    ("as a body", |scene| {
        let unions = scene.objects.iter().map(Model::spheres);
        let clusters = unions.map(|union| Some(SphereClusters::new(union?)));
        let clusters: Vec<_> = clusters.collect::<Option<_>>()?;
        let body = WholeBody::new(std::slice::from_ref(&scene.patch)).ok()?;
        let mut state = BodyState::at_rest(&body);
        state.press(&body, &clusters, &scene.poses, 1.0).unwrap();
        Some(state.deflections(0).to_vec())
    }),
];

#[test]
fn every_way_pushes_every_taxel_as_far_as_every_part_says() {
    let mut n_touched = [0; WAYS.len()];
    let (mut n_by_mesh, mut n_edges) = (0, 0);
    for case in 0..N_CASES {
        let scene = Scene::random("parts", case);
        let expected = by_every_part(&scene, Behind::Ignored);
        for (number, (name, way)) in WAYS.iter().enumerate() {
            let Some(found) = way(&scene) else { continue };
            for (taxel, (found, expected)) in found.iter().zip(&expected).enumerate() {
                n_touched[number] += usize::from(*found > 0.0);
                n_by_mesh += usize::from(expected.is_by_mesh);
                if (found - expected.deflection).abs() > expected.tolerance {
                    // Rounding decides whether the edge of a mesh pushes from the side, and whether a substrate is inside the mesh.
                    let place = format!("{name}, case {case}, taxel {taxel}");
                    assert!(expected.is_by_mesh, "{place}: {found} for {expected:?}");
                    n_edges += 1;
                }
            }
        }
    }
    assert!(n_touched.iter().all(|&n| n > 2_000), "{n_touched:?}");
    assert!(n_edges < n_by_mesh / 1000, "{n_edges} of {n_by_mesh}");
}

/// A sphere beside the last column pushes it by millimetres as soon as its distance from the axis is less than the sum of the radii by one bit.
#[test]
fn a_sphere_that_touches_the_last_column_by_one_bit_pushes_it_on_every_way() {
    let mut n_touched = 0;
    for case in 0..2000 {
        let mut rng = rng("tangent", case);
        let taxel = Taxel {
            radius: rng.gen_range(0.3e-3..3e-3),
            ..TAXEL
        };
        let [nx, ny] = [0; 2].map(|_| rng.gen_range(1..20));
        let pitch = rng.gen_range(1e-3..5e-3);
        let flat = Grid { nx, ny, pitch };
        let radius = 10f64.powf(rng.gen_range(-3.0..0.0));
        let reach = taxel.radius + radius;
        let (last, height) = (flat.x(nx - 1), -rng.gen_range(1e-3..taxel.stroke));
        let mut x = last + reach;
        for _ in 0..rng.gen_range(0..4) {
            x = x.next_down();
        }
        let center = DVec3::new(x, flat.y(rng.gen_range(0..ny)), height);
        let scene = Scene::new(
            skin(Layout::grid(&flat).unwrap(), taxel),
            union([center], radius),
            Pose::IDENTITY,
        );
        let beside = x - last;
        let q = reach * reach - beside * beside;
        let expected = if q > 0.0 { q.sqrt() - height } else { 0.0 };
        n_touched += usize::from(q > 0.0);
        for (name, way) in WAYS {
            let found = way(&scene).unwrap().into_iter().fold(0.0, f64::max);
            let place = format!("{name}, case {case}");
            assert_eq!(found, f64::min(expected, taxel.stroke), "{place}");
        }
    }
    assert!(n_touched > 800, "{n_touched}");
}

/// Returns the scene after a reflection at the plane x = 0 and a motion.
fn mirrored(scene: &Scene, motion: &Pose) -> Scene {
    let mirror = |v: DVec3| motion.transform_point(DVec3::new(-v.x, v.y, v.z));
    let axes = scene.patch.layout().axes().iter();
    let axes = axes.map(|axis| motion.rotation * DVec3::new(-axis.x, axis.y, axis.z));
    let centers = scene.patch.layout().centers().iter().copied().map(mirror);
    let layout = Layout::new(centers.collect(), axes.collect()).unwrap();
    let objects = scene
        .objects
        .iter()
        .zip(&scene.poses)
        .map(|(object, pose)| match object {
            Model::Spheres(spheres) => {
                let spheres = spheres.spheres().iter().map(|sphere| Sphere {
                    center: mirror(pose.transform_point(sphere.center)),
                    ..*sphere
                });
                SphereUnion::new(spheres.collect()).unwrap().into()
            }
            Model::Mesh(model) => {
                let mesh = model.mesh().moved(pose);
                let corners = mesh.vertices().iter().copied().map(mirror).collect();
                let mesh =
                    TriangleMesh::new("mirrored", corners, mesh.triangles().to_vec()).unwrap();
                MeshModel::rounded(inside_out(&mesh), model.rounding())
                    .unwrap()
                    .into()
            }
        });
    Scene {
        objects: objects.collect(),
        poses: vec![Pose::IDENTITY; scene.objects.len()],
        patch: skin(layout, scene.patch.taxels().clone()),
    }
}

#[test]
fn a_rigid_motion_of_the_world_or_its_mirror_image_changes_nothing() {
    let (mut n_compared, mut n_flanks) = (0, 0);
    for case in 0..N_CASES / 2 {
        let scene = Scene::random("motion", case);
        let expected = by_every_part(&scene, Behind::Ignored);
        let motion = random_pose(&mut rng("to", case), 0.5);
        let layout = scene.patch.layout().moved(&motion);
        let patch = skin(layout, scene.patch.taxels().clone());
        let moved = Scene {
            patch,
            ..scene.moved(&motion)
        };
        for there in [moved, mirrored(&scene, &motion)] {
            for (name, way) in WAYS {
                let (Some(a), Some(b)) = (way(&scene), way(&there)) else {
                    continue;
                };
                for (taxel, (a, b)) in a.iter().zip(&b).enumerate() {
                    let expected = expected[taxel];
                    let mesh = if expected.is_by_mesh { 1e-9 } else { 0.0 };
                    let tolerance = expected.tolerance.max(mesh);
                    n_compared += usize::from(*a > 0.0);
                    if (a - b).abs() > 4.0 * tolerance {
                        n_flanks += 1;
                        let place = format!("{name}, case {case}, taxel {taxel}");
                        assert!(expected.is_by_mesh, "{place}: {a} {b}");
                    }
                }
            }
        }
    }
    let share = format!("{n_flanks} of {n_compared}");
    assert!(
        n_compared > 10_000 && n_flanks < n_compared / 500,
        "{share}"
    );
}

#[test]
fn a_read_of_a_skin_at_its_poses_is_the_press_under_all_bodies() {
    let mut reading = SkinReading::default();
    let mut n_touched = 0;
    for case in 0..N_CASES {
        let mut scene = Scene::random("read", case);
        if case % 3 == 0 {
            // A single taxel: parts that push it deeply are far from its centre at rest.
            let (center, axis) = (
                scene.patch.layout().centers()[0],
                scene.patch.layout().axes()[0],
            );
            let one = Layout::new(vec![center], vec![axis]).unwrap();
            scene.patch = skin(one, *scene.patch.taxels().at(0));
        }
        let poses = SkinPoses {
            patches: &[Pose::IDENTITY],
            bodies: &scene.poses.clone(),
        };
        // As a read places the bodies.
        for pose in &mut scene.poses {
            *pose = Pose::IDENTITY.compose(pose);
        }
        let skin = vec![scene.patch.clone()];
        let skin = Skin::new(skin, scene.objects.clone(), SkinRelations::default()).unwrap();
        let at_poses = skins::Pressed::AtPoses;
        skin.read(poses, at_poses, ReadOptions::default(), None, &mut reading)
            .unwrap();
        let pressed = pressed(scene.press(Until::Pose));
        assert_eq!(reading.deflections, pressed.deflections, "case {case}");
        n_touched += reading.counts[0].n_touched;
    }
    assert!(n_touched > 2_000, "{n_touched}");
}

#[test]
fn the_order_of_objects_changes_no_bit() {
    for case in 0..N_CASES {
        let mut scene = Scene::random("order", case);
        let before = WAYS.map(|(_, way)| way(&scene));
        scene.objects.reverse();
        scene.poses.reverse();
        for ((name, way), before) in WAYS.iter().zip(before) {
            assert_eq!(way(&scene), before, "{name}, case {case}");
        }
    }
}

#[test]
fn a_contact_says_what_its_taxel_touches_and_of_equal_objects_the_first_counts() {
    let mut n_touched = [0; 2];
    for case in 0..N_CASES {
        let mut scene = Scene::random("contacts", case);
        let own = scene.objects.len();
        scene.objects.push(scene.objects[0].clone());
        scene.poses.push(scene.poses[0]);
        let (patch, found) = (&scene.patch, scene.touched());
        let counts = found.counts();
        assert_eq!(found.contacts.len(), counts.n_touched);
        assert!(found.contacts.is_sorted_by(|a, b| a.taxel < b.taxel));
        for contact in &found.contacts {
            let taxel = patch.taxels().at(contact.taxel);
            let axis = patch.layout().axes()[contact.taxel];
            let pushed = patch.layout().centers()[contact.taxel] - contact.needed * axis;
            assert!((contact.normal.length() - 1.0).abs() < 1e-14);
            assert!((contact.cosine + contact.normal.dot(axis)).abs() < 1e-14);
            assert_eq!(contact.deflection, found.deflections[contact.taxel]);
            assert_eq!(contact.deflection, contact.needed.min(taxel.stroke));
            assert!(
                contact.object < own,
                "case {case}: the first of two equal objects"
            );
            let pose = scene.poses[contact.object];
            // The point of contact is on the part, one radius of the taxel from the centre of the pushed taxel.
            let is_on = match &scene.objects[contact.object] {
                Model::Spheres(spheres) => {
                    let sphere = spheres.spheres()[contact.part];
                    let from = contact.point - pose.transform_point(sphere.center);
                    let is_radius = (from - sphere.radius * contact.normal).length() < 1e-14;
                    let reached = contact.point + taxel.radius * contact.normal - pushed;
                    is_radius && reached.length() < 1e-14
                }
                Model::Mesh(mesh) => {
                    let placed = mesh.mesh().moved(&pose).triangle(contact.part);
                    let (nearest, _) = placed.closest(contact.point);
                    let rounded = nearest.distance(contact.point) - mesh.rounding();
                    let reached = contact.point + taxel.radius * contact.normal - pushed;
                    rounded.abs() < 1e-9 && reached.length() < 1e-9
                }
            };
            assert!(is_on, "case {case}: {contact:?}");
            let is_sphere = scene.objects[contact.object].spheres().is_some();
            n_touched[usize::from(is_sphere)] += 1;
        }
        let n_deflected = found.deflections.iter().filter(|&&d| d > 0.0).count();
        assert_eq!(n_deflected, counts.n_touched);
        let is_saturated = |taxel: usize| move |stroke: f64| taxel as f64 >= stroke;
        let _ = is_saturated;
        let contacts = found.contacts.iter();
        let saturated = contacts.filter(|c| c.is_saturated(patch.taxels().at(c.taxel)));
        assert_eq!(saturated.count(), counts.n_saturated);
    }
    assert!(n_touched.iter().all(|&n| n > 2_000), "{n_touched:?}");
}

#[test]
fn patch_and_objects_push_each_other_equally_and_every_spring_along_its_axis() {
    for case in 0..N_CASES {
        let scene = Scene::random("reaction", case);
        let contacts = scene.touched().contacts;
        let load = spring_load(&scene.patch, &contacts);
        let both = load.on_object + load.on_patch();
        assert_eq!((both.force, both.torque), (DVec3::ZERO, DVec3::ZERO));
        let parts = (0..scene.objects.len()).map(|object| {
            let of_one = contacts.iter().filter(|c| c.object == object);
            spring_load(&scene.patch, of_one).on_object
        });
        let parts = parts.fold(Wrench::default(), |sum, one| sum + one);
        assert!((parts.force - load.on_object.force).length() < 1e-9 * (1.0 + load.spring_force));
        for contact in contacts.iter().filter(|c| !c.is_grazing()) {
            let spring = scene.patch.taxels().at(contact.taxel).stiffness * contact.deflection;
            let one = spring_load(&scene.patch, [contact]).on_object.force;
            let along = one.dot(scene.patch.layout().axes()[contact.taxel]);
            assert!(
                (along - spring).abs() < 1e-12 * spring.max(1.0),
                "{along} {spring}"
            );
        }
    }
}

/// Presses of a grid work by rows and rasterise meshes; presses with contacts and presses of other layouts search a tree.
#[test]
fn a_grid_is_pressed_as_its_taxels_one_by_one_and_with_the_same_bits_by_all_instructions() {
    let (mut n_touched, mut n_saturated) = ([0; 4], [0; 4]);
    for case in 0..600 {
        let scene = Scene::on_grid("rows", case);
        let lonely = Scene {
            patch: loose(&scene.patch),
            ..scene.clone()
        };
        let mut rng = rng("goals", case);
        let depth = 5e-3 * 10f64.powf(rng.gen_range(-2.0..0.7));
        let first = pressed(scene.press(Until::Depth(0.0))).counts().travel;
        let travel = first + rng.gen_range(-1e-3..0.02);
        let force = 10f64.powf(rng.gen_range(-2.0..1.5));
        let goals = [
            Until::Pose,
            Until::Depth(depth),
            Until::Travel(travel),
            Until::Force(force),
        ];
        for (number, goal) in goals.into_iter().enumerate() {
            let place = format!("case {case}, {goal:?}");
            let mut workspace = Workspace::with(Instructions::Baseline);
            let expected = scene.press(goal).run(&mut workspace);
            let Ok(contact) = expected else {
                assert!(lonely.press(goal).run(&mut workspace).is_err(), "{place}");
                continue;
            };
            let deflections = workspace.deflections().to_vec();
            for &instructions in Instructions::here() {
                let mut workspace = Workspace::with(instructions);
                let same = scene.press(goal).run(&mut workspace).unwrap();
                let is_same = same == contact && deflections == workspace.deflections();
                assert!(is_same, "{place}, {instructions:?}");
            }
            let counts = contact.unwrap_or_default();
            let [touched, one_by_one] = [&scene, &lonely].map(|scene| {
                let other = pressed(scene.press(goal).with_contacts());
                assert_eq!(other.contact.is_some(), contact.is_some(), "{place}");
                let travelled = (other.counts().travel - counts.travel).abs();
                assert!(travelled < 1e-12, "{place}: {other:?} {counts:?}");
                assert_eq!(other.counts().n_saturated, counts.n_saturated, "{place}");
                assert_close(&other.deflections, &deflections, 1e-12, &place);
                other
            });
            for &instructions in Instructions::here() {
                let mut workspace = Workspace::with(instructions);
                let same = pressed_in(&mut workspace, lonely.press(goal).with_contacts());
                assert_eq!(same, one_by_one, "{place}, {instructions:?}");
            }
            if goal == Until::Pose && scene.is_of_spheres() {
                assert_eq!(
                    touched, one_by_one,
                    "{place}: taxels, parts, normals and points"
                );
            }
            n_touched[number] += counts.n_touched;
            n_saturated[number] += counts.n_saturated;
        }
    }
    let found = format!("{n_touched:?} {n_saturated:?}");
    assert!(n_touched.iter().all(|&n| n > 5_000), "{found}");
    assert!(n_saturated.iter().all(|&n| n > 300), "{found}");
}

#[test]
fn force_and_torque_are_minus_the_gradient_of_the_energy() {
    let mut n_checked = [0; 2];
    for case in 0..4 * N_CASES {
        let mut rng = rng("energy", case);
        let patch = skin(
            random_layout(&mut rng, case),
            Taxel {
                stroke: 0.05,
                ..TAXEL
            },
        );
        let number = rng.gen_range(0..patch.n_taxels());
        let (place, axis) = (
            patch.layout().centers()[number],
            patch.layout().axes()[number],
        );
        let radius = rng.gen_range(0.01..0.1);
        let object: Model = match case % 2 {
            0 => ball(radius).into(),
            _ => mesh(icosphere(radius, 2)),
        };
        let scene = Scene::new(
            patch,
            object,
            Pose::from_translation(place + (radius - 1e-3) * axis),
        );
        let parts = |found: &Pressed| found.contacts.iter().map(|c| c.part).collect::<Vec<_>>();
        let found = scene.touched();
        let is_grazing = found.contacts.iter().any(|c| c.cosine < 0.1);
        if found.counts().n_touched < 2 || found.counts().n_saturated > 0 || is_grazing {
            continue;
        }
        let load = spring_load(&scene.patch, &found.contacts).on_object;
        // The slope of the energy has kinks between triangles.
        let mut is_smooth = true;
        let mut energy = |motion: Pose| {
            let moved = scene.moved(&motion).touched();
            is_smooth &= parts(&moved) == parts(&found);
            let springs = moved.deflections.iter();
            springs.map(|d| 0.5 * TAXEL.stiffness * d * d).sum::<f64>()
        };
        let step = 1e-7;
        let mut slopes = Vec::new();
        for along in DVec3::AXES {
            let mut slope = |motion: &dyn Fn(f64) -> Pose| {
                (energy(motion(step)) - energy(motion(-step))) / (2.0 * step)
            };
            let moved = slope(&|s| Pose::from_translation(s * along));
            let turned = slope(&|a| Pose::from_rotation(DQuat::from_scaled_axis(a * along)));
            slopes.push((
                moved + load.force.dot(along),
                turned + load.torque.dot(along),
            ));
        }
        if !is_smooth {
            continue;
        }
        n_checked[(case % 2) as usize] += 1;
        let scale = 1e-5 * load.force.length();
        for (force, torque) in slopes {
            let is_balanced = force.abs() < scale && torque.abs() < 0.1 * scale;
            assert!(is_balanced, "case {case}: {force} {torque}");
        }
    }
    assert!(n_checked.iter().all(|&n| n > 40), "{n_checked:?}");
}

#[test]
fn presses_after_the_first_allocate_nothing() {
    let radius = 0.03;
    let paths = [Until::Travel(0.0), Until::Depth(1e-3), Until::Force(0.01)];
    for case in 0..2 * N_FAMILIES {
        let (family, is_mesh) = (case / 2, case % 2 == 1);
        let patch = skin(random_layout(&mut rng("allocation", family), family), TAXEL);
        let number = patch.n_taxels() / 2;
        let (place, axis) = (
            patch.layout().centers()[number],
            patch.layout().axes()[number],
        );
        let objects: [Model; 1] = match is_mesh {
            true => [mesh(icosphere(radius, 2))],
            false => [ball(radius).into()],
        };
        let on_grids = if family == 0 { &paths[..] } else { &[] };
        let presses = [(Until::Pose, false), (Until::Pose, true)].into_iter();
        for (goal, with_contacts) in presses.chain(on_grids.iter().map(|&goal| (goal, false))) {
            let mut workspace = Workspace::new();
            let mut n_touched = Vec::with_capacity(50);
            let mut allocated = |step: u32| {
                // The deepest press comes first, so later presses touch no more taxels.
                let height = radius - 2e-3 + 5e-5 * f64::from(step);
                let pose = [Pose::from_translation(place + height * axis)];
                let press = Press::new(&patch, &objects, &pose, goal);
                let press = if with_contacts {
                    press.with_contacts()
                } else {
                    press
                };
                allocations(|| {
                    let contact = press.run(&mut workspace).unwrap().unwrap_or_default();
                    let load = spring_load(&patch, workspace.contacts());
                    assert!(load.spring_force.is_finite());
                    n_touched.push(contact.n_touched);
                })
            };
            let case =
                format!("layout {family}, mesh {is_mesh}, {goal:?}, contacts {with_contacts}");
            assert!(allocated(0) > 0, "{case}");
            assert_eq!((1..50).map(&mut allocated).sum::<usize>(), 0, "{case}");
            assert!(n_touched[0] > 0, "{case}");
        }
    }
}
