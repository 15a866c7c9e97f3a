//! Laws of scenes with friction, with different taxels, and with objects that are pressed to a force.

use crate::command::filled;
use crate::scene::{CUBE, Press, frames, plan, plan_in, pressed, recorded, resolved};
use bubbletouch::contact::{self, FrictionState, NormalForce, Until, Workspace};
use bubbletouch::geometry::Pose;
use bubbletouch::report::scene_files::scene_table;
use bubbletouch::scene::{Frame, FrameSink, PatchReading, PoseControl, ScenePlan, Summary};
use glam::DVec3;
use std::fs;
use std::path::Path;

/// Returns a scene in which a pear is pressed into a palm, moved along it and turned; `palm` contains more keys of the patch.
fn drawn(palm: &str) -> String {
    filled(
        include_str!("../fixtures/texts/scene_forces_drawn.toml"),
        &[("palm", &palm)],
    )
}

const ROUGH: &str = "friction = 0.7\nshear_stiffness_n_per_m = 150.0";

#[test]
fn no_friction_is_the_same_as_a_coefficient_of_zero_to_the_bit() {
    for damping in ["", "damping_n_s_per_m = 1.5\n"] {
        let without = frames(&plan(&drawn(damping)));
        let zero = frames(&plan(&drawn(&format!("{damping}friction = 0.0"))));
        assert!(without.iter().any(|frame| frame.patches[0].n_touched > 30));
        for (zero, without) in zero.into_iter().zip(&without) {
            let reading = &zero.patches[0];
            let friction = reading.friction.as_ref().unwrap();
            assert_eq!(friction.shear, DVec3::ZERO);
            let bare = PatchReading {
                friction: None,
                ..reading.clone()
            };
            assert_eq!(bare, without.patches[0]);
        }
    }
}

#[test]
fn a_scene_without_friction_takes_no_steps_for_it() {
    assert!(!plan(&drawn("")).needs_steps());
    assert!(plan(&drawn(ROUGH)).needs_steps());
    assert!(frames(&plan(&drawn("")))[3].patches[0].friction.is_none());
}

#[test]
fn tips_are_dragged_from_step_to_step_as_by_hand() {
    let plan = plan(&drawn(ROUGH));
    let patch = &plan.patches[0];
    let mut state = FrictionState::at_rest(&patch.skin, patch.shears.clone().unwrap()).unwrap();
    let mut workspace = Workspace::new();
    let bubbletouch::scene::Movement::Imposed { motion, .. } = &plan.objects[0].movement else {
        panic!("the pear goes where it is told")
    };
    let (mut n_sticking, mut n_slipping) = (0, 0);
    for (number, frame) in frames(&plan).iter().enumerate() {
        // Each frame has ten steps; the first frame has one.
        let before = plan.time(number.saturating_sub(1));
        let n_steps = if number == 0 { 1 } else { plan.n_substeps };
        let mut counts = Default::default();
        for step in 1..=n_steps {
            let share = step as f64 / n_steps as f64;
            let time = match step == n_steps {
                true => frame.time,
                false => before + share * (frame.time - before),
            };
            let pose = Pose::IDENTITY.inverse().compose(&motion.pose_at(time));
            contact::Press::new(&patch.skin, &plan.models, &[pose], Until::Pose)
                .with_contacts()
                .run(&mut workspace)
                .unwrap();
            let contacts = workspace.contacts();
            counts = state.step(&patch.skin, contacts, &[pose], NormalForce::Springs);
        }
        let reading = &frame.patches[0];
        let friction = reading.friction.as_ref().unwrap();
        let load = state.load(&patch.skin, workspace.contacts());
        assert_eq!(reading.wrench.force, -load.on_object.force);
        assert_eq!(reading.wrench.torque, -load.on_object.torque);
        assert_eq!(friction.shear, -load.friction.force);
        assert_eq!(friction.n_sticking, counts.n_sticking);
        assert_eq!(friction.n_slipping, counts.n_slipping);
        n_sticking = n_sticking.max(counts.n_sticking);
        n_slipping = n_slipping.max(counts.n_slipping);
    }
    assert!(n_sticking.min(n_slipping) > 20, "{n_sticking} {n_slipping}");
}

#[test]
fn forces_of_the_tips_are_the_wrench_and_stay_in_their_cones() {
    let frames = frames(&plan(&drawn(&format!("{ROUGH}\ndamping_n_s_per_m = 1.5"))));
    let mut most: f64 = 0.0;
    for frame in &frames {
        let reading = &frame.patches[0];
        let friction = reading.friction.as_ref().unwrap();
        let sum: DVec3 = reading.force3.iter().sum();
        let off = (sum - reading.wrench.force).length();
        assert!(off < 1e-12 * (1.0 + sum.length()), "{off}");
        for (force3, force) in reading.force3.iter().zip(&reading.force) {
            assert_eq!(-force3.z, *force, "what presses a flat taxel in");
        }
        let pressed: f64 = reading.force.iter().sum();
        assert!(friction.shear.length() <= 0.7 * pressed * (1.0 + 1e-12));
        // Each tip that is pressed sticks or slips.
        let n_tips = friction.n_sticking + friction.n_slipping;
        assert_eq!(n_tips, reading.n_touched);
        most = most.max(friction.shear.length() / pressed.max(1e-9));
    }
    assert!(most > 0.4, "{most}");
    let last = frames.last().unwrap().patches[0].friction.as_ref().unwrap();
    assert_eq!((last.n_sticking, last.shear), (0, DVec3::ZERO), "let go");
}

#[test]
fn a_drawn_object_and_a_patch_drawn_the_other_way_feel_the_same_friction() {
    let object = plan(&drawn(ROUGH));
    let motion = r#"motion = { phases = [
            { duration_s = 0.25, linear_mm_per_s = [0.0, 0.0, 20.0] },
            { duration_s = 0.2, linear_mm_per_s = [-40.0, 0.0, 0.0] },
        ] }"#;
    let patch = plan(&filled(
        include_str!("../fixtures/texts/scene_forces_a_drawn_object_and.toml"),
        &[("motion", &motion), ("ROUGH", &ROUGH)],
    ));
    let text = drawn(ROUGH).replace(
        "[40.0, 5.0, 0.0], angular_deg_per_s = [0.0, 0.0, 50.0]",
        "[40.0, 0.0, 0.0]",
    );
    assert!(text != drawn(ROUGH) && object.n_frames > 40);
    let object = frames(&plan(&text));
    for (a, b) in frames(&patch).iter().zip(&object) {
        let [a, b] = [a, b].map(|frame| frame.patches[0].friction.as_ref().unwrap().shear);
        assert!((a - b).length() < 1e-9, "{a} {b}");
    }
    let held = object[44].patches[0].friction.as_ref().unwrap();
    assert!(held.shear.x > 1.0, "drawn along x: {}", held.shear);
}

#[test]
fn a_recording_of_a_patch_with_friction_has_forces_in_three_dimensions() {
    let plan = plan(&drawn(ROUGH));
    let (folder, all) = recorded(&plan);
    let recording = crate::stored::read_recording(&folder.path().join("recording.npz")).unwrap();
    let stored = &recording.patches[0].force;
    assert_eq!(stored.dim(), (all.len(), 280, 3));
    for (number, frame) in all.iter().enumerate() {
        for (taxel, force) in frame.patches[0].force3.iter().enumerate() {
            for (axis, number_n) in force.to_array().into_iter().enumerate() {
                assert_eq!(stored[[number, taxel, axis]] as f32, number_n as f32);
            }
        }
    }
    let table = fs::read_to_string(folder.path().join("wrenches.csv")).unwrap();
    let slipping = table.lines().skip(1).map(|line| {
        let last = line.rsplit(',').next().unwrap();
        last.parse::<usize>().unwrap()
    });
    let expected = all.iter().map(|frame| &frame.patches[0].friction);
    let expected = expected.map(|friction| friction.as_ref().unwrap().n_slipping);
    assert!(slipping.eq(expected));
}

/// Returns the plan of a plate of spheres on a tray that moves sideways and then tilts by 12 degrees.
fn on_a_tray(folder: &Path, friction: f64) -> ScenePlan {
    let places = (0..25).map(|k| (4 * (k % 5) - 8, 4 * (k / 5) - 8));
    let rows = places.map(|(x, y)| format!("{x},{y},0,4\n"));
    let table = format!("x,y,z,r\n{}", rows.collect::<String>());
    fs::write(folder.join("plate.csv"), table).unwrap();
    let text = filled(
        include_str!("../fixtures/texts/scene_forces_on_a_tray.toml"),
        &[("friction", &friction)],
    );
    plan_in(folder, &text).unwrap()
}

#[test]
fn a_skin_with_friction_carries_a_free_object_along_and_on_a_slope() {
    let folder = tempfile::tempdir().unwrap();
    let plan = on_a_tray(folder.path(), 0.6);
    let frames = frames(&plan);
    let weight = 0.15 * 9.81;
    let seen = |frame: &Frame| frame.objects[0].pose.seen_from(&frame.patches[0].pose);
    let start = seen(&frames[0]);
    for frame in &frames {
        assert_eq!(frame.objects[0].held, PoseControl::AtRest, "{}", frame.time);
        let patch = &frame.patches[0];
        // The patch carries the weight, expressed in its own frame.
        let down = patch.pose.rotation.conjugate() * DVec3::new(0.0, 0.0, -weight);
        assert!((patch.wrench.force - down).length() < 1e-6 * weight);
        let friction = patch.friction.as_ref().unwrap();
        assert!(friction.n_sticking + friction.n_slipping > 20);
        let moved = seen(frame).translation - start.translation;
        assert!(moved.length() < 1e-3, "{}: {moved}", frame.time);
    }
    let last = frames.last().unwrap();
    let slope = last.patches[0].pose.rotation * DVec3::X;
    let shear = last.patches[0].friction.as_ref().unwrap().shear.x;
    let pull = -weight * slope.z;
    let is_held = pull > 0.2 * weight && shear > 0.5 * pull;
    assert!(is_held, "{shear} of {pull}");

    // The summary contains the last angles about x, y and z, in degrees.
    let mut summary = Summary::default();
    summary.frame(last).unwrap();
    let table = scene_table(&plan, &summary);
    let (_, angles) = table.split_once("rotated by (").unwrap();
    let (angles, _) = angles.split_once(")°").unwrap();
    let angles: Vec<f64> = angles
        .split(", ")
        .map(|angle| angle.parse().unwrap())
        .collect();
    assert!(
        (angles[1] - 12.0).abs() < 1.5 && angles[0].abs() < 1.0,
        "{table}"
    );

    let (_, frames) = recorded(&on_a_tray(folder.path(), 0.02));
    let last = frames.last().unwrap();
    assert!(matches!(last.objects[0].held, PoseControl::Escaped { .. }));
}

#[test]
fn taxels_that_differ_are_the_same_from_a_list_from_a_file_and_alone() {
    let folder = tempfile::tempdir().unwrap();
    let n = 280;
    let stiffness = |taxel: usize| 80.0 + taxel as f64;
    let damping = |taxel: usize| if taxel.is_multiple_of(3) { 0.0 } else { 1.5 };
    let rows = (0..n).map(|t| format!("{},{}\n", damping(t), stiffness(t)));
    let header = "damping_n_s_per_m, stiffness_n_per_m\n".to_owned();
    let table = header + &rows.collect::<String>();
    fs::write(folder.path().join("taxels.csv"), table).unwrap();
    let [stiffnesses, dampings] =
        [&stiffness as &dyn Fn(usize) -> f64, &damping].map(|of| Vec::from_iter((0..n).map(of)));
    let listed = format!("stiffness_n_per_m = {stiffnesses:?}\ndamping_n_s_per_m = {dampings:?}");
    let from_list = frames(&plan(&drawn(&listed)));
    let text = drawn("taxels_csv = \"taxels.csv\"");
    let from_file = plan_in(folder.path(), &text).unwrap();
    assert_eq!(frames(&from_file), from_list);
    // The resolved scene is valid in any folder.
    assert_eq!(frames(&resolved(&from_file)), from_list);
    // Each taxel behaves as in a patch of equal taxels.
    for (taxel, damped) in [(147, "0.0"), (148, "1.5")] {
        let own = stiffness(taxel);
        let alone = format!("stiffness_n_per_m = {own}\ndamping_n_s_per_m = {damped}");
        assert_eq!(damping(taxel) > 0.0, damped == "1.5");
        let alone = frames(&plan(&drawn(&alone)));
        let mut felt: f64 = 0.0;
        for (mixed, alone) in from_list.iter().zip(&alone) {
            let [mixed, alone] = [mixed, alone].map(|frame| &frame.patches[0]);
            // An undamped patch makes no steps and is at rest at its frames; only its values may differ, by the rounding of times.
            assert!((mixed.deflection[taxel] - alone.deflection[taxel]).abs() < 1e-12);
            felt = felt.max(mixed.force[taxel]);
        }
        assert!(felt > 0.1, "{felt}");
    }
}

#[test]
fn a_list_of_equal_numbers_is_the_number() {
    let of = |stiffness: &str, friction: &str| {
        let shear = "shear_stiffness_n_per_m = 150.0";
        let keys = format!("stiffness_n_per_m = {stiffness}\nfriction = {friction}\n{shear}");
        frames(&plan(&drawn(&keys)))
    };
    let list = |number: f64| format!("{:?}", vec![number; 280]);
    assert_eq!(of(&list(130.0), &list(0.7)), of("130", "0.7"));
}

/// Returns a scene with a ball over a palm that moves aside. `press` contains the keys of its force control, `palm` more keys of the patch.
fn pushed(press: &str, palm: &str) -> String {
    filled(
        include_str!("../fixtures/texts/scene_forces_pushed.toml"),
        &[("palm", &palm), ("press", &press)],
    )
}

fn total(reading: &PatchReading) -> f64 {
    reading.force.iter().sum()
}

const CURVE: &str = "time_s = [0.1, 0.3, 0.8, 1.0], force_n = [0.0, 3.0, 3.0, 1.0]";

#[test]
fn the_force_that_is_recorded_is_the_one_that_is_wanted() {
    let press = format!("{CURVE}, speed_mm_per_s = 200.0, travel_mm = 20.0");
    let plan = plan(&pushed(&press, ROUGH));
    assert_eq!(plan.spec.duration_s, Some(1.0));
    let press = plan.objects[0].press.clone().unwrap();
    let (mut summary, mut n_held) = (Summary::default(), 0);
    for frame in frames(&plan) {
        summary.frame(&frame).unwrap();
        let at = pressed(&frame, 0);
        let (travel, force, wanted) = (at.travel, at.force, at.wanted);
        assert_eq!(wanted, press.force_at(frame.time));
        assert!((force - total(&frame.patches[0])).abs() < 1e-9);
        // From two millimetres above the palm, the ball takes some hundredths of a second to arrive.
        if frame.time > 0.15 {
            assert!((force - wanted).abs() < 1e-9, "{force} of {wanted}");
            assert!(travel > 2e-3 && travel < 20e-3);
            n_held += 1;
        }
    }
    assert!(n_held > 80);
    assert!(summary.objects[0].n_off <= 5, "{summary:?}");
    assert!((press.force_at(0.2) - 1.5).abs() < 1e-12);
    assert_eq!([0.0, 5.0].map(|time| press.force_at(time)), [0.0, 1.0]);
}

#[test]
fn a_damped_skin_feels_more_on_the_way_in_and_the_force_at_rest() {
    let curve = "time_s = [0.0, 0.2, 2.0], force_n = [0.0, 3.0, 3.0], speed_mm_per_s = 200.0, travel_mm = 20.0";
    let text =
        pushed(curve, "damping_n_s_per_m = 2.0").replace("[30.0, 0.0, 2.0]", "[0.0, 0.0, 0.0]");
    let frames = frames(&plan(&text));
    let at = |time: f64| {
        let frame = &frames[(100.0 * time) as usize];
        let Press { force, .. } = pressed(frame, 0);
        (force, total(&frame.patches[0]))
    };
    let (springs, all) = at(0.15);
    assert!(all > 1.02 * springs, "{springs} {all}");
    let (springs, all) = at(1.9);
    let off = (springs - 3.0).abs().max((all - 3.0).abs());
    assert!(off < 1e-9, "{springs} {all}");
}

#[test]
fn a_pushed_object_keeps_to_its_speed_and_its_travel_and_says_what_it_reached() {
    let text = pushed("force_n = 50.0, speed_mm_per_s = 20.0, travel_mm = 6.0", "");
    // At the start, the ball has travelled completely, as if it had been there for a long time.
    let Press { travel, force, .. } = pressed(&frames(&plan(&text))[0], 0);
    assert_eq!(travel, 6e-3);
    assert!(force > 0.5 && force < 50.0, "{force}");
    let step =
        "time_s = [0.0, 0.001], force_n = [0.0, 50.0], speed_mm_per_s = 20.0, travel_mm = 6.0";
    let text = pushed(step, "");
    let (frames, mut before) = (frames(&plan(&text)), 0.0);
    let mut summary = Summary::default();
    for frame in &frames {
        summary.frame(frame).unwrap();
        let Press { travel, .. } = pressed(frame, 0);
        assert!(travel >= before && travel - before <= 0.02 * 0.01 + 1e-12);
        before = travel;
    }
    assert_eq!(before, 6e-3);
    let n_off = summary.objects[0].n_off;
    assert_eq!(n_off, frames.len() - 1, "all but the first frame");
}

#[test]
fn an_object_that_is_pushed_too_hard_stays_felt_however_far_it_goes() {
    // Straight down, up to 120 mm, although the ball has a diameter of 65 mm.
    let press =
        "time_s = [0.0, 0.001], force_n = [0.0, 500.0], speed_mm_per_s = 200.0, travel_mm = 120.0";
    let text = pushed(press, "").replace("[30.0, 0.0, 2.0]", "[0.0, 0.0, 0.0]");
    let text = text.replace("[0.1, 0.0, -2.0]", "[0.0, 0.0, -1.0]");
    let (mut before, mut n_through) = (vec![0.0; 24 * 16], 0);
    for frame in frames(&plan(&text)) {
        let reading = &frame.patches[0];
        let Press { travel, force, .. } = pressed(&frame, 0);
        assert!((force - total(reading)).abs() < 1e-9, "{travel} m");
        let mut pairs = reading.deflection.iter().zip(&before);
        assert!(pairs.all(|(now, before)| now >= before), "{travel} m");
        n_through += usize::from(travel > 0.1 && reading.n_saturated > 100);
        before.clone_from(&reading.deflection);
    }
    assert!(n_through > 20, "{n_through}");
}

#[test]
fn a_force_is_held_by_one_object_among_those_that_stand_there() {
    let press = format!("{CURVE}, speed_mm_per_s = 200.0, travel_mm = 20.0");
    let other =
        "[[objects]]\nname = \"other\"\nobject = \"golf\"\nat = { position_mm = [25.0, 5.0, 0.7] }";
    let text = format!("{}\n{other}", pushed(&press, ""));
    let frames = frames(&plan(&text));
    let alone = total(&frames[0].patches[0]);
    assert!(alone > 0.1 && alone < 1.0, "{alone}");
    for frame in &frames[20..] {
        let Press { wanted, .. } = pressed(frame, 0);
        assert!((total(&frame.patches[0]) - wanted).abs() < 1e-9);
    }
}

/// Layouts of a patch below an object.
const LAYOUTS: [&str; 5] = [
    "grid = { nx = 16, ny = 16, pitch_mm = 4.0 }",
    "hexagonal = { nx = 16, ny = 16, pitch_mm = 4.0 }",
    "disc = { radius_mm = 32.0, pitch_mm = 4.0 }",
    "cylinder = { radius_mm = 40.0, length_mm = 60.0, arc_deg = 200.0, pitch_mm = 4.0 }",
    "sphere_cap = { radius_mm = 30.0, half_angle_deg = 80.0, pitch_mm = 4.0 }",
];

#[test]
fn forces_of_a_frame_sum_to_the_wrench_on_every_layout_for_every_kind_of_object() {
    let folder = tempfile::tempdir().unwrap();
    // Two spheres side by side: where they meet, both push the same taxels.
    let two = "x,y,z,r\n-0.011,0.0,0.0,0.02\n0.011,0.0005,0.0,0.02\n";
    fs::write(folder.path().join("two.csv"), two).unwrap();
    fs::write(folder.path().join("cube.obj"), CUBE).unwrap();
    let shapes = [
        ("object = \"tennis\"", 32.7),
        ("object = \"mug\"\nsurface_error_mm = 3.0", 5.0),
        ("spheres = \"two.csv\"\nunit = \"m\"", 20.0),
        (
            "mesh = \"cube.obj\"\nunit = \"cm\"\nmodel = \"packed\"\nsurface_error_mm = 2.0",
            10.0,
        ),
        ("mesh = \"cube.obj\"\nunit = \"cm\"\nmodel = \"mesh\"", 10.0),
    ];
    let kinds = [
        "motion = { phases = [{ duration_s = 0.1, linear_mm_per_s = [20.0, 5.0, -20.0] }] }",
        // Within the stroke, and with most of the weight on the stops.
        "free = { mass_kg = 0.2 }",
        "free = { mass_kg = 50.0 }",
    ];
    let bottoms = [0.0, 0.0, 0.0, 40.0, 30.0];
    let (mut n_checked, mut n_stopped, mut n_shared) = (0, 0, 0);
    for number in 0..LAYOUTS.len() * shapes.len() * kinds.len() {
        let (kind, (shape, height)) = (kinds[number % 3], shapes[number / 3 % 5]);
        let (layout, bottom) = (LAYOUTS[number / 15], bottoms[number / 15]);
        let is_free = kind.starts_with("free");
        if is_free && shape.contains("\"mesh\"") {
            continue;
        }
        let friction = ["", "friction = 0.5\ndamping_n_s_per_m = 1.0\n"][number % 2];
        let turn = match bottom == 40.0 {
            true => "rotation_deg = [0.0, -90.0, 0.0]",
            false => "",
        };
        let text = format!(
            "title = \"t\"\nduration_s = 0.05\noutput_hz = 20.0\ndt_ms = 10.0\n\
             [[patches]]\nname = \"palm\"\nlayout = {{ {layout} }}\nstroke_mm = 2.0\n{friction}at = {{ {turn} }}\n\
             [[objects]]\nname = \"thing\"\n{shape}\nat = {{ position_mm = [1.0, 2.0, {}] }}\n{kind}\n",
            bottom + height
        );
        let plan = plan_in(folder.path(), &text).unwrap();
        for frame in frames(&plan) {
            let reading = &frame.patches[0];
            let sum: DVec3 = reading.force3.iter().sum();
            let off = (sum - reading.wrench.force).length();
            assert!(off <= 1e-9 * (1.0 + sum.length()), "{off} N\n{text}");
            // The force along a taxel's axis equals its axial force, except on flanks that are nearly parallel to the axis.
            let axes = plan.patches[0].skin.layout().axes();
            for ((force3, force), &axis) in reading.force3.iter().zip(&reading.force).zip(axes) {
                let axial = -force3.dot(axis);
                let is_close = (axial - force).abs() <= 1e-9 * (1.0 + force);
                assert!(is_close || reading.n_grazing > 0, "{axial} {force}\n{text}");
            }
            n_checked += usize::from(reading.n_touched > 0);
            n_stopped += usize::from(reading.stop_force > 100.0);
            let is_shared = is_free && shape.starts_with("spheres") && reading.n_touched > 0;
            n_shared += usize::from(is_shared);
        }
    }
    assert!(
        n_checked > 80 && n_stopped > 10 && n_shared > 8,
        "{n_checked} {n_stopped} {n_shared}"
    );
}

/// Returns a scene with two patches side by side. Each of two balls is pushed onto its own patch and touches the other patch, too.
fn pushed_side_by_side(is_swapped: bool) -> String {
    let patch = |name: &str, x: f64| {
        format!(
            "[[patches]]\nname = \"{name}\"\nat = {{ position_mm = [{x:?}, 0.0, 0.0] }}\n\
             layout = {{ grid = {{ nx = 10, ny = 14, pitch_mm = 3.0 }} }}\nstroke_mm = 6.0\n"
        )
    };
    let ball = |name: &str, patch: &str, x: f64, forces: &str| {
        format!(
            "[[objects]]\nname = \"{name}\"\nobject = \"golf\"\nat = {{ position_mm = [{x:?}, 0.0, 2.0] }}\n\
             press = {{ patch = \"{patch}\", direction = [0.0, 0.0, -1.0], time_s = [0.0, 0.4], force_n = {forces}, \
             speed_mm_per_s = 100.0, travel_mm = 15.0 }}\n"
        )
    };
    let mut balls = [
        ball("one", "left", -6.0, "[2.0, 3.0]"),
        ball("two", "right", 7.0, "[2.0, 1.0]"),
    ];
    if is_swapped {
        balls.reverse();
    }
    let patches = patch("left", -15.0) + &patch("right", 15.0);
    format!(
        "title = \"Two balls\"\noutput_hz = 50.0\n{patches}{}{}",
        balls[0], balls[1]
    )
}

#[test]
fn two_pushed_objects_reach_their_forces_together_in_any_order() {
    let [given, swapped] =
        [false, true].map(|is_swapped| frames(&plan(&pushed_side_by_side(is_swapped))));
    for (one, other) in given.iter().zip(&swapped) {
        for (object, patch) in [(0, 0), (1, 1)] {
            let (given, swapped) = (pressed(one, object), pressed(other, 1 - object));
            assert!((total(&one.patches[patch]) - given.force).abs() < 1e-9);
            if one.time > 0.1 {
                let off = given.force - given.wanted;
                assert!(off.abs() < 1e-9, "{} s: {off} N", one.time);
                assert!((given.travel - swapped.travel).abs() < 1e-12);
                // The balls touch the patches of each other.
                assert!(one.patches.iter().all(|patch| patch.n_touched > 15));
            }
        }
    }
}

#[test]
fn the_largest_force_on_a_patch_is_the_force_of_its_wrench() {
    let text = drawn("").replace(
        "{ grid = { nx = 20, ny = 14, pitch_mm = 3.0 } }",
        "{ cylinder = { radius_mm = 30.0, length_mm = 60.0, arc_deg = 200.0, pitch_mm = 3.0 } }",
    );
    let plan = plan(&text.replace("[-10.0, 3.0, 3.0]", "[20.0, 3.0, 32.0]"));
    let (mut summary, mut largest, mut axial) = (Summary::default(), 0.0_f64, 0.0_f64);
    for frame in frames(&plan) {
        summary.frame(&frame).unwrap();
        let sum: DVec3 = frame.patches[0].force3.iter().sum();
        largest = largest.max(sum.length());
        axial = axial.max(total(&frame.patches[0]));
    }
    assert!((summary.patches[0].force - largest).abs() < 1e-9 * largest);
    assert!((largest - axial).abs() > 1e-2 * axial, "{largest} {axial}");
}

#[test]
fn an_imposed_object_that_moves_through_the_skin_stays_sensed_behind_it() {
    let text = |speed: f64| {
        format!(
            "title = \"Through\"\noutput_hz = 100.0\n[[patches]]\nname = \"palm\"\n\
             layout = {{ grid = {{ nx = 12, ny = 12, pitch_mm = 3.0 }} }}\nstroke_mm = 4.0\n\
             [[objects]]\nname = \"ball\"\nobject = \"golf\"\nat = {{ position_mm = [0.0, 0.0, 3.0] }}\n\
             motion = {{ phases = [{{ duration_s = 0.5, linear_mm_per_s = [0.0, 0.0, {:?}] }}, \
             {{ duration_s = 0.5, linear_mm_per_s = [0.0, 0.0, {speed:?}] }}] }}\n",
            -speed
        )
    };
    let readings = frames(&plan(&text(200.0)));
    // At 0.5 s, the ball has moved by 100 mm, its diameter is 43 mm.
    let n_saturated = readings.iter().map(|frame| frame.patches[0].n_saturated);
    let n_saturated: Vec<usize> = n_saturated.collect();
    assert!(n_saturated[50] > 100, "{n_saturated:?}");
    assert!(n_saturated[10..50].is_sorted(), "{n_saturated:?}");
    // Back in front of the skin, it is not sensed.
    assert_eq!(readings.last().unwrap().patches[0].n_touched, 0);
    // A ball that starts behind the skin was never in it.
    let behind = text(0.0).replace("[0.0, 0.0, 3.0]", "[0.0, 0.0, -90.0]");
    assert_eq!(frames(&plan(&behind))[0].patches[0].n_touched, 0);
}

/// A scene with an early end, with and without damping and friction.
#[test]
fn the_frames_of_a_scene_that_ends_early_are_its_first_ones() {
    let whole = plan(include_str!("../fixtures/texts/scene_cut_text.toml"));
    let all = frames(&whole);
    assert!(all[12].patches[0].n_touched > 0);
    for until in [0.0, 0.33, 0.6, 1.0] {
        let mut cut = whole.clone();
        cut.cut("the test", until).unwrap();
        let first = frames(&cut);
        assert_eq!(first.len(), 1 + (20.0 * until) as usize);
        assert_eq!(first[..], all[..first.len()], "{until}");
    }
}
