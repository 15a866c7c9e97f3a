//! A chain that has processed one frame makes no allocations for further frames.

use super::{grid, noise, smoothing};
use crate::counting::allocations;
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::{Chain, Recording, SensorError, SignalStep, SignalWorkspace};

#[test]
fn touches_after_the_first_allocate_nothing() {
    let skin = Seed::new(1);
    let steps = [
        SensorError::Hysteresis.step(&[0.1], skin).unwrap(),
        SensorError::Crosstalk.step(&[0.1], skin).unwrap(),
        SensorError::Scan.step(&[100.0], skin).unwrap(),
        SignalStep::Force,
        SensorError::Gain.step(&[0.1], skin).unwrap(),
        SensorError::Drift.step(&[0.1], skin).unwrap(),
        noise(0.1),
        SensorError::Faults.step(&[0.1, 0.1], skin).unwrap(),
        SensorError::Quantisation.step(&[8.0], skin).unwrap(),
        smoothing(2.0),
    ];
    let chain = Chain::new(&steps, &grid(64, 48)).unwrap();
    let mut frames = vec![1e-3; 3 * 64 * 48];
    let rates = vec![0.01; 3 * 64 * 48];
    let mut scratch = SignalWorkspace::default();
    let mut touch = |number| {
        let seed = Seed::new(2018).numbered(number);
        frames.fill(1e-3);
        let recording = Recording {
            frames: &mut frames,
            rates: Some(&rates),
            n_before: 1,
            interval: Some(0.1),
            time: None,
        };
        chain.apply_recording(recording, &seed, &mut scratch);
    };
    assert!(allocations(|| touch(0)) > 0);
    assert_eq!(allocations(|| (1..20).for_each(touch)), 0);
}
