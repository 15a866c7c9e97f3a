//! Test that a scene with an early end gives the first frames of the complete scene, with and without damping and friction.

use bubbletouch::scene::{Frame, ScenePlan, SceneSpec, Simulation, Stepping};
use std::path::Path;

fn frames(plan: &ScenePlan) -> Vec<Frame> {
    let mut frames = Vec::new();
    let mut simulation = Simulation::new(plan, Stepping::AsNeeded);
    simulation.run(&mut [&mut frames]).unwrap();
    frames
}

#[test]
fn the_frames_of_a_scene_that_ends_early_are_its_first_ones() {
    let text = r#"
        title = "A ball on a damped skin whose zeros drift"
        output_hz = 20.0
        [[patches]]
        name = "pad"
        layout = { grid = { nx = 8, ny = 8, pitch_mm = 4.0 } }
        stroke_mm = 5.0
        damping_n_s_per_m = 2.0
        friction = 0.4
        signal = [{ drift_std_full_scale = 0.05 }, { noise_std_full_scale = 0.01 }]
        [[objects]]
        name = "ball"
        object = "golf"
        at = { position_mm = [0.0, 0.0, 4.0] }
        motion = { phases = [{ duration_s = 1.0, linear_mm_per_s = [2.0, 0.0, -5.0] }] }
        "#;
    let spec = SceneSpec::parse("s.toml", text).unwrap();
    let whole = ScenePlan::new("s.toml", Path::new(""), spec).unwrap();
    let all = frames(&whole);
    assert!(all[12].patches[0].n_touched > 0);
    for until in [0.0, 0.33, 0.6, 1.0] {
        let mut cut = whole.clone();
        cut.cut("the test", until).unwrap();
        let first = frames(&cut);
        assert_eq!(first.len(), 1 + (20.0 * until) as usize);
        assert_eq!(first[..], all[..first.len()], "{until}");
    }
}
