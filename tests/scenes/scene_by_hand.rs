//! Manual control of scenes: manual steps equal the steps of the time loop, and invalid settings are refused.

use crate::command::{contains, filled, says};
use crate::scene::{frames, plan};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::{Catalogue, Model};
use bubbletouch::scene::{
    Frame, Movement, PoseControl, ScenePlan, SceneSpec, Simulation, Stepping,
};
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;
use std::path::Path;

/// Returns the frames of a scene whose bodies are placed by `set` at each time. The steps are as long as the loop's, in numbers of seconds that add up without
/// rounding.
fn by_hand(plan: &ScenePlan, set: impl Fn(&mut Simulation, f64)) -> Vec<Frame> {
    let mut simulation = Simulation::new(plan, Stepping::AsNeeded);
    let dt = 1.0 / (plan.output_rate * plan.n_substeps as f64);
    set(&mut simulation, 0.0);
    let mut frames = vec![simulation.observe().unwrap().clone()];
    for _ in 1..plan.n_frames {
        for _ in 0..plan.n_substeps {
            let time = simulation.time() + dt;
            set(&mut simulation, time);
            simulation.step(dt).unwrap();
        }
        frames.push(simulation.observe().unwrap().clone());
    }
    frames
}

/// Keys for 64 frames per second with four steps each.
const CLOCK: &str = "title = \"By hand\"\noutput_hz = 64.0\ndt_ms = 3.90625\nduration_s = 0.75";

const MOTION: &str = "motion = { phases = [
    { duration_s = 0.25, linear_mm_per_s = [0.0, 5.0, -20.0] },
    { duration_s = 0.5, linear_mm_per_s = [60.0, 0.0, 0.0], angular_deg_per_s = [0.0, 10.0, 70.0] },
] }";

/// Returns a scene in which a pear slides over a damped skin with friction and noise, and a ball is pushed onto another skin.
fn sliding(motion: &str) -> String {
    filled(
        include_str!("../fixtures/texts/scene_by_hand_sliding.toml"),
        &[("CLOCK", &CLOCK), ("motion", &motion)],
    )
}

#[test]
fn a_step_by_hand_is_the_time_loops() {
    let (looped, still) = (plan(&sliding(MOTION)), plan(&sliding("")));
    let set = |simulation: &mut Simulation, time: f64| {
        for object in &looped.objects {
            let Movement::Imposed { motion, .. } = &object.movement else {
                panic!("both go where they are told");
            };
            let pose = motion.pose_at(time);
            simulation.set_object_pose(&object.name, pose).unwrap();
        }
    };
    let frames = frames(&looped);
    let is_touched = |frame: &Frame| frame.patches.iter().all(|patch| patch.n_touched > 20);
    assert!(frames.iter().any(is_touched));
    let slipping = |frame: &Frame| frame.patches[0].friction.as_ref().unwrap().n_slipping;
    assert!(frames.iter().any(|frame| slipping(frame) > 0));
    assert!(frames == by_hand(&still, set));
    // Bodies that are not set manually follow the scene.
    assert!(frames == by_hand(&looped, |_, _| {}));
}

#[test]
fn joints_and_bases_by_hand_move_skin_as_trajectories_do() {
    let arm = |joints: &str| {
        filled(
            include_str!("../fixtures/texts/scene_by_hand_arm.toml"),
            &[("CLOCK", &CLOCK), ("shoulder_turn", &joints)],
        )
    };
    let turning = plan(&arm("[-40.0, 0.0]"));
    let rise = "motion = { way_points = [{ time_s = 0.0, position_mm = [2000.0, 0.0, 0.0] }, { time_s = 0.75, position_mm = [2000.0, 0.0, 9.0] }] }";
    let at = "at = { position_mm = [2000.0, 0.0, 0.0] }";
    let moved = plan(&arm("[-40.0, 0.0]").replace(at, rise));
    let still = plan(&arm("[-40.0, -40.0]"));
    let set = |simulation: &mut Simulation, time: f64| {
        let joints = turning.robots[0].joints.as_ref().unwrap();
        simulation
            .set_joint_positions("arm", &joints.positions_at(time))
            .unwrap();
        let tray = moved.robots[1].base.pose_at(time);
        simulation.set_robot_pose("tray", tray).unwrap();
    };
    let frames = frames(&moved);
    assert!(frames.iter().any(|frame| frame.patches[0].n_touched > 10));
    let mut held = frames.iter().map(|frame| frame.objects[1].held);
    assert!(held.all(|held| held == PoseControl::AtRest));
    let [start, end] = [0, 48].map(|frame| frames[frame].objects[1].pose.translation.z);
    assert!(end - start > 8e-3);
    assert!(frames == by_hand(&still, set));
}

#[test]
fn a_reset_is_a_new_start_and_another_seed_is_other_noise() {
    let plan = plan(&sliding(MOTION));
    let frames = frames(&plan);
    let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
    simulation
        .set_object_pose("pear", Pose::from_translation(DVec3::Z))
        .unwrap();
    for _ in 0..5 {
        simulation.step(0.01).unwrap();
        simulation.observe().unwrap();
    }
    let error = simulation.next_frame().unwrap_err();
    says(&error.to_string(), &["reset"]);
    simulation.reset(plan.spec.seed);
    let mut again = Vec::new();
    simulation.run(&mut [&mut again]).unwrap();
    assert!(frames == again);
    simulation.reset(plan.spec.seed + 1);
    let mut other = Vec::new();
    simulation.run(&mut [&mut other]).unwrap();
    let [a, b] = [&frames, &other].map(|frames| &frames[40].patches[0]);
    assert_eq!(a.deflection, b.deflection);
    let signals = a.signal.iter().flatten().zip(b.signal.iter().flatten());
    assert!(signals.filter(|(a, b)| a != b).count() > 300);
}

#[test]
fn a_frame_is_made_once_and_the_first_is_the_scenes() {
    let plan = plan(&sliding(MOTION));
    let frames = frames(&plan);
    let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
    for _ in 0..3 {
        assert!(*simulation.observe().unwrap() == frames[0]);
    }
    assert!(*simulation.next_frame().unwrap().unwrap() == frames[1]);
    assert!(*simulation.observe().unwrap() == frames[1]);
}

#[test]
fn a_free_object_that_was_lost_is_put_back() {
    let text = filled(
        include_str!("../fixtures/texts/scene_by_hand_a_free_object_that.toml"),
        &[("CLOCK", &CLOCK)],
    );
    let plan = plan(&text);
    let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
    let held = |simulation: &mut Simulation| simulation.observe().unwrap().objects[0].held;
    assert!(matches!(held(&mut simulation), PoseControl::Escaped { .. }));
    simulation
        .set_object_pose("mug", Pose::from_translation(0.04 * DVec3::Z))
        .unwrap();
    simulation.step(0.01).unwrap();
    assert_eq!(held(&mut simulation), PoseControl::AtRest);
}

#[test]
fn objects_in_memory_are_those_of_the_catalogue() {
    let named = sliding(MOTION);
    let spec = |text: &str| SceneSpec::parse("s.toml", text).unwrap();
    let without = named
        .replace("object = \"pear\"\n", "\n")
        .replace("object = \"tennis\"\n", "\n");
    let catalogue = Catalogue::builtin().unwrap();
    let model = |name: &str| -> Model {
        let entry = catalogue.object(name).unwrap();
        entry.build(0.25e-3).unwrap().model
    };
    let models = BTreeMap::from([
        ("pear".to_owned(), model("pear")),
        ("ball".to_owned(), model("tennis")),
    ]);
    let folder = Path::new("");
    let plan_of = |text: &str, models: &BTreeMap<String, Model>| {
        ScenePlan::with_models("s.toml", folder, spec(text), models)
    };
    let given = plan_of(&without, &models).unwrap();
    assert!(frames(&given) == frames(&plan(&named)));
    let said = |text: &str, models: &BTreeMap<String, Model>| {
        plan_of(text, models).unwrap_err().to_string()
    };
    let twice = "objects.pear.object: given beside an object in memory";
    says(&said(&named, &models), &[twice]);
    let unknown = BTreeMap::from([("peer".to_owned(), model("pear"))]);
    says(&said(&named, &unknown), &["a model for `peer`", "pear"]);
}

#[test]
fn what_cannot_be_set_is_refused_and_nothing_moves() {
    let text = filled(
        include_str!("../fixtures/texts/scene_by_hand_what_cannot_be_set.toml"),
        &[("CLOCK", &CLOCK)],
    );
    let plan = plan(&text);
    let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
    let before = simulation.observe().unwrap().clone();
    let nan = Pose::from_translation(f64::NAN * DVec3::X);
    let long = Pose {
        rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0),
        translation: DVec3::ZERO,
    };
    let refused = |result: bubbletouch::Result<()>, words: &str| {
        let error = result.unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(
            contains(&error.to_string(), words),
            "no {words:?} in {error}"
        );
    };
    let far = [0.0, 9.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let bent = "robots.arm … `shoulder_bend` … 9.0 … at most";
    for (robot, positions, words) in [
        ("arn", &[0.0; 7][..], "robot: `arn` … `arm`"),
        ("arm", &[0.0; 6], "robots.arm … 6 positions … 7"),
        ("arm", &[f64::NAN; 7], "robots.arm … NaN … finite"),
        ("arm", &far, bent),
    ] {
        refused(simulation.set_joint_positions(robot, positions), words);
    }
    let moved = simulation.set_robot_pose("arm", nan);
    refused(moved, "robots.arm … NaN … finite");
    for (object, pose, words) in [
        ("balls", Pose::IDENTITY, "object: `balls` … `ball`"),
        ("ball", Pose::IDENTITY, "objects.ball … a robot carries"),
        ("other", long, "objects.other … unit quaternion"),
    ] {
        refused(simulation.set_object_pose(object, pose), words);
    }
    for dt in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        refused(simulation.step(dt), "step … a positive number of seconds");
    }
    assert!(*simulation.observe().unwrap() == before);
    simulation.step(1.0 / 64.0).unwrap();
    assert_eq!(simulation.observe().unwrap().patches, before.patches);
}
