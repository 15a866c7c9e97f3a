//! SVMs with extreme C on rows that no hyperplane separates: the solution is optimal or counted as capped.

use crate::svm_conditions::Worth;
use bubbletouch_svm::dataset::{Dataset, dataset};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::{Multiclass, SvmParams};
use ndarray::{Array1, Array2};

const RBF: Kernel = Kernel::Rbf {
    gamma: Gamma::Value(0.5),
};

/// Returns eighteen points of a lattice in three classes, such that no hyperplane separates two classes.
fn lattice() -> Dataset {
    let features = Array2::from_shape_fn((18, 2), |(row, column)| match column {
        0 => ((row * 7) % 5) as f64 - 2.0,
        _ => ((row * 11) % 7) as f64 - 3.0,
    });
    let labels = Array1::from_shape_fn(18, |row| (row * 5 + row / 4) % 3);
    dataset(features, labels).unwrap()
}

/// Returns every row twice, once with each label; not even an RBF kernel separates them.
fn contradictory() -> Dataset {
    let features = Array2::from_shape_fn((12, 2), |(row, column)| {
        ((row / 2 * (3 + column)) % 5) as f64
    });
    dataset(features, Array1::from_shape_fn(12, |row| row % 2)).unwrap()
}

/// Dual objectives of the three pairs by scikit-learn 1.9.1 (LIBSVM), tolerance 1e-3. With a linear kernel, LIBSVM's iterations grow with C. LIBSVM needs 16
/// million iterations at 1e6, and is stopped at 20 million at 1e9.
const LIBSVM: [(Kernel, f64, [f64; 3]); 11] = [
    (Kernel::Linear, 1e-12, [8.0e-12, 1.0e-11, 8.0e-12]),
    (
        Kernel::Linear,
        1e-6,
        [7.9999995e-6, 9.9999995e-6, 7.9999815e-6],
    ),
    (Kernel::Linear, 1.0, [8.0, 10.0, 6.4580498701]),
    (Kernel::Linear, 1e2, [8.0e2, 1.0e3, 6.3817233560e2]),
    (Kernel::Linear, 1e4, [8.0e4, 1.0e5, 6.3809600907e4]),
    (RBF, 1e-12, [8.0e-12, 1.0e-11, 8.0e-12]),
    (RBF, 1.0, [6.9353217282, 8.1994634497, 6.5830919733]),
    (RBF, 1e2, [15.837258078, 16.703599584, 13.934782816]),
    (RBF, 1e6, [15.837258078, 16.703599584, 13.934782816]),
    (RBF, 1e9, [15.837258078, 16.703599584, 13.934782816]),
    (RBF, 1e12, [15.837258078, 16.703599584, 13.934782816]),
];

#[test]
fn where_libsvm_ends_ours_is_as_good_as_it() {
    let data = lattice();
    for (kernel, c, wanted) in LIBSVM {
        let params = SvmParams {
            kernel,
            c,
            ..SvmParams::default()
        };
        let model = params.train(&data).unwrap();
        for (problem, wanted) in model.problems().iter().zip(wanted) {
            let about = format!("{kernel:?}, C = {c:e}, class {}", problem.positive);
            let worth = Worth::new(&params, &data, problem);
            assert!(!problem.solution.is_capped, "{about}");
            let allowed = 1.01 * params.tolerance + worth.rounding;
            assert!(worth.violation <= allowed, "{about}: {worth:?}");
            assert!(
                (worth.dual / wanted - 1.0).abs() < 2e-4,
                "{about}: {worth:?} against {wanted}"
            );
        }
    }
}

#[test]
fn at_a_trillion_a_problem_is_optimal_or_counted_and_its_bounds_enclose_the_optimum() {
    let sets = [("lattice", lattice()), ("contradictory", contradictory())];
    for (name, data) in &sets {
        for kernel in [Kernel::Linear, RBF] {
            for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
                if name == &"lattice"
                    && (kernel, multiclass) == (Kernel::Linear, Multiclass::OneVsRest)
                {
                    // One-vs-rest problems need ten million steps each, as pairs do.
                    continue;
                }
                let params = SvmParams {
                    kernel,
                    multiclass,
                    c: 1e12,
                    ..SvmParams::default()
                };
                let model = params.train(data).unwrap();
                let values = model.decision_values(data.records.view()).unwrap();
                assert!(values.iter().all(|value| value.is_finite()));
                let mut n_capped = 0;
                for problem in model.problems() {
                    let about = format!(
                        "{name}, {kernel:?}, {multiclass:?}, class {}",
                        problem.positive
                    );
                    let worth = Worth::new(&params, data, problem);
                    println!("{about}: capped {}, {worth:?}", problem.solution.is_capped);
                    let (dual, primal) = (worth.dual, worth.primal);
                    assert!(
                        dual >= 0.0 && primal >= dual * (1.0 - 1e-9),
                        "{about}: {worth:?}"
                    );
                    let allowed = 1.01 * params.tolerance + worth.rounding;
                    match problem.solution.is_capped {
                        true => n_capped += 1,
                        false => assert!(worth.violation <= allowed, "{about}: {worth:?}"),
                    }
                }
                assert_eq!(n_capped, model.n_capped());
                // A non-linear kernel separates all rows except contradictory ones; no hyperplane separates the lattice, and the solver reports its cap.
                let is_parted = *name == "lattice" && kernel == RBF;
                assert!(!is_parted || n_capped == 0);
                let is_mixed = *name == "lattice" && kernel == Kernel::Linear;
                assert!(!is_mixed || n_capped == 3);
            }
        }
    }
}
