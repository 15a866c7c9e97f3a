//! Mounted bodies: skin on an object, and objects on a robot's links, compared with equal bodies that move on their own.

use crate::command::filled;
use crate::scene::{frames, plan, plan_in};
use bubbletouch::scene::PoseControl;
use glam::DVec3;

const MOTION: &str = "motion = { phases = [
    { duration_s = 0.2, linear_mm_per_s = [0.0, 5.0, -40.0] },
    { duration_s = 0.3, linear_mm_per_s = [20.0, 0.0, 0.0], angular_deg_per_s = [0.0, 30.0, 40.0] },
] }";

/// Asserts that the first patch has equal deflections in both scenes, and that some are not zero.
fn assert_same(a: &str, b: &str) {
    let [a, b] = [a, b].map(|text| frames(&plan(text)));
    assert_eq!(a.len(), b.len());
    let mut n_touched = 0;
    for (a, b) in a.iter().zip(&b) {
        let [a, b] = [a, b].map(|frame| &frame.patches[0]);
        n_touched += a.n_touched;
        for (a, b) in a.deflection.iter().zip(&b.deflection) {
            assert!((a - b).abs() < 1e-12, "{a} for {b}");
        }
    }
    assert!(n_touched > 100, "{n_touched}");
}

/// Returns a scene with an object above a skin that is fixed in the world.
fn over_skin(carrier: &str, object: &str) -> String {
    filled(
        include_str!("../fixtures/texts/scene_mounts_over_skin.toml"),
        &[("carrier", &carrier), ("object", &object)],
    )
}

/// A link that is turned and moved, and the skin on it.
const TURNED: &str =
    "at = { position_mm = [40.0, 30.0, -20.0], rotation_deg = [10.0, 20.0, 30.0] }";

#[test]
fn the_motion_of_an_object_on_a_link_is_in_the_frame_of_the_link() {
    let at = "at = { position_mm = [3.0, -2.0, 6.0], rotation_deg = [0.0, 0.0, 15.0] }";
    let oscillation = "motion = { oscillation = { linear_mm = [2.0, 0.0, -6.0], angular_deg = [0.0, 10.0, 20.0], period_s = 0.4 } }";
    for motion in [MOTION, oscillation] {
        let alone = over_skin("", &format!("{at}\n{motion}"));
        let carrier = format!("[[robots]]\nname = \"hand\"\nfloating = true\n{TURNED}\n");
        let carried = over_skin(&carrier, &format!("robot = \"hand\"\n{at}\n{motion}"));
        let carried = carried.replace("name = \"skin\"", "name = \"skin\"\nrobot = \"hand\"");
        assert_same(&alone, &carried);
    }
    // Without `duration_s`, a scene ends with its motion, here after one period.
    let carrier = format!("[[robots]]\nname = \"hand\"\nfloating = true\n{TURNED}\n");
    let text = over_skin(&carrier, &format!("robot = \"hand\"\n{at}\n{oscillation}"));
    let plan = plan(&text.replace("duration_s = 0.5", ""));
    assert_eq!(plan.n_frames, 21);
}

#[test]
fn an_oscillation_is_farthest_after_a_quarter_of_its_period() {
    let text = over_skin(
        "",
        "at = { position_mm = [1.0, 0.0, 50.0] }
        motion = { oscillation = { linear_mm = [0.0, 0.0, 8.0], angular_deg = [0.0, 0.0, 90.0], period_s = 0.4 } }",
    );
    let frames = frames(&plan(&text));
    let place = |frame: usize| 1e3 * frames[frame].objects[0].pose.translation;
    assert_eq!(place(0), DVec3::new(1.0, 0.0, 50.0));
    assert!(place(5).distance(DVec3::new(0.0, 1.0, 58.0)) < 1e-9);
    assert!(place(15).distance(DVec3::new(0.0, -1.0, 42.0)) < 1e-9);
    assert!(place(20).distance(place(0)) < 1e-9);
}

#[test]
fn parts_in_a_scene_are_the_solid_of_a_file_of_objects() {
    let folder = tempfile::tempdir().unwrap();
    let parts = "shape = \"ball\"\ndiameter_mm = 30\nposition_mm = [0, 0, 85]
        [[object.part]]\nshape = \"cylinder\"\ndiameter_mm = 4\nheight_mm = 70\nposition_mm = [0, 0, 35]";
    let file =
        format!("[[object]]\nname = \"lollipop\"\nsource = \"ours\"\n[[object.part]]\n{parts}");
    std::fs::write(folder.path().join("sweets.toml"), file).unwrap();
    let models = |object: &str| {
        let text = over_skin("", object).replace("object = \"pear\"", "");
        plan_in(folder.path(), &text).map(|plan| plan.models)
    };
    let named = models("object = \"lollipop\"\nobjects = \"sweets.toml\"").unwrap();
    let ball = "shape = \"ball\", diameter_mm = 30";
    let stick = "shape = \"cylinder\", diameter_mm = 4, height_mm = 70";
    // The stick of the file stands on z = 0 with the middle of the bounding box above the origin.
    let written = format!(
        "parts = [{{ {ball}, position_mm = [0, 0, 85] }}, {{ {stick}, position_mm = [0, 0, 35] }}]"
    );
    let spheres = |models: &[bubbletouch::objects::Model]| models[0].spheres().unwrap().clone();
    let as_written = spheres(&models(&written).unwrap());
    assert_eq!(as_written, spheres(&named));
    let centered = spheres(&models(&format!("{written}\ncentered = true")).unwrap());
    assert!(centered.bounds().center().length() < 1e-3);
    let moved = as_written.bounds().center() - centered.bounds().center();
    assert!(moved.distance(0.05 * DVec3::Z) < 1e-9, "{moved}");
}

#[test]
fn an_object_on_a_link_goes_where_the_link_goes() {
    let at = "at = { position_mm = [3.0, -2.0, 6.0] }";
    let alone = over_skin("", &format!("{at}\n{MOTION}"));
    let carrier = format!("[[robots]]\nname = \"hand\"\nfloating = true\n{at}\n{MOTION}\n");
    let carried = over_skin(&carrier, "robot = \"hand\"");
    assert_same(&alone, &carried);
}

/// Returns a scene with skin around a can that is lowered onto a pear.
fn skinned_can(carrier: &str, patch: &str, can: &str) -> String {
    filled(
        include_str!("../fixtures/texts/scene_mounts_skinned_can.toml"),
        &[("carrier", &carrier), ("patch", &patch), ("can", &can)],
    )
}

#[test]
fn skin_on_an_object_goes_with_it_and_does_not_feel_it() {
    let place = "at = { position_mm = [0.0, 0.0, 30.0] }";
    let can = format!("[[objects]]\nname = \"can\"\nobject = \"soup_can\"\n{place}\n{MOTION}\n");
    let at = "at = { position_mm = [0.0, 0.0, 50.0] }";
    let on_object = skinned_can("", &format!("object = \"can\"\n{at}"), &can);
    let robot = format!("[[robots]]\nname = \"core\"\nfloating = true\n{place}\n{MOTION}\n");
    let on_robot = skinned_can(&robot, &format!("robot = \"core\"\n{at}"), "");
    assert_same(&on_object, &on_robot);
    // Skin that is fixed in the world touches the can that moves into it.
    let beside = skinned_can("", "at = { position_mm = [0.0, 40.0, 50.0] }", &can);
    let beside = frames(&plan(&beside));
    assert!(beside.iter().any(|frame| frame.patches[0].n_touched > 0));
}

#[test]
fn a_free_ball_is_carried_by_skin_on_an_object_that_rides_a_link() {
    let text = include_str!("../fixtures/texts/scene_mounts_a_free_ball_is.toml");
    let weight = 0.046 * 9.81;
    for frame in frames(&plan(text)) {
        let held = frame.objects[1].held;
        assert_eq!(held, PoseControl::AtRest, "{} s", frame.time);
        let carried = frame.patches[0].wrench.force;
        assert!((carried.z + weight).abs() < 1e-6 * weight, "{carried}");
        assert!(frame.touches.is_empty());
    }
}
