//! Laws of scenes: time steps, frames of reference, shortcuts and free objects, each compared with a slower or simpler computation.

use crate::command::filled;
use crate::scene::{frames_with as frames, plan as plan_of, plan_in, plan_shipped, shipped};
use bubbletouch::contact::equilibrium::{
    EquilibriumSolver, FreeObject, Ground, Obstacle, PlacedSkin, Touched,
};
use bubbletouch::contact::{DamperState, Press, Until, Workspace, Wrench, spring_load};
use bubbletouch::geometry::Pose;
use bubbletouch::scene::{Carrier, Frame, Movement, PoseControl, ScenePlan, Simulation, Stepping};
use bubbletouch::world::{Motion, Phase, VelocityPlan};
use glam::{DQuat, DVec3};
use std::path::Path;
use std::slice::from_ref;

/// Returns a scene in which a ball is lowered onto two patches, slides and turns. `damping` applies to one of the patches.
fn sliding(dt_ms: f64, damping: f64) -> ScenePlan {
    plan_of(&filled(
        include_str!("../fixtures/texts/scene_laws_sliding.toml"),
        &[("dt_ms", &dt_ms), ("damping", &damping)],
    ))
}

fn farthest(a: &[Frame], b: &[Frame], of: impl Fn(&Frame) -> Vec<f64>) -> f64 {
    assert_eq!(a.len(), b.len());
    let frames = a.iter().zip(b);
    let pairs = frames.flat_map(|(a, b)| of(a).into_iter().zip(of(b)));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn deflections(frame: &Frame) -> Vec<f64> {
    let patches = frame.patches.iter();
    patches.flat_map(|patch| patch.deflection.clone()).collect()
}

#[test]
fn half_the_step_changes_nothing_without_dampers_and_little_with_them() {
    let always = |dt_ms, damping| frames(&sliding(dt_ms, damping), Stepping::Always);
    let coarse = always(2.0, 0.0);
    let is_touched = |frame: &Frame| frame.patches.iter().all(|patch| patch.n_touched > 20);
    assert!(coarse.iter().any(is_touched));
    assert_eq!(coarse, always(1.0, 0.0));
    // A damped taxel that loses contact between two steps is late by the object's travel in one step: 120 mm/s on flanks of up to 45°.
    let off = farthest(&always(2.0, 3.0), &always(1.0, 3.0), deflections);
    let finer = farthest(&always(1.0, 3.0), &always(0.5, 3.0), deflections);
    assert!(off > 0.0 && off < 240e-6, "{off}");
    assert!(finer < 120e-6, "{finer}");
}

#[test]
fn what_remembers_nothing_is_the_same_with_and_without_steps() {
    let plan = sliding(1.0, 0.0);
    let needed = frames(&plan, Stepping::AsNeeded);
    assert_eq!(needed, frames(&plan, Stepping::Always));
    let steps = [Stepping::AsNeeded, Stepping::Always].map(|stepping| {
        let mut simulation = Simulation::new(&plan, stepping);
        simulation.run(&mut []).unwrap();
        simulation.n_steps()
    });
    assert_eq!(steps, [plan.n_frames, 1 + 20 * (plan.n_frames - 1)]);
}

#[test]
fn a_damped_patch_is_the_same_beside_one_that_is_not() {
    // As needed, the undamped patch makes no steps, and damped grids use another kernel between frames.
    let plan = sliding(1.0, 3.0);
    let both = |mut plan: ScenePlan, is_damped: [bool; 2]| {
        for (patch, is_damped) in plan.patches.iter_mut().zip(is_damped) {
            if !is_damped {
                let undamped = sliding(1.0, 0.0);
                let name = patch.skin.name().to_owned();
                let same = |p: &&bubbletouch::scene::PlannedPatch| p.skin.name() == name;
                *patch = undamped.patches.iter().find(same).unwrap().clone();
            }
        }
        frames(&plan, Stepping::AsNeeded)
    };
    let (all, first) = (both(plan.clone(), [true, true]), both(plan, [true, false]));
    for (all, first) in all.iter().zip(&first) {
        assert_eq!(all.patches[0], first.patches[0]);
    }
}

#[test]
fn a_moved_world_feels_the_same() {
    let world = Pose::new(
        DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 0.7)),
        DVec3::new(0.3, -0.2, 0.5),
    );
    let phases = |moved: &Pose| {
        let phase = |duration, linear: DVec3, angular: DVec3| Phase {
            duration,
            linear: moved.rotation * linear,
            angular: moved.rotation * angular,
        };
        let down = phase(0.31, DVec3::new(0.0, 0.0, -0.016), DVec3::ZERO);
        let along = phase(0.53, DVec3::new(0.12, 0.0, 0.0), DVec3::new(0.2, 0.0, 1.2));
        let start = Pose::from_translation(DVec3::new(-0.01, 0.003, 0.003));
        let plan = VelocityPlan::new(moved.compose(&start), vec![down, along]);
        Movement::Imposed {
            carrier: Carrier::World,
            motion: Motion::Plan(plan.unwrap()),
        }
    };
    let at = |moved: Pose| {
        let mut plan = sliding(1.0, 3.0);
        for patch in &mut plan.patches {
            if patch.carrier == Carrier::World {
                patch.at = moved.compose(&patch.at);
            }
        }
        plan.objects[0].movement = phases(&moved);
        frames(&plan, Stepping::AsNeeded)
    };
    let (here, there) = (at(Pose::IDENTITY), at(world));
    assert!(here.iter().any(|frame| frame.patches[1].n_touched > 20));
    let off = farthest(&here, &there, deflections);
    assert!(off < 1e-12, "{off}");
    let wrench = |frame: &Frame| {
        let forces = frame.patches.iter().map(|patch| patch.wrench.force);
        forces.flat_map(|force| force.to_array()).collect()
    };
    let off = farthest(&here, &there, wrench);
    assert!(off < 1e-7, "{off}");
}

#[test]
fn the_drill_scene_is_what_the_time_loop_of_one_patch_computes() {
    let plan = plan_shipped(&shipped("drill_press.toml"));
    let phase = |duration, speed| Phase {
        duration,
        linear: DVec3::new(0.0, 0.0, speed),
        angular: DVec3::ZERO,
    };
    let phases = vec![phase(0.6, -0.01), phase(0.4, 0.0), phase(0.6, 0.01)];
    let start = Pose::new(
        DQuat::from_rotation_x(90f64.to_radians()),
        DVec3::new(0.02, 0.1, 0.031),
    );
    let (patch, objects) = (&plan.patches[0].skin, &plan.models);
    let drill = VelocityPlan::new(start, phases).unwrap();
    let (mut workspace, mut damper) = (Workspace::new(), DamperState::at_rest(patch.n_taxels()));
    let states = (1..=2000).map(|step| {
        let pose = drill.pose_at(f64::from(step) * 1e-3);
        let press = Press::new(patch, objects, from_ref(&pose), Until::Pose);
        press.with_contacts().run(&mut workspace).unwrap();
        let contacts = workspace.contacts().to_vec();
        workspace.hold(&contacts);
        damper.step(patch.taxels(), 1e-3, workspace.deflections());
        damper.clone()
    });
    let states: Vec<DamperState> = states.collect();
    let frames = frames(&plan, Stepping::AsNeeded);
    assert_eq!(frames.len(), 201);
    for (number, frame) in frames.iter().enumerate().skip(1) {
        let row = 10 * number - 1;
        let reading = &frame.patches[0];
        assert!((1e-3 * (row + 1) as f64 - frame.time).abs() < 1e-12);
        // A deflection rate, which is part of a force, is a difference of deflections over a millisecond.
        for (looped, read, most) in [
            (&states[row].deflection, &reading.deflection, 1e-14),
            (&states[row].force, &reading.force, 1e-10),
        ] {
            for (a, b) in looped.iter().zip(read) {
                assert!((a - b).abs() < most, "frame {number}: {a} and {b}");
            }
        }
    }
    assert!(frames[80].patches[0].n_touched > 500);
}

#[test]
fn what_is_out_of_reach_is_left_out_and_nothing_else() {
    let mut n_touching = 0;
    for plan in [plan_shipped(&shipped("arm_sweep.toml")), sliding(1.0, 0.0)] {
        let mut workspace = Workspace::new();
        for frame in frames(&plan, Stepping::AsNeeded) {
            for (reading, patch) in frame.patches.iter().zip(&plan.patches) {
                let objects = frame.objects.iter();
                let poses = objects.map(|object| object.pose.seen_from(&reading.pose));
                let poses: Vec<Pose> = poses.collect();
                let press = Press::new(&patch.skin, &plan.models, &poses, Until::Pose);
                let counts = press.with_contacts().run(&mut workspace);
                let counts = counts.unwrap().unwrap_or_default();
                assert_eq!(reading.deflection, workspace.deflections());
                assert_eq!(reading.n_touched, counts.n_touched);
                assert_eq!(reading.n_saturated, counts.n_saturated);
                let load = spring_load(&patch.skin, workspace.contacts());
                let Wrench { force, torque } = load.on_patch();
                let sum: DVec3 = reading.force3.iter().sum();
                for (found, expected) in [
                    (reading.wrench.force, force),
                    (reading.wrench.torque, torque),
                    (reading.wrench.force, sum),
                ] {
                    assert!((found - expected).length() < 1e-12 * (1.0 + expected.length()));
                }
                let centers = (reading.center_of_pressure, load.center_of_pressure);
                match centers {
                    (Some(a), Some(b)) => assert!((a - b).length() < 1e-12),
                    (a, b) => assert_eq!(a, b),
                }
                n_touching += usize::from(counts.n_touched > 0);
            }
        }
    }
    assert!(n_touching > 50, "{n_touching}");
}

#[test]
fn a_mug_on_a_bed_is_where_the_balance_of_one_object_puts_it_and_rises_with_the_bed() {
    let plan = plan_shipped(&shipped("drop_on_bed.toml"));
    let frames = frames(&plan, Stepping::AsNeeded);
    let Movement::Free {
        start,
        mass,
        center_of_mass,
    } = plan.objects[0].movement
    else {
        panic!("the mug is free")
    };
    let skin = PlacedSkin::new(&plan.patches[0].skin, Pose::IDENTITY);
    let spheres = plan.models[0].spheres().unwrap();
    let mug = FreeObject::new(spheres, mass, center_of_mass).unwrap();
    let settled = EquilibriumSolver::new().solve(&mug, &[skin], plan.gravity, &start);
    let (first, last) = (&frames[0], &frames[frames.len() - 1]);
    assert_eq!(first.objects[0].pose, settled.unwrap().pose);
    for frame in &frames {
        assert_eq!(frame.objects[0].held, PoseControl::AtRest);
        // On vertical springs, the weight is the sum of their forces.
        let force = frame.patches[0].wrench.force.z;
        assert!((force + mass * 9.81).abs() < 1e-5, "{force} N");
    }
    let rise = last.objects[0].pose.translation.z - first.objects[0].pose.translation.z;
    // Without friction, the mug slides to other taxels while the bed rises.
    assert!((rise - 0.02).abs() < 1e-4, "{rise}");
}

/// Returns a scene with two balls at x = ±`apart` on a bed of taxels, each with additional keys.
fn two_balls(apart: f64, one: &str, other: &str) -> ScenePlan {
    // A scene that is read must have free objects apart; they are moved together afterwards.
    let read = apart.max(33.0);
    let mut plan = plan_of(&filled(
        include_str!("../fixtures/texts/scene_laws_two_balls.toml"),
        &[("read", &read), ("one", &one), ("other", &other)],
    ));
    for (object, x) in plan.objects.iter_mut().zip([-apart, apart]) {
        match &mut object.movement {
            Movement::Free { start: pose, .. }
            | Movement::Imposed {
                motion: Motion::Fixed(pose),
                ..
            } => {
                pose.translation.x = 1e-3 * x;
            }
            _ => panic!("the balls stand or are free"),
        }
    }
    plan
}

#[test]
fn free_balls_on_springs_and_on_stops_of_one_skin_are_carried_side_by_side() {
    for masses in [[0.2, 0.058], [50.0, 0.058]] {
        let [one, other] = masses.map(|mass| format!("free = {{ mass_kg = {mass} }}"));
        let plan = two_balls(40.0, &one, &other);
        let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
        let frame = simulation.next_frame().unwrap().unwrap().clone();
        assert_eq!(simulation.n_unsettled(), 0);
        let weights = masses.map(|mass| -9.81 * mass * DVec3::Z);
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for (object, weight) in frame.objects.iter().zip(weights) {
            assert_eq!(object.held, PoseControl::AtRest);
            force += weight;
            torque += object.pose.translation.cross(weight);
        }
        let on_patch = frame.patches[0].wrench;
        assert!((on_patch.force - force).length() < 1e-6 * force.length());
        assert!((on_patch.torque - torque).length() < 1e-6 * force.length() * 0.04);
    }
}

/// Returns the centre of the first object's single sphere in the world.
fn middle_of_ball(plan: &ScenePlan, frame: &Frame) -> DVec3 {
    let [ball] = plan.models[0].spheres().unwrap().spheres() else {
        panic!("a ball is one sphere")
    };
    frame.objects[0].pose.transform_point(ball.center)
}

/// Returns the force of all patches on a ball, by geometry alone: Σ f n / (n·axis), with n from the centre of the ball to the centre of the taxel. Also returns
/// the number of taxels at their stroke.
fn carried(plan: &ScenePlan, frame: &Frame) -> (DVec3, usize) {
    let middle = middle_of_ball(plan, frame);
    let (mut force, mut n_stopped) = (DVec3::ZERO, 0);
    for (patch, reading) in plan.patches.iter().zip(&frame.patches) {
        let layout = patch.skin.layout();
        for (taxel, f) in reading.force.iter().enumerate() {
            let axis = reading.pose.rotation * layout.axes()[taxel];
            let rest = reading.pose.transform_point(layout.centers()[taxel]);
            let away = rest - reading.deflection[taxel] * axis - middle;
            force += f * away / away.dot(axis);
            let stroke = patch.skin.taxels().at(taxel).stroke;
            n_stopped += usize::from(reading.deflection[taxel] > stroke - 1e-9);
        }
    }
    (force, n_stopped)
}

#[test]
fn what_rests_on_stops_is_carried_by_the_forces_of_the_frame_on_flat_and_on_curved_skins() {
    let bed = include_str!("../fixtures/texts/scene_laws_bed.toml");
    let forearms = shipped("ball_over_forearm.toml");
    for (scene, is_flat) in [(bed, true), (&forearms, false)] {
        let mut most_stopped = 0;
        for mass in [0.45, 5.0, 50.0, 500.0] {
            let mut plan = plan_of(&scene.replace("mass_kg = 0.45", &format!("mass_kg = {mass}")));
            plan.cut("the test", 0.0).unwrap();
            let frame = &frames(&plan, Stepping::AsNeeded)[0];
            let case = format!("{mass} kg, flat: {is_flat}");
            assert_eq!(frame.objects[0].held, PoseControl::AtRest, "{case}");
            let weight = mass * 9.81;
            let up = weight * DVec3::Z;
            let (force, n_stopped) = carried(&plan, frame);
            assert!((force - up).length() < 1e-6 * weight, "{case}: {force}");
            let n_saturated: usize = frame.patches.iter().map(|patch| patch.n_saturated).sum();
            assert_eq!(n_saturated, n_stopped, "{case}");
            most_stopped = most_stopped.max(n_stopped);
            // The wrenches of all patches together equal the weight at the centre of the ball.
            let (mut together, mut torque) = (DVec3::ZERO, DVec3::ZERO);
            for patch in &frame.patches {
                let force = patch.pose.rotation * patch.wrench.force;
                together += force;
                torque += patch.pose.rotation * patch.wrench.torque;
                torque += patch.pose.translation.cross(force);
            }
            let middle = middle_of_ball(&plan, frame);
            assert!((together + up).length() < 1e-6 * weight, "{case}");
            let off = (torque - middle.cross(together)).length();
            assert!(off < 1e-6 * weight * 0.03, "{case}: {off}");
            if is_flat {
                let sum: f64 = frame.patches[0].force.iter().sum();
                assert!((sum - weight).abs() < 1e-6 * weight, "{case}: {sum} N");
            }
        }
        assert!(most_stopped >= 3, "stops carry, too: {most_stopped}");
    }
}

#[test]
fn two_free_balls_that_come_to_rest_on_the_same_taxels_are_carried_together_and_touch() {
    for masses in [[0.2, 0.2], [0.2, 0.1], [50.0, 0.2]] {
        let [one, other] = masses.map(|mass| format!("free = {{ mass_kg = {mass} }}"));
        // Balls that overlap at the start move apart.
        let plan = two_balls(5.0, &one, &other);
        let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
        let frame = simulation.next_frame().unwrap().unwrap();
        let places = [0, 1].map(|object| {
            let reading = frame.objects[object];
            assert_eq!(reading.held, PoseControl::AtRest, "{masses:?}");
            assert!(reading.balance.unwrap().imbalance < 1e-6, "{masses:?}");
            let [ball] = plan.models[object].spheres().unwrap().spheres() else {
                panic!("a ball is one sphere")
            };
            (reading.pose.transform_point(ball.center), ball.radius)
        });
        let [(one, radius), (other, _)] = places;
        assert!(one.distance(other) > 2.0 * radius - 1e-9, "{masses:?}");
        let on_patch = frame.patches[0].wrench;
        let weights = masses.map(|mass| -9.81 * mass * DVec3::Z);
        let torque = one.cross(weights[0]) + other.cross(weights[1]);
        let lightest = 9.81 * masses[1];
        assert!((on_patch.force - weights[0] - weights[1]).length() < 1e-5 * lightest);
        assert!((on_patch.torque - torque).length() < 1e-5 * lightest * radius);
        let stops = frame.patches[0].stop_force;
        assert_eq!(stops > 0.0, masses[0] > 1.0, "{masses:?}: {stops} N");
    }
}

#[test]
fn a_free_ball_comes_to_rest_in_the_hollow_that_an_imposed_one_makes_and_on_it() {
    let mut plan = two_balls(32.0, "", "free = { mass_kg = 0.058 }");
    // The acceleration towards the other ball is so small that the ball does not slip past it.
    plan.gravity = DVec3::new(-0.5, 0.0, -9.8);
    let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
    let frame = simulation.next_frame().unwrap().unwrap().clone();
    let Movement::Free {
        start,
        mass,
        center_of_mass,
    } = plan.objects[1].movement
    else {
        panic!("the other ball is free")
    };
    let skin = &plan.patches[0].skin;
    let mut workspace = Workspace::new();
    let (pressed, pose) = (&plan.models[..1], [frame.objects[0].pose]);
    let press = Press::new(skin, pressed, &pose, Until::Pose);
    press.with_contacts().run(&mut workspace).unwrap();
    let ball = plan.models[1].spheres().unwrap();
    let ball = FreeObject::new(ball, mass, center_of_mass).unwrap();
    let obstacles = [Obstacle {
        shape: (&plan.models[0]).into(),
        pose: frame.objects[0].pose,
    }];
    let settled = |pushed, obstacles| {
        let skins = [PlacedSkin {
            pushed,
            ..PlacedSkin::new(skin, Pose::IDENTITY)
        }];
        let ground = Ground {
            skins: skins.to_vec(),
            obstacles,
            ..Ground::default()
        };
        let balances = EquilibriumSolver::new().solve_all(&[ball], &ground, plan.gravity, &[start]);
        balances.unwrap()[0].pose
    };
    let both = settled(workspace.deflections(), obstacles.to_vec());
    assert_eq!(frame.objects[1].pose, both);
    let [alone, hollow] =
        [&[][..], workspace.deflections()].map(|pushed| settled(pushed, Vec::new()));
    assert!(both.translation.distance(alone.translation) > 1e-4);
    assert!(both.translation.distance(hollow.translation) > 1e-4);
    let [touch] = frame.touches[..] else {
        panic!("{:?}", frame.touches)
    };
    assert_eq!((touch.object, touch.other), (1, Touched::Object(0, 0)));
}

#[test]
fn a_damped_bed_carries_the_whole_weight_while_a_ball_sinks_and_after() {
    let plan = plan_of(include_str!(
        "../fixtures/texts/scene_laws_a_damped_bed_carries.toml"
    ));
    let weight = 0.3 * 9.81;
    let (mut n_carried, mut n_both) = (0, 0);
    let mut deepest = Vec::new();
    for frame in frames(&plan, Stepping::AsNeeded) {
        let held = frame.objects[0].held;
        assert_eq!(held, PoseControl::AtRest, "{} s", frame.time);
        let on_patch = frame.patches[0].wrench.force;
        let of_table: DVec3 = frame.touches.iter().map(|touch| touch.force).sum();
        let left = on_patch - of_table + weight * DVec3::Z;
        assert!(left.length() < 1e-6 * weight, "{} s: {left}", frame.time);
        n_both += usize::from(of_table.z > 0.0 && on_patch.z < 0.0);
        if frame.touches.is_empty() {
            n_carried += 1;
            let all = frame.patches[0].deflection.iter();
            deepest.push(all.copied().fold(0.0, f64::max));
        }
    }
    // At first both patches carry the ball; then it sinks more and more slowly.
    assert!(n_both > 0 && n_carried > 20, "{n_both} {n_carried}");
    let n = deepest.len();
    assert!(deepest[n - 1] > deepest[n - 20] + 1e-6, "{deepest:?}");
}

#[test]
fn what_has_rolled_off_is_reported_once_and_touches_nothing_any_more() {
    let plan = plan_shipped(&shipped("ball_over_forearm.toml"));
    let frames = frames(&plan, Stepping::AsNeeded);
    let PoseControl::Escaped { time, direction } = frames.last().unwrap().objects[0].held else {
        panic!("the ball escapes")
    };
    assert!(time > 0.5 && time < 1.2, "{time} s");
    // The ball escapes over the lowered arm, which is at negative y.
    assert!(direction.y < -0.9, "{direction}");
    for frame in &frames {
        let n_touched: usize = frame.patches.iter().map(|patch| patch.n_touched).sum();
        let expected = match frame.time >= time {
            true => PoseControl::Escaped { time, direction },
            false => PoseControl::AtRest,
        };
        assert_eq!(frame.objects[0].held, expected);
        assert_eq!(n_touched > 0, frame.time < time);
    }
}

#[test]
fn a_scene_begins_as_if_it_had_stood_so_for_long() {
    let text = |damping: f64| {
        filled(
            include_str!("../fixtures/texts/scene_laws_a_scene_begins_as.toml"),
            &[("damping", &damping)],
        )
    };
    let with = frames(&plan_of(&text(2.0)), Stepping::AsNeeded);
    let without = frames(&plan_of(&text(0.0)), Stepping::AsNeeded);
    for (with, without) in with.iter().zip(&without) {
        let pairs = with.patches[0].force.iter().zip(&without.patches[0].force);
        assert_eq!(with.patches[0].deflection, without.patches[0].deflection);
        for (a, b) in pairs {
            assert!((a - b).abs() < 1e-12);
        }
    }
    assert!(with[0].patches[0].n_touched > 0);
}

#[test]
fn the_original_slides_a_drill_over_64_x_64_taxels() {
    let Some(folder) = crate::reference_data::folder("BUBBLETOUCH_REFERENCE") else {
        return;
    };
    let folder = Path::new(&folder).join("traj_drill_example");
    let text = std::fs::read_to_string(folder.join("scene.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let way_points = json["frames"].as_array().unwrap().iter().map(|frame| {
        let time = frame["time"].as_f64().unwrap();
        let at = [0, 1, 2].map(|k| 1e3 * frame["position"][k].as_f64().unwrap());
        format!(
            "{{ time_s = {time:?}, position_mm = {at:?}, rotation_deg = [180.0, 0.0, 0.0] }},\n"
        )
    });
    let beside = tempfile::tempdir().unwrap();
    let spheres = std::fs::read_to_string(folder.join("spheres.csv")).unwrap();
    let table = format!("x,y,z,r\n{spheres}");
    std::fs::write(beside.path().join("drill.csv"), table).unwrap();
    let text = filled(
        include_str!("../fixtures/texts/scene_laws_example.toml"),
        &[("way_points", &way_points.collect::<String>())],
    );
    let plan = plan_in(beside.path(), &text).unwrap();
    let frames = frames(&plan, Stepping::AsNeeded);
    let recorded = std::fs::read_to_string(folder.join("displacement_frames.csv")).unwrap();
    let row = |line: &str| {
        line.split(',')
            .map(|number| number.trim().parse().unwrap())
            .collect()
    };
    let rows: Vec<Vec<f64>> = recorded.lines().map(row).collect();
    assert_eq!((frames.len(), rows.len()), (21, 20));
    for (number, (frame, row)) in frames[1..].iter().zip(&rows).enumerate() {
        for (a, b) in frame.patches[0].deflection.iter().zip(row) {
            assert!((a - b).abs() < 1e-12, "frame {}: {a} and {b}", number + 1);
        }
    }
}

#[test]
fn the_plan_of_a_scene_has_its_frames_and_steps_and_planes_of_any_length() {
    let scene = include_str!("../fixtures/texts/arm.toml");
    let arm = plan_of(scene);
    assert_eq!((arm.n_frames, arm.n_substeps), (101, 10));
    assert_eq!(arm.spec.duration_s, Some(1.0));
    assert!(arm.needs_steps());
    let plane = "name = \"table\"\npoint_mm = [0.0, 0.0, 7.0]\nnormal = [0.0, 3.0, 4.0]";
    let tilted = plan_of(&format!("{scene}[[planes]]\n{plane}")).planes[0];
    assert!((tilted.height - 5.6e-3).abs() < 1e-15 && (tilted.normal.z - 0.8).abs() < 1e-15);
}
