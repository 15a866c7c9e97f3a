//! Layouts that are projected onto a mesh or a robot link.

use crate::scene::{CUBE, plan_in, resolved};
use bubbletouch::scene::ScenePlan;
use glam::DVec3;
use std::fs;

const ROBOT: &str = "<robot name='hand'><link name='base'/><link name='tip'><collision><geometry><sphere radius='0.012'/></geometry></collision></link>\
    <joint name='a' type='fixed'><parent link='base'/><child link='tip'/><origin xyz='0 0 0.1'/></joint></robot>";

/// Returns the plan of a scene with one patch, and checks that its resolved scene gives the same taxels in any folder.
fn plan(layout: &str, more: &str) -> bubbletouch::Result<ScenePlan> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cube.obj"), CUBE).unwrap();
    fs::write(folder.path().join("hand.urdf"), ROBOT).unwrap();
    let text = format!(
        "title = \"A projected array\"\n[[robots]]\nname = \"hand\"\nurdf = \"hand.urdf\"\n\
         [[patches]]\nname = \"skin\"\nstroke_mm = 2.0\n{more}\nlayout = {{ draped = {{ pitch_mm = 4.0, {layout} }} }}\n"
    );
    let plan = plan_in(folder.path(), &text)?;
    let layout = |plan: &ScenePlan| plan.patches[0].skin.layout().clone();
    assert_eq!(layout(&plan), layout(&resolved(&plan)));
    Ok(plan)
}

const ABOVE: &str = "grid = { nx = 4, ny = 3, at = { position_mm = [0.0, 0.0, 15.0] } }";

#[test]
fn a_flat_array_is_projected_onto_a_mesh() {
    let plan = plan(&format!("mesh = \"cube.obj\", unit = \"cm\", {ABOVE}"), "").unwrap();
    let skin = &plan.patches[0].skin;
    assert_eq!(skin.layout().sides(), Some([3, 4]));
    assert!((skin.taxels().at(0).radius - 2e-3).abs() < 1e-15);
    for (taxel, center) in skin.layout().centers().iter().enumerate() {
        let [row, column] = [taxel / 4, taxel % 4].map(|place| place as f64);
        let expected = DVec3::new(4e-3 * (column - 1.5), 4e-3 * (row - 1.0), 0.01);
        assert!((*center - expected).length() < 1e-15, "{center}");
    }
    assert_eq!(skin.layout().axes(), [DVec3::Z; 12]);
    // The grid is turned towards +x, with its rows along −z.
    let turned = "mesh = \"cube.obj\", unit = \"cm\", grid = { nx = 4, ny = 3, at = { position_mm = [15.0, 0.0, 0.0], rotation_deg = [0.0, 90.0, 0.0] } }";
    let plan = self::plan(turned, "").unwrap();
    let layout = plan.patches[0].skin.layout();
    let mut centers = layout.centers().iter();
    assert!(centers.all(|center| (center.x - 0.01).abs() < 1e-15));
    assert_eq!(layout.axes(), [DVec3::X; 12]);
}

#[test]
fn a_flat_array_is_projected_onto_a_link_which_carries_it() {
    let tip = format!("region = {{ link = \"tip\" }}, {ABOVE}");
    let plan = plan(&tip, "robot = \"hand\"").unwrap();
    let skin = &plan.patches[0].skin;
    assert_eq!(plan.spec.patches[0].link.as_deref(), Some("tip"));
    for (center, axis) in skin.layout().centers().iter().zip(skin.layout().axes()) {
        let is_on_ball = (center.length() - 0.012).abs() < 1e-4;
        assert!(is_on_ball && center.z > 0.0, "{center}");
        assert!(axis.dot(center.normalize()) > 0.98, "{axis}");
    }
}

#[test]
fn taxels_beside_the_surface_are_dropped_and_reported() {
    let beside = "mesh = \"cube.obj\", unit = \"cm\", grid = { nx = 4, ny = 3, at = { position_mm = [6.0, 0.0, 15.0] }, missing = \"drop\" }";
    let plan = plan(beside, "").unwrap();
    let layout = plan.patches[0].skin.layout();
    assert_eq!((layout.n_taxels(), layout.n_left_out()), (9, 3));
    assert_eq!(layout.sides(), None);
}
