//! Limits of frames and measurements: noise of ten times the full scale, smoothing wider than the array, one measurement, and as many measurements as taxels.
//! Each case has the behaviour that the guide's page on limits states.

use crate::standard_errors::assert_expected;
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::sensing::{Ensemble, Projection};
use bubbletouch_sim::signal::{Chain, Noise, NoiseUnit, SensorError, SignalStep, SignalWorkspace};
use bubbletouch_sim::world::ImageShape;
use bubbletouch_sim::world::{Grid, Patch, Taxel};
use ndarray::Array2;
use rand::Rng;

const ENSEMBLES: [Ensemble; 7] = [
    Ensemble::Gaussian,
    Ensemble::Bernoulli,
    Ensemble::Sparse,
    Ensemble::Sbhe,
    Ensemble::BlockAverage,
    Ensemble::Subsample,
    Ensemble::Identity,
];

fn patch(n: usize) -> Patch {
    let grid = Grid {
        nx: n,
        ny: n,
        pitch: 2e-3,
    };
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 100.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    Patch::grid(grid, taxel).unwrap()
}

fn applied(steps: &[SignalStep], patch: &Patch, frame: &[f64]) -> Vec<f64> {
    let mut frame = frame.to_vec();
    let chain = Chain::new(steps, patch).unwrap();
    chain.apply(
        &mut frame,
        None,
        &Seed::new(11),
        &mut SignalWorkspace::default(),
    );
    frame
}

#[test]
fn noise_of_ten_times_the_full_scale_is_neither_clipped_nor_bounded() {
    let patch = patch(160);
    let full_scale = patch.taxels().at(0).stroke;
    for std in [0.1, 1.0, 10.0] {
        let noise = SignalStep::Noise(Noise {
            std,
            unit: NoiseUnit::FullScale,
        });
        let n = patch.n_taxels() as f64;
        let noisy = applied(&[noise], &patch, &vec![0.5 * full_scale; n as usize]);
        let z: Vec<f64> = noisy
            .iter()
            .map(|v| (v - 0.5 * full_scale) / (std * full_scale))
            .collect();
        let mean = z.iter().sum::<f64>() / n;
        let moment = |power| z.iter().map(|v| (v - mean).powi(power)).sum::<f64>() / n;
        let near = |what: &str, found, expected, variance: f64| {
            let what = format!("{std}: {what}");
            assert_expected(&what, found, expected, (variance / n).sqrt());
        };
        near("mean", mean, 0.0, 1.0);
        near("variance", moment(2), 1.0, 2.0);
        near("fourth moment", moment(4), 3.0, 96.0);
        let beyond = noisy.iter().filter(|&&v| v < 0.0 || v > full_scale).count() as f64 / n;
        assert!(
            std < 1.0 || beyond > 0.5,
            "{std}: {beyond} beyond the full scale"
        );
        // A converter after the noise clips the values.
        let clipped = applied(
            &[
                noise,
                SensorError::Quantisation
                    .step(&[8.0], Seed::new(1))
                    .unwrap(),
            ],
            &patch,
            &noisy,
        );
        assert!(
            clipped
                .iter()
                .all(|&v| (0.0..=full_scale * (1.0 + 1e-12)).contains(&v))
        );
    }
}

#[test]
fn smoothing_wider_than_the_array_is_the_weighted_mean_of_the_mirrored_array() {
    let patch = patch(6);
    let mut rng = Seed::new(2).named("frame").rng();
    let frame: Vec<f64> = (0..36).map(|_| rng.gen_range(0.0..5e-3)).collect();
    for pitches in [1.0, 3.0, 6.0, 20.0, 300.0, 1e4] {
        let width = pitches * patch.layout().as_grid().unwrap().pitch;
        let found = applied(&[SignalStep::Smoothing { width }], &patch, &frame);
        // Slow oracle: every weight of the truncated Gaussian on the endlessly mirrored array.
        let reach = (4.0 * pitches + 0.5) as i64;
        let taps: Vec<f64> = (-reach..=reach)
            .map(|t| (-0.5 * (t as f64 / pitches).powi(2)).exp())
            .collect();
        let sum: f64 = taps.iter().sum();
        let mirrored = |place: i64| {
            let wrapped = place.rem_euclid(12);
            wrapped.min(11 - wrapped) as usize
        };
        let mut weights = [[0.0; 6]; 6];
        for (to, row) in weights.iter_mut().enumerate() {
            for (tap, t) in taps.iter().zip(-reach..) {
                row[mirrored(to as i64 + t)] += tap / sum;
            }
        }
        for (taxel, found) in found.iter().enumerate() {
            let mut slow = 0.0;
            for (from, value) in frame.iter().enumerate() {
                slow += weights[taxel / 6][from / 6] * weights[taxel % 6][from % 6] * value;
            }
            assert!((found - slow).abs() < 1e-15, "{pitches}: {found} {slow}");
        }
        if pitches >= 300.0 {
            let mean = frame.iter().sum::<f64>() / 36.0;
            assert!(found.iter().all(|v| (v / mean - 1.0).abs() < 1e-4));
        }
    }
}

/// Solves Φx = y by elimination with pivoting, as a slow and simple oracle.
fn solve(matrix: &Array2<f64>, measured: &[f64]) -> Vec<f64> {
    let n = measured.len();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| matrix.row(i).iter().copied().chain([measured[i]]).collect())
        .collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()));
        rows.swap(k, pivot.unwrap());
        let by = rows[k].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / by[k];
            for (value, pivot) in row.iter_mut().zip(&by).skip(k) {
                *value -= factor * pivot;
            }
        }
    }
    (0..n).map(|k| rows[k][n] / rows[k][k]).collect()
}

#[test]
fn as_many_measurements_as_taxels_lose_nothing() {
    for side in [2, 8, 12, 16] {
        let n = side * side;
        let frame = Array2::from_shape_fn((1, n), |(_, i)| 5e-3 * (1.3 * i as f64).sin().max(0.0));
        for ensemble in ENSEMBLES {
            let projection = Projection::new(
                ensemble,
                ImageShape { ny: side, nx: side },
                n,
                &Seed::new(4),
            )
            .unwrap();
            let measured = projection.measure(frame.view());
            let back = solve(&projection.matrix(), measured.row(0).as_slice().unwrap());
            // Blocks of 32 taxels are padded with zeros; only as many of their coefficients as there are taxels are kept.
            let is_padded = ensemble == Ensemble::Sbhe && side == 12;
            // Sparse matrices of a few taxels may have empty rows.
            let is_empty = ensemble == Ensemble::Sparse && side == 2;
            if is_padded || is_empty {
                let is_lost = back.iter().any(|x| !x.is_finite() || x.abs() > 1.0);
                assert!(is_lost, "{ensemble:?}, {n}: else the guide is wrong");
                continue;
            }
            for (back, x) in back.iter().zip(frame.row(0)) {
                assert!(
                    (back - x).abs() < 1e-9 * 5e-3 * n as f64,
                    "{ensemble:?}, {n}: {back} {x}"
                );
            }
        }
    }
}

#[test]
fn a_single_measurement_is_its_row_of_the_matrix_and_none_is_refused() {
    for side in [1, 8, 64] {
        let n = side * side;
        let frame = Array2::from_shape_fn((1, n), |(_, i)| 5e-3 * (0.7 * i as f64).sin().max(0.0));
        for ensemble in ENSEMBLES {
            let projection = Projection::new(
                ensemble,
                ImageShape { ny: side, nx: side },
                1,
                &Seed::new(4),
            )
            .unwrap();
            let measured = projection.measure(frame.view());
            let matrix = projection.matrix();
            assert_eq!(
                measured.ncols(),
                if ensemble == Ensemble::Identity { n } else { 1 }
            );
            let row: f64 = matrix
                .row(0)
                .iter()
                .zip(frame.row(0))
                .map(|(a, x)| a * x)
                .sum();
            assert!((measured[[0, 0]] - row).abs() < 1e-15, "{ensemble:?}, {n}");
            if ensemble == Ensemble::BlockAverage {
                let mean = frame.sum() / n as f64;
                assert!(
                    (measured[[0, 0]] - mean).abs() < 1e-15,
                    "the mean of the array"
                );
            }
            let error = Projection::new(
                ensemble,
                ImageShape { ny: side, nx: side },
                0,
                &Seed::new(4),
            )
            .unwrap_err();
            assert!(
                error.to_string().starts_with("number of measurements: 0"),
                "{error}"
            );
        }
    }
}
