//! Laws of sensor errors in signal chains: strengths, order, history, time, units.

use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::{
    Chain, Noise, NoiseUnit, Recording, SensorError, SignalStep, SignalWorkspace,
};
use bubbletouch_sim::world::{Grid, Patch, Taxel};

const N: usize = 48;
const NOISE: SignalStep = SignalStep::Noise(Noise {
    std: 0.02,
    unit: NoiseUnit::FullScale,
});

fn patch() -> Patch {
    let grid = Grid {
        nx: 8,
        ny: 6,
        pitch: 2e-3,
    };
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    Patch::grid(grid, taxel).unwrap()
}

fn skin() -> Seed {
    Seed::new(1).named("skin")
}

fn is_error(step: &SignalStep, wanted: SensorError) -> bool {
    matches!(step, SignalStep::Error { error, .. } if *error == wanted)
}

/// Returns a list of all imperfections, each at a multiple of a base strength.
fn imperfections(times: f64) -> Vec<SignalStep> {
    let skin = skin();
    vec![
        SensorError::Hysteresis.step(&[0.1 * times], skin).unwrap(),
        SensorError::Crosstalk.step(&[0.2 * times], skin).unwrap(),
        SensorError::Scan.step(&[1e3 * 0.05 * times], skin).unwrap(),
        SensorError::Gain.step(&[0.3 * times], skin).unwrap(),
        SensorError::Drift.step(&[0.1 * times], skin).unwrap(),
        SensorError::Faults
            .step(&[0.1 * times, 0.1 * times], skin)
            .unwrap(),
        SensorError::Quantisation
            .step(&[(6.0 * times).floor()], skin)
            .unwrap(),
        SensorError::MatrixReadout
            .step(&[0.1 * times], skin)
            .unwrap(),
    ]
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
        NOISE,
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
        let std = 0.3;
        read(
            &[SensorError::Gain.step(&[std], skin).unwrap()],
            &frames,
            0,
            4,
        )
    };
    assert_ne!(of(skin()), of(Seed::new(2).named("skin")));
}

#[test]
fn steps_act_in_the_order_of_the_list() {
    let frames = press(1);
    let [_, crosstalk, _, gain, _, faults, converter, _] = imperfections(1.0)[..] else {
        panic!("eight steps");
    };
    for (first, second) in [(crosstalk, gain), (faults, crosstalk), (converter, NOISE)] {
        let one_way = read(&[first, second], &frames, 0, 4);
        assert_ne!(one_way, read(&[second, first], &frames, 0, 4));
        // The second step acts on the output of the first step.
        if second != NOISE {
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
    steps.insert(2, NOISE);
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
    let chain = Chain::new(&[NOISE, hysteresis], &patch()).unwrap();
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
fn a_strength_that_no_skin_has_is_refused_by_name() {
    let skin = skin();
    for (step, place) in [
        (
            SensorError::Hysteresis.step(&[0.3], skin).unwrap(),
            "hysteresis width: 0.3;",
        ),
        (
            SensorError::Crosstalk.step(&[-0.1], skin).unwrap(),
            "crosstalk: -0.1;",
        ),
        (
            SensorError::Scan.step(&[1e3 * f64::NAN], skin).unwrap(),
            "scan time: NaN;",
        ),
        (
            SensorError::Gain.step(&[-1.0], skin).unwrap(),
            "gain std: -1;",
        ),
        (
            SensorError::Drift.step(&[f64::INFINITY], skin).unwrap(),
            "drift std: inf;",
        ),
        (
            SensorError::Faults.step(&[0.7, 0.7], skin).unwrap(),
            "dead and stuck fractions: 0.7 and 0.7;",
        ),
        (
            SensorError::Quantisation.step(&[25.0], skin).unwrap(),
            "converter bits: 25;",
        ),
        (
            SensorError::MatrixReadout.step(&[-0.1], skin).unwrap(),
            "line resistance: -0.1;",
        ),
    ] {
        let error = Chain::new(&[step], &patch()).unwrap_err();
        assert!(error.to_string().starts_with(place), "{error}");
    }
}
