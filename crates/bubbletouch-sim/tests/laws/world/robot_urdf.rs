//! Robots from URDF: poses of links, and error messages of invalid files.

use crate::cases::{cases, replaced};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{Dimension, JointKind, LinkGeometry, Robot, ShapeRole};
use bubbletouch_sim::{Error, Result};
use glam::{DMat3, DQuat, DVec3};
use rand::Rng;

/// Returns the text of the arm in the project's own robots.
fn arm_urdf() -> String {
    std::fs::read_to_string("../../objects/robots/arm.urdf").unwrap()
}

const SIX_AXIS: &str = include_str!("../../robots/six_axis.urdf");
const GRIPPER: &str = include_str!("../../robots/gripper.urdf");
const ROVER: &str = include_str!("../../robots/rover.urdf");
/// Link poses computed by another program, robots/forward.py.
const FORWARD: &str = include_str!("../../robots/forward.csv");

fn robot(text: &str) -> Robot {
    Robot::from_urdf("robot.urdf", text).expect("a sound robot")
}

fn numbers(words: &str) -> Vec<f64> {
    let number = |word: &str| word.parse().expect("a number");
    words.split_whitespace().map(number).collect()
}

#[test]
fn every_link_is_where_an_independent_program_has_it() {
    let mut n_poses = 0;
    for line in FORWARD.lines().skip(1) {
        let [name, positions, link, pose] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("four columns: {line}");
        };
        let robot = robot(match name {
            "six_axis" => SIX_AXIS,
            "gripper" => GRIPPER,
            _ => ROVER,
        });
        let found = robot.forward(&Pose::IDENTITY, &numbers(positions)).unwrap();
        let found = found[robot.link(link).unwrap()];
        let expected = numbers(pose);
        let rotation = DMat3::from_quat(found.rotation).transpose().to_cols_array();
        let found = [found.translation.to_array().as_slice(), &rotation].concat();
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "{line}: {found:?}");
        }
        n_poses += 1;
    }
    assert_eq!(n_poses, 6 * (8 + 6 + 5));
}

#[test]
fn moving_the_base_moves_all_links_alike() {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -1.0, 2.0));
    let base = Pose::new(turn, DVec3::new(4.0, -3.0, 0.5));
    for text in [&arm_urdf(), SIX_AXIS, GRIPPER, ROVER] {
        let robot = robot(text);
        let positions: Vec<f64> = (0..robot.n_positions())
            .map(|i| 0.1 + 0.07 * i as f64)
            .collect();
        let still = robot.forward(&Pose::IDENTITY, &positions).unwrap();
        let moved = robot.forward(&base, &positions).unwrap();
        assert_eq!(moved[robot.base()], base);
        for (still, moved) in still.iter().zip(&moved) {
            let expected = base.compose(still);
            for point in [DVec3::ZERO, DVec3::X, DVec3::Y] {
                let apart = expected.transform_point(point) - moved.transform_point(point);
                assert!(apart.length() < 1e-14, "{apart}");
            }
        }
    }
}

#[test]
fn a_floating_robot_is_where_its_base_is() {
    let robot = Robot::floating("probe");
    let base = Pose::from_translation(DVec3::X);
    assert_eq!(robot.forward(&base, &[]).unwrap(), [base]);
    assert_eq!(robot.link("probe").unwrap(), 0);
}

#[test]
fn the_shipped_arm_stands_as_tall_as_it_says() {
    let arm = robot(&arm_urdf());
    assert_eq!((arm.n_positions(), arm.links().len()), (7, 9));
    let up = arm.forward(&Pose::IDENTITY, &[0.0; 7]).unwrap();
    let tip = up[arm.link("fingertip").unwrap()].transform_point(DVec3::new(0.0, 0.0, 0.08));
    assert!((tip - DVec3::new(0.0, 0.0, 1.19)).length() < 1e-15, "{tip}");
    let moving = arm.joints().iter().filter(|it| it.kind != JointKind::Fixed);
    for limits in moving.map(|joint| joint.limits.expect("limits of a revolute joint")) {
        assert!(limits.lower < 0.0 && limits.upper > 0.0 && limits.velocity > 1.0);
    }
    let mut shapes = arm.links().iter().flat_map(|link| &link.shapes);
    assert_eq!(shapes.clone().count(), 22);
    assert!(shapes.all(|shape| shape.role == ShapeRole::Collision));
}

#[test]
fn positions_stand_in_the_order_of_the_file_without_those_that_mimic() {
    use Dimension::{Angle, Length};
    let (gripper, rover) = (robot(GRIPPER), robot(ROVER));
    for (robot, n, index, name, dimension) in [
        (&gripper, 2, 0, "left", Angle),
        (&gripper, 2, 1, "probe", Length),
        (&rover, 13, 2, "roam.theta", Angle),
        (&rover, 13, 11, "fly.yaw", Angle),
    ] {
        assert_eq!(robot.n_positions(), n);
        let found = &robot.coordinates()[index];
        assert_eq!((found.name.as_str(), found.dimension), (name, dimension));
    }
}

#[test]
fn what_skin_needs_of_a_link_is_kept() {
    let robot = robot(SIX_AXIS);
    let upper = &robot.links()[robot.link("upper_arm").unwrap()];
    let [visual, collision] = upper.shapes.as_slice() else {
        panic!("two shapes: {:?}", upper.shapes);
    };
    let roles = (visual.role, collision.role);
    assert_eq!(roles, (ShapeRole::Visual, ShapeRole::Collision));
    let mesh = LinkGeometry::Mesh {
        mesh_from_file: Pose::IDENTITY,
        file: "package://six_axis/meshes/upper_arm.stl".to_owned(),
        scale: DVec3::splat(1e-3),
    };
    assert_eq!(visual.geometry, mesh);
    let end = collision.origin.transform_point(DVec3::new(0.0, 0.0, 0.19));
    let apart = end - DVec3::new(0.38, 0.0, 0.12);
    assert!(apart.length() < 1e-15, "{end}");
}

#[test]
fn a_folder_is_no_urdf_file() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(Robot::read(folder.path()).unwrap_err().exit_code(), 2);
}

/// Robot | text | wrong text | message after `r.urdf, line `.
const BROKEN_FILES: &str = r#"
    arm | <parent link="base"/> | <parent link="flange"/> | 20: links in a circle: `shoulder` → `upper_arm` → `forearm` → `wrist_1` → `wrist_2` → `wrist_3` → `flange` → `shoulder`; a tree: no link carries itself
    arm | <parent link="base"/><child link="shoulder"/> | <parent link="base"/><child link="base"/> | 20: links in a circle: `base` → `base`; a tree: no link carries itself
    arm | <child link="forearm"/> | <child link="forarm"/> | 33: `link` "forarm", which is no link; perhaps `forearm`
    arm | <child link="forearm"/> | <child link="shoulder"/> | 32: link `shoulder` is the child of `pan` and of `elbow`; one joint that moves a link: a tree
    arm | <joint name="elbow" | <joint name="lift" | 32: a second joint `lift` (the first is on line 26); a name of its own
    arm | xyz="-0.4187 0.002 0.0013" | xyz="-0.4187 nan 0.0013" | 34: `xyz` "-0.4187 nan 0.0013"; 3 finite numbers with spaces between
    arm | <origin xyz="0 0 0.0874" rpy="0 0 3.1"/> | <orgin xyz="0 0 0.0874" rpy="0 0 3.1"/> | 22: <orgin>; perhaps <origin>
    gripper | <mimic joint="left"/> | <mimic joint="screw"/> | 5: joints mimic each other in a circle: `right_tip` → `right` → `screw` → `right_tip`; a chain that ends in a joint without <mimic>
    rover | xyz="1 2 0.05" | xyz="${width / 2} 2 0.05" | 11: <origin> of xacro; plain URDF: expand it first (xacro robot.urdf.xacro > robot.urdf)
    rover | <link name="board"/> | <link name="board"/\n> | 6: expected '>' not ' '; URDF: well-formed XML
    rover | <link name="board"/> | <link name="board"> | 28: expected 'link' tag, not 'robot'; URDF: well-formed XML
"#;

#[test]
fn every_broken_file_is_refused_in_one_sentence_with_its_line() {
    for [robot, old, new, sentence] in cases(BROKEN_FILES) {
        let text = match robot.as_str() {
            "arm" => SIX_AXIS,
            "gripper" => GRIPPER,
            _ => ROVER,
        };
        let error = Robot::from_urdf("r.urdf", &replaced(text, &old, &new)).expect_err(&new);
        assert_eq!(error.exit_code(), 2);
        assert_eq!(error.to_string(), format!("r.urdf, line {sentence}"));
    }
    let empty = Robot::from_urdf("r.urdf", " \n").unwrap_err().to_string();
    assert_eq!(empty, "r.urdf: an empty file; URDF: a <robot>");
}

#[test]
fn names_that_are_not_there_are_met_with_those_that_resemble_them() {
    let arm = robot(&arm_urdf());
    let mut positions = [0.0; 7];
    positions[3] = f64::NAN;
    let forward = |positions| arm.forward(&Pose::IDENTITY, positions).unwrap_err();
    for (error, sentence) in [
        (
            arm.link("fore_arm").unwrap_err(),
            "link of robot `arm`: `fore_arm`; perhaps `forearm`",
        ),
        (
            arm.joint("knee").unwrap_err(),
            "joint of robot `arm`: `knee`; one of `shoulder_turn`, ",
        ),
        (forward(&[0.0; 6]), "positions of robot `arm`: 6; 7 of them"),
        (
            forward(&positions),
            "position `elbow_bend` of robot `arm`: NaN; a finite number",
        ),
    ] {
        assert!(error.to_string().starts_with(sentence), "{error}");
    }
}

/// Reads a robot of one link with one shape.
fn one_shape(inside: &str) -> Result<Robot> {
    let text = format!("<robot name='r'><link name='l'><visual>{inside}</visual></link></robot>");
    Robot::from_urdf("r.urdf", &text)
}

#[test]
fn a_quaternion_is_read_where_roll_pitch_and_yaw_are() {
    let ball = "<geometry><sphere radius='1'/></geometry>";
    let shape = |origin: &str| {
        let robot = one_shape(&format!("<origin xyz='1 2 3' {origin}/>{ball}"));
        robot.map(|robot| robot.links()[0].shapes[0].origin)
    };
    let angles = shape("rpy='0 0 1.5707963267948966'").unwrap();
    let quaternion = shape("quat_xyzw='0 0 0.7071 0.7071'").unwrap();
    assert!(angles.rotation.dot(quaternion.rotation).abs() > 1.0 - 1e-15);
    assert_eq!(angles.translation, quaternion.translation);
    let note = |origin: &str| {
        let robot = one_shape(&format!("<origin xyz='1 2 3' {origin}/>{ball}")).unwrap();
        assert!(robot.links()[0].shapes.is_empty());
        robot.notes().concat()
    };
    assert_eq!(
        note("quat_xyzw='0 0 1 1'"),
        "r.urdf, line 1: a quaternion of length 1.4142135623730951; length 1: this shape is left out"
    );
    assert_eq!(
        note("rpy='0 0 0' quat_xyzw='0 0 0 1'"),
        "r.urdf, line 1: both `rpy` and `quat_xyzw`; one of them: this shape is left out"
    );
}

#[test]
fn every_form_is_read() {
    let (radius, length) = (0.5, 2.0);
    let size = DVec3::new(1.0, 2.0, 3.0);
    for (form, expected) in [
        ("box size='1 2 3'", LinkGeometry::Box { size }),
        (
            "cylinder radius='0.5' length='2'",
            LinkGeometry::Cylinder { radius, length },
        ),
        (
            "capsule radius='0.5' length='2'",
            LinkGeometry::Capsule { radius, length },
        ),
        ("sphere radius='0.5'", LinkGeometry::Sphere { radius }),
    ] {
        let robot = one_shape(&format!("<geometry><{form}/></geometry>")).unwrap();
        assert_eq!(robot.links()[0].shapes[0].geometry, expected);
    }
}

#[test]
fn other_tools_elements_are_passed_over() {
    let with_more = SIX_AXIS.replacen(
        r#"<link name="shoulder"/>"#,
        r#"<link name="shoulder"><inertial><mass value="2"/></inertial><sensor name="s"/></link>
           <gazebo reference="shoulder"><mu1>0.2</mu1></gazebo>
           <transmission name="t"><joint name="pan"><hardwareInterface>x</hardwareInterface></joint></transmission>"#,
        1,
    );
    // A default namespace, as some tools write it.
    let with_more = with_more.replacen("<robot ", r#"<robot xmlns="http://example.org/urdf" "#, 1);
    let (with_more, plain) = (robot(&with_more), robot(SIX_AXIS));
    let positions = [0.3; 6];
    assert_eq!(
        with_more.forward(&Pose::IDENTITY, &positions).unwrap(),
        plain.forward(&Pose::IDENTITY, &positions).unwrap()
    );
}

#[test]
fn a_chain_of_fifty_thousand_links_is_read_and_moved() {
    let n = 50_000;
    let mut text = String::from("<robot name='chain'><link name='l0'/>");
    for i in 1..n {
        text += &format!("<link name='l{i}'/><joint name='j{i}' type='continuous'>");
        let before = i - 1;
        text += &format!("<parent link='l{before}'/><child link='l{i}'/><origin xyz='1 0 0'/>");
        if i > 1 {
            text += &format!("<mimic joint='j{before}'/>");
        }
        text += "</joint>";
    }
    let robot = robot(&(text + "</robot>"));
    assert_eq!(robot.n_positions(), 1);
    let poses = robot.forward(&Pose::IDENTITY, &[0.0]).unwrap();
    assert_eq!(poses[n - 1].translation.x, (n - 1) as f64);
}

/// Returns the text with random damage, as careless editing or a broken disk may cause.
fn mutilated(text: &str, rng: &mut impl Rng) -> String {
    const VALUES: &str =
        ",nan,inf,-1,0,1e999,1e-320,1e300 1e300 1e300,1 2,0 0 0,base,fixed,floating,left";
    let values: Vec<&str> = VALUES.split(',').collect();
    let written = values[rng.gen_range(0..values.len())];
    let spans = |open: &str, close: &str| -> Vec<(usize, usize)> {
        let starts = text.match_indices(open).map(|(at, _)| at + open.len());
        let span = |start: usize| {
            let length = text[start..].find(close)?;
            Some((start - 1, start + length + 1))
        };
        starts.filter_map(span).collect()
    };
    let mut tags = spans("<", ">");
    if rng.gen_bool(0.8) {
        // Without these tags the text is still valid XML.
        tags.retain(|&(_, end)| text[..end].ends_with("/>"));
    }
    let values = spans("=\"", "\"");
    let mut pick = |all: &[(usize, usize)]| all[rng.gen_range(0..all.len())];
    let ((tag, tag_end), (other, other_end)) = (pick(&tags), pick(&tags));
    let (value, value_end) = pick(&values);
    let cut = |from: usize, to: usize, new: &str| format!("{}{new}{}", &text[..from], &text[to..]);
    match rng.gen_range(0..7) {
        0 => cut(tag, tag_end, ""),
        1 => cut(tag, tag_end, &text[other..other_end]),
        2 => cut(tag, tag, &text[other..other_end]),
        3 | 4 => cut(value, value_end, &format!("\"{written}\"")),
        5 => cut(value, value_end - 1, ""),
        _ => {
            let inside = text[tag..tag_end]
                .find(' ')
                .map_or(tag + 1, |space| tag + space + 1);
            cut(
                inside,
                inside + usize::from(text.is_char_boundary(inside + 1)),
                "x",
            )
        }
    }
}

#[test]
fn a_mutilated_file_is_a_robot_or_bad_input_and_never_a_panic() {
    let mut rng = Seed::new(2018).named("mutilated robots").rng();
    let (mut n_sound, mut n_refused) = (0, 0);
    let hand = std::fs::read_to_string("../../objects/robots/five_finger_hand.xml").unwrap();
    let sound = [&arm_urdf(), SIX_AXIS, GRIPPER, ROVER, &hand];
    for case in 0..2500 {
        let mut text = sound[case % sound.len()].to_owned();
        for _ in 0..rng.gen_range(1..3) {
            text = mutilated(&text, &mut rng);
        }
        match Robot::from_bytes("r.urdf", text.as_bytes()) {
            Ok(robot) => {
                n_sound += 1;
                for position in [0.0, 1.3] {
                    let positions = vec![position; robot.n_positions()];
                    let poses = robot.forward(&Pose::IDENTITY, &positions).unwrap();
                    assert_eq!(poses.len(), robot.links().len());
                }
            }
            Err(Error::Input { place, .. }) => {
                n_refused += 1;
                assert!(place.starts_with("r.urdf"), "{place}");
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!(n_sound > 200 && n_refused > 1000, "{n_sound}, {n_refused}");
}
