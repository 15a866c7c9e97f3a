//! SVMs with extreme C: the solution is optimal, or counted as capped.

use crate::drawn::clusters;
use crate::svm_conditions::Worth;
use bubbletouch_svm::SvmParams;
use bubbletouch_svm::dataset::{Dataset, dataset};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use ndarray::array;

const KERNELS: [Kernel; 2] = [
    Kernel::Linear,
    Kernel::Rbf {
        gamma: Gamma::Value(0.5),
    },
];

/// Returns five points on a line with the labels 0 1 0 1 0.
fn five() -> Dataset {
    dataset(
        array![[0.0], [1.0], [2.0], [3.0], [4.5]],
        array![0, 1, 0, 1, 0],
    )
    .unwrap()
}

#[test]
fn from_a_trillionth_to_a_trillion_of_c_a_solution_is_optimal_or_counted_as_capped() {
    // Labels of two classes, with a fraction of each class exchanged.
    let wrong = |data: Dataset, share: f64| {
        let n_wrong = (share * data.targets.len() as f64).round() as usize;
        let mut labels = data.targets;
        labels
            .iter_mut()
            .take(n_wrong)
            .for_each(|label| *label = 1 - *label);
        dataset(data.records, labels).unwrap()
    };
    let sets = [
        ("far apart", clusters(&[20, 20, 20], 8.0, 1)),
        ("overlapping", clusters(&[20, 20], 1.0, 2)),
        ("100 : 1", clusters(&[100, 1], 4.0, 3)),
        ("two rows a class", clusters(&[2; 6], 3.0, 4)),
        ("five rows that no point separates", five()),
        (
            "a third mislabelled",
            wrong(clusters(&[20, 20], 6.0, 5), 0.33),
        ),
        ("half mislabelled", wrong(clusters(&[12, 12], 6.0, 6), 0.5)),
    ];
    let mut n_capped = 0;
    for (name, data) in &sets {
        for kernel in KERNELS {
            // Classes that no hyperplane separates need ten million steps, the cap, at a large C.
            let is_mixed = ["overlapping", "mislabelled", "no point"]
                .iter()
                .any(|word| name.contains(word));
            let largest = match kernel {
                Kernel::Linear if is_mixed => 2,
                _ => 12,
            };
            for exponent in (-12..=largest).step_by(2) {
                let params = SvmParams {
                    kernel,
                    c: 10f64.powi(exponent),
                    ..SvmParams::default()
                };
                let case = format!("{name}, {kernel:?}, C = 1e{exponent}");
                let model = params.train(data).unwrap();
                let values = model.decision_values(data.records.view()).unwrap();
                assert!(values.iter().all(|value| value.is_finite()), "{case}");
                n_capped += model.n_capped();
                let mut n_violated = 0;
                for problem in model.problems() {
                    let worth = Worth::new(&params, data, problem);
                    let allowed = 1.01 * params.tolerance + worth.rounding;
                    n_violated += usize::from(worth.violation > allowed);
                }
                assert!(
                    n_violated <= model.n_capped(),
                    "{case}: {n_violated} not optimal"
                );
            }
        }
    }
    assert!(n_capped < 40, "{n_capped}");
}

#[test]
fn at_an_enormous_c_what_can_be_separated_has_the_hard_margin() {
    // The nearest rows are at −1 and 1: w = 1, b = 0, and both multipliers are ½ for any C.
    let data = dataset(
        array![[-1.0], [1.0], [-3.0], [2.0], [-7.0], [1.5]],
        array![0, 1, 0, 1, 0, 1],
    )
    .unwrap();
    for exponent in 0..=12 {
        let params = SvmParams {
            c: 10f64.powi(exponent),
            tolerance: 1e-9,
            ..SvmParams::default()
        };
        let model = params.train(&data).unwrap();
        let problem = &model.problems()[0];
        assert_eq!(model.n_capped(), 0);
        assert!(problem.solution.rho.abs() < 1e-8, "1e{exponent}");
        for (&row, a) in problem.rows.iter().zip(&problem.solution.coefficients) {
            let expected = if row < 2 { 0.5 } else { 0.0 };
            assert!((a.abs() - expected).abs() < 1e-8, "1e{exponent}: {a}");
        }
    }
}
