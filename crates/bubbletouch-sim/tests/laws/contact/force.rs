//! Laws of presses to a force: comparison with slow bisection and with a press to the travel found, and errors for unreachable forces.

use crate::mesh_shapes::{cuboid, icosphere, joined};
use crate::scenes::{
    Pressed, Scene, TAXEL, assert_close, ball, direction, grid, mesh, pressed, rng, skin,
};
use bubbletouch_sim::contact::{MovedObject, Press, Until, Workspace, spring_load};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Model, Sphere, SphereUnion};
use bubbletouch_sim::world::{Layout, Patch, Taxel, Taxels};
use glam::DVec3;
use rand::Rng;

/// Returns the sum of the spring forces, newtons.
fn force_of(patch: &Patch, found: &Pressed) -> f64 {
    let deflections = found.deflections.iter().enumerate();
    let forces = deflections.map(|(taxel, d)| patch.taxels().at(taxel).stiffness * d);
    forces.sum()
}

/// Returns a force that the scene can reach, from nearly zero to the force of a press three strokes deep; `None` if nothing is met.
fn reachable_force(scene: &Scene, case: u64) -> Option<f64> {
    let mut rng = rng("share", case);
    let stroke = scene.patch.taxels().at(0).stroke;
    let depth = stroke * 10f64.powf(rng.gen_range(-3.0..0.5));
    let found = pressed(scene.press(Until::Depth(depth)));
    found.contact?;
    Some(force_of(&scene.patch, &found) * rng.gen_range(0.5..1.0))
}

#[test]
fn a_touch_to_a_force_is_where_a_slow_bisection_finds_it() {
    let (mut n_found, mut n_deep) = (0, 0);
    for case in 0..300 {
        let scene = Scene::on_grid("bisection", case);
        let Some(force) = reachable_force(&scene, case) else {
            let missed = pressed(scene.press(Until::Force(1.0)));
            assert!(missed.contact.is_none() && missed.deepest() == 0.0);
            continue;
        };
        let taxel = *scene.patch.taxels().at(0);
        let first = pressed(scene.press(Until::Depth(0.0))).travel();
        let found = pressed(scene.press(Until::Force(force)));
        let there = pressed(scene.press(Until::Travel(found.travel())));
        assert_eq!(
            found, there,
            "case {case}: the press to its travel, to the bit"
        );
        let depth = found.travel() - first;
        let there = pressed(scene.press(Until::Depth(depth)));
        assert_close(
            &found.deflections,
            &there.deflections,
            1e-16,
            "the press to its depth",
        );
        let (mut low, mut high) = (first, first + 4.0 * taxel.stroke);
        while 0.5 * (low + high) > low && 0.5 * (low + high) < high {
            let middle = 0.5 * (low + high);
            let slow = pressed(scene.press(Until::Travel(middle)));
            let carries_less = force_of(&scene.patch, &slow) < force;
            *(if carries_less { &mut low } else { &mut high }) = middle;
        }
        let counts = found.counts();
        // The last bit of a position changes the force by the stiffness of the touched taxels.
        let sizes = scene
            .objects
            .iter()
            .map(|object| object.bounds().size().max_element());
        let size = sizes.fold(0.0, f64::max);
        let last_bit_of_place = f64::max(1e-17, 0.5 * f64::EPSILON * size);
        let last_bit = last_bit_of_place * taxel.stiffness * counts.n_touched as f64;
        let error = (force_of(&scene.patch, &found) - force).abs();
        let place = format!("case {case}: {force} N, error {error}");
        assert!(error <= 1e-12 * force + 4.0 * last_bit, "{place}");
        let at_most = f64::max(1e-15, 4.0 * last_bit_of_place) + 1e-12 * force / taxel.stiffness;
        assert!((counts.travel - high).abs() <= at_most, "{place}");
        n_found += 1;
        n_deep += usize::from(counts.n_saturated > 0);
    }
    assert!(n_found > 200 && n_deep > 10, "{n_found} {n_deep}");
}

#[test]
fn more_force_goes_further() {
    let mut n_steps = 0;
    for case in 0..60 {
        let scene = Scene::on_grid("monotone", case);
        let Some(most) = reachable_force(&scene, case) else {
            continue;
        };
        let mut before = f64::NEG_INFINITY;
        for k in 1..=20 {
            let force = most * f64::from(k) / 20.0;
            let travel = pressed(scene.press(Until::Force(force))).travel();
            assert!(travel > before, "case {case}: {force} N");
            before = travel;
            n_steps += 1;
        }
    }
    assert!(n_steps > 500, "{n_steps}");
}

fn ball_over(patch: Patch) -> Scene {
    Scene::new(patch, ball(0.03), Pose::from_translation(0.1 * DVec3::Z))
}

#[test]
fn a_single_taxel_is_a_spring() {
    let scene = ball_over(grid(1, 1, 2e-3));
    for force in [1e-9, 0.1, 0.4, 0.5] {
        let travel = pressed(scene.press(Until::Force(force))).travel();
        let expected = 0.1 - 0.03 - TAXEL.radius + force / TAXEL.stiffness;
        assert!((travel - expected).abs() < 1e-15, "{travel} {expected}");
    }
}

#[test]
fn what_cannot_be_reached_is_refused_with_the_largest_force() {
    let scene = ball_over(grid(4, 2, 2e-3));
    let message = |force: f64| {
        let result = scene.press(Until::Force(force)).run(&mut Workspace::new());
        result.unwrap_err().to_string()
    };
    for force in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let expected = format!("touch force: {force} N; a finite positive number");
        assert_eq!(message(force), expected);
    }
    assert_eq!(
        message(4.5),
        "touch force: 4.5 N; up to 4.000000 N, where all 8 taxels that the object reaches are at their stroke, 5.129 mm past \
         first contact"
    );
    // The force of all taxels at their strokes can be reached, but no larger force.
    assert_eq!(
        pressed(scene.press(Until::Force(4.0))).counts().n_touched,
        8
    );
}

#[test]
fn no_part_passes_through_a_skin_on_the_way_to_a_force() {
    // A small part in front of a large part: the small part is far behind the substrate before the large part touches.
    let sphere = |z: f64, radius: f64| Sphere {
        center: DVec3::new(1e-3, 1e-3, z),
        radius,
    };
    let lollipop = SphereUnion::new(vec![sphere(0.0, 1.5e-3), sphere(0.1, 0.05)]).unwrap();
    let nail = joined(&[
        cuboid(DVec3::splat(1.5e-3)),
        cuboid(DVec3::splat(0.03)).moved(&Pose::from_translation(0.1 * DVec3::Z)),
    ]);
    let patch = grid(40, 40, 2e-3);
    let mut on_skin = Workspace::new();
    for object in [Model::from(lollipop), mesh(nail)] {
        let scene = Scene::new(
            patch.clone(),
            object,
            Pose::from_translation(0.01 * DVec3::Z),
        );
        let first = pressed(scene.press(Until::Depth(0.0))).travel();
        for force in [1.0, 50.0] {
            let found = pressed(scene.press(Until::Force(force)));
            let felt = found.spring_force(TAXEL.stiffness);
            assert!((felt - force).abs() < 1e-9, "{felt} of {force} N");
            let has_gone_through = found.travel() - first > 0.04;
            assert_eq!(has_gone_through, force > 10.0);
            let with_contacts = scene.press(Until::Force(force)).with_contacts();
            let contact = with_contacts.run(&mut on_skin).unwrap().unwrap();
            assert!((contact.travel - found.travel()).abs() < 1e-12);
            let there = pressed(scene.press(Until::Travel(contact.travel)));
            assert_close(
                on_skin.deflections(),
                &there.deflections,
                1e-12,
                "with contacts",
            );
        }
        // Afterwards the workspace can press objects at their given poses, with correct results.
        let behind = [Pose::from_translation(-0.3 * DVec3::Z)];
        let press = Press::new(&patch, &scene.objects, &behind, Until::Pose).with_contacts();
        assert_eq!(press.run(&mut on_skin).unwrap(), None);
    }
}

/// Returns a skin with a ball in front of it, and the direction of travel towards the ball.
fn random_way(case: u64) -> (Scene, DVec3) {
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
    let way = (axis + 0.4 * direction(&mut rng)).normalize();
    let radius = rng.gen_range(0.01..0.03);
    let object: Model = match case % 2 {
        0 => ball(radius).into(),
        _ => mesh(icosphere(radius, 2)),
    };
    let away = radius + rng.gen_range(0.005..0.05);
    let pose = Pose::from_translation(center + away * way);
    (Scene::new(skin(layout, each), object, pose), way)
}

#[test]
fn a_skin_moved_to_a_force_carries_it_and_first_there() {
    let mut n_touched = 0;
    for case in 0..200 {
        let (scene, way) = random_way(case);
        let force = 10f64.powf(rng("force", case).gen_range(-3.0..0.5));
        let found = pressed(scene.press(Until::Force(force)).along(way).with_contacts());
        let carried = spring_load(&scene.patch, &found.contacts).spring_force;
        // The last bit of a position in the scene, which is about 0.1 m large, changes the force by the stiffness of the touched taxels.
        let stiffness = |taxel: usize| scene.patch.taxels().at(taxel).stiffness;
        let stiffness: f64 = found.contacts.iter().map(|one| stiffness(one.taxel)).sum();
        let tolerance = f64::max(1e-12 * force, stiffness * 0.1 * f64::EPSILON);
        let travel = found.travel();
        let place = format!("case {case}: {carried} N for {force} N at {travel} m");
        assert!((carried - force).abs() <= tolerance, "{place}");
        let at = |travel: f64| {
            scene
                .moved(&Pose::from_translation(-travel * way))
                .touched()
        };
        let force_of = |found: &Pressed| spring_load(&scene.patch, &found.contacts).spring_force;
        for k in 0..100 {
            let before = at(travel * f64::from(k) / 100.0);
            assert!(force_of(&before) < force, "case {case}: not before");
        }
        let there = at(travel);
        assert!((force_of(&there) - force).abs() <= tolerance);
        assert_close(&found.deflections, &there.deflections, 1e-12, &place);
        n_touched += found.counts().n_touched;
    }
    assert!(n_touched > 1_000, "{n_touched}");
}

#[test]
fn an_object_held_to_a_force_carries_it_up_to_the_last_bit() {
    let mut n_touched = 0;
    for case in 0..200 {
        let (scene, way) = random_way(case);
        let force = 10f64.powf(rng("held force", case).gen_range(-3.0..0.5));
        let found = pressed(scene.press(Until::Force(force)).along(way).with_contacts());
        let moved = MovedObject {
            patch: &scene.patch,
            objects: &scene.objects,
            moving: Some(0),
            direction: -way,
        };
        let (mut poses, mut workspace) = (scene.poses.clone(), Workspace::new());
        let travels = [0.0, 0.0, found.travel() + 1e-4];
        let held = moved.hold(&mut poses, travels, force, &mut workspace);
        let held = held.unwrap();
        let stiffness = |taxel: usize| scene.patch.taxels().at(taxel).stiffness;
        let contacts = workspace.contacts().iter();
        let stiffness: f64 = contacts.map(|one| stiffness(one.taxel)).sum();
        let last_bit = stiffness * 0.1 * f64::EPSILON;
        let error = (held.force - force).abs();
        let place = format!("case {case}: error {error} of {force} N");
        assert!(error <= f64::max(1e-13 * force, last_bit), "{place}");
        assert!((held.travel - found.travel()).abs() < 1e-12, "{place}");
        n_touched += workspace.contacts().len();
    }
    assert!(n_touched > 1_000, "{n_touched}");
}

#[test]
fn ways_that_miss_or_cannot_be_gone_are_told_apart() {
    let scene = ball_over(grid(4, 4, 2e-3));
    let press = |pose: Pose, way: DVec3, force: f64| {
        let press = Press::new(
            &scene.patch,
            &scene.objects,
            &scene.poses,
            Until::Force(force),
        );
        let poses = [pose.compose(&scene.poses[0])];
        Press {
            poses: &poses,
            ..press
        }
        .along(way)
        .with_contacts()
        .run(&mut Workspace::new())
    };
    let here = Pose::IDENTITY;
    assert!(press(here, DVec3::X, 1.0).unwrap().is_none());
    // The path starts far away, whatever the patch's position.
    let at = |travel: f64| press(Pose::from_translation(-travel * DVec3::Z), DVec3::Z, 1.0);
    let [near, far] = [0.0, 0.071].map(|travel| at(travel).unwrap().unwrap().travel);
    assert!((near - far - 0.071).abs() < 1e-15, "{near} {far}");
    let longest = "touch force: 9 N; up to 8.000000 N, where the patch has gone 7";
    for (way, force, said) in [
        (
            2.0 * DVec3::Z,
            1.0,
            "touch direction: [0, 0, 2]; a vector of length one",
        ),
        (DVec3::Z, 0.0, "touch force: 0 N; a finite positive number"),
        (DVec3::Z, 9.0, longest),
    ] {
        let message = press(here, way, force).unwrap_err().to_string();
        assert!(message.starts_with(said), "{message}");
    }
}
