//! Laws of presses to a force: comparison with slow bisection and with a press to the travel found, and errors for unreachable forces.

use crate::random_scenes::Scene;
use bubbletouch_sim::contact::{Press, Until, Workspace, spring_load};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::TriangleMesh;
use bubbletouch_sim::objects::{MeshModel, Model, Sphere, SphereUnion};
use bubbletouch_sim::world::{Grid, Layout, Patch, Taxel, Taxels};
use glam::{DQuat, DVec3};
use rand::Rng;

use crate::mesh_shapes::{cuboid, icosphere};
use crate::random_scenes::{TAXEL, direction, rng};

/// Returns a scene of spheres a few times as large as the stroke, or a mesh, in a random orientation over or beside a grid.
fn random_scene(name: &str, case: u64) -> (Scene, Vec<Pose>) {
    let mut rng = rng(name, case);
    let grid = Grid {
        nx: rng.gen_range(1..30),
        ny: rng.gen_range(1..30),
        pitch: rng.gen_range(0.5e-3..4e-3),
    };
    let mut object = |kind: u64| -> Model {
        let size = rng.gen_range(5e-3..3e-2);
        match kind % 3 {
            0 => MeshModel::new(cuboid(size * DVec3::new(1.0, 0.7, 0.4))).into(),
            1 => MeshModel::new(icosphere(size, 2)).into(),
            _ => {
                let spheres = (0..40).map(|_| Sphere {
                    center: size * direction(&mut rng),
                    radius: size * rng.gen_range(0.2..0.6),
                });
                SphereUnion::new(spheres.collect()).unwrap().into()
            }
        }
    };
    let objects = vec![object(case), object(case / 3 + 1)];
    let mut pose = || {
        let turn = DQuat::from_scaled_axis(rng.gen_range(0.0..6.0) * direction(&mut rng));
        Pose::new(turn, rng.gen_range(0.0..0.04) * direction(&mut rng))
    };
    let poses = vec![pose(), pose()];
    let patch = Patch::grid(grid, TAXEL).unwrap();
    (Scene { patch, objects }, poses)
}

/// Returns the travel at first contact, metres.
fn first_contact(scene: &Scene, poses: &[Pose]) -> f64 {
    let press = Press::new(&scene.patch, &scene.objects, poses, Until::Depth(0.0));
    press.run(&mut Workspace::new()).unwrap().unwrap().travel
}

fn force_of(workspace: &Workspace) -> f64 {
    TAXEL.stiffness * workspace.deflections().iter().sum::<f64>()
}

/// Returns a force that the scene can reach, from nearly zero to the force of a press three strokes deep; `None` if nothing is met.
fn reachable_force(scene: &Scene, poses: &[Pose], case: u64) -> Option<f64> {
    let mut workspace = Workspace::new();
    let mut rng = rng("share", case);
    let depth = TAXEL.stroke * 10f64.powf(rng.gen_range(-3.0..0.5));
    Press::new(&scene.patch, &scene.objects, poses, Until::Depth(depth))
        .run(&mut workspace)
        .unwrap()?;
    Some(force_of(&workspace) * rng.gen_range(0.5..1.0))
}

#[test]
fn a_touch_to_a_force_is_where_a_slow_bisection_finds_it() {
    let (mut workspace, mut slow) = (Workspace::new(), Workspace::new());
    let (mut n_found, mut n_deep) = (0, 0);
    for case in 0..300 {
        let (scene, poses) = random_scene("bisection", case);
        let Some(force) = reachable_force(&scene, &poses, case) else {
            let missed = Press::new(&scene.patch, &scene.objects, &poses, Until::Force(1.0))
                .run(&mut workspace);
            assert!(missed.unwrap().is_none());
            assert!(workspace.deflections().iter().all(|&d| d == 0.0));
            continue;
        };
        let first = first_contact(&scene, &poses);
        let contact = Press::new(&scene.patch, &scene.objects, &poses, Until::Force(force))
            .run(&mut workspace);
        let contact = contact.unwrap().unwrap();
        let (mut low, mut high) = (first, first + 4.0 * TAXEL.stroke);
        while 0.5 * (low + high) > low && 0.5 * (low + high) < high {
            let middle = 0.5 * (low + high);
            Press::new(&scene.patch, &scene.objects, &poses, Until::Travel(middle))
                .run(&mut slow)
                .unwrap();
            let carries_less = force_of(&slow) < force;
            *(if carries_less { &mut low } else { &mut high }) = middle;
        }
        let n_touched = contact.n_touched as f64;
        let last_bit = 1e-17 * TAXEL.stiffness * n_touched;
        let error = (force_of(&workspace) - force).abs();
        let place = format!("case {case}: {force} N, error {error}");
        assert!(error <= 1e-12 * force + 4.0 * last_bit, "{place}");
        let at_most = 1e-15 + 1e-12 * force / TAXEL.stiffness;
        assert!((contact.travel - high).abs() <= at_most, "{place}");
        n_found += 1;
        n_deep += usize::from(contact.n_saturated > 0);
    }
    assert!(n_found > 200 && n_deep > 20, "{n_found} {n_deep}");
}

#[test]
fn a_touch_to_a_force_is_the_press_at_its_travel_and_at_its_depth() {
    let (mut workspace, mut other) = (Workspace::new(), Workspace::new());
    for case in 0..200 {
        let (scene, poses) = random_scene("press", case);
        let Some(force) = reachable_force(&scene, &poses, case) else {
            continue;
        };
        let contact = Press::new(&scene.patch, &scene.objects, &poses, Until::Force(force))
            .run(&mut workspace)
            .unwrap();
        let contact = contact.unwrap();
        let there = Press::new(
            &scene.patch,
            &scene.objects,
            &poses,
            Until::Travel(contact.travel),
        )
        .run(&mut other)
        .unwrap()
        .unwrap_or_default();
        assert_eq!(contact, there);
        assert_eq!(workspace.deflections(), other.deflections(), "to the bit");
        let depth = contact.travel - first_contact(&scene, &poses);
        Press::new(&scene.patch, &scene.objects, &poses, Until::Depth(depth))
            .run(&mut other)
            .unwrap()
            .unwrap();
        for (a, b) in workspace.deflections().iter().zip(other.deflections()) {
            assert!((a - b).abs() < 1e-16, "{a} {b}");
        }
    }
}

#[test]
fn more_force_goes_further() {
    let mut workspace = Workspace::new();
    let mut n_steps = 0;
    for case in 0..60 {
        let (scene, poses) = random_scene("monotone", case);
        let Some(most) = reachable_force(&scene, &poses, case) else {
            continue;
        };
        let mut before = f64::NEG_INFINITY;
        for k in 1..=20 {
            let force = most * f64::from(k) / 20.0;
            let contact = Press::new(&scene.patch, &scene.objects, &poses, Until::Force(force))
                .run(&mut workspace)
                .unwrap();
            let travel = contact.unwrap().travel;
            assert!(travel > before, "case {case}: {force} N");
            before = travel;
            n_steps += 1;
        }
    }
    assert!(n_steps > 500, "{n_steps}");
}

fn ball_over(grid: Grid, radius: f64) -> Scene {
    let center = DVec3::new(0.0, 0.0, 0.1);
    let ball = SphereUnion::new(vec![Sphere { center, radius }]).unwrap();
    let patch = Patch::grid(grid, TAXEL).unwrap();
    Scene::of_one(&patch, &ball.into())
}

#[test]
fn a_single_taxel_is_a_spring() {
    let grid = Grid {
        nx: 1,
        ny: 1,
        pitch: 2e-3,
    };
    let scene = ball_over(grid, 0.03);
    let mut workspace = Workspace::new();
    for force in [1e-9, 0.1, 0.4, 0.5] {
        let contact = Press::new(
            &scene.patch,
            &scene.objects,
            &[Pose::IDENTITY],
            Until::Force(force),
        )
        .run(&mut workspace)
        .unwrap();
        let travel = contact.unwrap().travel;
        let expected = 0.1 - 0.03 - TAXEL.radius + force / TAXEL.stiffness;
        assert!((travel - expected).abs() < 1e-15, "{travel} {expected}");
    }
}

#[test]
fn what_cannot_be_reached_is_refused_with_the_largest_force() {
    let grid = Grid {
        nx: 4,
        ny: 2,
        pitch: 2e-3,
    };
    let mut workspace = Workspace::new();
    let mut message = |scene: &Scene, force: f64| {
        let result = Press::new(
            &scene.patch,
            &scene.objects,
            &[Pose::IDENTITY],
            Until::Force(force),
        )
        .run(&mut workspace);
        result.unwrap_err().to_string()
    };
    let scene = ball_over(grid, 0.03);
    for force in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            message(&scene, force),
            format!("touch force: {force} N; a finite positive number")
        );
    }
    assert_eq!(
        message(&scene, 4.5),
        "touch force: 4.5 N; up to 4.000000 N, where all 8 taxels that the object reaches are at their stroke, 5.129 mm past \
         first contact"
    );
    // The force of all taxels at their strokes can be reached, but no larger force.
    let scene = ball_over(grid, 0.03);
    let all = Press::new(
        &scene.patch,
        &scene.objects,
        &[Pose::IDENTITY],
        Until::Force(4.0),
    )
    .run(&mut workspace)
    .unwrap();
    assert_eq!(all.unwrap().n_touched, 8);
}

/// Joins several meshes into one.
fn joined(meshes: &[TriangleMesh]) -> TriangleMesh {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let before = corners.len() as u32;
        corners.extend_from_slice(mesh.vertices());
        faces.extend(
            mesh.triangles()
                .iter()
                .map(|face| face.map(|corner| corner + before)),
        );
    }
    TriangleMesh::new("joined", corners, faces).unwrap()
}

#[test]
fn no_part_passes_through_a_skin_on_the_way_to_a_force() {
    // A small part in front of a large part: the small part is far behind the substrate before the large part touches.
    let grid = Grid {
        nx: 40,
        ny: 40,
        pitch: 2e-3,
    };
    let patch = Patch::grid(grid, TAXEL).unwrap();
    let sphere = |z: f64, radius: f64| Sphere {
        center: DVec3::new(1e-3, 1e-3, z),
        radius,
    };
    let lollipop = SphereUnion::new(vec![sphere(0.0, 1.5e-3), sphere(0.1, 0.05)]).unwrap();
    let both = [
        cuboid(DVec3::splat(1.5e-3)),
        cuboid(DVec3::splat(0.03)).moved(&Pose::from_translation(0.1 * DVec3::Z)),
    ];
    let nail = joined(&both);
    let (mut workspace, mut on_skin) = (Workspace::new(), Workspace::new());
    for object in [lollipop.into(), Model::from(MeshModel::new(nail))] {
        let scene = Scene::of_one(&patch, &object);
        let start = [Pose::from_translation(0.01 * DVec3::Z)];
        for force in [1.0, 50.0] {
            let pressed = Press::new(&scene.patch, &scene.objects, &start, Until::Force(force))
                .run(&mut workspace);
            let pressed = pressed.unwrap().unwrap();
            let felt = force_of(&workspace);
            assert!((felt - force).abs() < 1e-9, "{felt} of {force} N");
            let first = first_contact(&scene, &start);
            let has_gone_through = pressed.travel - first > 0.04;
            assert_eq!(has_gone_through, force > 10.0);
            let found = Press::new(&scene.patch, &scene.objects, &start, Until::Force(force))
                .with_contacts()
                .run(&mut on_skin);
            let found = found.unwrap().unwrap();
            assert!((found.travel - pressed.travel).abs() < 1e-12);
            Press::new(
                &scene.patch,
                &scene.objects,
                &start,
                Until::Travel(found.travel),
            )
            .run(&mut workspace)
            .unwrap();
            for (a, b) in on_skin.deflections().iter().zip(workspace.deflections()) {
                assert!((a - b).abs() < 1e-12, "{force} N: {a} {b}");
            }
        }
        let skin = patch.clone();
        // Afterwards the workspace can press objects at their given poses, with correct results.
        let behind = [Pose::from_translation(-0.3 * DVec3::Z)];
        assert_eq!(
            Press::new(&skin, &scene.objects, &behind, Until::Pose)
                .with_contacts()
                .run(&mut on_skin)
                .unwrap()
                .unwrap_or_default()
                .n_touched,
            0
        );
    }
}

/// Returns a skin, and a ball in front of it in the returned direction of travel.
fn random_way(case: u64) -> (Patch, Vec<Model>, Pose, DVec3) {
    let mut rng = rng("way", case);
    let layout = match case % 4 {
        0 => Layout::hexagonal(12, 12, 2e-3),
        1 => Layout::sphere_cap(0.02, 1.4, 2e-3),
        2 => Layout::cylinder(0.02, 0.03, 3.0, 2e-3),
        _ => Layout::disc(0.012, 1.5e-3),
    };
    let layout = layout.unwrap();
    let each = (0..layout.n_taxels()).map(|_| Taxel {
        stiffness: rng.gen_range(50.0..300.0),
        stroke: rng.gen_range(3e-3..6e-3),
        ..TAXEL
    });
    let each = Taxels::Each(each.collect());
    let middle = rng.gen_range(0..layout.n_taxels());
    let (center, axis) = (layout.centers()[middle], layout.axes()[middle]);
    let skin = Patch::new("skin", layout, each).unwrap();
    let way = (axis + 0.4 * direction(&mut rng)).normalize();
    let radius = rng.gen_range(0.01..0.03);
    let spheres = vec![Sphere {
        center: DVec3::ZERO,
        radius,
    }];
    let ball = match case % 2 {
        0 => SphereUnion::new(spheres).unwrap().into(),
        _ => MeshModel::new(icosphere(radius, 2)).into(),
    };
    let away = radius + rng.gen_range(0.005..0.05);
    (
        skin,
        vec![ball],
        Pose::from_translation(center + away * way),
        way,
    )
}

#[test]
fn a_skin_moved_to_a_force_carries_it_and_first_there() {
    let (mut workspace, mut slow) = (Workspace::new(), Workspace::new());
    let mut n_touched = 0;
    for case in 0..200 {
        let (skin, objects, pose, way) = random_way(case);
        let force = 10f64.powf(rng("force", case).gen_range(-3.0..0.5));
        let press = Press::new(&skin, &objects, &[pose], Until::Force(force))
            .along(way)
            .with_contacts()
            .run(&mut workspace);
        let press = press.unwrap().unwrap();
        let carried = spring_load(&skin, workspace.contacts()).spring_force;
        // The last bit of a position in the scene, which is about 0.1 m large, changes the force by the stiffness of the touched taxels.
        let contacts = workspace.contacts().iter();
        let stiffness: f64 = contacts
            .map(|one| skin.taxels().at(one.taxel).stiffness)
            .sum();
        let tolerance = f64::max(1e-12 * force, stiffness * 0.1 * f64::EPSILON);
        assert!(
            (carried - force).abs() <= tolerance,
            "case {case}: {carried} N for {force} N at {} m",
            press.travel
        );
        let deflections = workspace.deflections().to_vec();
        let mut force_at = |travel: f64| {
            let moved = Pose::from_translation(-travel * way).compose(&pose);
            Press::new(&skin, &objects, &[moved], Until::Pose)
                .with_contacts()
                .run(&mut slow)
                .unwrap();
            spring_load(&skin, slow.contacts()).spring_force
        };
        for k in 0..100 {
            let before = press.travel * f64::from(k) / 100.0;
            assert!(force_at(before) < force, "case {case}: not before");
        }
        assert!((force_at(press.travel) - force).abs() <= tolerance);
        for (a, b) in deflections.iter().zip(slow.deflections()) {
            assert!((a - b).abs() < 1e-12, "case {case}: {a} {b}");
        }
        n_touched += press.n_touched;
    }
    assert!(n_touched > 1_000, "{n_touched}");
}

#[test]
fn ways_that_miss_or_cannot_be_gone_are_told_apart() {
    let grid = Grid {
        nx: 4,
        ny: 4,
        pitch: 2e-3,
    };
    let scene = ball_over(grid, 0.03);
    let skin = scene.patch.clone();
    let mut workspace = Workspace::new();
    let mut press = |pose: Pose, way: DVec3, force: f64| {
        Press::new(&skin, &scene.objects, &[pose], Until::Force(force))
            .along(way)
            .with_contacts()
            .run(&mut workspace)
    };
    let here = Pose::IDENTITY;
    assert!(press(here, DVec3::X, 1.0).unwrap().is_none());
    // The path starts far away, whatever the patch's position.
    let mut at = |travel: f64| press(Pose::from_translation(-travel * DVec3::Z), DVec3::Z, 1.0);
    let travels = [0.0, 0.071]
        .map(&mut at)
        .map(|found| found.unwrap().unwrap().travel);
    assert!(
        (travels[0] - travels[1] - 0.071).abs() < 1e-15,
        "{travels:?}"
    );
    let mut message = |pose, way, force| press(pose, way, force).unwrap_err().to_string();
    assert_eq!(
        message(here, 2.0 * DVec3::Z, 1.0),
        "touch direction: [0, 0, 2]; a vector of length one"
    );
    assert_eq!(
        message(here, DVec3::Z, 0.0),
        "touch force: 0 N; a finite positive number"
    );
    let said = message(here, DVec3::Z, 9.0);
    assert!(
        said.starts_with("touch force: 9 N; up to 8.000000 N, where the patch has gone 7"),
        "{said}"
    );
}
