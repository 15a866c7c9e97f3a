//! Robots of scenes: joints that nothing moves, what is said of their files, and where files are.

use bubbletouch::scene::{ScenePlan, SceneSpec, Simulation, Stepping};
use glam::DVec3;
use std::path::Path;

const URDF: &str = r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
<joint name="bend" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/><limit lower="0.2" upper="1.5"/></joint>
<joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
<joint name="stuck" type="revolute"><parent link="c"/><child link="d"/><axis xyz="0 0 0"/></joint><link name="d"/>
<sensor name="skin"><parent link="c"/><tactile/></sensor></robot>"#;

/// A scene in a new folder with a patch on link c, and the folder.
fn scene(robot: &str, more: &str) -> (tempfile::TempDir, bubbletouch::Result<ScenePlan>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("r.urdf"), URDF).unwrap();
    let text = format!(
        r#"
        title = "A robot"
        [[robots]]
        name = "robot"
        urdf = "r.urdf"
        {robot}
        [[patches]]
        name = "pad"
        robot = "robot"
        link = "c"
        layout = {{ grid = {{ nx = 2, ny = 2, pitch_mm = 4.0 }} }}
        stroke_mm = 5.0
        {more}
        "#
    );
    let spec = SceneSpec::parse("s.toml", &text).unwrap();
    let plan = ScenePlan::new("s.toml", folder.path(), spec);
    (folder, plan)
}

fn pad_at(plan: &ScenePlan) -> DVec3 {
    let mut frames = Vec::new();
    let mut simulation = Simulation::new(plan, Stepping::AsNeeded);
    simulation.run(&mut [&mut frames]).unwrap();
    frames[frames.len() - 1].patches[0].pose.translation
}

#[test]
fn joints_that_are_not_listed_stand_at_zero_or_at_the_nearest_limit() {
    let (_folder, plan) = scene("", "");
    assert_eq!(pad_at(&plan.unwrap()), DVec3::ZERO);
    let slide = "joints = { time_s = [0.0], positions = { slide_m = [0.5] } }";
    let (_folder, plan) = scene(slide, "");
    let tilted = 0.5 * DVec3::new(0.2f64.sin(), 0.0, 0.2f64.cos());
    assert!((pad_at(&plan.unwrap()) - tilted).length() < 1e-15);
}

#[test]
fn a_joint_that_cannot_move_is_refused_only_if_it_is_listed() {
    let stuck = "joints = { time_s = [0.0], positions = { stuck_rad = [0.5] } }";
    let (_folder, plan) = scene(stuck, "");
    assert_eq!(
        plan.unwrap_err().to_string(),
        "s.toml, key robots.robot.joints.positions: `stuck_rad`, and joint `stuck` is fixed; joints that move and mimic none"
    );
}

#[test]
fn what_a_robots_file_has_and_is_not_read_is_said() {
    let (_folder, plan) = scene("", "");
    let notes: Vec<String> = plan.unwrap().notes().collect();
    let [axis, sensor] = notes.as_slice() else {
        panic!("{notes:?}");
    };
    assert!(axis.starts_with("robots.robot: ") && axis.contains("r.urdf, line 4: joint `stuck`"));
    assert!(sensor.contains("tactile sensor `skin` on link `c`, which is not read"));
}

#[test]
fn every_path_of_a_resolved_scene_is_absolute() {
    let objects = tempfile::tempdir().unwrap();
    let file = objects.path().join("my.toml");
    std::fs::write(
        &file,
        "[[object]]\nname = \"ball\"\nsource = \"ours\"\n[[object.part]]\nshape = \"ball\"\ndiameter_mm = 30\n",
    )
    .unwrap();
    let folder = objects.path();
    std::fs::write(folder.join("s.csv"), "x,y,z,r\n0,0,0,0.01\n").unwrap();
    std::fs::write(
        folder.join("m.csv"),
        "time_s,x,y,z,qx,qy,qz,qw\n0,0,0,0.1,0,0,0,1\n",
    )
    .unwrap();
    std::fs::write(folder.join("j.csv"), "time_s,slide\n0,0.1\n").unwrap();
    std::fs::write(folder.join("t.csv"), "stiffness_n_per_m\n1\n2\n3\n4\n").unwrap();
    std::fs::write(folder.join("r.urdf"), URDF).unwrap();
    let text = r#"
        title = "Paths"
        robots = [{ name = "robot", urdf = "r.urdf", joints = { csv = "j.csv" }, motion = { csv = "m.csv" } }]
        patches = [{ name = "pad", layout = { grid = { nx = 2, ny = 2, pitch_mm = 4.0 } }, stroke_mm = 5.0, taxels_csv = "t.csv" }]
        objects = [
            { name = "a", object = "ball", objects = "my.toml", motion = { csv = "m.csv" } },
            { name = "b", spheres = "s.csv" },
        ]
    "#;
    let spec = SceneSpec::parse("s.toml", text).unwrap();
    let plan = ScenePlan::new("s.toml", folder, spec).unwrap();
    let resolved = plan.spec.to_toml();
    for name in ["r.urdf", "j.csv", "m.csv", "t.csv", "my.toml", "s.csv"] {
        let absolute = format!("\"{}\"", folder.join(name).display());
        assert!(resolved.contains(&absolute), "{name} in {resolved}");
        assert!(
            !resolved.contains(&format!("\"{name}\"")),
            "{name} in {resolved}"
        );
    }
    let elsewhere = Path::new("/nowhere/at/all");
    let again = SceneSpec::parse("s.toml", &resolved).unwrap();
    let again = ScenePlan::new("s.toml", elsewhere, again).unwrap();
    assert_eq!(again.spec, plan.spec);
}

#[test]
fn an_error_of_the_surface_is_given_only_where_spheres_are_made() {
    let object = |keys: &str| format!("[[objects]]\nname = \"o\"\nsurface_error_mm = 0.5\n{keys}");
    for keys in [
        "spheres = \"s.csv\"",
        "mesh = \"m.ply\"",
        "mesh = \"m.ply\"\nmodel = \"mesh\"",
        "mesh = \"m.ply\"\nmodel = \"vertex_spheres\"",
    ] {
        let (_folder, plan) = scene("", &object(keys));
        assert_eq!(
            plan.unwrap_err().to_string(),
            "s.toml, key objects.o.surface_error_mm: given beside spheres, or a mesh that is not packed; \
             it only beside object = \"NAME\" or model = \"packed\""
        );
    }
    let (_folder, plan) = scene("", &object("object = \"mug\""));
    plan.unwrap();
}
