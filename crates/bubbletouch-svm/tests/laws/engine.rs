//! The SVM engine against the definitions: every objective, violation and duality gap is recomputed from the features, one kernel value at a time. The checks
//! use no cached or rounded values of the solver.

use crate::drawn::{folds, params, rng};
use crate::svm_conditions::{Worth, kernel_value};
use bubbletouch_svm::class_weight::ClassWeight;
use bubbletouch_svm::cross_validation::choice::{Candidates, Chosen, choose, choose_c};
use bubbletouch_svm::dataset::{Dataset, dataset, rows};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::predict::svm_model::SvmModel;
use bubbletouch_svm::split::Split;
use bubbletouch_svm::{BinaryProblem, Multiclass, Result, SvmParams};
use ndarray::{Array1, Array2};
use rand::Rng;
use rand_distr::StandardNormal;

const RBF: Kernel = Kernel::Rbf {
    gamma: Gamma::Value(0.15),
};
const CUBIC: Kernel = Kernel::Polynomial {
    gamma: Gamma::Value(0.1),
    coef0: 1.0,
    degree: 3,
};
const KERNELS: [Kernel; 3] = [Kernel::Linear, RBF, CUBIC];

/// Returns normal clouds of `counts` rows, one cloud per class, in `m` features of unit standard deviation. The centres lie `apart` times a normal vector from
/// the origin; the rows of all classes are mixed.
fn clouds(counts: &[usize], m: usize, apart: f64, seed: u64) -> Dataset {
    let mut draws = rng(seed, &["centres"]);
    let centres = Array2::from_shape_fn((counts.len(), m), |_| {
        apart * draws.sample::<f64, _>(StandardNormal)
    });
    let mut labels: Vec<usize> = (0..counts.len())
        .flat_map(|class| std::iter::repeat_n(class, counts[class]))
        .collect();
    let mut rng = rng(seed, &["rows"]);
    for last in (1..labels.len()).rev() {
        labels.swap(last, rng.gen_range(0..=last));
    }
    let features = Array2::from_shape_fn((labels.len(), m), |(i, j)| {
        centres[[labels[i], j]] + rng.sample::<f64, _>(StandardNormal)
    });
    dataset(features, Array1::from(labels)).unwrap()
}

fn near(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * a.abs().max(b.abs())
}

fn assert_same_objectives(a: &SvmModel, b: &SvmModel, relative: f64, name: &str) {
    assert_eq!(a.problems().len(), b.problems().len(), "{name}");
    for (a, b) in a.problems().iter().zip(b.problems()) {
        assert_eq!((a.positive, a.negative), (b.positive, b.negative), "{name}");
        let [a, b] = [a, b].map(|problem| problem.solution.objective);
        assert!(near(a, b, relative), "{name}: {a} and {b}");
    }
}

/// Returns whether the kernel values of a model are f32. Only the `Debug` form of the model shows the precision.
fn is_single(model: &SvmModel) -> bool {
    format!("{model:?}").contains("Single(")
}

/// Returns the fraction of equal labels.
fn agreement(a: &Array1<usize>, b: &Array1<usize>) -> f64 {
    a.iter().zip(b).filter(|(a, b)| a == b).count() as f64 / a.len() as f64
}

fn worst_difference(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    (a - b).iter().fold(0.0, |max, value| value.abs().max(max))
}

// Memory.

/// Asserts that the memory limit changes no result. Pairs have 400 rows and all classes 600, so that variables are omitted if the submatrix fits in memory.
fn assert_memory_changes_nothing(multiclass: Multiclass) {
    let data = clouds(&[200, 200, 200], 6, 0.6, 1);
    let probes = clouds(&[70, 70, 70], 6, 0.6, 1).records;
    for kernel in KERNELS {
        let ample = SvmParams {
            multiclass,
            ..params(kernel, 1.0, 1e-5)
        };
        let expected = ample.train(&data).unwrap();
        // Memory for two rows, for some dozen rows, and for most rows with a part of the matrix.
        for memory_bytes in [1, 45_000, 1_100_000] {
            let scarce = SvmParams {
                memory_bytes,
                ..ample
            };
            let model = scarce.train(&data).unwrap();
            let name = format!("{kernel:?}, {memory_bytes} bytes");
            assert_eq!(model.n_capped(), 0, "{name}");
            assert_same_objectives(&expected, &model, 1e-6, &name);
            for problem in model.problems() {
                assert!(problem.solution.violation.unwrap() <= 1e-5, "{name}");
            }
            assert_eq!(
                model.labels(probes.view()).unwrap(),
                expected.labels(probes.view()).unwrap(),
                "{name}"
            );
        }
    }
}

#[test]
fn pairs_of_classes_are_solved_alike_in_any_memory_down_to_two_rows() {
    assert_memory_changes_nothing(Multiclass::OneVsOne);
}

#[test]
fn a_class_against_the_rest_is_solved_alike_in_any_memory_down_to_two_rows() {
    assert_memory_changes_nothing(Multiclass::OneVsRest);
}

// Paths of C.

#[test]
fn each_model_of_a_path_is_that_of_training_its_c_alone_in_the_order_asked() {
    let data = clouds(&[30, 25, 20], 5, 1.0, 2);
    // With and without a repeated C.
    for (path, tolerance, relative) in [
        (
            &[1e6, 100.0, 1e-6, 1.0, 1.0, 0.01, 1e4, 1e-6][..],
            1e-3,
            1e-4,
        ),
        (&[1e6, 100.0, 1e-6, 1.0, 0.01, 1e4], 1e-8, 1e-8),
    ] {
        for kernel in [RBF, CUBIC] {
            for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
                let params = SvmParams {
                    multiclass,
                    ..params(kernel, 1.0, tolerance)
                };
                let models = params.train_path(&data, path).unwrap();
                assert_eq!(models.len(), path.len());
                for (model, &c) in models.iter().zip(path) {
                    let params = SvmParams { c, ..params };
                    let alone = params.train(&data).unwrap();
                    let name = format!("{kernel:?} {multiclass:?}, C = {c}, {tolerance}");
                    assert_eq!((model.n_capped(), alone.n_capped()), (0, 0), "{name}");
                    assert_same_objectives(model, &alone, relative, &name);
                }
            }
        }
    }
}

// Rows near the margin.

#[test]
fn wide_rows_that_few_support_are_solved_to_the_optimum_of_all_rows() {
    // With this many features, only rows near a margin are multiplied with each other; the classes are far apart, touching, or mixed.
    for (apart, counts, class_weight) in [
        (1.0, [90, 80, 70], ClassWeight::Uniform),
        (0.12, [90, 80, 70], ClassWeight::Uniform),
        (0.0, [90, 80, 100], ClassWeight::Uniform),
        (0.12, [40, 80, 120], ClassWeight::Balanced),
    ] {
        let params = |kernel, c, tolerance| SvmParams {
            class_weight,
            ..params(kernel, c, tolerance)
        };
        let data = clouds(&counts, 130, apart, 11);
        for tolerance in [1e-3, 1e-6] {
            let path = [0.001, 0.1, 1.0];
            let models = params(Kernel::Linear, 1.0, tolerance)
                .train_path(&data, &path)
                .unwrap();
            for (model, &c) in models.iter().zip(&path) {
                let params = params(Kernel::Linear, c, tolerance);
                let name = format!("{apart} apart, C = {c}, tolerance {tolerance}");
                for problem in model.problems() {
                    let worth = Worth::new(&params, &data, problem);
                    let rounding = if is_single(model) { 1e-4 } else { 0.0 };
                    assert!(
                        worth.spread <= 1.01 * tolerance + rounding,
                        "{name}: {worth:?}"
                    );
                    assert!(
                        near(worth.dual, problem.solution.objective, 1e-5),
                        "{name}: {worth:?}"
                    );
                }
                // The products of all rows do not fit, so pairs are solved one by one, on all their rows.
                let memory_bytes = 400_000;
                let slow = SvmParams {
                    memory_bytes,
                    ..params
                }
                .train(&data)
                .unwrap();
                assert_same_objectives(model, &slow, 10.0 * tolerance, &name);
            }
        }
    }
}

#[test]
fn wide_classes_that_overlap_in_few_dimensions_are_parted_in_all_of_them() {
    // Two classes have 170 rows in 130 features, so some hyperplane separates them for any labels; in 64 dimensions, none does.
    let data = clouds(&[90, 80, 70], 130, 0.12, 11);
    let params = params(Kernel::Linear, 1e4, 1e-3);
    let model = optimal(params, &data);
    // The products of all rows do not fit, so pairs are solved one by one, on all their rows.
    let slow = SvmParams {
        memory_bytes: 400_000,
        ..params
    };
    assert_same_objectives(&model, &slow.train(&data).unwrap(), 1e-2, "apart");
}

#[test]
fn wide_rows_that_span_no_dimension_are_solved_too() {
    let equal = dataset(
        Array2::from_elem((140, 130), 0.3),
        (0..140).map(|row| row % 2).collect(),
    );
    let model = params(Kernel::Linear, 0.5, 1e-3)
        .train(&equal.unwrap())
        .unwrap();
    // No hyperplane separates the classes: every row is on the wrong side, with the full cost.
    assert_eq!(model.problems()[0].solution.objective, 140.0 * 0.5);
    assert_eq!(model.n_capped(), 0);
}

// Precision.

/// Returns four classes of 300 rows, which are solved in f32 at the default tolerance.
fn large() -> (Dataset, Array2<f64>) {
    let data = clouds(&[300, 300, 300, 300], 8, 0.7, 3);
    let mut rng = rng(4, &[]);
    let probes = Array2::from_shape_fn((800, 8), |_| 1.3 * rng.sample::<f64, _>(StandardNormal));
    (data, probes)
}

#[test]
fn single_precision_is_double_precision_to_the_tolerance() {
    let (data, probes) = large();
    // The coefficient of a heavy row may be as large as that of a large C.
    let mut weights = Array1::ones(1200);
    weights[7] = 1e7;
    let heavy = data.clone().with_weights(weights);
    assert!(!is_single(&params(RBF, 1.0, 1e-3).train(&heavy).unwrap()));
    for (kernel, penalties) in [
        (Kernel::Linear, &[0.1, 1.0, 100.0][..]),
        (RBF, &[0.1, 1.0, 100.0]),
        // Kernel values reach some hundred; with a larger C, f64 is used.
        (CUBIC, &[0.1, 1.0]),
    ] {
        for &c in penalties {
            let double = params(kernel, c, 1e-5).train(&data).unwrap();
            assert!(!is_single(&double));
            let expected = double.decision_values(probes.view()).unwrap();
            for tolerance in [1e-3, 1e-4] {
                // The bound is a multiple of the tolerance, which bounds f only at the support vectors, plus the rounding of f32 times C.
                let apart = 20.0 * tolerance + 3e-5 * c;
                let single = params(kernel, c, tolerance).train(&data).unwrap();
                let name = format!("{kernel:?}, C = {c}, tolerance {tolerance}");
                assert!(is_single(&single), "{name}");
                assert_same_objectives(&double, &single, 1e-4, &name);
                let values = single.decision_values(probes.view()).unwrap();
                let worst = worst_difference(&values, &expected);
                println!("{name}: decision values {worst:.1e} apart");
                assert!(worst <= apart, "{name}: {worst}");
                let labels = [&single, &double].map(|model| model.labels(probes.view()).unwrap());
                assert!(agreement(&labels[0], &labels[1]) >= 0.995, "{name}");
            }
        }
    }
}

#[test]
fn a_million_added_to_every_feature_changes_only_their_rounding() {
    let (data, probes) = large();
    let moved = dataset(&data.records + 1e6, data.targets.clone()).unwrap();
    let moved_probes = &probes + 1e6;
    for kernel in [Kernel::Linear, RBF] {
        // At 1e6, features lose digits from 1e-10 on. In f64 no label changes; in f32, labels within the tolerance may change.
        for (tolerance, least, apart) in [(1e-3, 0.99, 2e-2), (1e-6, 1.0, 1e-5)] {
            let params = params(kernel, 1.0, tolerance);
            let (here, there) = (params.train(&data).unwrap(), params.train(&moved).unwrap());
            assert_eq!(is_single(&here), tolerance == 1e-3);
            let labels = here.labels(probes.view()).unwrap();
            let moved_labels = there.labels(moved_probes.view()).unwrap();
            let share = agreement(&labels, &moved_labels);
            assert!(share >= least, "{kernel:?}, {tolerance}: {share}");
            let worst = worst_difference(
                &here.decision_values(probes.view()).unwrap(),
                &there.decision_values(moved_probes.view()).unwrap(),
            );
            assert!(worst <= apart, "{kernel:?}, {tolerance}: {worst}");
        }
    }
}

#[test]
fn classes_that_lie_close_in_clusters_that_lie_far_apart_are_told_apart() {
    // Distances are 1 within clusters that are 4,000 apart: the difference of squares of 4e6 has no correct digit in f32.
    let mut data = clouds(&[550, 550], 4, 0.0, 5);
    for (i, (mut row, &label)) in data
        .records
        .rows_mut()
        .into_iter()
        .zip(&data.targets)
        .enumerate()
    {
        row *= 0.2;
        row[0] += label as f64 + if i % 2 == 0 { 2000.0 } else { -2000.0 };
    }
    let kernel = Kernel::Rbf {
        gamma: Gamma::Value(1.0),
    };
    let model = params(kernel, 1.0, 1e-3).train(&data).unwrap();
    let labels = model.labels(data.records.view()).unwrap();
    assert!(agreement(&labels, &data.targets) > 0.98);
}

// Optimality.

/// Asserts optimality for two overlapping classes of 750 rows. The solver needs thousands of iterations, in which most variables are omitted at some time.
fn assert_optimal(kernel: Kernel) {
    let data = clouds(&[750, 750], 6, 0.5, 6);
    let own = |row| kernel_value(kernel, &data, row, row);
    for c in [0.01, 1.0, 100.0] {
        let params = params(kernel, c, 1e-3);
        let model = params.train(&data).unwrap();
        let problem = &model.problems()[0];
        let worth = Worth::new(&params, &data, problem);
        let name = format!("{kernel:?}, C = {c}");
        // f32 kernel values have rounding errors of 6e-8, multiplied by up to C and summed over hundreds of support vectors. Their unit is the typical kernel
        // value of two different rows (or 1, the unit of exponents), and at most the largest kernel value.
        let unit = if is_single(&model) { 2e-6 } else { 1e-10 };
        let n = data.targets.len();
        let largest = (0..n).map(own).fold(1.0, f64::max);
        let squares = (0..n).map(|row| kernel_value(kernel, &data, row, (row + 1) % n).powi(2));
        let usual = (squares.sum::<f64>() / n as f64).sqrt().max(1.0);
        let rounding = unit * c * largest;
        println!(
            "{name}: {worth:?}, {:?}, {usual}",
            problem.solution.objective
        );
        assert_eq!(model.n_capped(), 0, "{name}");
        assert!(
            worth.spread <= 1.01 * params.tolerance + unit * c * usual,
            "{name}"
        );
        // The hinge loss of each row is within the tolerance of the value that its multiplier implies; it costs at most C per unit.
        assert!(worth.gap() >= -1e-9 * worth.dual, "{name}");
        assert!(worth.gap() <= c * 1500.0 * params.tolerance, "{name}");
        assert!(worth.gap() <= 2e-3 * worth.dual, "{name}");
        assert!(near(worth.dual, problem.solution.objective, 1e-4), "{name}");
        let violation = problem.solution.violation.unwrap();
        assert!(violation <= params.tolerance, "{name}");
        assert!((violation - worth.spread).abs() <= rounding, "{name}");
    }
}

#[test]
fn a_linear_solution_is_optimal_by_its_definition() {
    assert_optimal(Kernel::Linear);
}

#[test]
fn a_gaussian_solution_is_optimal_by_its_definition() {
    assert_optimal(RBF);
}

#[test]
fn a_cubic_solution_is_optimal_by_its_definition() {
    assert_optimal(CUBIC);
}

// Hard sets.

/// Trains a model and asserts that every problem is feasible, optimal within the tolerance, and not capped.
fn optimal(params: SvmParams, data: &Dataset) -> SvmModel {
    let model = params.train(data).unwrap();
    for problem in model.problems() {
        let worth = Worth::new(&params, data, problem);
        let allowed = 1.01 * params.tolerance + 2e-6 * params.c;
        assert!(worth.spread <= allowed, "{params:?}: {worth:?}");
    }
    assert_eq!(model.n_capped(), 0, "{params:?}");
    model
}

#[test]
fn balanced_classes_are_solved_to_the_optimum_with_a_penalty_per_row() {
    // Kernel values in f64, and in f32 with omitted variables.
    for (counts, tolerance) in [(vec![40, 10, 25], 1e-8), (vec![1000, 50], 1e-3)] {
        let data = clouds(&counts, 5, 0.6, 13);
        for kernel in KERNELS {
            for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
                for c in [0.01, 1.0, 100.0] {
                    let params = SvmParams {
                        multiclass,
                        class_weight: ClassWeight::Balanced,
                        ..params(kernel, c, tolerance)
                    };
                    optimal(params, &data);
                }
            }
        }
    }
}

fn multipliers(model: &SvmModel) -> Vec<f64> {
    let of = |problem: &BinaryProblem| problem.solution.coefficients.clone();
    let all = model.problems().iter().flat_map(of);
    all.map(f64::abs).collect()
}

#[test]
fn one_row_in_a_hundred_is_found_where_it_stands_apart_and_given_up_where_it_does_not() {
    for (apart, c, expected) in [(3.0, 10.0, 10), (0.0, 0.1, 0)] {
        let data = clouds(&[1000, 10], 5, apart, 8);
        for kernel in [Kernel::Linear, RBF] {
            let model = optimal(params(kernel, c, 1e-3), &data);
            assert!(is_single(&model));
            let labels = model.labels(data.records.view()).unwrap();
            let few = |labels: &Array1<usize>| labels.iter().filter(|&&label| label == 1).count();
            assert_eq!(few(&labels), expected, "{kernel:?}");
        }
    }
}

#[test]
fn two_rows_a_class_are_enough_for_thirty_classes() {
    let data = clouds(&[2; 30], 40, 2.0, 9);
    for kernel in KERNELS {
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            let params = SvmParams {
                multiclass,
                ..params(kernel, 100.0, 1e-3)
            };
            let labels = optimal(params, &data).labels(data.records.view()).unwrap();
            assert_eq!(labels, data.targets, "{kernel:?} {multiclass:?}");
        }
    }
}

#[test]
fn of_equal_rows_the_more_frequent_label_wins() {
    // 3 rows of class 0 and 5 of class 1, or 500 and 600 (f32). Kβ = 0, so all rows of the smaller class end at C, and f = −1 everywhere.
    for counts in [[3, 5], [500, 600]] {
        let labels = (0..2).flat_map(|class| std::iter::repeat_n(class, counts[class]));
        let equal = Array2::from_elem((counts[0] + counts[1], 3), 0.7);
        let data = dataset(equal, labels.collect()).unwrap();
        for kernel in KERNELS {
            let model = optimal(params(kernel, 2.0, 1e-3), &data);
            let solution = &model.problems()[0].solution;
            let of_fewer = &solution.coefficients[..counts[0]];
            assert!(of_fewer.iter().all(|&beta| beta == 2.0), "{kernel:?}");
            assert!(near(solution.objective, 4.0 * counts[0] as f64, 1e-6));
            let values = model.decision_values(data.records.view()).unwrap();
            assert!(values.iter().all(|value| (value + 1.0).abs() < 1e-3));
        }
    }
}

#[test]
fn as_c_vanishes_every_multiplier_is_zero_or_c() {
    let data = clouds(&[20, 30, 50], 4, 1.0, 10);
    for kernel in KERNELS {
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            let c = 1e-9;
            let params = SvmParams {
                multiclass,
                ..params(kernel, c, 1e-3)
            };
            let model = optimal(params, &data);
            assert!(multipliers(&model).iter().all(|&a| a == 0.0 || a == c));
            for problem in model.problems() {
                let n_positive = data.targets.iter().filter(|&&l| l == problem.positive);
                let n_positive = n_positive.count();
                // All rows of the smaller class, and equally many of the other class, are at C.
                let n_fewer = n_positive.min(problem.rows.len() - n_positive) as f64;
                assert!(near(problem.solution.objective, 2.0 * n_fewer * c, 1e-6));
            }
        }
    }
}

#[test]
fn features_whose_kernel_values_are_no_numbers_are_refused() {
    let data = clouds(&[5, 5], 3, 1.0, 13);
    let huge = dataset(&data.records * 1e200, data.targets.clone()).unwrap();
    let rbf = Kernel::Rbf {
        gamma: Gamma::Scale,
    };
    let steep = Kernel::Polynomial {
        gamma: Gamma::Value(1e20),
        coef0: 0.0,
        degree: 20,
    };
    for (kernel, data) in [(Kernel::Linear, &huge), (rbf, &huge), (steep, &data)] {
        let params = params(kernel, 1.0, 1e-3);
        let error = params.train(data).unwrap_err().to_string();
        assert!(error.starts_with("features: "), "{error}");
    }
}

// Determinism.

#[test]
fn training_again_gives_the_same_bytes_and_another_order_of_rows_the_same_labels() {
    for (counts, tolerance) in [(vec![60, 50, 40], 1e-7), (vec![400, 400, 400], 1e-3)] {
        let data = clouds(&counts, 6, 0.8, 14);
        let probes = clouds(&[150; 3], 6, 0.8, 15).records;
        let n = data.targets.len();
        let order: Vec<usize> = (0..n).map(|row| row * 7 % n).rev().collect();
        let permuted = rows(&data, &order).unwrap();
        for kernel in KERNELS {
            let params = params(kernel, 1.0, tolerance);
            let values = |data| params.train(data).unwrap().decision_values(probes.view());
            let bytes = |values: &Array2<f64>| values.mapv(f64::to_bits);
            let (first, again) = (values(&data).unwrap(), values(&data).unwrap());
            assert_eq!(bytes(&first), bytes(&again), "{kernel:?}");
            let model = params.train(&permuted).unwrap();
            let labels = params.train(&data).unwrap().labels(probes.view()).unwrap();
            let other = model.labels(probes.view()).unwrap();
            // Within the tolerance, the result depends on the order in which equally good steps are made.
            let least = if tolerance < 1e-6 { 1.0 } else { 0.99 };
            assert!(agreement(&labels, &other) >= least, "{kernel:?}");
        }
    }
}

// The choice of C and γ.

fn candidates() -> Candidates {
    Candidates {
        c: vec![0.1, 10.0],
        gamma_scales: vec![0.5, 2.0],
    }
}

/// Returns the accuracies that [`choose`] must return, computed with a separate model for every fold and candidate.
fn accuracies(params: SvmParams, data: &Dataset, folds: &[Split], chosen: &Chosen) -> Vec<f64> {
    let accuracy = |params: SvmParams, fold: &Split| {
        let model = params.train(&rows(data, &fold.train).unwrap()).unwrap();
        let held_out = rows(data, &fold.test).unwrap();
        agreement(
            &model.labels(held_out.records.view()).unwrap(),
            &held_out.targets,
        )
    };
    let of = |c: f64, gamma: Option<f64>| {
        let gamma = gamma.map(Gamma::Value);
        let kernel = gamma.map_or(params.kernel, |gamma| params.kernel.with_gamma(gamma));
        let params = SvmParams {
            kernel,
            c,
            ..params
        };
        let of_folds = folds.iter().map(|fold| accuracy(params, fold));
        of_folds.sum::<f64>() / folds.len() as f64
    };
    chosen.tried.iter().map(|t| of(t.c, t.gamma)).collect()
}

#[test]
fn the_choice_on_one_matrix_is_that_of_training_one_by_one() {
    let three = |counts: &[usize]| clouds(counts, 4, 1.5, 20);
    for (multiclass, class_weight, data, n_folds, tolerance) in [
        // Four rows against 168 of one-vs-rest have decision values of −1, whose rounding decides; so pairs alone have many classes.
        (
            Multiclass::OneVsOne,
            ClassWeight::Uniform,
            clouds(&[8; 43], 12, 0.8, 16),
            2,
            1e-6,
        ),
        (
            Multiclass::OneVsRest,
            ClassWeight::Uniform,
            three(&[50, 50, 50]),
            3,
            1e-8,
        ),
        (
            Multiclass::OneVsOne,
            ClassWeight::Balanced,
            three(&[50, 24, 50]),
            3,
            1e-8,
        ),
        (
            Multiclass::OneVsRest,
            ClassWeight::Balanced,
            three(&[50, 24, 50]),
            3,
            1e-8,
        ),
    ] {
        let folds = folds(&data.targets, n_folds);
        for kernel in [Kernel::Linear, RBF] {
            let params = SvmParams {
                multiclass,
                class_weight,
                ..params(kernel, 1.0, tolerance)
            };
            let candidates = Candidates {
                c: vec![100.0, 0.01, 1.0],
                gamma_scales: vec![3.0, 0.3],
            };
            let chosen = choose(&params, &data, &folds, &candidates).unwrap();
            let expected = accuracies(params, &data, &folds, &chosen);
            let name = format!("{kernel:?} {multiclass:?} {class_weight:?}");
            for (tried, expected) in chosen.tried.iter().zip(&expected) {
                assert!((tried.accuracy - expected).abs() < 1e-12, "{name}");
            }
            let gammas: Vec<Option<f64>> = match kernel {
                Kernel::Linear => vec![None; 3],
                // Multiples of the kernel's own γ.
                _ => [0.3 * 0.15, 3.0 * 0.15].map(|g| [Some(g); 3]).concat(),
            };
            let tried = chosen.tried.iter();
            let (tried, accuracies): (Vec<_>, Vec<f64>) =
                tried.map(|tried| (tried.gamma, tried.accuracy)).unzip();
            assert_eq!((tried, chosen.n_capped), (gammas, 0), "{name}");
            let best = accuracies.into_iter().fold(0.0, f64::max);
            assert!(best > 0.3 && chosen.best.accuracy == best, "{name}");
        }
    }
}

#[test]
fn labels_of_rows_that_no_fold_holds_change_no_choice() {
    let data = clouds(&[30, 30, 30], 4, 0.7, 17);
    let (held, seen): (Vec<usize>, Vec<usize>) = (0..90).partition(|row| row % 3 == 0);
    let labels = seen.iter().map(|&row| data.targets[row]);
    let labels: Array1<usize> = labels.collect();
    let folds = folds(&labels, 3);
    let whole = |rows: &[usize]| rows.iter().map(|&at| seen[at]).collect();
    let folds = folds.iter().map(|fold| Split {
        train: whole(&fold.train),
        test: whole(&fold.test),
    });
    let folds: Vec<Split> = folds.collect();
    for kernel in [Kernel::Linear, RBF] {
        let params = params(kernel, 1.0, 1e-6);
        let expected = choose(&params, &data, &folds, &candidates()).unwrap();
        // Labels of other classes, and labels that no fold contains.
        for flip in [|label| (label + 1) % 3, |label| 100 + label] {
            let mut flipped = data.clone();
            held.iter()
                .for_each(|&row| flipped.targets[row] = flip(flipped.targets[row]));
            let chosen = choose(&params, &flipped, &folds, &candidates()).unwrap();
            assert_eq!(chosen, expected, "{kernel:?}");
        }
    }
}

#[test]
fn a_class_that_a_fold_does_not_train_on_is_never_recognised_there() {
    // Three clusters far apart; the first fold trains without class 2, the second without class 0.
    let data = clouds(&[20, 20, 20], 4, 8.0, 18);
    let of = |wanted: &[usize], part: usize| -> Vec<usize> {
        let is_in = |row: &usize| wanted.contains(&data.targets[*row]) && row % 2 == part;
        (0..60).filter(is_in).collect()
    };
    let folds = [
        Split {
            train: of(&[0, 1], 0),
            test: of(&[0, 1, 2], 1),
        },
        Split {
            train: of(&[1, 2], 1),
            test: of(&[0, 1, 2], 0),
        },
    ];
    let n_absent = of(&[2], 1).len() + of(&[0], 0).len();
    let expected = (60 - n_absent) as f64 / 60.0;
    // Candidates of γ are multiples of the kernel's own γ.
    let rbf = Kernel::Rbf {
        gamma: Gamma::Scale,
    };
    for kernel in [Kernel::Linear, rbf] {
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            let params = SvmParams {
                multiclass,
                ..params(kernel, 1.0, 1e-6)
            };
            let candidates = Candidates {
                c: vec![10.0, 100.0],
                ..candidates()
            };
            let chosen = choose(&params, &data, &folds, &candidates).unwrap();
            for tried in chosen.tried {
                assert_eq!(tried.accuracy, expected, "{params:?}: {tried:?}");
            }
        }
    }
}

#[test]
fn a_choice_for_a_problem_that_training_would_refuse_is_refused() {
    let data = clouds(&[20, 20], 4, 1.0, 19);
    let folds = folds(&data.targets, 2);
    let params = SvmParams {
        tolerance: 0.0,
        ..SvmParams::default()
    };
    let expected = params.train(&data).unwrap_err().to_string();
    let error = choose(&params, &data, &folds, &candidates()).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

#[test]
fn a_choice_of_c_counts_the_capped_problems_of_all_folds_and_candidates() {
    let data = clouds(&[20, 20], 4, 1.0, 21);
    let folds = folds(&data.targets, 3);
    let train = |_: &Dataset, _: f64| -> Result<_> {
        Ok((
            |rows: &Dataset| -> Result<_> { Ok(rows.targets.clone()) },
            2,
        ))
    };
    let chosen = choose_c(train, &data, &folds, &[5.0, 1.0]).unwrap();
    assert_eq!((chosen.best.c, chosen.best.accuracy), (1.0, 1.0));
    assert_eq!(chosen.n_capped, 2 * 3 * 2);
}
