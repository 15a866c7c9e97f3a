//! MJCF files: poses of bodies and sites, default classes, included files, shapes, and wrong files. `python/tests/test_robot.py` compares the poses of random
//! models with MuJoCo's.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::world::{JointKind, LinkGeometry, Robot, ShapeRole};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

/// Reads the children of `<mujoco>`.
fn model(inside: &str) -> bubbletouch_sim::Result<Robot> {
    Robot::from_mjcf("m.xml", &format!("<mujoco>\n{inside}\n</mujoco>"))
}

fn pose(robot: &Robot, link: &str, positions: &[f64]) -> Pose {
    robot.forward(&Pose::IDENTITY, positions).unwrap()[robot.link(link).unwrap()]
}

#[track_caller]
fn assert_at(pose: &Pose, translation: [f64; 3]) {
    let error = (pose.translation - DVec3::from(translation)).length();
    assert!(error < 1e-14, "{pose:?}");
}

#[test]
fn joints_of_one_body_act_one_after_the_other_about_their_anchors_from_their_references() {
    let robot = model(
        r#"<worldbody><body name="arm" pos="1 0 0">
             <joint name="lift" type="slide" axis="0 0 2" ref="0.5"/>
             <joint name="turn" pos="0 1 0" ref="90" range="0 180"/>
             <site name="tip" pos="1 0 0" euler="0 0 90"/>
           </body></worldbody>"#,
    )
    .unwrap();
    let names: Vec<&str> = robot
        .links()
        .iter()
        .map(|link| link.name.as_str())
        .collect();
    assert_eq!(names, ["world", "arm", "tip"]);
    assert_eq!(robot.rest_positions(), [0.5, FRAC_PI_2]);
    assert_at(
        &pose(&robot, "arm", &robot.rest_positions()),
        [1.0, 0.0, 0.0],
    );
    // Lifted by 0.2, and turned by a quarter about the line through (1, 1).
    let moved = [0.7, PI];
    assert_at(&pose(&robot, "arm", &moved), [2.0, 1.0, 0.2]);
    assert_at(&pose(&robot, "tip", &moved), [2.0, 2.0, 0.2]);
    let turn = pose(&robot, "tip", &moved).rotation;
    assert!((turn * DVec3::X - DVec3::NEG_X).length() < 1e-15);
    let kinds: Vec<JointKind> = robot.joints().iter().map(|joint| joint.kind).collect();
    assert_eq!(
        kinds,
        [JointKind::Prismatic, JointKind::Revolute, JointKind::Fixed]
    );
    let limits = robot.joints()[1].limits.unwrap();
    assert_eq!((limits.lower, limits.upper), (0.0, PI));
}

#[test]
fn a_free_body_starts_at_its_pose_and_its_positions_are_its_pose_in_the_world() {
    // A pitch of 90° has no unique roll and yaw.
    for euler in ["0 0 0", "20 90 -35", "10 -90 0", "170 30 -120"] {
        let robot = model(&format!(
            r#"<worldbody><body name="ball" pos="1 2 3" euler="{euler}"><freejoint name="free"/></body></worldbody>"#
        ))
        .unwrap();
        let fixed = model(&format!(
            r#"<worldbody><body name="ball" pos="1 2 3" euler="{euler}"/></worldbody>"#
        ))
        .unwrap();
        let rest = pose(&robot, "ball", &robot.rest_positions());
        let expected = pose(&fixed, "ball", &[]);
        assert_at(&rest, [1.0, 2.0, 3.0]);
        assert!(rest.rotation.angle_between(expected.rotation) < 1e-7);
        assert!((rest.rotation * DVec3::ONE - expected.rotation * DVec3::ONE).length() < 1e-14);
        assert_at(
            &pose(&robot, "ball", &[4.0, 5.0, 6.0, 0.1, 0.2, 0.3]),
            [4.0, 5.0, 6.0],
        );
    }
}

#[test]
fn attributes_come_from_the_element_then_its_class_then_the_classes_around() {
    let robot = model(
        r#"<compiler angle="radian"/>
           <default class="root"><joint type="slide" axis="1 0 0"/>
             <default class="y"><joint axis="0 1 0"/><default class="deep"><site pos="0 0 1"/></default></default>
           </default>
           <worldbody><body name="a" childclass="y">
             <joint name="own" axis="0 0 1"/>
             <joint name="of_body"/>
             <joint name="of_root" class="root"/>
             <joint name="of_main" class="main"/>
             <site name="deep" class="deep"/>
             <body name="b"><joint name="inherited"/>
               <frame childclass="deep" pos="0 0 5"><site name="framed"/></frame></body>
           </body></worldbody>"#,
    )
    .unwrap();
    let axes: Vec<DVec3> = robot.joints()[..5].iter().map(|joint| joint.axis).collect();
    assert_eq!(axes, [DVec3::Z, DVec3::Y, DVec3::X, DVec3::X, DVec3::Y]);
    let rest = robot.rest_positions();
    assert_at(&pose(&robot, "deep", &rest), [0.0, 0.0, 1.0]);
    assert_at(&pose(&robot, "framed", &rest), [0.0, 0.0, 6.0]);
}

#[test]
fn copies_are_turned_and_shifted_one_after_the_other() {
    let robot = model(
        r#"<worldbody><replicate count="3" sep="_" euler="0 0 90" offset="1 0 0">
             <body name="post" pos="0 0 1"><site name="top"/></body>
           </replicate></worldbody>"#,
    )
    .unwrap();
    assert_at(&pose(&robot, "post_0", &[]), [0.0, 0.0, 1.0]);
    assert_at(&pose(&robot, "top_1", &[]), [1.0, 0.0, 1.0]);
    assert_at(&pose(&robot, "post_2", &[]), [1.0, 1.0, 1.0]);
    let half_turn = pose(&robot, "post_2", &[]).rotation;
    assert!(half_turn.angle_between(DQuat::from_rotation_z(PI)) < 1e-7);
}

#[test]
fn a_linear_equality_of_two_joints_is_a_mimic_and_others_are_noted() {
    let joints = r#"<worldbody><body><joint name="a" type="slide" ref="0.1"/><joint name="b" type="slide" ref="0.3"/>
        <joint name="c"/></body></worldbody>"#;
    let robot = model(&format!(
        r#"{joints}<equality><joint joint1="b" joint2="a" polycoef="0.01 -2"/><joint joint1="c" joint2="a" active="false"/></equality>"#
    ))
    .unwrap();
    // b − 0.3 = 0.01 − 2 (a − 0.1)
    let mimic = robot.joints()[1].mimic.unwrap();
    assert_eq!((mimic.joint, mimic.multiplier), (0, -2.0));
    assert!((mimic.offset - 0.51).abs() < 1e-15);
    assert_eq!(robot.n_positions(), 2);
    for other in [
        r#"<joint joint1="b" joint2="a" polycoef="0 1 0.5"/>"#,
        r#"<joint joint1="b"/>"#,
        r#"<joint joint1="a" joint2="b"/><joint joint1="b" joint2="a"/>"#,
    ] {
        let robot = model(&format!("{joints}<equality>{other}</equality>")).unwrap();
        let mut notes = robot.notes().iter();
        assert!(
            notes.any(|note| note.contains("position of its own")),
            "{other}"
        );
    }
}

#[test]
fn geoms_are_shapes_with_the_roles_that_mujoco_gives_them() {
    let robot = model(
        r#"<compiler meshdir="parts" strippath="true"/>
           <asset><mesh name="hull" file="old/hull.stl" scale="1 1 -1" refpos="1 2 3"/><mesh file="cap.obj"/><texture name="t"/></asset>
           <default><default class="visual"><geom contype="0" conaffinity="0" group="2"/></default>
             <default class="collision"><geom group="3" type="capsule" size="0.01"/></default></default>
           <worldbody><light pos="0 0 1"/><geom type="plane" size="1 1 1"/><body name="a">
             <geom class="visual" type="mesh" mesh="hull"/>
             <geom class="collision" fromto="0 0 0 0 0 2"/>
             <geom type="ellipsoid" size="1 2 3"/>
             <geom type="box" size="0.1 0.2 0.3" pos="0 0 1"/>
             <geom type="cylinder" mesh="cap"/>
           </body></worldbody>
           <actuator><motor joint="j"/><motor joint="k"/></actuator><option timestep="0.01"/>"#,
    )
    .unwrap();
    let shapes = &robot.links()[1].shapes;
    let roles: Vec<ShapeRole> = shapes.iter().map(|shape| shape.role).collect();
    let (visual, collision) = (ShapeRole::Visual, ShapeRole::Collision);
    assert_eq!(
        roles,
        [visual, collision, visual, collision, visual, collision]
    );
    let LinkGeometry::Mesh {
        file,
        mesh_from_file,
        scale,
    } = &shapes[0].geometry
    else {
        panic!("{:?}", shapes[0]);
    };
    assert_eq!(
        (file.as_str(), *scale),
        ("parts/hull.stl", DVec3::new(1.0, 1.0, -1.0))
    );
    assert_eq!(mesh_from_file.translation, DVec3::new(-1.0, -2.0, -3.0));
    let capsule = LinkGeometry::Capsule {
        radius: 0.01,
        length: 2.0,
    };
    assert_eq!(shapes[1].geometry, capsule);
    assert_eq!(shapes[1].origin.translation, DVec3::Z);
    let sides = LinkGeometry::Box {
        size: DVec3::new(0.2, 0.4, 0.6),
    };
    assert_eq!(shapes[5].geometry, sides);
    let [fitted, ignored] = robot.notes() else {
        panic!("{:?}", robot.notes());
    };
    assert!(
        fitted.contains("m.xml, line 11: a cylinder fitted to mesh `cap`"),
        "{fitted}"
    );
    assert_eq!(
        ignored,
        "m.xml: elements that determine neither poses nor shapes are ignored: actuator (2), light (1), option (1), plane (1), texture (1)"
    );
}

#[test]
fn included_files_are_read_from_the_folder_of_the_model_or_of_the_including_file() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    };
    let main = write(
        "main.xml",
        "<mujoco>\n<!-- <include file=\"none.xml\"/> -->\n<include file=\"parts/all.xml\"/>\n<worldbody><include file=\"hand.xml\"/></worldbody></mujoco>",
    );
    write(
        "parts/all.xml",
        "<mujocoinclude>\n<include file=\"deep.xml\"/></mujocoinclude>",
    );
    write(
        "parts/deep.xml",
        "<mujoco><compiler angle=\"radian\"/></mujoco>",
    );
    write(
        "hand.xml",
        "<mujocoinclude>\n<body name=\"hand\">\n<joint name=\"j\" ref=\"1\"/></body></mujocoinclude>",
    );
    let robot = Robot::read(&main).unwrap();
    assert_eq!(robot.rest_positions(), [1.0]);
    write(
        "hand.xml",
        "<mujocoinclude>\n<body name=\"hand\">\n<joint axis=\"0 0\"/></body></mujocoinclude>",
    );
    let wrong = Robot::read(&main).unwrap_err().to_string();
    assert!(
        wrong.contains("hand.xml, line 3: `axis` \"0 0\""),
        "{wrong}"
    );
    write(
        "parts/deep.xml",
        "<mujoco><include file=\"all.xml\"/></mujoco>",
    );
    for (file, said) in [
        ("parts/all.xml", "included twice"),
        ("none.xml", "line 2: `none.xml`, a file that is not found"),
        ("broken.xml", "well-formed XML"),
    ] {
        write("broken.xml", "<mujoco><compiler");
        let other = write(
            "other.xml",
            &format!("<mujoco>\n<include file=\"{file}\"/></mujoco>"),
        );
        let error = Robot::read(&other).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
}

#[test]
fn sites_with_the_name_of_a_body_are_told_apart() {
    let robot = model(
        r#"<worldbody><body name="pad" pos="0 0 1"><site name="pad" pos="1 0 0"/><site/></body></worldbody>"#,
    )
    .unwrap();
    assert_at(&pose(&robot, "pad", &[]), [0.0, 0.0, 1.0]);
    assert_at(&pose(&robot, "pad_site", &[]), [1.0, 0.0, 1.0]);
    assert!(robot.notes()[0].contains("its link is called `pad_site`"));
}

#[test]
fn joints_that_stay_at_a_default_beyond_their_range_are_no_error() {
    use bubbletouch_sim::world::{Interpolation, JointTrajectory};
    let robot = model(
        r#"<worldbody><body><joint name="a" range="10 20"/><body><joint name="b" range="-90 90"/></body></body></worldbody>"#,
    )
    .unwrap();
    let along = |positions: [[f64; 2]; 2]| {
        let positions = ndarray::arr2(&positions);
        JointTrajectory::new(&robot, vec![0.0, 1.0], positions, Interpolation::Linear)
    };
    assert!(along([[0.0, 0.0], [0.0, 1.0]]).is_ok());
    let moved = along([[0.0, 0.0], [0.1, 1.0]]).unwrap_err().to_string();
    assert!(moved.contains("joint `a`"), "{moved}");
}

#[test]
fn wrong_models_are_refused_with_their_file_and_line() {
    for (inside, said) in [
        ("<worldbody><body>", "well-formed XML"),
        (
            "<worldbody><body pos=\"0 0\"/></worldbody>",
            "line 2: `pos` \"0 0\"",
        ),
        (
            "<worldbody><body pos=\"0 nan 0\"/></worldbody>",
            "line 2: `pos` \"0 nan 0\"",
        ),
        (
            "<worldbody><body pos=\"0 0 inf\"/></worldbody>",
            "3 finite numbers",
        ),
        (
            "<worldbody><body quat=\"0 0 0 0\"/></worldbody>",
            "`quat` of length zero",
        ),
        (
            "<worldbody><body zaxis=\"0 0 0\"/></worldbody>",
            "`zaxis` with a direction of length zero",
        ),
        (
            "<worldbody><body xyaxes=\"1 0 0 2 0 0\"/></worldbody>",
            "`xyaxes` with a direction",
        ),
        (
            "<worldbody><body quat=\"1 0 0 0\" euler=\"0 0 0\"/></worldbody>",
            "quat and euler; one orientation",
        ),
        (
            "<worldbody><body><joint axis=\"0 0 0\"/></body></worldbody>",
            "axis of length zero",
        ),
        (
            "<worldbody><body><joint type=\"hing\"/></body></worldbody>",
            "`type` \"hing\"",
        ),
        (
            "<worldbody><body><joint raneg=\"0 1\"/></body></worldbody>",
            "perhaps `range`",
        ),
        (
            "<worldbody><body><joint range=\"1 0\"/></body></worldbody>",
            "range 1 to 0",
        ),
        (
            "<worldbody><body><joint class=\"x\"/></body></worldbody>",
            "which is no default class",
        ),
        (
            "<worldbody><body><joint type=\"free\"/><joint/></body></worldbody>",
            "only joint of a body in <worldbody>",
        ),
        ("<worldbody><joint/></worldbody>", "a joint of the world"),
        (
            "<worldbody><body name=\"a\"/>\n<body name=\"a\"/></worldbody>",
            "line 3: a second body `a` (the first is on line 2)",
        ),
        ("<worldbody><bdy/></worldbody>", "perhaps <body>"),
        (
            "<worldbody><replicate count=\"2.5\"/></worldbody>",
            "`count` 2.5",
        ),
        (
            "<worldbody><site name=\"s\" fromto=\"0 0 0 0 0 0\"/></worldbody>",
            "`fromto` of length zero",
        ),
        ("<compiler eulerseq=\"xyw\"/>", "three of x, y, z, X, Y, Z"),
        ("<compiler angle=\"grad\"/>", "one of `degree`, `radian`"),
        ("<compiler coordinate=\"global\"/>", "MuJoCo 2.3.3"),
        ("<asset><mesh/></asset>", "a name or a file"),
        (
            "<asset><mesh file=\"a.stl\" scale=\"1 0 1\"/></asset>",
            "other than zero",
        ),
        (
            "<equality><joint joint1=\"none\"/></equality>",
            "`joint1` \"none\", which is no joint",
        ),
        ("<default><default/></default>", "the attribute `class`"),
    ] {
        let error = model(inside)
            .map(|robot| robot.notes().to_vec())
            .unwrap_err();
        let message = error.to_string();
        assert!(
            message.starts_with("m.xml, line ") && message.contains(said),
            "{inside}: {message}"
        );
        assert_eq!(error.exit_code(), 2);
    }
    let other = Robot::from_bytes("m.xml", b"<sdf/>")
        .unwrap_err()
        .to_string();
    assert!(
        other.contains("URDF: a <robot>, or MJCF: a <mujoco>"),
        "{other}"
    );
}

#[test]
fn an_attached_model_has_its_prefix_frame_mimics_and_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::create_dir(path("parts")).unwrap();
    let part = "<mujoco><asset><mesh name='m' file='m.obj'/></asset><worldbody><body name='a' pos='0 0 1'><joint name='j' axis='0 1 0'/>\
                <body name='b' pos='1 0 0'><joint name='k' axis='0 1 0'/><geom type='mesh' mesh='m'/><site name='tip' pos='0 1 0'/></body></body>\
                <body name='c'/></worldbody><equality><joint joint1='k' joint2='j'/></equality></mujoco>";
    std::fs::write(path("parts/part.xml"), part).unwrap();
    let main = "<mujoco><asset><model name='p' file='parts/part.xml'/></asset><worldbody>\
                <frame pos='2 0 0'><attach model='p' body='a' prefix='x_'/></frame></worldbody></mujoco>";
    std::fs::write(path("main.xml"), main).unwrap();
    let robot = Robot::read(&path("main.xml")).unwrap();
    assert!(robot.notes().is_empty(), "{:?}", robot.notes());
    let names: Vec<&str> = robot
        .links()
        .iter()
        .map(|link| link.name.as_str())
        .collect();
    assert_eq!(names, ["world", "x_a", "x_b", "x_tip"]);
    let poses = robot.forward(&Pose::IDENTITY, &[FRAC_PI_2]).unwrap();
    // The second joint follows the first, so the last link is turned by half a revolution.
    assert!((poses[2].translation - DVec3::new(2.0, 0.0, 0.0)).length() < 1e-12);
    assert!((poses[2].rotation * DVec3::X + DVec3::X).length() < 1e-12);
    let LinkGeometry::Mesh { file, .. } = &robot.links()[2].shapes[0].geometry else {
        panic!("a mesh");
    };
    assert_eq!(Path::new(file), path("parts/m.obj"));
}

#[test]
fn an_aligned_free_joint_has_a_note() {
    for text in [
        "<mujoco><worldbody><body name='a'><freejoint align='true'/></body></worldbody></mujoco>",
        "<mujoco><compiler alignfree='true'/><worldbody><body name='a'><joint type='free'/></body></worldbody></mujoco>",
    ] {
        let robot = Robot::from_mjcf("m.xml", text).unwrap();
        let notes = robot.notes();
        assert!(
            notes
                .iter()
                .any(|note| note.contains("the body keeps its frame")),
            "{notes:?}"
        );
    }
}
