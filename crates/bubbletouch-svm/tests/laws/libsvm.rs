//! The support vector machines against LIBSVM on data sets that are difficult for such solvers.
//!
//! `libsvm.json` contains data sets and the solutions of LIBSVM (scikit-learn 1.9.1); it was written by `make_libsvm.py` in the same folder. LIBSVM stores
//! kernel values in 32 bits. The file therefore contains the duality gap of the coefficients for every case, and the resulting error bound of the decision
//! values.

use crate::svm_conditions::{Worth, kernel_value};
use bubbletouch_svm::dataset::{Dataset, dataset};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::predict::svm_model::SvmModel;
use bubbletouch_svm::{Multiclass, SvmParams};
use ndarray::{Array1, Array2, ArrayView1};
use std::collections::BTreeMap;

#[derive(serde::Deserialize)]
struct Goldens {
    sets: BTreeMap<String, Set>,
    cases: Vec<Case>,
}

#[derive(serde::Deserialize)]
struct Set {
    rows: Vec<Vec<f64>>,
    labels: Vec<usize>,
    probes: Vec<Vec<f64>>,
}

/// LIBSVM's solution of one case.
#[derive(serde::Deserialize)]
struct Case {
    set: String,
    kernel: String,
    gamma: f64,
    c: f64,
    multiclass: Multiclass,
    tolerance: f64,
    /// Objective that training minimises, summed over the binary problems.
    dual: f64,
    /// Duality gap: the optimum is at least `dual − gap`.
    gap: f64,
    /// Largest possible difference between a decision value and its optimum.
    decision_error: f64,
    /// Number of problems that LIBSVM stopped before convergence.
    n_capped: usize,
    /// Predicted labels of the probe rows.
    labels: Vec<usize>,
    /// Decision values, probes × problems; `None` if the error of these values is not small.
    decision: Option<Vec<Vec<f64>>>,
}

impl Case {
    fn name(&self) -> String {
        format!(
            "{}, {}, C = {}, {:?}",
            self.set, self.kernel, self.c, self.multiclass
        )
    }

    fn params(&self) -> SvmParams {
        SvmParams {
            kernel: self.kernel(),
            multiclass: self.multiclass,
            c: self.c,
            tolerance: self.tolerance,
            ..SvmParams::default()
        }
    }

    fn kernel(&self) -> Kernel {
        let gamma = Gamma::Value(self.gamma);
        match self.kernel.as_str() {
            "linear" => Kernel::Linear,
            "rbf" => Kernel::Rbf { gamma },
            "poly" => Kernel::Polynomial {
                gamma,
                coef0: 1.0,
                degree: 3,
            },
            other => panic!("no kernel {other}"),
        }
    }
}

fn goldens() -> Goldens {
    serde_json::from_str(include_str!("libsvm.json")).unwrap()
}

fn matrix(rows: &[Vec<f64>]) -> Array2<f64> {
    Array2::from_shape_fn((rows.len(), rows[0].len()), |(i, j)| rows[i][j])
}

/// Sums over a model's problems of the objective and of the duality gap, and the largest possible error of its decision values (as in `make_libsvm.py`).
struct Sums {
    dual: f64,
    gap: f64,
    decision_error: f64,
}

fn sums(case: &Case, data: &Dataset, model: &SvmModel) -> Sums {
    let own = |row| kernel_value(case.kernel(), data, row, row);
    let largest = (0..data.targets.len()).map(own).fold(0.0, f64::max);
    let params = case.params();
    let mut sums = Sums {
        dual: 0.0,
        gap: 0.0,
        decision_error: 0.0,
    };
    for problem in model.problems() {
        let worth = Worth::new(&params, data, problem);
        let gap = worth.gap().max(0.0);
        let error = 2.0 * (2.0 * gap * largest).sqrt() + case.tolerance;
        sums.dual -= worth.dual;
        sums.gap += gap;
        sums.decision_error = sums.decision_error.max(error);
    }
    sums
}

/// Asserts that our solution reaches LIBSVM's objective and agrees with its decisions, as far as both are exact. Returns the number of equal labels of the probe
/// rows, and the number of probe rows.
fn check(case: &Case, set: &Set) -> (usize, usize) {
    let name = case.name();
    let data = dataset(matrix(&set.rows), Array1::from(set.labels.clone())).unwrap();
    let model = case.params().train(&data).unwrap();
    let ours = sums(case, &data, &model);
    println!(
        "{name}: dual {:.8e}, LIBSVM {:.8e}; gap {:.1e}, {:.1e}; capped {}, {}",
        ours.dual,
        case.dual,
        ours.gap,
        case.gap,
        model.n_capped(),
        case.n_capped
    );
    let scale = case.dual.abs();
    // The objective is at most as good as the duality gap of LIBSVM's solution allows.
    assert!(ours.dual >= case.dual - case.gap - 1e-9 * scale, "{name}");
    if case.n_capped == 0 {
        assert_eq!(model.n_capped(), 0, "{name}");
        assert!((ours.dual - case.dual).abs() <= 1e-3 * scale, "{name}");
    } else {
        // If LIBSVM stopped early, our solution is at least as good, or was also stopped and counted.
        let is_no_worse = ours.dual <= case.dual + 1e-3 * scale;
        assert!(is_no_worse || model.n_capped() > 0, "{name}");
    }
    let probes = matrix(&set.probes);
    let labels = model.labels(probes.view()).unwrap();
    let n_same = labels
        .iter()
        .zip(&case.labels)
        .filter(|(a, b)| a == b)
        .count();
    let Some(decision) = &case.decision else {
        return (n_same, labels.len());
    };
    let values = model.decision_values(probes.view()).unwrap();
    let near = case.decision_error + ours.decision_error;
    let expected = matrix(decision);
    let worst = (&values - &expected).fold(0.0_f64, |max, difference| max.max(difference.abs()));
    assert!(worst <= near, "{name}: {worst} is above {near}");
    for (probe, values) in expected.rows().into_iter().enumerate() {
        if is_clear(case.multiclass, values, near) {
            assert_eq!(labels[probe], case.labels[probe], "{name}, probe {probe}");
        }
    }
    (n_same, labels.len())
}

/// Returns whether all decision values that determine the label exceed the error.
fn is_clear(multiclass: Multiclass, values: ArrayView1<f64>, near: f64) -> bool {
    if multiclass == Multiclass::OneVsOne {
        return values.iter().all(|value| value.abs() > near);
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    sorted[n - 1] - sorted[n - 2] > 2.0 * near
}

#[test]
fn every_case_reaches_libsvms_objective_and_most_labels_even_where_margins_are_small() {
    let goldens = goldens();
    let (mut n_same, mut n_all) = (0, 0);
    for case in &goldens.cases {
        let (same, all) = check(case, &goldens.sets[&case.set]);
        if case.n_capped == 0 {
            n_same += same;
            n_all += all;
        }
    }
    println!("{n_same} of {n_all} labels are LIBSVM's");
    assert!(n_same as f64 > 0.98 * n_all as f64, "{n_same} of {n_all}");
    assert!(goldens.cases.len() > 20, "{} cases", goldens.cases.len());
}
