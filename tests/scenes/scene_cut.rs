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
    let text = include_str!("../fixtures/texts/scene_cut_text.toml");
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
