//! Calibration of simulated skins with known settings: each setting is recovered within 10 %, or reported as not identifiable.

use crate::study::Study;
use bubbletouch::calibration::{Calibration, Measured, RecordedSkin, calibrate};
use bubbletouch::random::Seed;
use bubbletouch::signal::{
    Chain, Noise, NoiseUnit, Recording, SensorError, SignalStep, SignalWorkspace,
};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::simulate_array;
use bubbletouch::world::{Grid, Patch, Taxel};
use ndarray::{Array1, Array2, Axis};
use serde::Deserialize;
use std::sync::LazyLock;

const SIDE: usize = 32;
const STROKE: f64 = 5e-3;
const STIFFNESS: f64 = 180.0;

const STUDY: &str = include_str!("../fixtures/texts/calibration.toml");

/// Deflections of touches in random order, n × 1,024, metres.
static TOUCHED: LazyLock<Array2<f64>> = LazyLock::new(|| {
    let study = Study::new(STUDY);
    let frames = simulate_array(&study.touched, &study.plan.array, 1, &Silent);
    let frames = frames.to_array();
    let n = frames.len() / (SIDE * SIDE);
    let frames = frames.into_shape_with_order((n, SIDE * SIDE)).unwrap();
    let order: Vec<usize> = (0..n).map(|k| k * 367 % n).collect();
    frames.select(Axis(0), &order).mapv(f64::from)
});

/// Settings of a simulated skin.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
struct Settings {
    crosstalk: f64,
    gain: f64,
    drift: f64,
    noise: f64,
    /// Standard deviation of the smoothing, in pitches.
    smoothing: f64,
    dead: f64,
    stuck: f64,
    bits: f64,
}

/// Returns settings from their keys, such as `gain = 0.1, noise = 0.003`; all others are zero.
fn settings(keys: &str) -> Settings {
    toml::from_str(&keys.replace(", ", "\n")).unwrap()
}

impl Settings {
    fn steps(&self, skin: Seed) -> Vec<SignalStep> {
        let noise = Noise {
            std: self.noise,
            unit: NoiseUnit::FullScale,
        };
        vec![
            SensorError::Crosstalk
                .step(&[self.crosstalk], skin)
                .unwrap(),
            SensorError::Gain.step(&[self.gain], skin).unwrap(),
            SensorError::Drift.step(&[self.drift], skin).unwrap(),
            SignalStep::Noise(noise),
            SignalStep::Smoothing {
                width: self.smoothing * 2e-3,
            },
            SensorError::Faults
                .step(&[self.dead, self.stuck], skin)
                .unwrap(),
            SensorError::Quantisation.step(&[self.bits], skin).unwrap(),
        ]
    }

    /// Returns the readings of such a skin at times of a session, as fractions of the full scale.
    fn read(&self, deflections: &Array2<f64>, times: &Array1<f64>, name: &str) -> Array2<f64> {
        let seed = Seed::new(7);
        let grid = Grid {
            nx: SIDE,
            ny: SIDE,
            pitch: 2e-3,
        };
        let taxel = Taxel {
            radius: 1e-3,
            stiffness: STIFFNESS,
            damping: 0.0,
            stroke: STROKE,
        };
        let patch = Patch::grid(grid, taxel).unwrap();
        let chain = Chain::new(&self.steps(seed.named("skin")), &patch).unwrap();
        let mut scratch = SignalWorkspace::default();
        let mut read = deflections.clone();
        for (k, mut frame) in read.outer_iter_mut().enumerate() {
            let recording = Recording {
                frames: frame.as_slice_mut().unwrap(),
                rates: None,
                n_before: 0,
                interval: None,
                time: Some(times[k]),
            };
            let touch = seed.named(name).numbered(k as u64);
            chain.apply_recording(recording, &touch, &mut scratch);
        }
        // Rounded as in a file of single precision.
        read.mapv(|metres| f64::from((metres / STROKE) as f32))
    }

    fn calibrated(&self, untouched_times: Array1<f64>) -> Calibration {
        let untouched = Array2::zeros((untouched_times.len(), SIDE * SIDE));
        let touched_times = Array1::linspace(0.0, 1.0, TOUCHED.nrows());
        calibrate(&RecordedSkin {
            shape: (SIDE, SIDE),
            touched: self.read(&TOUCHED, &touched_times, "touched"),
            untouched: self.read(&untouched, &untouched_times, "untouched"),
            touched_times,
            untouched_times,
            forces: Some(TOUCHED.sum_axis(Axis(1)) * STIFFNESS),
            stroke: Some(STROKE),
        })
        .unwrap()
    }
}

/// Asserts that the estimates are within 10 % of the settings (near zero for absent ones), and that exactly the expected settings are not identifiable.
fn is_recovered(settings: Settings, n_untouched: usize, unknown: &[&str]) {
    let times = Array1::linspace(0.0, 1.0, n_untouched);
    let found = are_right(settings, times);
    for name in unknown {
        assert!(found.contains(name), "{settings:?}: {name} is estimated");
    }
    assert_eq!(
        found.len(),
        unknown.len(),
        "{settings:?}: not identifiable are {found:?}"
    );
}

/// Asserts that the estimates are within 10 % of the settings (near zero for absent ones). Returns the names of the settings that are not identifiable.
fn are_right(settings: Settings, untouched_times: Array1<f64>) -> Vec<&'static str> {
    let found = settings.calibrated(untouched_times);
    let mut unknown = Vec::new();
    let all = [
        ("crosstalk", &found.crosstalk, settings.crosstalk, 0.01),
        ("gain", &found.gain, settings.gain, 0.01),
        ("drift", &found.drift, settings.drift, 0.002),
        ("noise", &found.noise, settings.noise, 0.0),
        ("smoothing", &found.smoothing, settings.smoothing, 0.0),
        ("dead", &found.dead, settings.dead, 0.0),
        ("stuck", &found.stuck, settings.stuck, 0.0),
        ("bits", &found.converter, settings.bits, 0.0),
        ("stiffness", &found.stiffness, STIFFNESS, 0.0),
    ];
    for (name, estimate, expected, none) in all {
        match estimate {
            Err(_) => unknown.push(name),
            Ok(Measured { value, interval }) => {
                let allowed = (0.1 * expected).max(none);
                let given = format!("{settings:?}: {name}: {estimate:?}");
                assert!((value - expected).abs() <= allowed, "{given}");
                assert!(interval[0] <= *value && *value <= interval[1], "{given}");
            }
        }
    }
    unknown
}

/// Law: zeros that drift between untouched frames are neither gains nor crosstalk.
#[test]
fn drift_is_no_gain_wherever_the_skin_is_untouched() {
    let evenly = || Array1::linspace(0.0, 1.0, 400);
    let at_ends = || {
        Array1::from_iter((0..200).map(|k| {
            if k < 100 {
                5e-4 * f64::from(k)
            } else {
                0.9 + 5e-4 * f64::from(k)
            }
        }))
    };
    let at_start = || Array1::linspace(0.0, 0.05, 200);
    let drifting = settings("drift = 0.05, noise = 0.003");
    let leaking = settings("drift = 0.05, noise = 0.003, crosstalk = 0.2");
    let unlike = settings("drift = 0.1, noise = 0.003, gain = 0.1");
    let all = settings("drift = 0.02, noise = 0.02, gain = 0.05, crosstalk = 0.1");
    for (times, found) in [
        (evenly(), &["drift"][..]),
        (at_ends(), &["drift"]),
        (at_start(), &[]),
        (Array1::zeros(0), &[]),
    ] {
        for skin in [drifting, leaking, unlike, all] {
            let unknown = are_right(skin, times.clone());
            let is_found = found.iter().all(|name| !unknown.contains(name));
            assert!(is_found, "{skin:?}: {unknown:?}");
        }
    }
}

#[test]
fn each_setting_of_a_skin_is_recovered_within_a_tenth_or_said_to_be_not_identifiable() {
    let none = Settings::default();
    is_recovered(none, 400, &["smoothing"]);
    let leaking = settings("crosstalk = 0.3, gain = 0.05");
    is_recovered(leaking, 400, &["smoothing"]);
    let quiet = settings("crosstalk = 0.2, noise = 0.003");
    is_recovered(quiet, 400, &[]);
    let worn = settings(
        "crosstalk = 0.1, gain = 0.1, drift = 0.05, noise = 0.02, dead = 0.02, stuck = 0.01",
    );
    is_recovered(worn, 400, &["crosstalk"]);
    let unlike = settings("gain = 0.2, drift = 0.1, noise = 0.01");
    is_recovered(unlike, 400, &["crosstalk"]);
    let smoothed = settings("noise = 0.03, smoothing = 1.0");
    is_recovered(smoothed, 400, &["crosstalk", "gain"]);
    let blurred = settings("noise = 0.1, smoothing = 2.0, drift = 0.05");
    is_recovered(blurred, 400, &["crosstalk", "gain", "drift"]);
}

#[test]
fn a_converter_is_found_and_what_it_clips_or_rounds_away_is_said() {
    let exact = settings("crosstalk = 0.3, gain = 0.05, bits = 12.0");
    is_recovered(exact, 400, &["noise", "smoothing"]);
    let coarse = settings("crosstalk = 0.2, noise = 0.003, bits = 8.0");
    is_recovered(coarse, 400, &["noise"]);
    let smoothed = settings("noise = 0.03, smoothing = 1.0, bits = 12.0");
    is_recovered(smoothed, 400, &["crosstalk", "gain"]);
    let worn = settings(
        "crosstalk = 0.1, gain = 0.1, drift = 0.05, noise = 0.02, dead = 0.02, stuck = 0.01, bits = 10.0",
    );
    is_recovered(worn, 400, &["crosstalk", "stiffness"]);
}

#[test]
fn without_untouched_frames_nothing_is_said_of_noise_smoothing_and_drift() {
    let settings = settings("crosstalk = 0.1, gain = 0.1, dead = 0.03");
    is_recovered(settings, 0, &["noise", "smoothing", "drift"]);
}
