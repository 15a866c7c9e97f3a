//! Robots of scenes: joints without motion, notes on robot files, and locations of files.

use crate::command::{filled, says};
use bubbletouch::scene::{ScenePlan, SceneSpec, Simulation, Stepping};
use glam::DVec3;
use std::path::Path;

const URDF: &str = r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
<joint name="bend" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/><limit lower="0.2" upper="1.5"/></joint>
<joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
<joint name="stuck" type="revolute"><parent link="c"/><child link="d"/><axis xyz="0 0 0"/></joint><link name="d"/>
<sensor name="skin"><parent link="c"/><tactile/></sensor></robot>"#;

/// Creates a scene in a new folder with a patch on link c; returns the folder and the plan.
fn scene(robot: &str, more: &str) -> (tempfile::TempDir, bubbletouch::Result<ScenePlan>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("r.urdf"), URDF).unwrap();
    let text = filled(
        include_str!("../fixtures/texts/scene_robots_scene.toml"),
        &[("robot", &robot), ("more", &more)],
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
fn what_a_robots_file_has_and_is_not_read_is_said() {
    let (_folder, plan) = scene("", "");
    let notes: Vec<String> = plan.unwrap().notes().collect();
    let [axis, sensor] = notes.as_slice() else {
        panic!("{notes:?}");
    };
    assert!(axis.starts_with("robots.robot: ") && axis.contains("r.urdf, line 4: joint `stuck`"));
    assert!(sensor.contains("tactile sensor `skin` on link `c` is not read"));
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
    let text = include_str!("../fixtures/texts/scene_robots_text.toml");
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

/// Hand with a box as palm and a capsule as wrist. Its fingertip has a collision ball and a visual cube in centimetres. Its base has no shape.
const HAND: &str = include_str!("../fixtures/texts/scene_robots_hand.urdf");

/// Cube about the origin with edges of 2.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// Returns a scene with skin draped over the hand, with keys of the layout and other keys of the patch.
fn hand(draped: &str, more: &str) -> bubbletouch::Result<ScenePlan> {
    let folder = tempfile::tempdir().unwrap();
    let robots = folder.path().join("hand_description/urdf");
    let meshes = folder.path().join("hand_description/meshes");
    for (folder, name, text) in [(&robots, "hand.urdf", HAND), (&meshes, "cube.obj", CUBE)] {
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join(name), text).unwrap();
    }
    let text = format!(
        "title = \"A hand\"\n[[robots]]\nname = \"left\"\nurdf = \"hand_description/urdf/hand.urdf\"\n\
         [[patches]]\nname = \"skin\"\nstroke_mm = 2.0\n{more}\nlayout = {{ draped = {{ pitch_mm = 2.0, {draped} }} }}\n"
    );
    let plan = ScenePlan::new("s.toml", folder.path(), SceneSpec::parse("s.toml", &text)?)?;
    // The resolved scene is the same in any folder.
    let resolved = SceneSpec::parse("r.toml", &plan.spec.to_toml()).unwrap();
    let again = ScenePlan::new("r.toml", Path::new("/"), resolved).unwrap();
    assert_eq!(
        plan.patches[0].skin.layout(),
        again.patches[0].skin.layout()
    );
    Ok(plan)
}

#[test]
fn skin_is_draped_over_the_shapes_of_a_named_link_which_carries_it() {
    const ROBOT: &str = "robot = \"left\"";
    let plan = hand("region = { link = \"palm\" }", ROBOT).unwrap();
    assert_eq!(pad_at(&plan), DVec3::new(0.0, 0.0, 0.5));
    let layout = plan.patches[0].skin.layout();
    let half = DVec3::new(0.02, 0.015, 0.01);
    for (&center, &axis) in layout.centers().iter().zip(layout.axes()) {
        let out = (center - DVec3::new(0.0, 0.0, 0.01)).abs() - half;
        assert!(out.max_element().abs() < 1e-12, "{center}");
        assert!((center - DVec3::new(0.0, 0.0, 0.01)).dot(axis) > 0.0);
    }
    // The number of taxels is close to 52 cm² / (2 mm)², as for a 2 mm grid.
    let area = 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x);
    let share = layout.n_taxels() as f64 * 4e-6 / area;
    assert!((0.9..1.15).contains(&share), "{share}");
    // Region beside a plane, in the link's frame; the link may be named twice.
    let twice = format!("{ROBOT}\nlink = \"palm\"");
    let top = "region = { link = \"palm\", plane_point_mm = [0.0, 0.0, 20.0], plane_normal = [0.0, 0.0, 1.0] }";
    let plan = hand(top, &twice).unwrap();
    let mut centers = plan.patches[0].skin.layout().centers().iter();
    assert!(centers.all(|center| (center.z - 0.02).abs() < 1e-12));
    // Collision shapes are used if there are any: here a ball, whose facets are at most 2 % of a pitch inside.
    let plan = hand("region = { link = \"tip\" }", ROBOT).unwrap();
    let layout = plan.patches[0].skin.layout();
    for (center, axis) in layout.centers().iter().zip(layout.axes()) {
        let from_middle = *center - DVec3::new(0.1, 0.0, 0.0);
        let inside = 0.012 - from_middle.length();
        assert!((-1e-12..=2.0 * 0.02 * 2e-3).contains(&inside), "{inside}");
        assert!(from_middle.normalize().dot(*axis) > 0.99);
    }
    // The visual mesh is found in its package, scaled and mirrored.
    let plan = hand("region = { link = \"tip\", shapes = \"visual\" }", ROBOT).unwrap();
    let layout = plan.patches[0].skin.layout();
    for (&center, &axis) in layout.centers().iter().zip(layout.axes()) {
        assert!((center.abs().max_element() - 0.01).abs() < 1e-12);
        assert!(center.dot(axis) > 0.0);
    }
    // Shapes that overlap have one outer surface, so no taxel of the capsule is within the disc.
    let plan = hand("region = { link = \"wrist\" }", ROBOT).unwrap();
    let mut centers = plan.patches[0].skin.layout().centers().iter();
    assert!(
        centers.all(|center| center.z.abs() > 0.005 - 1e-9 || center.truncate().length() > 0.019)
    );
}

#[test]
fn skin_is_draped_over_the_shapes_of_the_patchs_own_link() {
    let own = |link: &str, draped: &str| {
        hand(draped, &format!("robot = \"left\"\nlink = \"{link}\"")).map(|plan| {
            let layout = plan.patches[0].skin.layout();
            layout.centers().to_vec()
        })
    };
    for (link, role) in [
        ("palm", "collision"),
        ("tip", "visual"),
        ("wrist", "visual"),
    ] {
        let region = format!("region = {{ link = \"{link}\", shapes = \"{role}\" }}");
        let on = format!("on = \"{role}\"");
        assert_eq!(own(link, &on).unwrap(), own(link, &region).unwrap());
    }
    let top = "on = \"collision\", region = { plane_point_mm = [0.0, 0.0, 20.0], plane_normal = [0.0, 0.0, 1.0] }";
    assert!(
        own("palm", top)
            .unwrap()
            .iter()
            .all(|center| (center.z - 0.02).abs() < 1e-12)
    );
    for (draped, more, said) in [
        (
            "on = \"collision\"",
            "",
            "key patches.skin.layout.on: a patch without a robot",
        ),
        (
            "on = \"collision\", region = { link = \"palm\" }",
            "robot = \"left\"",
            "beside mesh, region.link or region.shapes",
        ),
        (
            "on = \"collision\"",
            "robot = \"left\"",
            "`base`: a link without collision shapes",
        ),
        ("on = \"both\"", "robot = \"left\"", "both"),
    ] {
        let error = hand(draped, more).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
}

/// Arm of MuJoCo, whose elbow starts outside its range, with a site and a mesh of the model's folder.
const ARM: &str = r#"<mujoco model="arm"><compiler meshdir="parts"/><asset><mesh file="cube.obj" scale="0.01 0.01 0.02"/></asset>
<worldbody><body name="upper" pos="0 0 0.5"><joint name="shoulder" axis="0 1 0"/>
<body name="lower" pos="0.3 0 0"><joint name="elbow" axis="0 1 0" range="10 90"/>
<geom type="mesh" mesh="cube" pos="0 0 0.1"/><site name="palm" pos="0.2 0 0" euler="0 90 0"/></body></body></worldbody></mujoco>"#;

#[test]
fn a_robot_of_mujoco_carries_skin_on_its_bodies_and_sites() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    std::fs::write(folder.path().join("parts/cube.obj"), CUBE).unwrap();
    std::fs::write(folder.path().join("arm.xml"), ARM).unwrap();
    let plan = |robot: &str, link: &str, layout: &str| {
        let text = format!(
            "title = \"An arm\"\n[[robots]]\nname = \"arm\"\n{robot}\n[[patches]]\nname = \"pad\"\nrobot = \"arm\"\n\
             link = \"{link}\"\nstroke_mm = 2.0\nlayout = {{ {layout} }}\n"
        );
        ScenePlan::new("s.toml", folder.path(), SceneSpec::parse("s.toml", &text)?)
    };
    let grid = "grid = { nx = 2, ny = 2, pitch_mm = 2.0 }";
    let file = "file = \"arm.xml\"";
    assert_eq!(
        pad_at(&plan(file, "palm", grid).unwrap()),
        DVec3::new(0.5, 0.0, 0.5)
    );
    let bent =
        format!("{file}\njoints = {{ time_s = [0.0], positions = {{ shoulder_deg = [90.0] }} }}");
    let at = pad_at(&plan(&bent, "palm", grid).unwrap());
    assert!((at - DVec3::new(0.0, 0.0, 0.0)).length() < 1e-15, "{at}");
    let covered = plan(
        file,
        "lower",
        "draped = { on = \"collision\", pitch_mm = 2.0 }",
    )
    .unwrap();
    let mut centers = covered.patches[0].skin.layout().centers().iter();
    let half = DVec3::new(0.01, 0.01, 0.02);
    assert!(centers.all(|&center| {
        let out = (center - DVec3::new(0.0, 0.0, 0.1)).abs() - half;
        out.max_element().abs() < 1e-12
    }));
    for (robot, said) in [
        (
            "file = \"arm.xml\"\nurdf = \"arm.xml\"",
            "key robots.arm: `file` and `urdf`; one of `file`, `urdf`, `floating`",
        ),
        ("file = \"none.xml\"", "key robots.arm.file"),
        (
            "file = \"arm.xml\"\npackages = { arm = \"none\" }",
            "key robots.arm.packages.arm",
        ),
    ] {
        let error = plan(robot, "palm", grid).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
}

#[test]
fn meshes_of_a_package_are_read_from_the_folder_of_the_scenes_key() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("robots")).unwrap();
    std::fs::create_dir_all(folder.path().join("elsewhere/meshes")).unwrap();
    std::fs::write(folder.path().join("robots/hand.urdf"), HAND).unwrap();
    std::fs::write(folder.path().join("elsewhere/meshes/cube.obj"), CUBE).unwrap();
    let plan = |packages: &str| {
        let text = format!(
            "title = \"A hand\"\n[[robots]]\nname = \"left\"\nfile = \"robots/hand.urdf\"\n{packages}\n[[patches]]\nname = \"skin\"\n\
             robot = \"left\"\nlink = \"tip\"\nstroke_mm = 2.0\nlayout = {{ draped = {{ on = \"visual\", pitch_mm = 2.0 }} }}\n"
        );
        ScenePlan::new(
            "s.toml",
            folder.path(),
            SceneSpec::parse("s.toml", &text).unwrap(),
        )
    };
    let missing = plan("").unwrap_err().to_string();
    says(
        &missing,
        &[
            "package://hand_description/meshes/cube.obj: a mesh that is not found; packages = { hand_description = \"FOLDER\" }",
            "robots/hand_description/meshes/cube.obj",
        ],
    );
    let found = plan("packages = { hand_description = \"elsewhere\" }").unwrap();
    // The resolved scene finds the package from any folder.
    let resolved = SceneSpec::parse("r.toml", &found.spec.to_toml()).unwrap();
    ScenePlan::new("r.toml", Path::new("/"), resolved).unwrap();
}
