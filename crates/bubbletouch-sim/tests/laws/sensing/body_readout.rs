//! Laws of the readings of a whole body: a taxel reads equal values alone and among others, with the distributions of a chain's readings.

use super::noise;
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Sphere, SphereClusters, SphereUnion};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::{
    BodyReading, BodyReadout, Chain, Moment, Noise, NoiseUnit, Quantity, Recording, SensorError,
    SignalStep, SignalWorkspace,
};
use bubbletouch_sim::whole_body::{BodyState, WholeBody};
use bubbletouch_sim::world::{Dome, Extrusion, Grid, Patch, Taxel};
use glam::DVec3;
use rand::Rng;

use crate::counting::allocations;

const STROKE: f64 = 2e-3;

fn taxel(damping: f64, stroke: f64) -> Taxel {
    Taxel {
        radius: 0.5e-3,
        stiffness: 100.0,
        damping,
        stroke,
    }
}

/// Creates a grid, a sleeve and a cap of different taxels, whose numbers are not multiples of any group size.
fn body(damping: f64) -> WholeBody {
    let grid = Grid {
        nx: 101,
        ny: 103,
        pitch: 1e-3,
    };
    let sleeve = Extrusion::cylinder(0.05, 0.07, 2.0, 1.1e-3).unwrap();
    let cap = Dome::new(0.04, 1.2, 3.0, 1.3e-3).unwrap();
    let patches = [
        Patch::grid(grid, taxel(damping, STROKE)).unwrap(),
        Patch::new("sleeve", sleeve, taxel(damping, 2.0 * STROKE)).unwrap(),
        Patch::new("cap", cap, taxel(damping, STROKE)).unwrap(),
    ];
    WholeBody::new(&patches).unwrap()
}

/// Presses a ball into the middle of each patch; the patches are far apart.
fn pressed(body: &WholeBody) -> BodyState {
    let mut state = BodyState::at_rest(body);
    let away = [0.0, 1.0, 2.0].map(|x| Pose::from_translation(x * DVec3::X));
    state.place(body, &away).unwrap();
    let ball = |x: f64, rest: f64| Sphere {
        center: DVec3::new(x, 0.0, rest + 0.2 - 1e-3),
        radius: 0.2,
    };
    let mut spheres = vec![ball(0.0, 0.0), ball(2.0, 0.04)];
    spheres.push(Sphere {
        center: DVec3::new(1.249, 0.0, 0.035),
        radius: 0.2,
    });
    let object = [SphereClusters::new(&SphereUnion::new(spheres).unwrap())];
    for deeper in [0.0, 0.5e-3, 0.3e-3] {
        let pose = [Pose::from_translation(-deeper * DVec3::Z)];
        state.press(body, &object, &pose, 1e-3).unwrap();
    }
    state
}

fn skin() -> Seed {
    Seed::new(2018).named("skin")
}

fn step(error: SensorError, strengths: &[f64]) -> SignalStep {
    error.step(strengths, skin()).unwrap()
}

/// Returns all signal steps that act on each taxel independently.
fn steps() -> Vec<SignalStep> {
    vec![
        step(SensorError::Gain, &[0.1]),
        noise(0.01),
        step(SensorError::Drift, &[0.05]),
        noise(0.02),
        step(SensorError::Faults, &[0.1, 0.05]),
        step(SensorError::Quantisation, &[12.0]),
    ]
}

const MOMENT: Moment = Moment {
    frame: (1 << 33) + 5,
    time: 0.37,
};

#[test]
fn a_taxel_reads_the_same_among_the_touched_and_with_all_of_its_patch() {
    for (damping, force) in [(0.0, false), (0.05, true)] {
        let body = body(damping);
        let state = pressed(&body);
        let mut listed = steps();
        listed.splice(0..0, force.then_some(SignalStep::Force));
        let readout = BodyReadout::new(&listed, &body, &skin()).unwrap();
        let mut dense = Vec::new();
        for (number, patch) in body.patches().iter().enumerate() {
            let mut values = vec![f64::NAN; patch.n_taxels()];
            readout.read_patch(&body, &state, number, MOMENT, &mut values);
            dense.extend(values);
        }
        let mut reading = BodyReading::default();
        readout.read_touched(&body, &state, MOMENT, &mut reading);
        assert!(reading.taxels.len() > 2500, "{}", reading.taxels.len());
        let patches: Vec<usize> = reading
            .iter()
            .map(|(taxel, _)| body.place_of(taxel).0)
            .collect();
        assert!((0..3).all(|patch| patches.contains(&patch)));
        for (taxel, value) in reading.iter() {
            assert_eq!(value, dense[taxel], "taxel {taxel}");
        }
        // All taxels in one list read as patch by patch.
        let mut values = match force {
            true => body.frame(state.forces(&body)),
            false => body.frame(state.touched(&body)),
        };
        let all: Vec<usize> = (0..body.n_taxels()).collect();
        readout.read(&all, MOMENT, &mut values);
        assert_eq!(values, dense);
    }
}

#[test]
fn threads_change_nothing_and_a_second_reading_allocates_nothing() {
    let body = body(0.0);
    let state = pressed(&body);
    let readout = BodyReadout::new(&steps(), &body, &skin()).unwrap();
    let read = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let mut reading = BodyReading::default();
        pool.build().unwrap().install(|| {
            readout.read_touched(&body, &state, MOMENT, &mut reading);
        });
        reading
    };
    let alone = read(1);
    assert_eq!(alone, read(4));
    let few: Vec<usize> = (0..1500).collect();
    let mut values = vec![0.0; few.len()];
    assert_eq!(allocations(|| readout.read(&few, MOMENT, &mut values)), 0);
}

/// Creates a flat skin of `n` taxels.
fn flat(n: usize) -> (Patch, WholeBody) {
    let grid = Grid {
        nx: n,
        ny: 1,
        pitch: 1e-3,
    };
    let patch = Patch::grid(grid, taxel(0.0, STROKE)).unwrap();
    let body = WholeBody::new(std::slice::from_ref(&patch)).unwrap();
    (patch, body)
}

/// Returns the readings of all `n` taxels of a skin with equal deflections, given in strokes.
fn read(n: usize, steps: &[SignalStep], moment: Moment, felt: f64) -> Vec<f64> {
    let readout = BodyReadout::new(steps, &flat(n).1, &skin()).unwrap();
    let taxels: Vec<usize> = (0..n).collect();
    let mut values = vec![felt * STROKE; n];
    readout.read(&taxels, moment, &mut values);
    values.iter().map(|value| value / STROKE).collect()
}

fn at(frame: u64, time: f64) -> Moment {
    Moment { frame, time }
}

fn covariance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
}

/// Returns the largest distance between a sample and a distribution function, times the root of the sample size. The value exceeds 1.95 once in a thousand
/// samples.
fn kolmogorov(sample: &[f64], below: impl Fn(f64) -> f64) -> f64 {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let distances = sorted.iter().enumerate().map(|(rank, &value)| {
        let below = below(value);
        (below - rank as f64 / n).max((rank + 1) as f64 / n - below)
    });
    distances.fold(0.0, f64::max) * n.sqrt()
}

#[test]
fn noise_is_normal_and_independent_between_taxels_and_frames() {
    const N: usize = 1_000_000;
    let frames: Vec<Vec<f64>> = [0, 1, 2, 1 << 32]
        .map(|frame| read(N, &[noise(1.0)], at(frame, 0.0), 0.0))
        .into();
    let error = 1.0 / (N as f64).sqrt();
    for z in &frames {
        let moment = |power: i32| z.iter().map(|z| z.powi(power)).sum::<f64>() / N as f64;
        // Tolerance of five standard errors: the variance of zᵖ is (2p − 1)!! − (E zᵖ)².
        let moments = [
            (1, 0.0, 1.0),
            (2, 1.0, 2.0),
            (3, 0.0, 15.0),
            (4, 3.0, 96.0),
            (6, 15.0, 10_170.0_f64),
        ];
        for (power, expected, variance) in moments {
            let off = (moment(power) - expected).abs();
            assert!(off < 5.0 * error * variance.sqrt(), "{power}: {off}");
        }
        let normal = |x: f64| {
            use statrs::distribution::{ContinuousCDF, Normal};
            Normal::standard().cdf(x)
        };
        let distance = kolmogorov(z, normal);
        assert!(distance < 1.95, "{distance}");
        // Correlations of neighbours, including taxels that share a counter or a logarithm. Correlations of squares detect dependence that linear correlation
        // misses.
        let squares: Vec<f64> = z.iter().map(|z| z * z - 1.0).collect();
        for lag in [1, 2, 3, 4, 5, 7, 8, 31, 32, 33, 101] {
            let together = covariance(&z[lag..], &z[..N - lag]);
            assert!(together.abs() < 5.0 * error, "{lag}: {together}");
            let together = covariance(&squares[lag..], &squares[..N - lag]);
            assert!(together.abs() < 5.0 * 2.0 * error, "{lag}: {together}");
        }
    }
    for (number, a) in frames.iter().enumerate() {
        for b in &frames[..number] {
            assert!(covariance(a, b).abs() < 5.0 * error);
            assert!(covariance(&a[1..], b).abs() < 5.0 * error);
        }
    }
}

#[test]
fn one_taxel_has_noise_that_is_normal_from_frame_to_frame() {
    const N: usize = 20_000;
    let (_, body) = flat(16);
    let readout = BodyReadout::new(&[noise(1.0)], &body, &skin()).unwrap();
    let z: Vec<f64> = (0..N as u64)
        .map(|frame| {
            let mut value = [0.0];
            readout.read(&[9], at(frame, 0.0), &mut value);
            value[0] / STROKE
        })
        .collect();
    let error = 1.0 / (N as f64).sqrt();
    assert!((covariance(&z, &z) - 1.0).abs() < 5.0 * error * 2f64.sqrt());
    for lag in [1, 2, 3, 10, 1000] {
        assert!(covariance(&z[lag..], &z[..N - lag]).abs() < 5.0 * error);
    }
    // Two noise steps of one list are independent, as are the noises of two skins.
    let both = read(N, &[noise(1.0), noise(1.0)], at(3, 0.0), 0.0);
    assert!((covariance(&both, &both) / 2.0 - 1.0).abs() < 5.0 * error * 2f64.sqrt());
}

#[test]
fn zeros_drift_as_a_random_walk_does() {
    const N: usize = 200_000;
    let drift = step(SensorError::Drift, &[0.1]);
    let zeros = |time| -> Vec<f64> {
        let zeros = read(N, &[drift], at(0, time), 0.0);
        zeros.iter().map(|zero| zero / 0.1).collect()
    };
    assert!(zeros(0.0).iter().all(|&zero| zero == 0.0));
    let times = [1.0 / 64.0, 0.25, 0.265625, 0.5, 0.984375, 1.0];
    let at_times = times.map(zeros);
    for (s, early) in times.iter().zip(&at_times) {
        for (t, late) in times.iter().zip(&at_times) {
            // Expected covariance Cov(W(s), W(t)) = min(s, t), with five standard errors of products of normal numbers.
            let expected = s.min(*t);
            let error = ((s * t + expected * expected) / N as f64).sqrt();
            let found = covariance(early, late);
            assert!((found - expected).abs() < 5.0 * error, "{s}, {t}: {found}");
        }
    }
    // Between two of the 64 times, the zero is linear.
    let between = zeros(0.25 + 0.25 / 64.0);
    for ((a, b), zero) in at_times[1].iter().zip(&at_times[2]).zip(between) {
        assert!((zero - (0.75 * a + 0.25 * b)).abs() < 1e-12);
    }
    let neighbours = covariance(&at_times[5][1..], &at_times[5][..N - 1]);
    assert!(neighbours.abs() < 5.0 / (N as f64).sqrt());
}

#[test]
fn faults_stay_and_grow() {
    const N: usize = 100_000;
    let faults = |dead, stuck, frame| {
        let faults = step(SensorError::Faults, &[dead, stuck]);
        read(N, &[faults], at(frame, 0.0), 0.5)
    };
    let values = faults(0.1, 0.2, 1);
    assert_eq!(values, faults(0.1, 0.2, 2));
    // The faults of a skin with fewer faults are also faults of the skin with more.
    for (few, many) in values.iter().zip(faults(0.2, 0.4, 3)) {
        assert!(*few == 0.5 || *few == many);
    }
}

#[test]
fn a_chain_whose_errors_have_laws_of_their_own_reads_values_of_the_same_distribution() {
    const N: usize = 50_000;
    let end = at(11, 1.0);
    for (number, step) in steps().into_iter().enumerate() {
        let mut sparse = read(N, &[step], end, 0.5);
        let (patch, _) = flat(N);
        let mut frames = vec![0.5 * STROKE; N];
        let recording = Recording {
            frames: &mut frames,
            rates: None,
            n_before: 0,
            interval: None,
            time: Some(end.time),
        };
        let chain = Chain::new(&[step], &patch).unwrap();
        chain.apply_recording(recording, &skin(), &mut SignalWorkspace::default());
        let mut dense: Vec<f64> = frames.iter().map(|value| value / STROKE).collect();
        assert_eq!(
            sparse == dense,
            step == steps()[5],
            "step {number}: other draws"
        );
        sparse.sort_by(f64::total_cmp);
        dense.sort_by(f64::total_cmp);
        // Two samples of size N differ by less than 1.95 √(2 / N) in 999 of 1000 pairs, at values that few readings share.
        for part in 1..100 {
            let value = dense[part * N / 100];
            let below =
                |sorted: &[f64]| sorted.partition_point(|&of| of <= value) as f64 / N as f64;
            let apart = (below(&sparse) - below(&dense)).abs();
            assert!(
                apart < 1.95 * (2.0 / N as f64).sqrt(),
                "step {number}: {apart}"
            );
        }
    }
}

#[test]
fn steps_are_in_the_unit_of_what_is_read_and_of_their_patch() {
    let body = body(0.0);
    let first_of_sleeve = body.firsts()[1];
    let taxels: Vec<usize> = (0..body.n_taxels()).collect();
    let zeros = |steps: &[SignalStep]| {
        let readout = BodyReadout::new(steps, &body, &skin()).unwrap();
        let mut values = vec![0.0; taxels.len()];
        readout.read(&taxels, at(1, 1.0), &mut values);
        (readout.quantity(), values)
    };
    let (quantity, metres) = zeros(&[noise(0.1)]);
    assert_eq!(quantity, Quantity::Deflection);
    let (quantity, newtons) = zeros(&[SignalStep::Force, noise(0.1)]);
    assert_eq!(quantity, Quantity::Force);
    for (metres, newtons) in metres.iter().zip(&newtons) {
        assert!((newtons - 100.0 * metres).abs() <= 1e-14);
    }
    // The sleeve's stroke is twice as long.
    let std = |values: &[f64]| covariance(values, values).sqrt();
    let ratio = std(&metres[first_of_sleeve..body.firsts()[2]]) / std(&metres[..first_of_sleeve]);
    assert!((ratio - 2.0).abs() < 0.1, "{ratio}");
    let (_, none) = zeros(&[noise(0.0), step(SensorError::Drift, &[0.0])]);
    assert!(none.iter().all(|&value| value == 0.0));
}

#[test]
fn what_no_taxel_reads_by_itself_is_refused() {
    let body = body(0.0);
    let newtons = SignalStep::Noise(Noise {
        std: 0.1,
        unit: NoiseUnit::N,
    });
    let cases = [
        (
            vec![step(SensorError::Crosstalk, &[0.1])],
            "crosstalk, which needs other taxels",
        ),
        (
            vec![step(SensorError::Hysteresis, &[0.1])],
            "hysteresis, which needs",
        ),
        (
            vec![SignalStep::Smoothing { width: 1e-3 }],
            "smoothing, which needs",
        ),
        (
            vec![noise(0.1), SignalStep::Force],
            "force, after another step",
        ),
        (vec![SignalStep::Force; 2], "force, after another step"),
        (vec![newtons], "still deflections"),
        (vec![noise(f64::NAN)], "noise std"),
        // Strengths are checked as by a chain.
        (
            vec![step(SensorError::Drift, &[-0.1])],
            "drift_std_full_scale",
        ),
        (
            vec![step(SensorError::Faults, &[0.7, 0.6])],
            "dead_fraction and stuck_fraction",
        ),
    ];
    for (steps, expected) in cases {
        let error = BodyReadout::new(&steps, &body, &skin())
            .unwrap_err()
            .to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn random_numbers_of_taxels_in_random_scenes_read_as_in_a_loop_over_single_ones() {
    let body = body(0.0);
    let readout = BodyReadout::new(&steps(), &body, &skin()).unwrap();
    let mut rng = Seed::new(8).rng();
    for _ in 0..50 {
        let n = rng.gen_range(1..3000);
        let moment = at(rng.r#gen(), rng.r#gen());
        let taxels: Vec<usize> = (0..n).map(|_| rng.gen_range(0..body.n_taxels())).collect();
        let felt: Vec<f64> = (0..n).map(|_| rng.gen_range(0.0..STROKE)).collect();
        let mut values = felt.clone();
        readout.read(&taxels, moment, &mut values);
        for ((&taxel, &felt), &value) in taxels.iter().zip(&felt).zip(&values) {
            let mut alone = [felt];
            readout.read(&[taxel], moment, &mut alone);
            assert_eq!(alone[0], value);
        }
    }
}
