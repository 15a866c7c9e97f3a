//! Laws of dictionaries, of projected dictionaries, and of their coherence and isometry.

use super::{complete, drawn, linear, shape};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::sensing::{Basis, Dictionary, Ensemble, SensedDictionary};
use ndarray::{Array2, Axis};

const FIXED: [Basis; 3] = [Basis::Dct, Basis::Haar, Basis::Daubechies4];

fn frames(n_frames: usize, n: usize) -> Array2<f64> {
    Array2::from_shape_fn((n_frames, n), |(i, j)| {
        ((1 + i) as f64 * 0.37 * j as f64).sin() + 0.3
    })
}

/// Returns the dictionary of the `k` atoms with the largest energy in the frames of an 8 × 8 array.
fn learned(basis: Basis, frames: &Array2<f64>, k: Option<usize>) -> Dictionary {
    Dictionary::learned(basis, shape(8, 8), frames.view(), k, &Seed::new(1)).unwrap()
}

fn largest(values: &Array2<f64>) -> f64 {
    values.iter().fold(0.0, |most, v| most.max(v.abs()))
}

#[test]
fn atoms_are_orthonormal_and_synthesis_undoes_analysis() {
    for basis in FIXED {
        for grid in [(8, 8), (1, 16), (4, 2), (2, 32), (1, 1)].map(|(ny, nx)| shape(ny, nx)) {
            let n = grid.ny * grid.nx;
            let dictionary = complete(basis, grid);
            let atoms = dictionary.synthesise(Array2::eye(n).view());
            let error = atoms.dot(&atoms.t()) - Array2::<f64>::eye(n);
            assert!(largest(&error) < 1e-13, "{basis:?} {grid:?}");
            let frames = frames(5, n);
            let coefficients = dictionary.analyse(frames.view());
            let slow = frames.dot(&atoms.t());
            assert!(largest(&(&coefficients - &slow)) < 1e-12, "{basis:?}");
            let again = dictionary.synthesise(coefficients.view());
            assert!(largest(&(&again - &frames)) < 1e-12, "{basis:?} {grid:?}");
        }
    }
}

#[test]
fn a_constant_frame_is_one_atom_and_a_plane_few() {
    for basis in FIXED {
        let dictionary = complete(basis, shape(16, 16));
        let constant = Array2::from_elem((1, 256), 2.0);
        let coefficients = dictionary.analyse(constant.view());
        let n_used = coefficients.iter().filter(|c| c.abs() > 1e-12).count();
        assert_eq!(n_used, 1, "{basis:?}");
        assert!((coefficients[[0, 0]].abs() - 32.0).abs() < 1e-12);
    }
    // Two vanishing moments: a linear slope has no details, except for the jump at the periodic edge.
    let slope = Array2::from_shape_fn((1, 64), |(_, j)| j as f64);
    let dictionary = complete(Basis::Daubechies4, shape(1, 64));
    let details = dictionary.analyse(slope.view());
    let n_used = details.iter().filter(|c| c.abs() > 1e-9).count();
    assert!(n_used < 16, "{n_used}");
}

#[test]
fn a_learned_dictionary_keeps_the_atoms_that_carry_most() {
    let frames = frames(30, 64);
    for basis in FIXED {
        let all = complete(basis, shape(8, 8));
        let squares = all.analyse(frames.view()).mapv(|c| c * c);
        let mut energy = squares.mean_axis(Axis(0)).unwrap().to_vec();
        energy.sort_by(|a, b| b.total_cmp(a));
        let learned = learned(basis, &frames, Some(10));
        let kept = learned.energy().unwrap();
        assert_eq!(learned.n_atoms(), 10);
        assert!((kept.of_atoms.sum() - energy[..10].iter().sum::<f64>()).abs() < 1e-12);
        assert!((kept.rest - energy[10..].iter().sum::<f64>() / 64.0).abs() < 1e-12);
    }
}

#[test]
fn energies_and_rest_add_up_to_the_mean_square_of_training_frames() {
    let frames = frames(30, 64);
    for basis in [Basis::Dct, Basis::Haar, Basis::Daubechies4, Basis::Pca] {
        for n_atoms in [Some(1), Some(7), None] {
            let learned = learned(basis, &frames, n_atoms);
            let centred = &frames - learned.origin();
            let square = centred.iter().map(|x| x * x).sum::<f64>() / 30.0;
            let energy = learned.energy().unwrap();
            let sum = energy.of_atoms.sum() + 64.0 * energy.rest;
            assert!((sum / square - 1.0).abs() < 1e-10, "{basis:?} {n_atoms:?}");
        }
    }
}

#[test]
fn principal_components_show_training_frames_best() {
    let frames = frames(30, 64);
    let missed = |basis| {
        let learned = learned(basis, &frames, Some(8));
        let shown = learned.synthesise(learned.analyse(frames.view()).view());
        (&shown - &frames).iter().map(|e| e * e).sum::<f64>()
    };
    let pca = missed(Basis::Pca);
    assert!(FIXED.into_iter().all(|basis| pca < missed(basis)));
}

#[test]
fn sensed_atoms_are_the_projection_times_the_dictionary() {
    let frames = frames(30, 64);
    for ensemble in [Ensemble::Gaussian, Ensemble::Sbhe, Ensemble::Sparse] {
        let projection = drawn(ensemble, shape(8, 8), 20, 2);
        for basis in [Basis::Dct, Basis::Haar, Basis::Pca] {
            let dictionary = learned(basis, &frames, Some(12));
            let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
            let atoms = dictionary.synthesise(Array2::eye(12).view()) - dictionary.origin();
            let slow = atoms.dot(&projection.matrix().t());
            assert!(largest(&(&sensed.atoms() - &slow)) < 1e-12, "{basis:?}");
            let gram = slow.dot(&slow.t());
            assert!(largest(&(sensed.gram() - &gram)) < 1e-12);
        }
    }
}

#[test]
fn row_norm_and_row_gram_are_those_of_the_matrix() {
    for ensemble in linear() {
        for (grid, m) in [(shape(8, 8), 16), (shape(5, 7), 9)] {
            let projection = drawn(ensemble, grid, m, 2);
            let matrix = projection.matrix();
            let square = matrix.iter().map(|v| v * v).sum::<f64>() / matrix.nrows() as f64;
            let error = projection.row_norm() - square.sqrt();
            assert!(error.abs() < 1e-12, "{ensemble:?}: {error}");
            let gram = projection.row_gram() - matrix.dot(&matrix.t());
            assert!(largest(&gram) < 1e-12, "{ensemble:?}");
        }
    }
}

#[test]
fn coherence_is_the_largest_cosine_between_two_columns() {
    let dictionary = complete(Basis::Dct, shape(8, 8));
    let projection = drawn(Ensemble::Gaussian, shape(8, 8), 24, 2);
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    let a = sensed.atoms();
    let mut slow: f64 = 0.0;
    for i in 0..64 {
        for j in 0..i {
            let (x, y) = (a.row(i), a.row(j));
            slow = slow.max(x.dot(&y).abs() / (x.dot(&x) * y.dot(&y)).sqrt());
        }
    }
    let coherence = sensed.coherence();
    assert!((coherence.mutual - slow).abs() < 1e-14);
    assert_eq!(coherence.n_invisible, 0);
    // Welch's bound √((k − m) / (m (k − 1))).
    assert!((coherence.welch_bound - f64::sqrt(40.0 / 1512.0)).abs() < 1e-10);
    assert!(coherence.mutual > coherence.welch_bound);
}

#[test]
fn atoms_that_averaging_wipes_out_are_counted_not_compared() {
    // Averages of 2 × 2 taxels of the finest Haar details are zero, which are three quarters of the atoms.
    let dictionary = complete(Basis::Haar, shape(8, 8));
    let projection = drawn(Ensemble::BlockAverage, shape(8, 8), 16, 2);
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    let coherence = sensed.coherence();
    assert_eq!(coherence.n_invisible, 48);
    assert!(coherence.mutual < 1e-12, "coarse atoms stay orthogonal");
}

#[test]
fn full_sampling_keeps_every_support_an_isometry() {
    let dictionary = complete(Basis::Haar, shape(8, 8));
    let projection = drawn(Ensemble::Identity, shape(8, 8), 64, 2);
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    assert!(sensed.coherence().mutual < 1e-13);
    for extremes in sensed.isometry(9, 20, &Seed::new(3)).unwrap() {
        assert!(extremes.deviation() < 1e-12);
    }
}

#[test]
fn the_isometry_of_all_atoms_is_known_where_rows_are_orthonormal() {
    // With A Aᵀ = 1 (m × m), the matrix AᵀA has m eigenvalues 1 and others 0. Columns of mean square norm m / k scale the eigenvalues by k / m.
    let dictionary = complete(Basis::Dct, shape(8, 8));
    let projection = drawn(Ensemble::Sbhe, shape(8, 8), 16, 2);
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    let all = sensed.isometry(64, 2, &Seed::new(3)).unwrap();
    for extremes in all {
        assert!(extremes.low < 1e-12 && (extremes.high - 4.0).abs() < 1e-12);
    }
}

#[test]
fn more_measurements_or_fewer_atoms_bring_a_projection_nearer_to_an_isometry() {
    let dictionary = complete(Basis::Dct, shape(16, 16));
    let mean = |m, sparsity| {
        let projection = drawn(Ensemble::Gaussian, shape(16, 16), m, 2);
        let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
        let all = sensed.isometry(sparsity, 50, &Seed::new(3)).unwrap();
        assert_eq!(all, sensed.isometry(sparsity, 50, &Seed::new(3)).unwrap());
        all.iter().map(|e| e.deviation()).sum::<f64>() / 50.0
    };
    assert!(mean(128, 8) < mean(64, 8));
    assert!(mean(64, 4) < mean(64, 8));
    assert!(mean(64, 1) > 0.0);
}

#[test]
fn bad_dictionaries_are_refused_by_a_clear_sentence() {
    let seed = Seed::new(1);
    let of_basis = |basis, grid| Dictionary::complete(basis, grid).unwrap_err().to_string();
    for (basis, grid, expected) in [
        (Basis::Haar, shape(8, 12), "12 × 8 taxels; a power of two"),
        (
            Basis::Daubechies4,
            shape(8, 12),
            "12 × 8 taxels; a power of two",
        ),
        (Basis::Dct, shape(0, 3), "no taxels"),
        (Basis::Pca, shape(4, 4), "without training frames"),
    ] {
        let error = of_basis(basis, grid);
        assert!(error.contains(expected), "{error}");
    }
    let grid = shape(4, 4);
    let mut broken = frames(3, 16);
    broken[[1, 5]] = f64::NAN;
    for (frames, n_atoms, expected) in [
        (frames(3, 15), None, "at least one, of 16 taxels"),
        (frames(0, 16), None, "0 of 16 taxels"),
        (frames(3, 16), Some(0), "number of atoms: 0"),
        (broken, None, "training frame 1, taxel 5: NaN"),
    ] {
        let learned = Dictionary::learned(Basis::Dct, grid, frames.view(), n_atoms, &seed);
        let error = learned.unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let dictionary = complete(Basis::Dct, grid);
    let other = drawn(Ensemble::Sbhe, shape(4, 5), 4, 1);
    assert!(SensedDictionary::new(&other, &dictionary).is_err());
    let projection = drawn(Ensemble::Sbhe, grid, 4, 1);
    let sensed = SensedDictionary::new(&projection, &dictionary).unwrap();
    for sparsity in [0, 17] {
        assert!(sensed.isometry(sparsity, 1, &seed).is_err());
    }
    // Identical frames have no principal component.
    let same = Array2::from_elem((3, 16), 1.0);
    let flat = Dictionary::learned(Basis::Pca, grid, same.view(), None, &seed).unwrap();
    assert!(SensedDictionary::new(&projection, &flat).is_err());
}
