//! Public URDF files that a strict reader rejects. Each file is read, omitted parts have a note, and the poses of links equal the poses in the file.

use crate::cases::cases;
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{MeshFormat, SizeLimits};
use bubbletouch_sim::world::{JointKind, LinkGeometry, MeshFolders, Robot};
use glam::DVec3;
use std::path::Path;

fn read(text: &str) -> Robot {
    Robot::from_urdf("r.urdf", text).expect(text)
}

/// Returns a robot of two links with `<joint name="j" TYPE>` that contains `inside`; the child is 0.1 m above its parent.
fn jointed(kind: &str, inside: &str) -> Robot {
    read(&format!(
        r#"<robot name="r"><link name="a"/><link name="b"/>
<joint name="j" type="{kind}"><parent link="a"/><child link="b"/><origin xyz="0 0 0.1"/>
{inside}
</joint></robot>"#
    ))
}

/// Returns a robot of one link with this shape.
fn shaped(form: &str) -> Robot {
    read(&format!(
        r#"<robot name="r"><link name="a"><collision>{form}</collision></link></robot>"#
    ))
}

#[track_caller]
fn has_note(robot: &Robot, part: &str) {
    let notes = robot.notes();
    assert!(
        notes.iter().any(|note| note.contains(part)),
        "{notes:?} has no {part:?}"
    );
    assert!(
        notes.iter().all(|note| note.starts_with("r.urdf")),
        "{notes:?}"
    );
}

/// Returns the pose of the second link at rest.
fn second(robot: &Robot) -> Pose {
    let links = robot.forward(&Pose::IDENTITY, &robot.rest_positions());
    links.unwrap()[1]
}

#[test]
fn the_axis_of_a_fixed_or_floating_joint_means_nothing() {
    for axis in [
        r#"<axis xyz="0 0 0"/>"#,
        r#"<axis xzy="1 0"/>"#,
        r#"<axis xyz="nan"/>"#,
    ] {
        for kind in ["fixed", "floating"] {
            let robot = jointed(kind, axis);
            assert!(robot.notes().is_empty(), "{:?}", robot.notes());
            assert_eq!(second(&robot).translation, DVec3::new(0.0, 0.0, 0.1));
        }
    }
}

/// Type of a joint | content of the joint | part of the note.
const UNREADABLE_MOTIONS: &str = r#"
    revolute | <axis xyz="0 0 0"/> | r.urdf, line 3: joint `j` with an axis of length zero; a direction: the joint is fixed
    planar | <axis xyz="0 0 0"/> | axis of length zero
    continuous | <axis xzy="0 0 1"/> | `xzy` in <axis>; perhaps `xyz`: the joint is fixed
    universal | | joint `j` of type `universal`
    continous | | joint `j` of type `continous`; perhaps `continuous`: the joint is fixed
"#;

#[test]
fn a_joint_whose_axis_or_type_cannot_be_read_is_fixed_with_a_note() {
    for [kind, axis, note] in cases(UNREADABLE_MOTIONS) {
        let robot = jointed(&kind, &axis);
        assert_eq!(robot.joints()[0].kind, JointKind::Fixed);
        assert_eq!(robot.n_positions(), 0);
        has_note(&robot, &note);
        assert_eq!(second(&robot).translation, DVec3::new(0.0, 0.0, 0.1));
    }
}

/// Attributes of `<limit>` | lower | upper | velocity | part of the note, if any.
const LIMITS: &str = r#"
    lower="0.2" upper="1.5" | 0.2 | 1.5 | inf |
    lower="-1" upper="1" velocity="-1" effort="2" | -1 | 1 | inf | `velocity` -1; zero or a positive number
    lower="-1" upper="1" velocity="1e999" | -1 | 1 | inf | `velocity` "1e999"; a finite number
    effort="1" velocity="3" | -inf | inf | 3 | without `lower` and `upper`
    lower="1" upper="0" velocity="3" | -inf | inf | 3 | lower limit 1 above upper limit 0; lower ≤ upper
    upper="2" velocity="3" | 0 | 2 | 3 |
"#;

#[test]
fn limits_that_are_missing_or_contradict_themselves_do_not_limit() {
    for [limit, lower, upper, velocity, note] in cases(LIMITS) {
        let robot = jointed("revolute", &format!("<limit {limit}/>"));
        let found = robot.joints()[0].limits.expect("a limit");
        let found = [found.lower, found.upper, found.velocity];
        let expected = [lower, upper, velocity].map(|number| number.parse::<f64>().unwrap());
        assert_eq!(found, expected, "{limit}");
        match note.as_str() {
            "" => assert!(robot.notes().is_empty(), "{:?}", robot.notes()),
            note => has_note(&robot, note),
        }
    }
    let without = jointed("prismatic", "");
    assert_eq!(without.joints()[0].limits, None);
    let note = "joint `j` without <limit>; lower and upper: its position is not limited";
    has_note(&without, note);
}

#[test]
fn a_joint_rests_at_zero_or_at_the_nearest_limit() {
    for (limit, rest) in [
        ("0.2\" upper=\"1.5", 0.2),
        ("-3\" upper=\"-0.5", -0.5),
        ("-3\" upper=\"3", 0.0),
    ] {
        let inside = format!("<axis xyz=\"0 0 1\"/><limit lower=\"{limit}\"/>");
        let robot = jointed("revolute", &inside);
        assert_eq!(robot.rest_positions(), [rest]);
        let (axis, angle) = second(&robot).rotation.to_axis_angle();
        assert!((angle * axis.z - rest).abs() < 1e-15);
    }
}

/// Returns three links in a row: joint `first` with `of_first`, joint `second` with `of_second`, both 0.1 m along x, axes along z.
fn in_a_row(first: &str, second: &str) -> Robot {
    let joint = |name: &str, [a, b]: [&str; 2], inside: &str| {
        let (kind, inside) = inside.split_once(' ').unwrap_or((inside, ""));
        format!(
            r#"<joint name="{name}" type="{kind}"><parent link="{a}"/><child link="{b}"/>
            <origin xyz="0.1 0 0"/><axis xyz="0 0 1"/>{inside}</joint>"#
        )
    };
    let joints = joint("first", ["a", "b"], first) + &joint("second", ["b", "c"], second);
    read(&format!(
        r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>{joints}</robot>"#
    ))
}

#[test]
fn a_joint_that_mimics_a_fixed_one_stands_at_its_offset() {
    let mimic = r#"continuous <mimic joint="first" multiplier="3" offset="0.4"/>"#;
    let robot = in_a_row("fixed", mimic);
    assert_eq!((robot.n_positions(), robot.drive_of(1)), (0, None));
    let tip = robot.forward(&Pose::IDENTITY, &[]).unwrap()[2];
    let (axis, angle) = tip.rotation.to_axis_angle();
    assert!((angle * axis.z - 0.4).abs() < 1e-15, "{angle}");
    assert!((tip.translation - DVec3::new(0.2, 0.0, 0.0)).length() < 1e-15);
}

/// Type of the first joint | attributes of `<mimic>` in the second joint | part of the note.
const LOST_MIMICS: &str = r#"
    floating | joint="first" | joint `second` mimics `first`, which has several coordinates
    continuous | joint="fisrt" | `joint` "fisrt", which is no joint; perhaps `first`
    continuous | joint="first" multiplier="much" | `multiplier` "much"; a finite number: the joint mimics none
"#;

#[test]
fn a_mimic_that_cannot_be_followed_leaves_a_joint_of_its_own() {
    for [first, mimic, note] in cases(LOST_MIMICS) {
        let robot = in_a_row(&first, &format!("continuous <mimic {mimic}/>"));
        assert_eq!(robot.joints()[1].mimic, None);
        assert!(robot.coordinates().iter().any(|c| c.name == "second"));
        has_note(&robot, &note);
    }
    let fixed = in_a_row("continuous", r#"fixed <mimic joint="first"/>"#);
    assert_eq!(fixed.n_positions(), 1);
    has_note(&fixed, "<mimic> in the fixed joint `second`");
}

/// Content of `<geometry>` | part of the note.
const UNREADABLE_SHAPES: &str = r#"
     | <geometry> with 0 forms; exactly one of box, cylinder, capsule, sphere, mesh
    <plane/> | <geometry> with 0 forms
    <box size='1 1'/> | `size` "1 1"; 3 finite numbers
    <sphere radius='-1'/> | `radius` -1; lengths in metres, zero or positive
    <mesh filename='' scale='1 1 1'/> | an empty `filename`
    <mesh filename='a.stl' scale='1 1 1 1'/> | `scale` "1 1 1 1"
    <mesh filename='a.stl' scale='1 0 1'/> | `scale` 1 0 1; three numbers other than zero
"#;

#[test]
fn a_shape_that_cannot_be_read_is_left_out_and_one_of_size_zero_is_kept() {
    for [form, note] in cases(UNREADABLE_SHAPES) {
        let robot = shaped(&format!("<geometry>{form}</geometry>"));
        assert!(robot.links()[0].shapes.is_empty());
        has_note(&robot, &note);
        has_note(&robot, "this shape is left out");
    }
    has_note(&shaped(""), "this shape is left out");
    for form in [
        "<box size='0 0 0'/>",
        "<sphere radius='0'/>",
        "<cylinder radius='0' length='0'/>",
    ] {
        let robot = shaped(&format!("<geometry>{form}</geometry>"));
        assert!(robot.notes().is_empty());
        assert!(!robot.links()[0].shapes[0].geometry.has_volume());
    }
    let nowhere = "package://nowhere/at_all.dae";
    let robot = shaped(&format!(
        "<geometry><mesh filename='{nowhere}'/></geometry>"
    ));
    assert!(
        matches!(&robot.links()[0].shapes[0].geometry, LinkGeometry::Mesh { file, .. } if file == nowhere)
    );
}

#[test]
fn a_spherical_joint_has_three_angles() {
    let robot = jointed("spherical", r#"<axis xyz="0 0 0"/>"#);
    assert!(robot.notes().is_empty(), "{:?}", robot.notes());
    assert_eq!(robot.joints()[0].kind, JointKind::Ball);
    let links = robot.forward(&Pose::IDENTITY, &[0.0, 0.0, std::f64::consts::FRAC_PI_2]);
    let pose = links.unwrap()[1];
    assert!((pose.rotation * DVec3::X - DVec3::Y).length() < 1e-15);
    assert_eq!(pose.translation, DVec3::new(0.0, 0.0, 0.1));
}

#[test]
fn files_with_the_separators_of_windows_and_coded_addresses_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(path("pkg/a b")).unwrap();
    std::fs::write(
        path("pkg/a b/arm.xml"),
        "<mujoco><worldbody><body name='arm'/></worldbody></mujoco>",
    )
    .unwrap();
    std::fs::write(path("pkg/a b/cube.obj"), "").unwrap();
    let main = path("pkg/main.xml");
    std::fs::write(&main, "<mujoco><include file='a b\\arm.xml'/></mujoco>").unwrap();
    let robot = Robot::read(&main).unwrap();
    assert_eq!(robot.links()[1].name, "arm");
    let folders = MeshFolders::beside(&main, Default::default());
    let file = format!("file://{}", path("pkg/a%20b/cube.obj").display());
    for name in [
        "a b\\cube.obj",
        "a%20b/cube.obj",
        "package://pkg/a%20b/cube.obj",
        "package://other/a b\\cube.obj",
        &file,
    ] {
        assert_eq!(
            folders.find(name).unwrap().canonicalize().unwrap(),
            path("pkg/a b/cube.obj").canonicalize().unwrap(),
            "{name}"
        );
    }
    assert!(folders.find("50%zz/cube.obj").is_err());
}

#[test]
fn a_pointer_of_git_lfs_is_named_as_such() {
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
    let expected = "r.urdf: a pointer of Git LFS without the content of the file; the file itself (git lfs pull)";
    let error = Robot::from_bytes("r.urdf", pointer.as_bytes()).unwrap_err();
    assert_eq!(error.to_string(), expected);
    for file in ["a.ply", "a.obj", "a.stl", "a.dae", "a.glb"] {
        let format = MeshFormat::from_path(Path::new(file)).unwrap();
        let read = format.read("r.urdf", None, &SizeLimits::ANY, pointer.as_bytes());
        assert_eq!(read.unwrap_err().to_string(), expected, "{file}");
    }
}

#[test]
fn text_that_is_not_quite_xml_is_read_and_lines_keep_their_numbers() {
    let robot = r#"<robot name="r"><link name="a"/></robot>"#;
    let declaration = r#"<?xml version="1.0" encoding="UTF-8"?>"#;
    for before in [
        "<!-- by a plug-in -->\n",
        "\n",
        "  ",
        "<!-- a -- b --->",
        "\u{feff}\n<!-- x -->",
    ] {
        let found = read(&format!("{before}{declaration}{robot}"));
        has_note(&found, "a comment or space before the XML declaration");
        assert_eq!(found.links()[0].name, "a");
    }
    for text in [
        format!("\u{feff}{declaration}{robot}"),
        format!("{declaration}<?xml-model href=\"x\"?>{robot}\0\0"),
        format!("{declaration}<!DOCTYPE robot>{robot}"),
        format!(
            "{declaration}<!-- -- -->{}",
            robot.replace("<link", "<gazebo:x y:z=\"1\"/><link")
        ),
    ] {
        assert!(read(&text).notes().is_empty(), "{text}");
    }
    let text = format!("<!--\n\n-->\n{declaration}\n<robot name='r'/>");
    let error = Robot::from_urdf("r.urdf", &text).unwrap_err().to_string();
    let expected = "r.urdf, line 5: a robot without a <link>; at least one";
    assert_eq!(error, expected);
    // Declared prefixes of namespaces make the first line longer.
    let text = "<robot name='r'>\n<link name='a'/>\n<a:b/><link/>\n</robot>";
    let error = Robot::from_urdf("r.urdf", text).unwrap_err().to_string();
    assert!(error.starts_with("r.urdf, line 3: <link> "), "{error}");
}

#[test]
fn bytes_of_other_encodings_are_text() {
    let text = "<robot name=\"bras\"><!-- \u{e9} --><link name=\"\u{e9}paule\"/></robot>";
    let latin = text.chars().map(|c| u8::try_from(c).unwrap());
    let latin: Vec<u8> = latin.collect();
    let declaration: &[u8] = b"<?xml version='1.0' encoding='ISO-8859-1'?>";
    let declared = [declaration, &latin].concat();
    let little = || text.encode_utf16().flat_map(u16::to_le_bytes);
    let big = || text.encode_utf16().flat_map(u16::to_be_bytes);
    for (bytes, has_note) in [
        (latin, true),
        (declared, true),
        ([b"\xef\xbb\xbf", text.as_bytes()].concat(), false),
        ([0xFF, 0xFE].into_iter().chain(little()).collect(), false),
        ([0xFE, 0xFF].into_iter().chain(big()).collect(), false),
    ] {
        let robot = Robot::from_bytes("r.urdf", &bytes).unwrap();
        assert_eq!(robot.links()[0].name, "\u{e9}paule");
        let is_latin = robot.notes().concat().contains("Latin-1");
        assert_eq!(is_latin, has_note, "{:?}", robot.notes());
    }
    for bytes in [&b"\x89PNG\r\n\x1a\n\0\0"[..], b"", b"\xFF", b"\xFF\xFE\0"] {
        let error = Robot::from_bytes("r.urdf", bytes).unwrap_err();
        assert_eq!(error.exit_code(), 2);
    }
}

#[test]
fn what_xacro_left_is_passed_over_with_a_note() {
    for leftover in [
        r#"<xacro:macro name="m"/>"#,
        r#"<xacro:include filename="m.xacro"/>"#,
        r#"<gazebo><plugin file="$(find r)/x"/></gazebo>"#,
    ] {
        let text = format!("<robot name='r'>\n{leftover}<link name='a'/></robot>");
        let robot = read(&text);
        has_note(&robot, "of xacro; plain URDF: expand it first");
    }
    // The missing parts are those that xacro would have created.
    let error = Robot::from_urdf("r.urdf", "<robot name='r'>\n<xacro:make_links/></robot>");
    let said = error.unwrap_err().to_string();
    assert!(
        said.starts_with("r.urdf, line 2: <make_links> of xacro; plain URDF"),
        "{said}"
    );
}

#[test]
fn a_robot_without_a_name_and_a_world_without_a_link_are_read() {
    let robot = read("<robot><link name='a'/></robot>");
    assert_eq!(robot.name(), "robot");
    has_note(&robot, "<robot> without `name`");
    let robot = read(
        "<robot name='r'><link name='a'/><joint name='j' type='fixed'><parent link='world'/>
        <child link='a'/><origin xyz='1, 2, 3'/></joint></robot>",
    );
    assert_eq!(robot.links()[robot.base()].name, "world");
    has_note(&robot, "parent `world`, which is no link");
    let links = robot.forward(&Pose::IDENTITY, &[]).unwrap();
    assert_eq!(links[0].translation, DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn a_tactile_sensor_is_named_in_a_note() {
    let tactile = r#"<tactile channel="pad"><array rows="4" cols="6"/></tactile>"#;
    for sensor in [
        format!("<sensor name='pad_tactile'><parent link='a'/>{tactile}</sensor>"),
        format!("<gazebo reference='a'><sensor name='pad_tactile'>{tactile}</sensor></gazebo>"),
    ] {
        let robot = read(&format!("<robot name='r'><link name='a'/>{sensor}</robot>"));
        let note = "tactile sensor `pad_tactile` on link `a` is not read";
        has_note(&robot, note);
    }
    let robot =
        read("<robot name='r'><link name='a'><sensor name='s'><tactile/></sensor></link></robot>");
    has_note(&robot, "tactile sensor `s` on link `a`");
    let camera = "<robot name='r'><link name='a'/><sensor name='s'><camera/></sensor></robot>";
    assert!(read(camera).notes().is_empty());
}

#[test]
fn further_links_that_no_joint_moves_are_fixed_to_the_first_one() {
    let robot = read(
        r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="j" type="fixed"><parent link="c"/><child link="d"/><origin xyz="1 0 0"/></joint></robot>"#,
    );
    assert_eq!(robot.base(), 0);
    let note = "line 1: links `a` and `b`, which no joint moves; one of them: `b` is fixed to `a`";
    has_note(&robot, note);
    has_note(&robot, "`c` is fixed to `a`");
    let base = Pose::from_translation(DVec3::new(0.0, 2.0, 0.0));
    let links = robot.forward(&base, &[]).unwrap();
    let at: Vec<DVec3> = links.iter().map(|link| link.translation).collect();
    let there = base.translation;
    assert_eq!(at, [there, there, there, there + DVec3::X]);
}

#[test]
fn repeated_links_and_joints_are_passed_over() {
    let robot = read(
        r#"<robot name="r"><link name="a"/><link name="b"/>
<link name="b"><collision><geometry><sphere radius="1"/></geometry></collision></link>
<joint name="j" type="fixed"><parent link="a"/><child link="b"/><origin xyz="1 0 0"/></joint>
<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>"#,
    );
    assert_eq!((robot.links().len(), robot.joints().len()), (2, 1));
    assert!(robot.links()[1].shapes.is_empty());
    assert_eq!(second(&robot).translation, DVec3::X);
    let note =
        "line 2: a second link `b` (the first is on line 1); a name of its own: it is passed over";
    has_note(&robot, note);
    has_note(&robot, "line 4: a second joint `j`");
}

#[test]
fn a_missing_link_that_carries_the_whole_robot_is_its_base() {
    let gripper = |inside: &str| {
        let text = format!(
            r#"<robot name="r"><link name="palm"/><link name="finger"/>{inside}
<joint name="mount" type="fixed"><parent link="left_hand"/><child link="palm"/><origin xyz="1 0 0"/></joint>
<joint name="grip" type="fixed"><parent link="palm"/><child link="finger"/></joint></robot>"#
        );
        Robot::from_urdf("r.urdf", &text)
    };
    let robot = gripper("").unwrap();
    assert_eq!(robot.links()[robot.base()].name, "left_hand");
    assert_eq!(second(&robot).translation, DVec3::X);
    let note =
        "parent `left_hand`, which is no link; a <link> of that name: it is the base of the robot";
    has_note(&robot, note);
    // A robot with another base has a misspelt parent.
    let wrong = gripper(r#"<link name="left_hnd"/>"#).unwrap_err();
    let said = "`link` \"left_hand\", which is no link; perhaps `left_hnd`";
    assert!(wrong.to_string().contains(said), "{wrong}");
}

/// A joint's misspelt pose concerns only its own frame if the link has no shapes and moves no other link.
#[test]
fn a_misspelt_attribute_of_a_fixed_frame_is_ignored_with_a_note() {
    let frame = |child: &str, kind: &str, more: &str| {
        let text = format!(
            r#"<robot name="r"><link name="a"/>{child}
<joint name="j" type="{kind}"><parent link="a"/><child link="b"/><origin xyz="0.02 0 0.005" rrpy="0 0.1 0"/>
<limit lower="0" upper="1"/></joint>{more}</robot>"#
        );
        Robot::from_urdf("r.urdf", &text)
    };
    let bare = r#"<link name="b"/>"#;
    let robot = frame(bare, "fixed", "").unwrap();
    let note = "r.urdf, line 2: `rrpy` in <origin>; perhaps `rpy`: the attribute is ignored";
    has_note(&robot, note);
    let expected = Pose::from_translation(DVec3::new(0.02, 0.0, 0.005));
    assert_eq!(second(&robot), expected);
    let solid =
        r#"<link name="b"><collision><geometry><sphere radius="1"/></geometry></collision></link>"#;
    let below = r#"<link name="c"/><joint name="k" type="fixed"><parent link="b"/><child link="c"/></joint>"#;
    for (child, kind, more) in [
        (solid, "fixed", ""),
        (bare, "revolute", ""),
        (bare, "fixed", below),
    ] {
        let error = frame(child, kind, more).unwrap_err().to_string();
        assert!(
            error.contains("line 2: `rrpy` in <origin>; perhaps `rpy`"),
            "{error}"
        );
    }
}

#[test]
fn a_second_end_tag_of_the_root_is_read_with_a_note() {
    let text = "<robot name='r'><link name='a'/></robot>\n";
    for end in ["</robot>", "</robot>\n<!-- end --> </robot>\n"] {
        let robot = read(&format!("{text}{end}"));
        assert_eq!(robot.links().len(), 1);
        has_note(&robot, "a second </robot>");
    }
    let mjcf =
        "<mujoco><worldbody><body name='b'><geom size='0.1'/></body></worldbody></mujoco></mujoco>";
    let notes = Robot::from_mjcf("r.xml", mjcf).unwrap().notes().concat();
    assert!(notes.contains("a second </mujoco>"), "{notes}");
}
