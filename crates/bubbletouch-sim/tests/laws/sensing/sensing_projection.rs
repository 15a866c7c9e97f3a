//! Laws of all ensembles.

use super::{RANDOM, drawn, gauss, linear, shape};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::sensing::{Ensemble, Projection};
use ndarray::{Array2, ArrayView2, s};

fn frames(n_frames: usize, n: usize) -> Array2<f64> {
    Array2::from_shape_fn((n_frames, n), |(i, j)| {
        ((1 + i) as f64 * 0.37 * j as f64).sin()
    })
}

fn bits(values: ArrayView2<f64>) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

#[test]
fn measuring_what_is_touched_is_measuring_the_frame() {
    for ensemble in linear() {
        for (grid, m) in [
            (shape(1, 1), 1),
            (shape(3, 5), 4),
            (shape(12, 9), 50),
            (shape(64, 64), 256),
        ] {
            let projection = drawn(ensemble, grid, m, 2018);
            let columns = projection.columns();
            let n = grid.ny * grid.nx;
            assert_eq!(columns.n_taxels(), n);
            let mut frames = frames(3, n);
            frames.mapv_inplace(|value| if value > 0.6 { value } else { 0.0 });
            let whole = projection.measure(frames.view());
            let mut measurements = vec![f64::NAN; columns.n_measurements()];
            for (frame, expected) in frames.outer_iter().zip(whole.outer_iter()) {
                let touched = frame.iter().copied().enumerate();
                columns
                    .measure_touched(touched.filter(|&(_, value)| value > 0.0), &mut measurements);
                for (fast, slow) in measurements.iter().zip(expected) {
                    assert!((fast - slow).abs() < 1e-12, "{ensemble:?} {fast} {slow}");
                }
            }
        }
    }
}

#[test]
fn larger_hadamard_blocks_read_more_taxels_and_their_rows_are_orthonormal_too() {
    let seed = Seed::new(5);
    let (grid, m) = (shape(64, 64), 16);
    let mut last = 0;
    for block in [1, 32, 256, 4096] {
        let projection = Projection::sbhe(grid, m, block, &seed).unwrap();
        let n_read = projection.columns().n_read();
        assert!(n_read > last && n_read <= m * block, "{block}: {n_read}");
        assert_eq!(projection.columns().n_entries(), m * block);
        last = n_read;
        let matrix = projection.matrix();
        let products = matrix.dot(&matrix.t()) - Array2::<f64>::eye(m);
        assert!(products.iter().all(|error| error.abs() < 1e-13));
    }
    assert_eq!(last, 4096);
    let published = Projection::new(Ensemble::Sbhe, grid, m, &seed).unwrap();
    let same = Projection::sbhe(grid, m, 32, &seed).unwrap();
    assert_eq!(published.matrix(), same.matrix());
    let error = Projection::sbhe(grid, m, 48, &seed).unwrap_err();
    assert_eq!(error.to_string(), "Hadamard block: 48; a power of two");
}

#[test]
fn measuring_is_multiplying_by_the_matrix() {
    for (grid, m) in [
        (shape(1, 1), 1),
        (shape(3, 5), 4),
        (shape(12, 9), 50),
        (shape(8, 8), 64),
        (shape(9, 9), 1),
    ] {
        let blocks = [8, 128].map(|block| Projection::sbhe(grid, m, block, &Seed::new(3)));
        let all = linear().map(|ensemble| drawn(ensemble, grid, m, 2018));
        for projection in all.chain(blocks.map(Result::unwrap)) {
            let frames = frames(19, grid.n_values());
            let matrix = projection.matrix();
            let slow = Array2::from_shape_fn((19, matrix.nrows()), |(i, k)| {
                let terms = frames.row(i).into_iter().zip(matrix.row(k));
                terms.map(|(x, a)| x * a).sum::<f64>()
            });
            let error = &projection.measure(frames.view()) - &slow;
            let is_small = error.iter().all(|e| e.abs() < 1e-13);
            assert!(is_small, "{:?} {grid:?}", projection.ensemble());
        }
    }
}

#[test]
fn a_frame_has_the_same_measurements_in_every_batch() {
    for ensemble in linear() {
        for (grid, m) in [
            (shape(64, 64), 64),
            (shape(31, 17), 100),
            (shape(5, 7), 35),
            (shape(9, 9), 1),
        ] {
            let projection = drawn(ensemble, grid, m, 2018);
            let frames = frames(150, grid.ny * grid.nx);
            let together = projection.measure(frames.view());
            for batch in [0, 1, 2, 3, 7, 8, 64, 149] {
                for start in [0, 1, 150 - batch] {
                    let rows = s![start..start + batch, ..];
                    let apart = projection.measure(frames.slice(rows));
                    assert_eq!(
                        bits(apart.view()),
                        bits(together.slice(rows)),
                        "{ensemble:?}, batch of {batch} from {start}"
                    );
                }
            }
        }
    }
}

#[test]
fn taxels_that_read_nothing_change_no_bit() {
    // One frame of ones makes every taxel count.
    for ensemble in linear() {
        for (grid, m) in [
            (shape(64, 64), 70),
            (shape(31, 17), 100),
            (shape(5, 7), 35),
            (shape(9, 9), 1),
        ] {
            let projection = drawn(ensemble, grid, m, 2018);
            let n = grid.ny * grid.nx;
            for (above, from) in [(0.0, 0), (0.9, 0), (0.0, n / 2), (0.99, n / 3), (1.0, 0)] {
                let mut frames = frames(6, n);
                for ((_, taxel), value) in frames.indexed_iter_mut() {
                    if *value <= above || taxel < from {
                        *value = 0.0;
                    }
                }
                let touched = s![..5, ..];
                let apart = projection.measure(frames.slice(touched));
                frames.row_mut(5).fill(1.0);
                let together = projection.measure(frames.view());
                let what = format!("{ensemble:?}, {grid:?}, over {above} from {from}");
                assert_eq!(bits(apart.view()), bits(together.slice(touched)), "{what}");
            }
        }
    }
}

#[test]
fn memory_layout_changes_nothing() {
    for ensemble in linear() {
        let projection = drawn(ensemble, shape(16, 16), 40, 2018);
        let frames = frames(21, 256);
        let column_major = frames.t().as_standard_layout().into_owned();
        let mut wide = Array2::zeros((21, 2 * projection.n_measurements()));
        projection.measure_into(column_major.t(), wide.slice_mut(s![.., ..;2]));
        let expected = projection.measure(frames.view());
        assert_eq!(
            bits(wide.slice(s![.., ..;2])),
            bits(expected.view()),
            "{ensemble:?}"
        );
    }
}

#[test]
fn a_smaller_projection_is_a_prefix_of_a_larger_bit_by_bit() {
    for ensemble in linear() {
        if !ensemble.is_prefix_nested() || ensemble == Ensemble::Identity {
            continue;
        }
        for grid in [(32, 32), (13, 11)].map(|(ny, nx)| shape(ny, nx)) {
            let n = grid.ny * grid.nx;
            let frames = frames(9, n);
            let largest = drawn(ensemble, grid, n, 2018).measure(frames.view());
            for m in [1, 2, 5, 16, 64, 100, n - 1] {
                let smaller = drawn(ensemble, grid, m, 2018).measure(frames.view());
                assert_eq!(
                    bits(smaller.view()),
                    bits(largest.slice(s![.., ..m])),
                    "{ensemble:?} {m}"
                );
            }
        }
    }
}

#[test]
fn coarse_block_averages_are_averages_of_fine_ones() {
    let frames = frames(4, 256);
    let of = |m| drawn(Ensemble::BlockAverage, shape(16, 16), m, 2018).measure(frames.view());
    let (fine, coarse, one) = (of(64), of(16), of(1));
    for frame in 0..4 {
        for block in 0..16 {
            let corner = 16 * (block / 4) + 2 * (block % 4);
            let children = [corner, corner + 1, corner + 8, corner + 9];
            let mean = children.iter().map(|&c| fine[[frame, c]]).sum::<f64>() / 4.0;
            assert!((coarse[[frame, block]] - mean).abs() < 1e-15);
        }
        assert!((one[[frame, 0]] - frames.row(frame).sum() / 256.0).abs() < 1e-15);
    }
}

#[test]
fn as_many_measurements_as_taxels_lose_nothing() {
    for side in [2, 8, 12, 16] {
        let n = side * side;
        let frame = Array2::from_shape_fn((1, n), |(_, i)| 5e-3 * (1.3 * i as f64).sin().max(0.0));
        // A circulant matrix may be singular.
        for ensemble in linear().filter(|one| *one != Ensemble::Circulant) {
            let projection = drawn(ensemble, shape(side, side), n, 4);
            let measured = projection.measure(frame.view());
            let back = gauss(projection.matrix(), measured.row(0).to_owned());
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
                let is_near = (back - x).abs() < 1e-9 * 5e-3 * n as f64;
                assert!(is_near, "{ensemble:?}, {n}: {back} {x}");
            }
        }
    }
}

#[test]
fn random_ensembles_keep_distances_between_frames() {
    let (n, m) = (1024, 256);
    let frames = frames(12, n);
    for ensemble in RANDOM {
        let measured = drawn(ensemble, shape(32, 32), m, 2018).measure(frames.view());
        for a in 0..12 {
            for b in 0..a {
                let square = |rows: &Array2<f64>| {
                    let difference = &rows.row(a) - &rows.row(b);
                    difference.dot(&difference)
                };
                let ratio = square(&measured) * n as f64 / m as f64 / square(&frames);
                // By Johnson and Lindenstrauss, the distance of one pair changes by more than a factor 1 ± ε with probability
                // 2 exp(−m (ε²/4 − ε³/6)) = 3e-5 at ε = 0.45. There are 132 pairs, and the seed is fixed.
                assert!((ratio - 1.0).abs() < 0.45, "{ensemble:?}: {ratio}");
            }
        }
    }
}

#[test]
fn independent_entries_have_mean_zero_and_variance_one_over_n() {
    // Variance of z² for a standardised entry z: 2 for Gaussian, 0 for ±1, s − 1 for sparse entries.
    for (ensemble, of_squares) in [
        (Ensemble::Gaussian, 2.0),
        (Ensemble::Bernoulli, 1e-20),
        (Ensemble::Sparse, 19.0),
    ] {
        let matrix = drawn(ensemble, shape(20, 20), 400, 2018).matrix();
        let count = 160_000.0f64;
        let mean = matrix.sum() / count;
        let variance = matrix.iter().map(|v| v * v).sum::<f64>() / count;
        assert!(mean.abs() < 4.0 / (400.0 * count).sqrt(), "{ensemble:?}");
        let error = (variance * 400.0 - 1.0).abs();
        assert!(error < 4.0 * f64::sqrt(of_squares / count), "{ensemble:?}");
    }
}

#[test]
fn bernoulli_entries_have_one_magnitude_and_sparse_ones_three_values_at_a_density_of_one_over_root_n()
 {
    let bernoulli = drawn(Ensemble::Bernoulli, shape(16, 16), 100, 2018).matrix();
    assert!(bernoulli.iter().all(|v| v.abs() == 1.0 / 16.0));
    let sparse = drawn(Ensemble::Sparse, shape(16, 16), 256, 2018).matrix();
    // With s = 16, entries are ±√(16/256) = ±0.25.
    assert!(sparse.iter().all(|v| [0.0, 0.25].contains(&v.abs())));
    let n_set = sparse.iter().filter(|v| **v != 0.0).count() as f64;
    let (entries, density) = (65_536.0, 1.0 / 16.0);
    let std = f64::sqrt(entries * density * (1.0 - density));
    assert!((n_set - entries * density).abs() < 4.0 * std, "{n_set}");
}

#[test]
fn a_subsample_takes_each_taxel_at_most_once() {
    let matrix = drawn(Ensemble::Subsample, shape(9, 7), 63, 2018).matrix();
    assert_eq!(matrix.sum(), 63.0);
    assert!(matrix.columns().into_iter().all(|c| c.sum() == 1.0));
}

#[test]
fn identity_gives_the_frame_whatever_is_asked() {
    let frames = frames(3, 20);
    let projection = drawn(Ensemble::Identity, shape(4, 5), 2, 2018);
    assert_eq!(projection.n_measurements(), 20);
    assert_eq!(projection.measure(frames.view()), frames);
}

#[test]
fn another_seed_draws_another_projection() {
    for ensemble in RANDOM.into_iter().chain([Ensemble::Subsample]) {
        let of = |seed| drawn(ensemble, shape(8, 8), 16, seed).matrix();
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
    }
}

#[test]
fn no_measurement_and_more_than_taxels_are_refused() {
    for ensemble in linear() {
        for (grid, m) in [(shape(4, 4), 0), (shape(4, 4), 17), (shape(0, 4), 1)] {
            let error = Projection::new(ensemble, grid, m, &Seed::new(1)).unwrap_err();
            assert!(error.to_string().starts_with("number of measurements"));
        }
    }
}
