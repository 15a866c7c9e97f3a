//! MJCF files: poses of bodies and sites, default classes, included and attached files, shapes, and wrong files. `python/tests/test_robot.py` compares the
//! poses of random models with MuJoCo's.

use crate::cases::cases;
use bubbletouch_sim::Result;
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::world::{Interpolation, JointKind, JointTrajectory};
use bubbletouch_sim::world::{LinkGeometry, Robot, ShapeRole};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::{Path, PathBuf};

/// Reads the children of `<mujoco>`.
fn read(inside: &str) -> Result<Robot> {
    Robot::from_mjcf("m.xml", &format!("<mujoco>\n{inside}\n</mujoco>"))
}

fn model(inside: &str) -> Robot {
    read(inside).expect(inside)
}

fn pose(robot: &Robot, link: &str, positions: &[f64]) -> Pose {
    robot.forward(&Pose::IDENTITY, positions).unwrap()[robot.link(link).unwrap()]
}

#[track_caller]
fn assert_at(robot: &Robot, link: &str, positions: &[f64], translation: [f64; 3]) {
    let found = pose(robot, link, positions).translation;
    let error = (found - DVec3::from(translation)).length();
    assert!(error < 1e-14, "{link}: {found}");
}

fn names(robot: &Robot) -> Vec<&str> {
    let links = robot.links().iter();
    links.map(|link| link.name.as_str()).collect()
}

#[track_caller]
fn has_note(robot: &Robot, part: &str) {
    let notes = robot.notes();
    assert!(notes.iter().any(|note| note.contains(part)), "{notes:?}");
}

/// Folder with files of models.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        files
            .iter()
            .for_each(|(name, text)| folder.write(name, text));
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        std::fs::write(self.path(name), text).unwrap();
    }

    fn read(&self, name: &str) -> Result<Robot> {
        Robot::read(&self.path(name))
    }
}

#[test]
fn joints_of_one_body_act_one_after_the_other_about_their_anchors_from_their_references() {
    let robot = model(
        r#"<worldbody><body name="arm" pos="1 0 0">
             <joint name="lift" type="slide" axis="0 0 2" ref="0.5"/>
             <joint name="turn" pos="0 1 0" ref="90" range="0 180"/>
             <site name="tip" pos="1 0 0" euler="0 0 90"/>
           </body></worldbody>"#,
    );
    assert_eq!(names(&robot), ["world", "arm", "tip"]);
    assert_eq!(robot.rest_positions(), [0.5, FRAC_PI_2]);
    assert_at(&robot, "arm", &robot.rest_positions(), [1.0, 0.0, 0.0]);
    // Lifted by 0.2, and turned by a quarter about the line through (1, 1).
    let moved = [0.7, PI];
    assert_at(&robot, "arm", &moved, [2.0, 1.0, 0.2]);
    assert_at(&robot, "tip", &moved, [2.0, 2.0, 0.2]);
    let turn = pose(&robot, "tip", &moved).rotation;
    assert!((turn * DVec3::X - DVec3::NEG_X).length() < 1e-15);
    let kinds: Vec<JointKind> = robot.joints().iter().map(|joint| joint.kind).collect();
    use JointKind::{Fixed, Prismatic, Revolute};
    assert_eq!(kinds, [Prismatic, Revolute, Fixed]);
    let limits = robot.joints()[1].limits.unwrap();
    assert_eq!((limits.lower, limits.upper), (0.0, PI));
}

#[test]
fn a_free_body_starts_at_its_pose_and_its_positions_are_its_pose_in_the_world() {
    // A pitch of 90° has no unique roll and yaw.
    for euler in ["0 0 0", "20 90 -35", "10 -90 0", "170 30 -120"] {
        let body = |inside: &str| {
            let body = format!(r#"<body name="ball" pos="1 2 3" euler="{euler}">{inside}</body>"#);
            model(&format!("<worldbody>{body}</worldbody>"))
        };
        let (robot, fixed) = (body(r#"<freejoint name="free"/>"#), body(""));
        let rest = pose(&robot, "ball", &robot.rest_positions());
        let expected = pose(&fixed, "ball", &[]);
        assert_at(&robot, "ball", &robot.rest_positions(), [1.0, 2.0, 3.0]);
        assert!((rest.rotation * DVec3::ONE - expected.rotation * DVec3::ONE).length() < 1e-14);
        let there = [4.0, 5.0, 6.0, 0.1, 0.2, 0.3];
        assert_at(&robot, "ball", &there, [4.0, 5.0, 6.0]);
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
    );
    let axes: Vec<DVec3> = robot.joints()[..5].iter().map(|joint| joint.axis).collect();
    assert_eq!(axes, [DVec3::Z, DVec3::Y, DVec3::X, DVec3::X, DVec3::Y]);
    let rest = robot.rest_positions();
    assert_at(&robot, "deep", &rest, [0.0, 0.0, 1.0]);
    assert_at(&robot, "framed", &rest, [0.0, 0.0, 6.0]);
}

#[test]
fn copies_are_turned_and_shifted_one_after_the_other() {
    let robot = model(
        r#"<worldbody><replicate count="3" sep="_" euler="0 0 90" offset="1 0 0">
             <body name="post" pos="0 0 1"><site name="top"/></body>
           </replicate></worldbody>"#,
    );
    assert_at(&robot, "post_0", &[], [0.0, 0.0, 1.0]);
    assert_at(&robot, "top_1", &[], [1.0, 0.0, 1.0]);
    assert_at(&robot, "post_2", &[], [1.0, 1.0, 1.0]);
    let half_turn = pose(&robot, "post_2", &[]).rotation;
    assert!(half_turn.angle_between(DQuat::from_rotation_z(PI)) < 1e-7);
}

#[test]
fn a_linear_equality_of_two_joints_is_a_mimic_and_others_are_noted() {
    let with = |equalities: &str| {
        let joints = r#"<joint name="a" type="slide" ref="0.1"/><joint name="b" type="slide" ref="0.3"/><joint name="c"/>"#;
        let bodies = format!("<worldbody><body>{joints}</body></worldbody>");
        model(&format!("{bodies}<equality>{equalities}</equality>"))
    };
    let robot = with(
        r#"<joint joint1="b" joint2="a" polycoef="0.01 -2"/><joint joint1="c" joint2="a" active="false"/>"#,
    );
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
        has_note(&with(other), "position of its own");
    }
}

#[test]
fn copies_of_coupled_joints_are_coupled() {
    let robot = model(
        r#"<worldbody><replicate count="2" offset="1 0 0"><body name="b"><joint name="j"/><joint name="k"/></body></replicate>
           <attach body="b" prefix="x_"/></worldbody><equality><joint joint1="k" joint2="j"/></equality>"#,
    );
    for (follower, joint) in [("k0", 0), ("k1", 2), ("x_k", 4)] {
        let mimic = robot.joints()[robot.joint(follower).unwrap()].mimic;
        assert_eq!(mimic.map(|mimic| mimic.joint), Some(joint), "{follower}");
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
    );
    let shapes = &robot.links()[1].shapes;
    let roles: Vec<ShapeRole> = shapes.iter().map(|shape| shape.role).collect();
    let (visual, collision) = (ShapeRole::Visual, ShapeRole::Collision);
    let expected = [visual, collision, visual, collision, visual, collision];
    assert_eq!(roles, expected);
    let LinkGeometry::Mesh {
        file,
        mesh_from_file,
        scale,
    } = &shapes[0].geometry
    else {
        panic!("{:?}", shapes[0]);
    };
    let mirrored = DVec3::new(1.0, 1.0, -1.0);
    assert_eq!((file.as_str(), *scale), ("parts/hull.stl", mirrored));
    assert_eq!(mesh_from_file.translation, DVec3::new(-1.0, -2.0, -3.0));
    let (radius, length) = (0.01, 2.0);
    let capsule = LinkGeometry::Capsule { radius, length };
    assert_eq!(shapes[1].geometry, capsule);
    assert_eq!(shapes[1].origin.translation, DVec3::Z);
    let size = DVec3::new(0.2, 0.4, 0.6);
    assert_eq!(shapes[5].geometry, LinkGeometry::Box { size });
    has_note(
        &robot,
        "m.xml, line 11: a cylinder fitted to mesh `cap`; type \"mesh\"",
    );
    has_note(
        &robot,
        "are ignored: actuator (2), light (1), option (1), plane (1), texture (1)",
    );
    assert_eq!(robot.notes().len(), 2);
}

#[test]
fn included_files_are_read_from_the_folder_of_the_model_or_of_the_including_file() {
    let folder = Folder::new(&[
        (
            "main.xml",
            "<mujoco>\n<!-- <include file='none.xml'/> -->\n<include file='parts/all.xml'/>\n<worldbody><include file='hand.xml'/></worldbody></mujoco>",
        ),
        (
            "parts/all.xml",
            "<mujocoinclude>\n<include file='deep.xml'/></mujocoinclude>",
        ),
        (
            "parts/deep.xml",
            "<mujoco><compiler angle='radian'/></mujoco>",
        ),
        (
            "parts/self.xml",
            "<mujoco><include file='../parts/self.xml'/></mujoco>",
        ),
        ("broken.xml", "<mujoco><compiler"),
    ]);
    let hand = |joint: &str| {
        let body = format!("<body name='hand'>\n<joint {joint}/></body>");
        folder.write("hand.xml", &format!("<include>\n{body}</include>"));
        folder.read("main.xml")
    };
    assert_eq!(hand("ref='1'").unwrap().rest_positions(), [1.0]);
    let wrong = hand("axis='0 0'").unwrap_err().to_string();
    let place = "hand.xml, line 3: `axis` \"0 0\"";
    assert!(wrong.contains(place), "{wrong}");
    folder.write(
        "parts/deep.xml",
        "<mujoco><include file='all.xml'/></mujoco>",
    );
    for (file, said) in [
        ("parts/all.xml", "included twice"),
        (
            "parts/self.xml",
            "parts/self.xml, line 1: `../parts/self.xml`, a file that is included twice",
        ),
        ("none.xml", "line 2: `none.xml`, a file that is not found"),
        ("broken.xml", "well-formed XML"),
    ] {
        let text = format!("<mujoco>\n<include file='{file}'/></mujoco>");
        folder.write("other.xml", &text);
        let error = folder.read("other.xml").unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
}

#[test]
fn sites_with_the_name_of_a_body_are_told_apart() {
    let robot = model(
        r#"<worldbody><body name="pad" pos="0 0 1"><site name="pad" pos="1 0 0"/><site/></body></worldbody>"#,
    );
    assert_at(&robot, "pad", &[], [0.0, 0.0, 1.0]);
    assert_at(&robot, "pad_site", &[], [1.0, 0.0, 1.0]);
    has_note(&robot, "its link is called `pad_site`");
}

#[test]
fn joints_that_stay_at_a_default_beyond_their_range_are_no_error() {
    let robot = model(
        r#"<worldbody><body><joint name="a" range="10 20"/><body><joint name="b" range="-90 90"/></body></body></worldbody>"#,
    );
    let along = |positions: [[f64; 2]; 2]| {
        let positions = ndarray::arr2(&positions);
        JointTrajectory::new(&robot, vec![0.0, 1.0], positions, Interpolation::Linear)
    };
    assert!(along([[0.0, 0.0], [0.0, 1.0]]).is_ok());
    let moved = along([[0.0, 0.0], [0.1, 1.0]]).unwrap_err().to_string();
    assert!(moved.contains("joint `a`"), "{moved}");
}

/// Children of `<mujoco>` | part of the message. `W` stands for the world, and `B` for a body in the world.
const WRONG_MODELS: &str = r#"
    <worldbody><body> | well-formed XML
    W<body pos="0 0"/> | line 2: `pos` "0 0"
    W<body pos="0 nan 0"/> | line 2: `pos` "0 nan 0"
    W<body pos="0 0 inf"/> | 3 finite numbers
    W<body quat="0 0 0 0"/> | `quat` of length zero
    W<body zaxis="0 0 0"/> | `zaxis` with a direction of length zero
    W<body xyaxes="1 0 0 2 0 0"/> | `xyaxes` with a direction
    W<body quat="1 0 0 0" euler="0 0 0"/> | quat and euler; one orientation
    B<joint axis="0 0 0"/> | axis of length zero
    B<joint type="hing"/> | `type` "hing"
    B<joint raneg="0 1"/> | perhaps `range`
    B<joint range="1 0"/> | range 1 to 0
    B<joint class="x"/> | which is no default class
    B<joint type="free"/><joint/> | only joint of a body in <worldbody>
    W<joint/> | a joint of the world
    W<body name="a"/>\n<body name="a"/> | line 3: a second body `a` (the first is on line 2)
    W<bdy/> | perhaps <body>
    W<replicate count="2.5"/> | `count` 2.5
    W<replicate count="10001"/> | `count` 10001; an integer from 0 to 10000
    W<site name="s" fromto="0 0 0 0 0 0"/> | `fromto` of length zero
    <compiler eulerseq="xyw"/> | three of x, y, z, X, Y, Z
    <compiler angle="grad"/> | one of `degree`, `radian`
    <compiler coordinate="global"/> | MuJoCo 2.3.3
    <asset><mesh/></asset> | a name or a file
    <asset><mesh file="a.stl" scale="1 0 1"/></asset> | `scale` 1 0 1; three numbers other than zero
    <equality><joint joint1="none"/></equality> | `joint1` "none", which is no joint
    <default><default/></default> | the attribute `class`
    W<attach prefix="p_"/> | <attach> without `model`; the attribute `model`
    W<attach body="b"/> | `body` "b", which is no body of the model
    W<body name="x"><attach body="x" prefix="p"/></body> | too many elements inside each other; at most 500
"#;

#[test]
fn wrong_models_are_refused_with_their_file_and_line() {
    for [inside, said] in cases(WRONG_MODELS) {
        let inside = match inside.split_at(1) {
            ("W", inside) => format!("<worldbody>{inside}</worldbody>"),
            ("B", inside) => format!("<worldbody><body>{inside}</body></worldbody>"),
            _ => inside,
        };
        let error = read(&inside).expect_err(&inside);
        let message = error.to_string();
        let has_line = message.starts_with("m.xml, line ");
        assert!(has_line && message.contains(&said), "{inside}: {message}");
        assert_eq!(error.exit_code(), 2);
    }
    let other = Robot::from_bytes("m.xml", b"<sdf/>").unwrap_err();
    let said = "URDF: a <robot>, or MJCF: a <mujoco>";
    assert!(other.to_string().contains(said), "{other}");
}

#[test]
fn an_attached_model_has_its_prefix_frame_mimics_and_meshes() {
    let part = "<mujoco><asset><mesh name='m' file='m.obj'/></asset><worldbody><body name='a' pos='0 0 1'><joint name='j' axis='0 1 0'/>\
                <body name='b' pos='1 0 0'><joint name='k' axis='0 1 0'/><geom type='mesh' mesh='m'/><site name='tip' pos='0 1 0'/></body></body>\
                <body name='c'/></worldbody><equality><joint joint1='k' joint2='j'/></equality></mujoco>";
    let main = "<mujoco><asset><model name='p' file='parts/part.xml'/></asset><worldbody>\
                <frame pos='2 0 0'><attach model='p' body='a' prefix='x_'/></frame></worldbody></mujoco>";
    let folder = Folder::new(&[("parts/part.xml", part), ("main.xml", main)]);
    let robot = folder.read("main.xml").unwrap();
    assert!(robot.notes().is_empty(), "{:?}", robot.notes());
    assert_eq!(names(&robot), ["world", "x_a", "x_b", "x_tip"]);
    // The second joint follows the first, so the last link is turned by half a revolution.
    let moved = pose(&robot, "x_b", &[FRAC_PI_2]);
    assert!((moved.translation - 2.0 * DVec3::X).length() < 1e-12);
    assert!((moved.rotation * DVec3::X + DVec3::X).length() < 1e-12);
    let LinkGeometry::Mesh { file, .. } = &robot.links()[2].shapes[0].geometry else {
        panic!("a mesh");
    };
    assert_eq!(Path::new(file), folder.path("parts/m.obj"));
}

/// As in MuJoCo, `<attach>` places a body alone, without the frames around it in its own model.
#[test]
fn an_attached_body_leaves_the_frames_around_it() {
    let framed = "<frame pos='0 0 1'><body name='b' pos='1 0 0'/></frame>";
    let model = |inside: &str| {
        let asset = "<asset><model name='p' file='part.xml'/></asset>";
        format!("<mujoco>{asset}<worldbody>{inside}</worldbody></mujoco>")
    };
    let attached = model("<attach model='p' body='b' prefix='x_'/>");
    let within = model(&format!("{framed}<attach body='b' prefix='x_'/>"));
    let part = format!("<mujoco><worldbody>{framed}</worldbody></mujoco>");
    for main in [attached, within] {
        let folder = Folder::new(&[("main.xml", &main), ("part.xml", &part)]);
        let robot = folder.read("main.xml").unwrap();
        assert_at(&robot, "x_b", &[], [1.0, 0.0, 0.0]);
    }
}

#[test]
fn an_aligned_free_joint_has_a_note() {
    for inside in [
        "<worldbody><body name='a'><freejoint align='true'/></body></worldbody>",
        "<compiler alignfree='true'/><worldbody><body name='a'><joint type='free'/></body></worldbody>",
    ] {
        has_note(&model(inside), "the body keeps its frame");
    }
}
