//! Initial poses of objects (free objects must not overlap others), and the part of a mesh that carries taxels.

use crate::command::says;
use crate::scene::{CUBE, frames, plan_in, resolved};
use bubbletouch::report::scene_files::scene_table;
use bubbletouch::scene::{PoseControl, Summary};
use std::fs;

/// Returns a scene with a bed of taxels and objects, each given by a name, a shape, a position (mm) and its motion keys.
fn bed(objects: &[(&str, &str, [f64; 3], &str)]) -> String {
    let objects = objects.iter().map(|(name, shape, position, movement)| {
        format!("[[objects]]\nname = \"{name}\"\n{shape}\nat = {{ position_mm = {position:?} }}\n{movement}\n")
    });
    let objects: String = objects.collect();
    format!(
        "title = \"A bed\"\noutput_hz = 20.0\ndt_ms = 5.0\nduration_s = 0.0\n\
         [[patches]]\nname = \"bed\"\nlayout = {{ grid = {{ nx = 24, ny = 24, pitch_mm = 4.0 }} }}\nstroke_mm = 15.0\n{objects}"
    )
}

const TENNIS: &str = "object = \"tennis\"";
const FREE: &str = "free = { mass_kg = 0.5 }";

#[test]
fn objects_that_touch_within_what_their_spheres_stand_out_are_read_and_so_are_those_deep_in_a_patch()
 {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cube.obj"), CUBE).unwrap();
    let cube = "mesh = \"cube.obj\"\nunit = \"cm\"\nmodel = \"packed\"\nsurface_error_mm = 2.0";
    // One cube on the other, and two balls side by side. The distances between the objects are rounding errors.
    let stack = [
        ("low", cube, [0.0, 0.0, 9.0], FREE),
        ("high", cube, [0.0, 0.0, 29.0], FREE),
    ];
    assert!(plan_in(folder.path(), &bed(&stack)).is_ok());
    let balls = [
        ("a", TENNIS, [0.0, 0.0, 30.0], FREE),
        ("b", TENNIS, [65.4, 0.0, 30.0], FREE),
    ];
    assert!(plan_in(folder.path(), &bed(&balls)).is_ok());
    // The object is deeper in the bed than the stroke, so the stops carry it.
    let free = "free = { mass_kg = 20.0 }";
    let heavy = bed(&[("heavy", TENNIS, [0.0, 0.0, -10.0], free)]);
    let plan = plan_in(folder.path(), &heavy).unwrap();
    assert_eq!(frames(&plan)[0].objects[0].held, PoseControl::AtRest);
    // A cube inside a cube overlaps, although only spheres are compared.
    let inside = [
        ("low", cube, [0.0, 0.0, 9.0], FREE),
        ("high", cube, [1.0, 0.0, 12.0], FREE),
    ];
    let error = plan_in(folder.path(), &bed(&inside)).unwrap_err();
    says(&error.to_string(), &["`high` starts", "inside `low`"]);
}

/// Tube with a square hole along z, outside in one group and inside in another; centimetres.
const TUBE: &str = include_str!("../fixtures/texts/tube.obj");

#[test]
fn a_draped_patch_covers_a_region_of_the_outer_surface_and_says_how_many_taxels_it_leaves_out() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tube.obj"), TUBE).unwrap();
    let text = |region: &str| {
        format!(
            "title = \"A tube\"\n[[patches]]\nname = \"tube\"\nstroke_mm = 2.0\n\
             layout = {{ draped = {{ mesh = \"tube.obj\", unit = \"cm\", pitch_mm = 4.0{region} }} }}\n"
        )
    };
    let layout = |region: &str| {
        let plan = plan_in(folder.path(), &text(region)).unwrap();
        let layout = plan.patches[0].skin.layout().clone();
        assert_eq!(resolved(&plan).patches[0].skin.layout(), &layout);
        (layout, scene_table(&plan, &Summary::default()))
    };
    let (whole, table) = layout("");
    // The walls of the hole face each other: four walls of 20 × 40 mm.
    let n_left_out = whole.n_left_out();
    assert!((150..250).contains(&n_left_out), "{n_left_out}");
    let left_out = "taxels left out, whose axes would meet the mesh again.";
    says(&table, &[format!("Patch tube: {n_left_out} {left_out}")]);
    let is_in_hole = |c: &glam::DVec3| c.x.abs().max(c.y.abs()) < 0.0101 && c.z.abs() < 0.0199;
    assert!(!whole.centers().iter().any(is_in_hole));
    let (outside, table) = layout(", region = { group = \"outside\" }");
    assert!(outside.n_left_out() == 0 && !table.contains("left out"));
    let on_outside = |c: &glam::DVec3| (c.x.abs().max(c.y.abs()) - 0.02).abs() < 1e-12;
    assert!(outside.n_taxels() > 300 && outside.centers().iter().all(on_outside));
    let (ends, _) = layout(", region = { triangles = [16, 31] }");
    assert_eq!(ends, layout(", region = { group = \"ends\" }").0);
    let is_end = |c: &glam::DVec3| (c.z.abs() - 0.02).abs() < 1e-12;
    assert!(ends.centers().iter().all(is_end));
    let (upper, _) = layout(", region = { group = \"ends\", plane_normal = [0.0, 0.0, 3.0] }");
    assert!(upper.centers().iter().all(|c| c.z > 0.0));
    let corner = ", region = { box_min_mm = [0.0, 0.0, 0.0], box_max_mm = [30.0, 30.0, 30.0] }";
    let (corner, _) = layout(corner);
    assert!(corner.centers().iter().all(|c| c.min_element() >= 0.0));
}
