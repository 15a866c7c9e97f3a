//! Free objects that are triangle meshes.

use crate::command::filled;
use crate::scene::{frames, plan_in, plan_shipped, shipped};
use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::geometry::Pose;
use bubbletouch::scene::{Frame, Movement, PoseControl, ScenePlan};
use glam::DVec3;
use std::fs;

const BOX: &str = "v -15 -11 -9\nv 15 -11 -9\nv -15 11 -9\nv 15 11 -9\nv -15 -11 9\nv 15 -11 9\nv -15 11 9\nv 15 11 9\n\
    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
/// Tray of 60 mm width and 14 mm height, with walls of 4 mm. Its origin is the middle of its base.
const TRAY: &str = "v -30 -30 0\nv 30 -30 0\nv 30 30 0\nv -30 30 0\nv -30 -30 14\nv 30 -30 14\nv 30 30 14\nv -30 30 14\n\
    v -26 -26 14\nv 26 -26 14\nv 26 26 14\nv -26 26 14\nv -26 -26 4\nv 26 -26 4\nv 26 26 4\nv -26 26 4\n\
    f 1 4 3 2\nf 13 14 15 16\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 10 9\nf 6 7 11 10\nf 7 8 12 11\nf 8 5 9 12\n\
    f 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n";

/// Bed that rises by 20 mm.
const RISING: &str = "[[robots]]\nname = \"bed\"\nfloating = true\n\
    motion = { interpolation = \"monotone\", way_points = [\n    { time_s = 0.0 },\n    \
    { time_s = 0.2 },\n    { time_s = 0.6, position_mm = [0.0, 0.0, 20.0] },\n] }\n";

fn plan(objects: &str) -> bubbletouch::Result<ScenePlan> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("box.obj"), BOX).unwrap();
    fs::write(folder.path().join("tray.obj"), TRAY).unwrap();
    let open = BOX.replace("f 5 6 8 7\n", "");
    fs::write(folder.path().join("open.obj"), open).unwrap();
    let text = format!(
        "title = \"A bed\"\noutput_hz = 20.0\ndt_ms = 5.0\nduration_s = 0.0\n\
         [[patches]]\nname = \"bed\"\nlayout = {{ grid = {{ nx = 40, ny = 40, pitch_mm = 2.5 }} }}\n\
         stroke_mm = 6.0\nstiffness_n_per_m = 60.0\n{objects}"
    );
    plan_in(folder.path(), &text)
}

/// Returns a free object of a mesh file, at a position in mm.
fn mesh(name: &str, file: &str, position: [f64; 3], mass: f64) -> String {
    format!(
        "[[objects]]\nname = \"{name}\"\nmesh = \"{file}\"\nunit = \"mm\"\nmodel = \"mesh\"\n\
         at = {{ position_mm = {position:?}, rotation_deg = [0.0, 0.0, 12.0] }}\nfree = {{ mass_kg = {mass:?} }}\n"
    )
}

fn first_frame(plan: &ScenePlan) -> Frame {
    frames(plan).remove(0)
}

#[test]
fn a_box_rests_in_a_tray_and_the_bed_carries_both() {
    let objects = mesh("tray", "tray.obj", [1.0, 0.5, 3.0], 0.1)
        + &mesh("box", "box.obj", [4.0, -3.0, 18.0], 0.05);
    let plan = plan(&objects).unwrap();
    let frame = first_frame(&plan);
    for (object, mass) in frame.objects.iter().zip([0.1, 0.05]) {
        assert_eq!(object.held, PoseControl::AtRest);
        let balance = object.balance.unwrap();
        assert!(balance.imbalance <= 1e-6, "{}", balance.imbalance);
        assert!((balance.force - DVec3::new(0.0, 0.0, mass * 9.81)).length() < 1e-6 * mass * 9.81);
    }
    let force = frame.patches[0].wrench.force.z;
    assert!((force + 0.15 * 9.81).abs() < 1e-5, "{force} N");
    // The forces between the two meshes carry the box.
    let between: DVec3 = frame.touches.iter().map(|touch| touch.force).sum();
    assert!((between.z.abs() - 0.05 * 9.81).abs() < 1e-5, "{between}");
    // The recorded deflections are those of a press at the final poses.
    let poses: Vec<Pose> = frame.objects.iter().map(|object| object.pose).collect();
    let mut workspace = Workspace::new();
    Press::new(&plan.patches[0].skin, &plan.models, &poses, Until::Pose)
        .with_contacts()
        .run(&mut workspace)
        .unwrap();
    assert_eq!(frame.patches[0].deflection, workspace.deflections());
}

#[test]
fn a_block_in_the_shipped_cup_comes_to_rest() {
    let frame = first_frame(&plan_shipped(&shipped("block_in_cup.toml")));
    let held: Vec<_> = frame.objects.iter().map(|object| object.held).collect();
    assert_eq!(held, [PoseControl::AtRest; 2]);
    let force = frame.patches[0].wrench.force.z;
    assert!((force + 0.25 * 9.81).abs() < 1e-5, "{force} N");
}

/// Turned, a corner of the block slides past the border of the floor and below the wall that rises there; the wall must stay a contact. The bed then rises by
/// 20 mm with both.
#[test]
fn a_turned_block_in_the_shipped_cup_rests_and_rises_with_the_bed() {
    let shipped = shipped("block_in_cup.toml");
    for yaw in [20.0, 33.0, 61.0] {
        let turned = shipped
            .replace("[8.0, 5.0, 0.0]", &format!("[8.0, 5.0, {yaw:?}]"))
            .replace("duration_s = 0.0\n", "")
            .replace(
                "[[patches]]\n",
                &format!("{RISING}[[patches]]\nrobot = \"bed\"\n"),
            );
        let frames = frames(&plan_shipped(&turned));
        let height = |frame: &Frame| frame.objects[0].pose.translation.z;
        let (first, last) = (&frames[0], frames.last().unwrap());
        assert!((height(last) - height(first) - 20e-3).abs() < 1e-3, "{yaw}");
        for frame in &frames {
            for object in &frame.objects {
                assert_eq!(object.held, PoseControl::AtRest, "{yaw}");
                let imbalance = object.balance.unwrap().imbalance;
                assert!(imbalance <= 1e-6, "{yaw}: {imbalance}");
            }
        }
    }
}

/// Robot with a patch of skin, as the finger of a gripper: approaches along the world's x-axis by `approach` mm/s, then rises.
fn finger(name: &str, x_mm: f64, tilt_deg: f64, approach: f64) -> String {
    filled(
        include_str!("../fixtures/texts/scene_meshes_finger.toml"),
        &[
            ("name", &name),
            ("x_mm", &x_mm),
            ("tilt_deg", &tilt_deg),
            ("approach", &approach),
        ],
    )
}

/// Returns a scene in which fingers grasp a block on a table.
fn grasp(fingers: &str, dt_ms: f64, mesh: &str, height_mm: f64) -> String {
    filled(
        include_str!("../fixtures/texts/scene_meshes_grasp.toml"),
        &[
            ("fingers", &fingers),
            ("dt_ms", &dt_ms),
            ("mesh", &mesh),
            ("height_mm", &height_mm),
        ],
    )
}

/// The taxels hold the block by friction: half of its weight each, while it hangs above the table.
#[test]
fn two_fingers_grasp_a_free_mesh_and_lift_it_from_a_table() {
    let fingers = finger("left", -18.0, 90.0, 20.0) + &finger("right", 18.0, -90.0, -20.0);
    let scene = grasp(&fingers, 5.0, "block.obj", 10.0);
    let frames = frames(&plan_shipped(&scene));
    for frame in &frames {
        assert_eq!(frame.objects[0].held, PoseControl::AtRest);
        let imbalance = frame.objects[0].balance.unwrap().imbalance;
        assert!(imbalance <= 1e-6, "{imbalance}");
    }
    let height = |frame: &Frame| frame.objects[0].pose.translation.z;
    let risen = height(frames.last().unwrap()) - height(&frames[0]);
    // The shear springs yield a little.
    assert!((risen - 4e-3).abs() < 5e-4, "{risen}");
}

#[test]
fn a_packed_mesh_has_the_centre_of_mass_of_the_mesh() {
    let tray = mesh("tray", "tray.obj", [1.0, 0.5, 3.0], 0.1);
    let tray = tray.replace("\"mesh\"\n", "\"packed\"\nsurface_error_mm = 1.0\n");
    let plan = plan(&tray).unwrap();
    let Movement::Free { center_of_mass, .. } = plan.objects[0].movement else {
        panic!("the tray is free")
    };
    let [outer, inner] = [60.0 * 60.0 * 14.0, 52.0 * 52.0 * 10.0];
    let height = 1e-3 * (7.0 * outer - 9.0 * inner) / (outer - inner);
    let off = center_of_mass.distance(height * DVec3::Z);
    assert!(off < 1e-12, "{center_of_mass}");
    assert!(plan.models[0].spheres().is_some());
}

#[test]
fn open_and_overlapping_meshes_beside_others_are_refused() {
    let said = |objects: String| {
        let error = plan(&objects).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    };
    let tray = mesh("tray", "tray.obj", [1.0, 0.5, 3.0], 0.1);
    let open = said(tray.clone() + &mesh("box", "open.obj", [4.0, -3.0, 18.0], 0.05));
    let words = "s.toml, key objects.box.mesh: an open mesh, beside another object in a scene with a free object; a closed mesh, or model = \"vertex_spheres\": an open mesh has no inside";
    assert_eq!(open, words);
    // The lower corners of the box are 2 mm below the floor of the tray.
    let inside = said(tray + &mesh("box", "box.obj", [4.0, -3.0, 14.0], 0.05));
    let words = "s.toml, key objects.box.at: free object `box` starts 2.0 mm inside `tray`; free objects that overlap no other object at the start";
    assert_eq!(inside, words);
    // Alone on the skin, an open mesh has a contact without an inside.
    let alone = plan(&mesh("box", "open.obj", [0.0, 0.0, 12.0], 0.05)).unwrap();
    assert_eq!(first_frame(&alone).objects[0].held, PoseControl::AtRest);
}

/// The edges of the block lie exactly on rows of taxels, where a small shift lowers the energy.
#[test]
fn friction_holds_a_box_whose_edges_lie_on_rows_of_taxels_from_the_first_touch() {
    let folder = tempfile::tempdir().unwrap();
    let corner = |k: usize| [(k & 1, 20.0), (k >> 1 & 1, 14.0), (k >> 2, 17.0)];
    let corners = (0..8).map(|k| {
        let [x, y, z] = corner(k).map(|(side, size)| size * (side as f64 - 0.5));
        format!("v {x} {y} {z}\n")
    });
    let faces = BOX.lines().filter(|line| line.starts_with('f'));
    let text = corners.collect::<String>() + &faces.collect::<Vec<_>>().join("\n");
    fs::write(folder.path().join("box.obj"), text).unwrap();
    let cases = [
        [5.0, 0.0, 0.8],
        [5.0, 1.0, 0.8],
        [2.0, 1.0, 2.0],
        [5.0, 0.3, 2.0],
    ];
    for [dt_ms, lag_mm, friction] in cases {
        let fingers =
            finger("left", -14.0, 90.0, 20.0) + &finger("right", 14.0 + lag_mm, -90.0, -20.0);
        let rise = "    { duration_s = 0.1, linear_mm_per_s = [0.0, 0.0, 40.0] },\n";
        let fingers = fingers.replace(rise, "");
        let fingers = fingers.replace("friction = 0.8", &format!("friction = {friction:?}"));
        let scene = grasp(&fingers, dt_ms, "box.obj", 8.5);
        let frames = frames(&plan_in(folder.path(), &scene).unwrap());
        let case = format!("dt {dt_ms} ms, lag {lag_mm} mm, friction {friction}");
        // Where both fingers touch at once, the box stays. One finger alone presses a box that slides on the table with no force, so nothing holds it.
        let shift = if lag_mm == 0.0 { 1e-6 } else { 2e-4 };
        for frame in &frames {
            let place = frame.objects[0].pose.translation;
            assert_eq!(frame.objects[0].held, PoseControl::AtRest, "{case}");
            assert!(place.y.abs() < shift, "{case}: {place}");
        }
        // Eight columns and nine rows of taxels press the box, also those on its edges. Without friction, one of these columns would leave it.
        let expected = 72.0 * 400.0 * (1e-3 - 0.5e-3 * lag_mm);
        for patch in &frames.last().unwrap().patches {
            let off = patch.wrench.force.length() / expected - 1.0;
            assert!(off.abs() < 5e-3, "{case}: {off}");
        }
    }
}
