//! Laws of sensor errors in signal chains: strengths, order, history, time, units.

use super::{grid, noise};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::{Chain, Recording, SENSOR_ERRORS, SensorError};
use bubbletouch_sim::signal::{SignalStep, SignalWorkspace};
use bubbletouch_sim::world::Patch;

const N: usize = 48;
const NOISE: f64 = 0.02;

fn patch() -> Patch {
    grid(8, 6)
}

fn skin() -> Seed {
    Seed::new(1).named("skin")
}

fn is_error(step: &SignalStep, wanted: SensorError) -> bool {
    matches!(step, SignalStep::Error { error, .. } if *error == wanted)
}

/// Returns a list of all imperfections, each at a multiple of a base strength.
fn imperfections(times: f64) -> Vec<SignalStep> {
    let strengths: [(SensorError, &[f64]); 8] = [
        (SensorError::Hysteresis, &[0.1]),
        (SensorError::Crosstalk, &[0.2]),
        (SensorError::Scan, &[50.0]),
        (SensorError::Gain, &[0.3]),
        (SensorError::Drift, &[0.1]),
        (SensorError::Faults, &[0.1, 0.1]),
        (SensorError::Quantisation, &[6.0]),
        (SensorError::MatrixReadout, &[0.1]),
    ];
    let steps = strengths.iter().map(|(error, strengths)| {
        let is_whole = error.about().strengths[0].is_whole;
        let times = |strength: &f64| match is_whole {
            true => (strength * times).floor(),
            false => strength * times,
        };
        let strengths: Vec<f64> = strengths.iter().map(times).collect();
        error.step(&strengths, skin()).unwrap()
    });
    steps.collect()
}

/// Returns a press of `n_frames` frames with increasing depth, 2 mm at most.
fn press(n_frames: usize) -> Vec<f64> {
    let value = |frame: usize, taxel: usize| {
        let depth = 2e-3 * (frame + 1) as f64 / n_frames as f64;
        (depth - 1e-4 * (taxel as f64 - 20.0).abs()).max(0.0)
    };
    (0..n_frames * N).map(|i| value(i / N, i % N)).collect()
}

/// Returns the readings of a chain for frames of which the first `n_before` came before the touch.
fn read(steps: &[SignalStep], frames: &[f64], n_before: usize, touch: u64) -> Vec<f64> {
    let mut frames = frames.to_vec();
    let recording = Recording {
        frames: &mut frames,
        rates: None,
        n_before,
        interval: Some(0.04),
        time: None,
    };
    let chain = Chain::new(steps, &patch()).unwrap();
    let touch = Seed::new(2018).numbered(touch);
    chain.apply_recording(recording, &touch, &mut SignalWorkspace::default());
    frames.split_off(n_before * N)
}

#[test]
fn an_imperfection_of_no_strength_is_as_if_it_were_not_listed() {
    let others = [
        SignalStep::Force,
        noise(NOISE),
        SignalStep::Smoothing { width: 3e-3 },
    ];
    for step in imperfections(0.0) {
        for place in 0..=others.len() {
            let mut steps = others.to_vec();
            steps.insert(place, step);
            for n_before in [0, 1] {
                let expected = read(&others, &press(3), n_before, 4);
                assert_eq!(read(&steps, &press(3), n_before, 4), expected, "{step:?}");
            }
        }
    }
}

#[test]
fn every_imperfection_changes_a_press_and_the_same_names_change_it_in_the_same_way() {
    let frames = press(3);
    for step in imperfections(1.0) {
        let once = read(&[step], &frames, 0, 4);
        assert_ne!(once, frames, "{step:?}");
        assert_eq!(read(&[step], &frames, 0, 4), once, "{step:?}");
    }
}

#[test]
fn gains_and_faults_stay_with_the_skin_and_zeros_wander_from_touch_to_touch() {
    let frames = press(2);
    for step in imperfections(1.0) {
        let is_same = read(&[step], &frames, 0, 4) == read(&[step], &frames, 0, 5);
        let wanders = is_error(&step, SensorError::Drift);
        assert_eq!(is_same, !wanders, "{step:?}");
    }
    let drift = imperfections(1.0)[4];
    let zeros = read(&[drift], &[0.0; 3 * N], 0, 4);
    // The zeros are constant within a touch.
    assert_eq!(zeros[..N], zeros[N..2 * N]);
    assert_eq!(zeros[..N], zeros[2 * N..]);
    let of = |skin| {
        let gain = SensorError::Gain.step(&[0.3], skin).unwrap();
        read(&[gain], &frames, 0, 4)
    };
    assert_ne!(of(skin()), of(Seed::new(2).named("skin")));
}

#[test]
fn steps_act_in_the_order_of_the_list() {
    let frames = press(1);
    let [_, crosstalk, _, gain, _, faults, converter, _] = imperfections(1.0)[..] else {
        panic!("eight steps");
    };
    for (first, second) in [
        (crosstalk, gain),
        (faults, crosstalk),
        (converter, noise(NOISE)),
    ] {
        let one_way = read(&[first, second], &frames, 0, 4);
        assert_ne!(one_way, read(&[second, first], &frames, 0, 4));
        // The second step acts on the output of the first step.
        if second != noise(NOISE) {
            let by_hand = read(&[second], &read(&[first], &frames, 0, 4), 0, 4);
            assert_eq!(one_way, by_hand);
        }
    }
}

#[test]
fn frames_of_a_chain_without_time_are_read_as_if_each_were_alone() {
    let mut steps = imperfections(1.0);
    let connects = [
        SensorError::Hysteresis,
        SensorError::Scan,
        SensorError::Drift,
    ];
    steps.retain(|step| !connects.iter().any(|error| is_error(step, *error)));
    steps.insert(2, noise(NOISE));
    let frames = press(3);
    let together = read(&steps, &frames, 0, 4);
    let chain = Chain::new(&steps, &patch()).unwrap();
    assert!(!chain.remembers());
    let touch = Seed::new(2018).numbered(4);
    let names = [
        touch.named("frame").numbered(1),
        touch.named("frame").numbered(2),
        touch,
    ];
    for (frame, name) in names.iter().enumerate() {
        let mut alone = frames[frame * N..(frame + 1) * N].to_vec();
        chain.apply(&mut alone, None, name, &mut SignalWorkspace::default());
        assert_eq!(together[frame * N..(frame + 1) * N], alone);
    }
    // Frames before the touch do not change the readings of a chain without memory.
    assert_eq!(read(&steps, &[press(1), frames].concat(), 1, 4), together);
}

#[test]
fn a_skin_that_was_pressed_deeper_and_let_go_reads_a_touch_differently_and_no_touch_as_one() {
    let hysteresis = SensorError::Hysteresis.step(&[0.1], skin()).unwrap();
    let chain = Chain::new(&[noise(NOISE), hysteresis], &patch()).unwrap();
    assert!(chain.remembers());
    let deep = vec![4e-3; N];
    let history = |before: &[f64], touch: &[f64]| {
        read(&[hysteresis], &[before, &[0.0; N], touch].concat(), 2, 4)
    };
    let fresh = read(&[hysteresis], &press(2), 0, 4);
    assert_eq!(history(&[0.0; N], &press(2)), fresh);
    let after = history(&deep, &press(2));
    assert!(after.iter().zip(&fresh).all(|(after, fresh)| after > fresh));
    // The residual is below twice the width of the loop.
    let left = history(&deep, &[0.0; N]);
    let most = 2.0 * 0.1 * 5e-3;
    assert!(left.iter().all(|&value| value > 0.0 && value < most));
    // A shallower press before a deeper press has no effect.
    let shallow = history(&[1e-3; N], &[3e-3; N]);
    assert_eq!(shallow, read(&[hysteresis], &[3e-3; N], 0, 4));
}

#[test]
fn a_fraction_of_the_full_scale_means_the_same_before_and_after_force() {
    // Deflections away from zero, where forces are clipped, and from the full scale, where a converter clips.
    let frames: Vec<f64> = press(2).iter().map(|d| d + 1.5e-3).collect();
    for step in imperfections(0.5) {
        let before = read(&[step, SignalStep::Force], &frames, 0, 4);
        let after = read(&[SignalStep::Force, step], &frames, 0, 4);
        for (before, after) in before.iter().zip(after) {
            assert!((before - after).abs() < 1e-12, "{step:?}");
        }
    }
}

#[test]
fn a_strength_that_no_skin_has_is_refused_by_its_key() {
    let refused = |error: SensorError, strengths: &[f64], expected: &str| {
        let step = error.step(strengths, skin()).unwrap();
        let said = Chain::new(&[step], &patch()).unwrap_err().to_string();
        assert!(said.starts_with(expected), "{said}");
    };
    for error in SENSOR_ERRORS {
        for (place, strength) in error.about().strengths.iter().enumerate() {
            let [_, largest] = strength.range;
            for bad in [-0.1, f64::NAN, f64::INFINITY, 1.01 * largest] {
                let mut strengths = [0.0; 2];
                strengths[place] = bad;
                let expected = format!("{}: {bad}; {}", strength.key, strength.allowed);
                refused(
                    *error,
                    &strengths[..error.about().strengths.len()],
                    &expected,
                );
            }
        }
    }
    let together = "dead_fraction and stuck_fraction: 0.7 and 0.7;";
    refused(SensorError::Faults, &[0.7, 0.7], together);
    refused(SensorError::Quantisation, &[2.5], "adc_bits: 2.5;");
}
