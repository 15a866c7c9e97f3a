//! Signals of skins in scenes: they equal a signal chain that is applied frame by frame, and an invalid chain is refused by its key.

use crate::command::filled;
use crate::scene::{frames, plan, recorded};
use bubbletouch::random::Seed;
use bubbletouch::scene::ScenePlan;
use bubbletouch::signal::{
    Chain, Noise, NoiseUnit, Quantity, Recording, SensorError, SignalStep, SignalWorkspace,
};
use ndarray::Array2;
use ndarray_npy::NpzReader;

fn sensed(signal: &str) -> ScenePlan {
    plan(&filled(
        include_str!("../fixtures/texts/scene_signal_try_plan.toml"),
        &[("signal", &signal)],
    ))
}

const SIGNAL: &str = r#"signal = ["force", { crosstalk = 0.2 }, { smoothing_mm = 3.0 }, { gain_std = 0.1 },
    { drift_std_full_scale = 0.05 }, { noise_std_n = 0.01 }, { dead_fraction = 0.05, stuck_fraction = 0.02 }, { adc_bits = 8 }]"#;

#[test]
fn the_signal_of_a_frame_is_what_the_chain_makes_of_its_forces() {
    let (plan, bare) = (sensed(SIGNAL), sensed(""));
    let (frames, bare) = (frames(&plan), frames(&bare));
    assert!(bare.iter().any(|frame| frame.patches[0].n_touched > 10));
    let seed = Seed::new(2018);
    let skin = seed.named("skin").named("finger");
    let noise = Noise {
        std: 0.01,
        unit: NoiseUnit::N,
    };
    let steps = [
        SensorError::Crosstalk.step(&[0.2], skin).unwrap(),
        SignalStep::Smoothing { width: 3e-3 },
        SensorError::Gain.step(&[0.1], skin).unwrap(),
        SensorError::Drift.step(&[0.05], skin).unwrap(),
        SignalStep::Noise(noise),
        SensorError::Faults.step(&[0.05, 0.02], skin).unwrap(),
        SensorError::Quantisation.step(&[8.0], skin).unwrap(),
    ];
    let chain = Chain::with_quantity(&steps, &plan.patches[0].skin, Quantity::Force).unwrap();
    for (number, (frame, bare)) in frames.iter().zip(&bare).enumerate() {
        let (reading, bare) = (&frame.patches[0], &bare.patches[0]);
        assert_eq!(
            (&reading.force, &reading.deflection),
            (&bare.force, &bare.deflection)
        );
        assert_eq!(bare.signal, None);
        let mut expected = reading.force.clone();
        let recording = Recording {
            frames: &mut expected,
            rates: None,
            n_before: 0,
            interval: None,
            time: Some(number as f64 / (frames.len() - 1) as f64),
        };
        let name = seed.named("signal").named("finger").numbered(number as u64);
        chain.apply_recording(recording, &name, &mut SignalWorkspace::default());
        assert_eq!(reading.signal.as_ref(), Some(&expected), "frame {number}");
    }
}

#[test]
fn zeros_drift_from_frame_to_frame_and_the_skin_has_the_same_faults_in_all() {
    let plan = sensed("signal = [{ drift_std_full_scale = 0.1 }, { stuck_fraction = 0.1 }]");
    let frames = frames(&plan);
    let signal = |frame: usize| frames[frame].patches[0].signal.as_ref().unwrap();
    let n = signal(0).len();
    let stuck: Vec<usize> = (0..n).filter(|&k| signal(0)[k] != 0.0).collect();
    // At the start of a session, no zero has drifted.
    assert_eq!(stuck.len(), (0.1 * n as f64).round() as usize);
    let last = frames.len() - 1;
    assert!(stuck.iter().all(|&k| signal(last)[k] == signal(0)[k]));
    let wandered = (0..n).filter(|&k| signal(last)[k] != signal(0)[k]).count();
    assert_eq!(wandered, n - stuck.len());
}

#[test]
fn a_recording_has_the_signal_beside_deflection_and_force() {
    let (folder, frames) = recorded(&sensed(SIGNAL));
    let file = std::fs::File::open(folder.path().join("recording.npz"));
    let mut stored = NpzReader::new(file.unwrap()).unwrap();
    let signal: Array2<f32> = stored.by_name("finger/signal").unwrap();
    let force: Array2<f32> = stored.by_name("finger/force").unwrap();
    assert_eq!(signal.dim(), force.dim());
    for (row, frame) in signal.outer_iter().zip(&frames) {
        let expected = frame.patches[0].signal.as_ref().unwrap();
        assert!(row.iter().zip(expected).all(|(a, b)| *a == *b as f32));
    }
}

#[test]
fn steps_that_are_given_twice_draw_twice() {
    let spread = |signal: &str| {
        let plan = sensed(&format!("signal = [{signal}]"));
        let frames = frames(&plan);
        let changes = frames.iter().flat_map(|frame| {
            let reading = &frame.patches[0];
            let signal = reading.signal.as_ref().unwrap().iter();
            signal
                .zip(&reading.deflection)
                .map(|(signal, true_value)| (signal - true_value).powi(2))
        });
        let changes: Vec<f64> = changes.collect();
        (changes.iter().sum::<f64>() / changes.len() as f64).sqrt()
    };
    for step in [
        "{ noise_std_full_scale = 0.01 }",
        "{ drift_std_full_scale = 0.01 }",
    ] {
        let ratio = spread(&format!("{step}, {step}")) / spread(step);
        assert!((ratio - 2f64.sqrt()).abs() < 0.15, "{step}: {ratio}");
    }
}
