//! A valid scene, whose changes are refused in `tests/refusals/scenes.toml`.

use bubbletouch::scene::{ScenePlan, SceneSpec};
use std::path::Path;

const SCENE: &str = include_str!("../fixtures/texts/arm.toml");

fn plan(text: &str) -> ScenePlan {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let spec = SceneSpec::parse("s.toml", text).unwrap();
    ScenePlan::new("s.toml", folder, spec).unwrap()
}

#[test]
fn the_good_scene_is_good() {
    let plan = plan(SCENE);
    assert_eq!((plan.n_frames, plan.n_substeps), (101, 10));
    assert_eq!(plan.spec.duration_s, Some(1.0));
    assert!(plan.needs_steps());
}

#[test]
fn the_normal_of_a_plane_has_any_length() {
    let plane = "name = \"table\"\npoint_mm = [0.0, 0.0, 7.0]\nnormal = [0.0, 3.0, 4.0]";
    let tilted = plan(&format!("{SCENE}[[planes]]\n{plane}")).planes[0];
    assert!((tilted.height - 5.6e-3).abs() < 1e-15 && (tilted.normal.z - 0.8).abs() < 1e-15);
}
