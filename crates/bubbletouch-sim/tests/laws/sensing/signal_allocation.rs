//! A chain that has processed one frame makes no allocations for further frames.

use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::{
    Chain, Noise, NoiseUnit, Recording, SensorError, SignalStep, SignalWorkspace,
};
use bubbletouch_sim::world::{Grid, Patch, Taxel};

use crate::counting::allocations;

#[test]
fn touches_after_the_first_allocate_nothing() {
    let grid = Grid {
        nx: 64,
        ny: 48,
        pitch: 2e-3,
    };
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.4,
        stroke: 5e-3,
    };
    let noise = SignalStep::Noise(Noise {
        std: 0.1,
        unit: NoiseUnit::FullScale,
    });
    let smoothing = SignalStep::Smoothing { width: 4e-3 };
    let skin = Seed::new(1);
    let steps = [
        SensorError::Hysteresis.step(&[0.1], skin).unwrap(),
        SensorError::Crosstalk.step(&[0.1], skin).unwrap(),
        SensorError::Scan.step(&[1e3 * 0.1], skin).unwrap(),
        SignalStep::Force,
        SensorError::Gain.step(&[0.1], skin).unwrap(),
        SensorError::Drift.step(&[0.1], skin).unwrap(),
        noise,
        SensorError::Faults.step(&[0.1, 0.1], skin).unwrap(),
        SensorError::Quantisation.step(&[8.0], skin).unwrap(),
        smoothing,
    ];
    let chain = Chain::new(&steps, &Patch::grid(grid, taxel).unwrap()).unwrap();
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
