//! Robots of scenes: joints without motion, notes on robot files, and locations of files.

use crate::command::{Case, filled, says};
use crate::scene::{CUBE, frames, plan_in, resolved};
use bubbletouch::scene::ScenePlan;
use glam::DVec3;

const URDF: &str = r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
<joint name="bend" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/><limit lower="0.2" upper="1.5"/></joint>
<joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
<joint name="stuck" type="revolute"><parent link="c"/><child link="d"/><axis xyz="0 0 0"/></joint><link name="d"/>
<sensor name="skin"><parent link="c"/><tactile/></sensor></robot>"#;

/// Plans a scene with a patch on link c and keys of its robot.
fn scene(robot: &str) -> ScenePlan {
    let case = Case::with("r.urdf", URDF);
    let text = filled(
        include_str!("../fixtures/texts/scene_robots_scene.toml"),
        &[("robot", &robot), ("more", &"")],
    );
    plan_in(case.folder(), &text).unwrap()
}

fn pad_at(plan: &ScenePlan) -> DVec3 {
    frames(plan).last().unwrap().patches[0].pose.translation
}

#[test]
fn joints_that_are_not_listed_stand_at_zero_or_at_the_nearest_limit() {
    assert_eq!(pad_at(&scene("")), DVec3::ZERO);
    let slide = "joints = { time_s = [0.0], positions = { slide_m = [0.5] } }";
    let tilted = 0.5 * DVec3::new(0.2f64.sin(), 0.0, 0.2f64.cos());
    assert!((pad_at(&scene(slide)) - tilted).length() < 1e-15);
}

#[test]
fn what_a_robots_file_has_and_is_not_read_is_said() {
    let notes: Vec<String> = scene("").notes().collect();
    let [axis, sensor] = notes.as_slice() else {
        panic!("{notes:?}");
    };
    assert!(axis.starts_with("robots.robot: ") && axis.contains("r.urdf, line 4: joint `stuck`"));
    assert!(sensor.contains("tactile sensor `skin` on link `c` is not read"));
}

#[test]
fn every_path_of_a_resolved_scene_is_absolute() {
    let case = Case::with("r.urdf", URDF);
    let ball = "[[object]]\nname = \"ball\"\nsource = \"ours\"\n[[object.part]]\nshape = \"ball\"\ndiameter_mm = 30\n";
    case.file("my.toml", ball);
    case.file("s.csv", "x,y,z,r\n0,0,0,0.01\n");
    case.file("m.csv", "time_s,x,y,z,qx,qy,qz,qw\n0,0,0,0.1,0,0,0,1\n");
    case.file("j.csv", "time_s,slide\n0,0.1\n");
    case.file("t.csv", "stiffness_n_per_m\n1\n2\n3\n4\n");
    let text = include_str!("../fixtures/texts/scene_robots_text.toml");
    let plan = plan_in(case.folder(), text).unwrap();
    let written = plan.spec.to_toml();
    for name in ["r.urdf", "j.csv", "m.csv", "t.csv", "my.toml", "s.csv"] {
        says(&written, &[format!("\"{}\"", case.path(name).display())]);
        let relative = format!("\"{name}\"");
        assert!(!written.contains(&relative), "{name} in {written}");
    }
    assert_eq!(resolved(&plan).spec, plan.spec);
}

/// Hand with a box as palm and a capsule as wrist. Its fingertip has a collision ball and a visual cube in centimetres. Its base has no shape.
const HAND: &str = include_str!("../fixtures/texts/scene_robots_hand.urdf");

/// Returns a scene with skin draped over the hand, with keys of the layout and other keys of the patch.
fn hand(draped: &str, more: &str) -> bubbletouch::Result<ScenePlan> {
    let case = Case::with("hand_description/urdf/hand.urdf", HAND);
    case.file("hand_description/meshes/cube.obj", CUBE);
    let text = format!(
        "title = \"A hand\"\n[[robots]]\nname = \"left\"\nurdf = \"hand_description/urdf/hand.urdf\"\n\
         [[patches]]\nname = \"skin\"\nstroke_mm = 2.0\n{more}\nlayout = {{ draped = {{ pitch_mm = 2.0, {draped} }} }}\n"
    );
    let plan = plan_in(case.folder(), &text)?;
    // The resolved scene is the same in any folder.
    let layouts = [&plan, &resolved(&plan)].map(|plan| plan.patches[0].skin.layout().clone());
    assert_eq!(layouts[0], layouts[1]);
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
    let is_outside = |c: &DVec3| c.z.abs() > 0.005 - 1e-9 || c.truncate().length() > 0.019;
    assert!(
        plan.patches[0]
            .skin
            .layout()
            .centers()
            .iter()
            .all(is_outside)
    );
}

#[test]
fn a_mesh_in_millimetres_is_as_large_as_its_scale_says() {
    let draped = |mesh: &str, scale: &str| {
        let mesh_element = format!("<mesh filename='cube.obj' scale='{scale}'/>");
        let link = format!(
            "<link name='a'><collision><geometry>{mesh_element}</geometry></collision></link>"
        );
        let case = Case::with("r.urdf", format!("<robot name='r'>{link}</robot>"));
        case.file("cube.obj", mesh);
        let text = "title = \"A cube\"\n[[robots]]\nname = \"r\"\nfile = \"r.urdf\"\n[[patches]]\nname = \"skin\"\nstroke_mm = 2.0\n\
                    robot = \"r\"\nlayout = { draped = { pitch_mm = 4.0, region = { link = \"a\" } } }\n";
        plan_in(case.folder(), text).map(|plan| plan.patches[0].skin.layout().clone())
    };
    let vertices = |line: &str| match line.starts_with('v') {
        true => line.replace('1', "20") + "\n",
        false => line.to_owned() + "\n",
    };
    let millimetres: String = CUBE.lines().map(vertices).collect();
    let expected = draped(CUBE, "0.02 0.02 0.02").unwrap();
    assert_eq!(draped(&millimetres, "0.001 0.001 0.001").unwrap(), expected);
    let error = draped(&millimetres, "1 1 1").unwrap_err().to_string();
    says(
        &error,
        &["cube.obj: 40 m wide with the scale [1, 1, 1]; 0.0001 m to 10 m"],
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
    let centers = own("palm", top).unwrap();
    assert!(centers.iter().all(|center| (center.z - 0.02).abs() < 1e-12));
}

/// Arm of MuJoCo, whose elbow starts outside its range, with a site and a mesh of the model's folder.
const ARM: &str = r#"<mujoco model="arm"><compiler meshdir="parts"/><asset><mesh file="cube.obj" scale="0.01 0.01 0.02"/></asset>
<worldbody><body name="upper" pos="0 0 0.5"><joint name="shoulder" axis="0 1 0"/>
<body name="lower" pos="0.3 0 0"><joint name="elbow" axis="0 1 0" range="10 90"/>
<geom type="mesh" mesh="cube" pos="0 0 0.1"/><site name="palm" pos="0.2 0 0" euler="0 90 0"/></body></body></worldbody></mujoco>"#;

#[test]
fn a_robot_of_mujoco_carries_skin_on_its_bodies_and_sites() {
    let case = Case::with("parts/cube.obj", CUBE);
    case.file("arm.xml", ARM);
    let plan = |robot: &str, link: &str, layout: &str| {
        let text = format!(
            "title = \"An arm\"\n[[robots]]\nname = \"arm\"\n{robot}\n[[patches]]\nname = \"pad\"\nrobot = \"arm\"\n\
             link = \"{link}\"\nstroke_mm = 2.0\nlayout = {{ {layout} }}\n"
        );
        plan_in(case.folder(), &text)
    };
    let grid = "grid = { nx = 2, ny = 2, pitch_mm = 2.0 }";
    let file = "file = \"arm.xml\"";
    let at = pad_at(&plan(file, "palm", grid).unwrap());
    assert_eq!(at, DVec3::new(0.5, 0.0, 0.5));
    let bent =
        format!("{file}\njoints = {{ time_s = [0.0], positions = {{ shoulder_deg = [90.0] }} }}");
    let at = pad_at(&plan(&bent, "palm", grid).unwrap());
    assert!((at - DVec3::new(0.0, 0.0, 0.0)).length() < 1e-15, "{at}");
    let draped = "draped = { on = \"collision\", pitch_mm = 2.0 }";
    let covered = plan(file, "lower", draped).unwrap();
    let mut centers = covered.patches[0].skin.layout().centers().iter();
    let half = DVec3::new(0.01, 0.01, 0.02);
    assert!(centers.all(|&center| {
        let out = (center - DVec3::new(0.0, 0.0, 0.1)).abs() - half;
        out.max_element().abs() < 1e-12
    }));
}

#[test]
fn meshes_of_a_package_are_read_from_the_folder_of_the_scenes_key() {
    let case = Case::with("robots/hand.urdf", HAND);
    case.file("elsewhere/meshes/cube.obj", CUBE);
    let plan = |packages: &str| {
        let text = format!(
            "title = \"A hand\"\n[[robots]]\nname = \"left\"\nfile = \"robots/hand.urdf\"\n{packages}\n[[patches]]\nname = \"skin\"\n\
             robot = \"left\"\nlink = \"tip\"\nstroke_mm = 2.0\nlayout = {{ draped = {{ on = \"visual\", pitch_mm = 2.0 }} }}\n"
        );
        plan_in(case.folder(), &text)
    };
    let missing = plan("").unwrap_err().to_string();
    let package = "package://hand_description/meshes/cube.obj: a mesh that is not found; packages = { hand_description = \"FOLDER\" }";
    says(
        &missing,
        &[package, "robots/hand_description/meshes/cube.obj"],
    );
    let found = plan("packages = { hand_description = \"elsewhere\" }").unwrap();
    // The resolved scene finds the package from any folder.
    resolved(&found);
}
