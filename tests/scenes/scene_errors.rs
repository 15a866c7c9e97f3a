//! An invalid scene is refused in one sentence: file, key, given value, allowed values.

use bubbletouch::Error;
use bubbletouch::scene::{ScenePlan, SceneSpec};
use std::path::Path;

const ROBOT: &str = r#"
[[robots]]
name = "arm"
urdf = "objects/robots/arm.urdf"
joints = { time_s = [0.0, 1.0], positions = { shoulder_turn_deg = [0.0, 10.0], shoulder_bend_deg = [0.0, 0.0], arm_turn_deg = [0.0, 0.0], elbow_bend_deg = [0.0, 0.0], forearm_turn_deg = [0.0, 0.0], wrist_bend_deg = [0.0, 0.0], flange_turn_deg = [0.0, 0.0] } }
"#;

const PATCH: &str = r#"
[[patches]]
name = "skin"
robot = "arm"
link = "forearm"
layout = { cylinder = { radius_mm = 50.0, length_mm = 100.0, arc_deg = 180.0, pitch_mm = 5.0 } }
stroke_mm = 5.0
"#;

const OBJECT: &str = r#"
[[objects]]
name = "ball"
object = "tennis"
at = { position_mm = [0.0, 0.0, 100.0] }
free = { mass_kg = 0.058 }
"#;

fn plan(text: &str) -> Result<ScenePlan, Error> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    ScenePlan::new("s.toml", folder, SceneSpec::parse("s.toml", text)?)
}

fn good() -> String {
    format!("title = \"A scene\"\n{ROBOT}{PATCH}{OBJECT}")
}

/// Returns the error for the valid scene after replacing `from` by `to`.
#[track_caller]
fn refused(from: &str, to: &str) -> String {
    let text = good();
    assert_eq!(text.matches(from).count(), 1, "{from}");
    let error = plan(&text.replace(from, to)).unwrap_err();
    assert_eq!(error.exit_code(), 2, "{error}");
    let said = error.to_string();
    assert!(said.starts_with("s.toml") && !said.contains('\n'), "{said}");
    said
}

#[track_caller]
fn says(said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "{said:?} has no {part:?}");
    }
}

#[test]
fn the_good_scene_is_good() {
    let plan = plan(&good()).unwrap();
    assert_eq!((plan.n_frames, plan.n_substeps), (101, 10));
    assert_eq!(plan.spec.duration_s, Some(1.0));
    assert!(plan.needs_steps());
}

#[test]
fn names_that_are_slips_are_answered_with_what_was_perhaps_meant() {
    let said = refused("link = \"forearm\"", "link = \"foream\"");
    says(
        &said,
        &["key patches.skin.link", "`foream`", "perhaps `forearm`"],
    );
    let said = refused("robot = \"arm\"", "robot = \"amr\"");
    assert_eq!(said, "s.toml, key patches.skin.robot: `amr`; perhaps `arm`");
    let said = refused("object = \"tennis\"", "object = \"tenis\"");
    says(
        &said,
        &["key objects.ball.object", "tenis", "perhaps", "tennis"],
    );
    let said = refused("elbow_bend_deg", "elbow_bedn_deg");
    says(
        &said,
        &[
            "key robots.arm.joints.positions",
            "`elbow_bedn_deg`",
            "perhaps `elbow_bend`",
        ],
    );
    let said = refused("cylinder = {", "cilinder = {");
    says(&said, &["s.toml:12:", "cilinder", "cylinder"]);
    let said = refused("stroke_mm = 5.0", "stroke_mm = 5.0\nstrength = 3");
    says(&said, &["s.toml:14:1", "unknown field `strength`"]);
}

#[test]
fn what_moves_needs_a_motion_that_it_can_make() {
    let said = refused(
        "shoulder_turn_deg = [0.0, 10.0]",
        "shoulder_turn_deg = [0.0, 170.0]",
    );
    says(
        &said,
        &["key robots.arm.joints", "joint `shoulder_turn`", "at most"],
    );
    let said = refused(
        "shoulder_turn_deg = [0.0, 10.0]",
        "shoulder_turn_deg = [0.0, nan]",
    );
    says(
        &said,
        &[
            "key robots.arm.joints",
            "shoulder_turn_deg",
            "NaN",
            "a finite number",
        ],
    );
    let said = refused(
        "shoulder_turn_deg = [0.0, 10.0]",
        "shoulder_turn_deg = [0.0]",
    );
    says(
        &said,
        &["`shoulder_turn_deg` with 1 numbers", "2, one a time"],
    );
    let said = refused("time_s = [0.0, 1.0]", "time_s = [1.0, 0.0]");
    says(&said, &["key robots.arm.joints", "strictly ascending"]);
    let said = refused("free = { mass_kg = 0.058 }", "motion = {}");
    says(
        &said,
        &[
            "key objects.ball.motion",
            "exactly one of phases, way_points, csv and oscillation",
        ],
    );
    let said = refused(
        "free = { mass_kg = 0.058 }",
        "motion = { way_points = [{ time_s = 0.0 }] }",
    );
    says(&said, &["key objects.ball.motion: way-points beside `at`"]);
    let said = refused(
        "free = { mass_kg = 0.058 }",
        "motion = { phases = [{ duration_s = -1.0 }] }",
    );
    says(
        &said,
        &["key objects.ball.motion.phases: -1", "zero or a positive"],
    );
}

#[test]
fn a_free_object_has_mass_gravity_and_spheres_and_no_motion() {
    let said = refused("free = { mass_kg = 0.058 }", "free = {}");
    assert_eq!(
        said,
        "s.toml, key objects.ball.free.mass_kg: a free object without mass; a positive number"
    );
    let said = refused("mass_kg = 0.058", "mass_kg = 0.0");
    says(&said, &["key objects.ball.free.mass_kg: 0;"]);
    let said = refused(
        "free = {",
        "motion = { phases = [{ duration_s = 1.0 }] }\nfree = {",
    );
    says(&said, &["key objects.ball: a free object with a motion"]);
    let said = refused(
        "title = \"A scene\"",
        "title = \"\"\ngravity_m_per_s2 = [0.0, 0.0, 0.0]",
    );
    says(&said, &["key gravity_m_per_s2", "not zero"]);
}

#[test]
fn what_is_rigid_is_for_free_objects_and_made_of_spheres() {
    let table = |lines: &str| {
        let text = format!("{}[[planes]]\nname = \"table\"\n{lines}", good());
        plan(&text).map(|plan| plan.planes[0])
    };
    let tilted = table("point_mm = [0.0, 0.0, 7.0]\nnormal = [0.0, 3.0, 4.0]").unwrap();
    assert!((tilted.height - 5.6e-3).abs() < 1e-15 && (tilted.normal.z - 0.8).abs() < 1e-15);
    let flat = table("normal = [0.0, 0.0, 0.0]").unwrap_err().to_string();
    says(
        &flat,
        &[
            "key planes.table.normal",
            "a direction of any length above zero",
        ],
    );
    let text = good().replace("free = { mass_kg = 0.058 }", "[[planes]]\nname = \"table\"");
    let alone = plan(&text).unwrap_err().to_string();
    says(&alone, &["plane `table` in a scene without free objects"]);
    let twice = table("[[planes]]\nname = \"table\"")
        .unwrap_err()
        .to_string();
    says(&twice, &["a second thing called `table`"]);
}

#[test]
fn two_things_of_one_name_and_files_that_are_not_there_are_refused() {
    let said = refused("name = \"ball\"", "name = \"skin\"");
    says(
        &said,
        &[
            "key objects: a second thing called `skin`",
            "each name once",
        ],
    );
    let said = refused("urdf = \"objects/robots/arm.urdf\"", "urdf = \"arm.urdf\"");
    says(
        &said,
        &["key robots.arm.urdf", "arm.urdf, which cannot be opened"],
    );
    let said = refused("object = \"tennis\"", "mesh = \"ball.ply\"");
    says(
        &said,
        &["key objects.ball.mesh", "ball.ply, which cannot be opened"],
    );
    let said = refused(
        "object = \"tennis\"",
        "object = \"tennis\"\nspheres = \"ball.csv\"",
    );
    says(&said, &["key objects.ball: none, or several"]);
    let said = refused("urdf = \"objects/robots/arm.urdf\"", "floating = true");
    says(&said, &["key robots.arm.joints", "no such key"]);
}

#[test]
fn numbers_out_of_their_range_are_refused_with_their_key() {
    for (key, to) in [
        ("dt_ms", "dt_ms = 0.0"),
        ("output_hz", "output_hz = -1.0"),
        ("duration_s", "duration_s = inf"),
        ("duration_s", "duration_s = 1e12"),
        ("dt_ms", "dt_ms = 1e-30"),
    ] {
        let said = refused("title = \"A scene\"", &format!("title = \"\"\n{to}"));
        says(&said, &[&format!("key {key}:")]);
    }
    let said = refused("stroke_mm = 5.0", "stroke_mm = 0.0");
    says(&said, &["key patches.skin.stroke_mm: 0; a positive number"]);
    let said = refused("radius_mm = 50.0", "radius_mm = -50.0");
    says(&said, &["key patches.skin.layout", "radius"]);
    let said = refused(
        "position_mm = [0.0, 0.0, 100.0]",
        "position_mm = [0.0, nan, 100.0]",
    );
    says(&said, &["key objects.ball.at.position_mm: NaN"]);
    let text = format!("title = \"\"\npatches = []\n{ROBOT}");
    let said = plan(&text).unwrap_err().to_string();
    assert_eq!(said, "s.toml, key patches: none; at least one");
}
