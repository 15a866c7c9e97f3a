//! Laws of the solvers, compared with slow oracles and with numbers of an independent program.

use super::{RANDOM, complete, drawn, gauss, shape};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::sensing::{
    Basis, Dictionary, Effort, Ensemble, Lasso, Lmmse, Omp, Projection, Reconstructor,
    SensedDictionary, Solver,
};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis, s};

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |most, v| most.max(v.abs()))
}

/// Returns s-sparse coefficients at scattered positions, all with different magnitudes.
fn sparse_rows(n_frames: usize, k: usize, s: usize) -> Array2<f64> {
    let mut rows = Array2::zeros((n_frames, k));
    for frame in 0..n_frames {
        for atom in 0..s {
            let place = (atom * 37 + frame * 11 + atom * atom * 5) % k;
            let sign = if (atom + frame) % 2 == 0 { 1.0 } else { -1.0 };
            rows[[frame, place]] = sign * (1.0 + 0.3 * atom as f64);
        }
    }
    rows
}

fn omp(most_atoms: usize, residual: f64) -> Omp {
    Omp {
        most_atoms,
        residual,
    }
}

fn lasso(lambda: f64, tolerance: f64, most_steps: usize) -> Lasso {
    Lasso {
        lambda,
        tolerance,
        most_steps,
    }
}

fn wavy_frames(n_frames: usize, n: usize) -> Array2<f64> {
    Array2::from_shape_fn((n_frames, n), |(i, j)| {
        let x = j as f64 / n as f64;
        (1..9)
            .map(|k| ((i * k * k) as f64).sin() / k as f64 * (k as f64 * 3.0 * x).cos())
            .sum()
    })
}

#[test]
fn pursuit_and_l1_recover_sparse_frames_from_enough_measurements_without_noise() {
    let grid = shape(16, 16);
    for ensemble in RANDOM {
        let projection = drawn(ensemble, grid, 100, 5);
        for basis in [Basis::Dct, Basis::Haar, Basis::Daubechies4] {
            let dictionary = complete(basis, grid);
            let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
            let truth = sparse_rows(6, 256, 8);
            let frames = dictionary.synthesise(truth.view());
            let y = projection.measure(frames.view());
            let omp = omp(20, 1e-9);
            let found = omp.solve(&sensed, y.view()).unwrap();
            assert!(!found.capped.contains(&true), "{ensemble:?} {basis:?}");
            let error = &found.coefficients - &truth;
            assert!(largest(&error) < 1e-8, "OMP, {ensemble:?} {basis:?}");
            let lasso = lasso(1e-4, 1e-10, 20_000);
            let found = lasso.solve(&sensed, y.view()).unwrap();
            assert!(!found.capped.contains(&true), "{ensemble:?} {basis:?}");
            let error = &found.coefficients - &truth;
            assert!(largest(&error) < 2e-3, "ℓ1, {ensemble:?} {basis:?}");
        }
    }
}

/// Orthogonal matching pursuit as in textbooks: residual, largest cosine, least squares on all chosen columns by normal equations.
fn naive_omp(a: ArrayView2<f64>, y: ArrayView1<f64>, n_atoms: usize) -> Array1<f64> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut residual = y.to_owned();
    let mut solution = Array1::zeros(0);
    for _ in 0..n_atoms {
        let cosine = |j: usize| {
            let column = a.column(j);
            column.dot(&residual).abs() / column.dot(&column).sqrt()
        };
        let best = (0..a.ncols())
            .filter(|j| !chosen.contains(j))
            .max_by(|&i, &j| cosine(i).total_cmp(&cosine(j)).then(j.cmp(&i)));
        chosen.push(best.unwrap());
        let part = a.select(Axis(1), &chosen);
        solution = gauss(part.t().dot(&part), part.t().dot(&y));
        residual = &y - &part.dot(&solution);
    }
    let mut coefficients = Array1::zeros(a.ncols());
    for (&atom, &value) in chosen.iter().zip(&solution) {
        coefficients[atom] = value;
    }
    coefficients
}

#[test]
fn batch_pursuit_is_the_textbook_pursuit() {
    let (grid, frames) = (shape(8, 8), wavy_frames(12, 64));
    for ensemble in RANDOM {
        let projection = drawn(ensemble, grid, 30, 6);
        let dictionary = complete(Basis::Dct, grid);
        let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
        let y = projection.measure(frames.view());
        for n_atoms in [1, 3, 10] {
            let omp = omp(n_atoms, 0.0);
            let found = omp.solve(&sensed, y.view()).unwrap();
            for (frame, row) in found.coefficients.outer_iter().enumerate() {
                let slow = naive_omp(sensed.atoms().t(), y.row(frame), n_atoms);
                let error = largest(&(&row - &slow));
                assert!(error < 1e-9, "{ensemble:?}, {n_atoms} atoms: {error}");
            }
        }
    }
}

#[test]
fn pursuit_stops_at_the_residual_and_says_when_it_could_not_reach_it() {
    let (grid, frames) = (shape(8, 8), wavy_frames(10, 64));
    let projection = drawn(Ensemble::Gaussian, grid, 40, 6);
    let dictionary = complete(Basis::Dct, grid);
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    let y = projection.measure(frames.view());
    for (most_atoms, residual) in [(40, 0.5), (3, 0.05)] {
        let omp = omp(most_atoms, residual);
        let found = omp.solve(&sensed, y.view()).unwrap();
        for (frame, alpha) in found.coefficients.outer_iter().enumerate() {
            let left = &y.row(frame) - &alpha.dot(&sensed.atoms());
            let norm = left.dot(&left).sqrt();
            assert_eq!(found.capped[frame], norm > residual, "{norm}");
        }
        assert_eq!(found.capped.contains(&true), most_atoms == 3);
    }
}

#[test]
fn the_l1_solution_meets_the_optimality_conditions() {
    let (grid, frames) = (shape(8, 8), wavy_frames(20, 64));
    for (ensemble, m) in [(Ensemble::Gaussian, 20), (Ensemble::Sbhe, 50)] {
        let projection = drawn(ensemble, grid, m, 6);
        let dictionary = complete(Basis::Dct, grid);
        let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
        let y = projection.measure(frames.view());
        // With a penalty above every correlation, no coefficient remains.
        let none = 1.0001 * largest(&y.dot(&sensed.atoms().t()));
        for lambda in [0.01, 0.1, 0.5, none] {
            let lasso = lasso(lambda, 1e-12, 100_000);
            let found = lasso.solve(&sensed, y.view()).unwrap();
            assert!(!found.capped.contains(&true));
            assert!(lambda < none || largest(&found.coefficients) == 0.0);
            for (frame, alpha) in found.coefficients.outer_iter().enumerate() {
                let left = &y.row(frame) - &alpha.dot(&sensed.atoms());
                let slopes = sensed.atoms().dot(&left);
                for (slope, value) in slopes.iter().zip(alpha) {
                    assert!(slope.abs() <= lambda * (1.0 + 1e-3));
                    if value.abs() > 1e-4 {
                        assert!((slope - lambda * value.signum()).abs() < 1e-3 * lambda);
                    }
                }
            }
        }
    }
}

/// Returns a small problem with known solutions: 24 taxels in a row, all 24 cosines as atoms, and 10 measurements. The measurements are averages over blocks of
/// 2, 2, 3, 2, 3, 2, 2, 3, 2, 3 taxels.
fn golden_problem() -> (Projection, Dictionary, Array2<f64>) {
    let grid = shape(1, 24);
    let projection = drawn(Ensemble::BlockAverage, grid, 10, 1);
    let dictionary = complete(Basis::Dct, grid);
    let y = Array2::from_shape_fn((1, 10), |(_, i)| (0.7 * i as f64).sin() + 0.1 * i as f64);
    (projection, dictionary, y)
}

/// Reference: minima of the objective by `Lasso(alpha=lam / 10, fit_intercept=False, tol=1e-14, max_iter=1000000)` of scikit-learn 1.9.1.
#[test]
fn a_solved_l1_objective_is_within_the_tolerance_of_scikit_learn_at_any_penalty() {
    let (projection, dictionary, y) = golden_problem();
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    for (lambda, minimum) in [
        (5e-1, 2.030066164644258),
        (5e-2, 0.3375109799824605),
        (5e-3, 0.036636369069384354),
        (5e-4, 0.0036936724369639614),
        (5e-5, 0.00036966759899665133),
    ] {
        let tolerance = Effort::default().tolerance;
        for most_steps in [3, 10_000] {
            let lasso = lasso(lambda, tolerance, most_steps);
            let found = lasso.solve(&sensed, y.view()).unwrap();
            let alpha = found.coefficients.row(0);
            let left = &y.row(0) - &alpha.dot(&sensed.atoms());
            let l1: f64 = alpha.iter().map(|a| a.abs()).sum();
            let excess = (0.5 * left.dot(&left) + lambda * l1) / minimum - 1.0;
            assert!(excess > -1e-9, "{lambda}: {excess}");
            assert!(found.capped[0] || excess <= tolerance, "{lambda}: {excess}");
            let is_capped = most_steps == 3 && lambda < 0.1;
            assert_eq!(found.capped[0], is_capped, "{lambda}: {excess}");
        }
    }
}

/// Computes the LMMSE estimate with the explicit covariance, solving one system per measurement.
fn dense_lmmse(sensed: &SensedDictionary, noise_std: f64, y: ArrayView2<f64>) -> Array2<f64> {
    let (phi, dictionary) = (sensed.projection().matrix(), sensed.dictionary());
    let energy = dictionary.energy().unwrap();
    let k = dictionary.n_atoms();
    let atoms = dictionary.synthesise(Array2::eye(k).view()) - dictionary.origin();
    let prior = atoms
        .t()
        .dot(&Array2::from_diag(&energy.of_atoms))
        .dot(&atoms);
    let rest = (energy.rest + noise_std * noise_std) * phi.dot(&phi.t());
    let of_measurements = phi.dot(&prior).dot(&phi.t()) + rest;
    let cross = prior.dot(&phi.t());
    let mut frames = Array2::zeros((y.nrows(), phi.ncols()));
    for (y, mut frame) in y.outer_iter().zip(frames.outer_iter_mut()) {
        let centred = &y - &phi.dot(dictionary.origin());
        let weights = gauss(of_measurements.clone(), centred);
        frame.assign(&(dictionary.origin() + &cross.dot(&weights)));
    }
    frames
}

#[test]
fn the_linear_estimate_is_its_dense_formula() {
    let (grid, frames) = (shape(6, 6), wavy_frames(40, 36));
    let noise_std = 0.2;
    for ensemble in RANDOM.into_iter().chain([Ensemble::BlockAverage]) {
        // With 4 atoms the estimate goes through coefficients, with 30 directly to taxels.
        for (basis, k) in [(Basis::Pca, 4), (Basis::Dct, 30), (Basis::Dct, 36)] {
            let seed = Seed::new(7);
            let projection = Projection::new(ensemble, grid, 9, &seed).unwrap();
            let train = frames.slice(s![..30, ..]);
            let dictionary = Dictionary::learned(basis, grid, train, Some(k), &seed).unwrap();
            let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
            let y = projection.measure(frames.slice(s![30.., ..]));
            let fast = Lmmse::new(&sensed, noise_std).unwrap().estimate(y.view());
            let slow = dense_lmmse(&sensed, noise_std, y.view());
            let error = largest(&(&fast - &slow));
            assert!(error < 1e-9, "{ensemble:?} {basis:?} {k}: {error}");
        }
    }
}

#[test]
fn the_linear_estimate_trusts_training_alone_when_noise_drowns_the_measurements() {
    let (grid, frames) = (shape(6, 6), wavy_frames(40, 36));
    let seed = Seed::new(7);
    let projection = Projection::new(Ensemble::Sbhe, grid, 20, &seed).unwrap();
    let dictionary = Dictionary::learned(Basis::Pca, grid, frames.view(), Some(8), &seed).unwrap();
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    let y = projection.measure(frames.view());
    let drowned = Lmmse::new(&sensed, 1e6).unwrap().estimate(y.view());
    assert!(largest(&(&drowned - dictionary.origin())) < 1e-9);
    // Eight components represent these frames, and 20 noise-free measurements determine them.
    let clear = Lmmse::new(&sensed, 0.0).unwrap().estimate(y.view());
    let square = |a: &Array2<f64>| a.iter().map(|e| e * e).sum::<f64>();
    assert!(square(&(&clear - &frames)) < 1e-6 * square(&frames));
}

#[test]
fn a_frame_is_reconstructed_the_same_in_every_batch() {
    let (grid, frames) = (shape(8, 8), wavy_frames(70, 64));
    let seed = Seed::new(8);
    let projection = Projection::new(Ensemble::Gaussian, grid, 24, &seed).unwrap();
    for basis in [Basis::Dct, Basis::Pca] {
        let dictionary = Dictionary::learned(basis, grid, frames.view(), Some(40), &seed).unwrap();
        let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
        let y = projection.measure(frames.view());
        for solver in [Solver::Omp, Solver::L1, Solver::Lmmse] {
            let reconstructor =
                Reconstructor::new(solver, &sensed, &Effort::default(), 0.02).unwrap();
            let together = reconstructor.reconstruct(y.view()).unwrap();
            for (start, end) in [(0, 1), (3, 5), (10, 70)] {
                let apart = reconstructor
                    .reconstruct(y.slice(s![start..end, ..]))
                    .unwrap();
                assert_eq!(apart.frames, together.frames.slice(s![start..end, ..]));
                assert_eq!(apart.n_atoms, together.n_atoms[start..end]);
                assert_eq!(apart.capped, together.capped[start..end]);
            }
            let none = reconstructor.reconstruct(y.slice(s![..0, ..])).unwrap();
            assert_eq!(none.frames.dim(), (0, 64));
        }
    }
}

#[test]
fn limits_out_of_range_and_untrained_dictionaries_are_refused() {
    let grid = shape(4, 4);
    let projection = drawn(Ensemble::Gaussian, grid, 8, 1);
    let dictionary = complete(Basis::Dct, grid);
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    let y = Array2::zeros((1, 8));
    for (most_atoms, residual, expected) in [
        (0, 0.1, "most atoms: 0; at least 1"),
        (1, -0.1, "residual: -0.1"),
        (1, f64::NAN, "residual: NaN"),
    ] {
        let error = omp(most_atoms, residual).solve(&sensed, y.view());
        assert!(error.unwrap_err().to_string().starts_with(expected));
    }
    for (lambda, tolerance, most_steps, expected) in [
        (0.0, 1e-3, 10, "lambda: 0"),
        (1.0, f64::INFINITY, 10, "tolerance"),
        (1.0, 1e-3, 0, "most steps: 0; at least 1"),
    ] {
        let error = lasso(lambda, tolerance, most_steps).solve(&sensed, y.view());
        assert!(error.unwrap_err().to_string().starts_with(expected));
    }
    let untrained = Lmmse::new(&sensed, 0.1).unwrap_err().to_string();
    assert!(
        untrained.contains("has seen no training frames"),
        "{untrained}"
    );
    let frames = Array2::ones((3, 16));
    let trained =
        Dictionary::learned(Basis::Dct, grid, frames.view(), None, &Seed::new(1)).unwrap();
    let sensed = SensedDictionary::new(&projection, &trained).unwrap();
    assert!(
        Lmmse::new(&sensed, -1.0)
            .unwrap_err()
            .to_string()
            .starts_with("noise std: -1")
    );
    // A frame of zeros has no atoms.
    let zero = Reconstructor::new(Solver::Omp, &sensed, &Effort::default(), 0.1).unwrap();
    assert_eq!(zero.reconstruct(y.view()).unwrap().n_atoms, [0]);
}
