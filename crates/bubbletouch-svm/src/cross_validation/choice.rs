//! Choice of C and γ by cross-validation on training rows; test rows are not used.

use ndarray::{Array1, Array3, ArrayView1, Axis};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

use crate::cross_validation::grid::Grid;
use crate::dataset::{
    Dataset, LabelledRows, check_labels, check_rows, check_unweighted, distinct, rows,
};
use crate::gram::sorted::Sorted;
use crate::kernel::{Gamma, Kernel, KernelFunction};
use crate::row_statistics::RowStatistics;
use crate::smo::SolverScalar;
use crate::split::Split;
use crate::svm_params::SvmParams;
use crate::training::Goal;
use crate::{Error, Result};

/// Candidate values of C and γ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidates {
    /// Candidate values of C; at least one.
    pub c: Vec<f64>,
    /// Candidate values of γ, as multiples of the kernel's γ; an empty list means only the kernel's γ. With `Gamma::Scale`, the kernel's γ is computed from the
    /// training rows. A linear kernel has no γ.
    pub gamma_scales: Vec<f64>,
}

/// Tested combination of C and γ, with its validation accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// Penalty C of this combination.
    pub c: f64,
    /// Kernel parameter γ of this combination; `None` for a linear kernel.
    pub gamma: Option<f64>,
    /// Fraction of the validation rows of a fold that are classified correctly, averaged over the folds, 0 to 1.
    pub accuracy: f64,
}

/// Result of a cross-validated choice of C and γ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// Combination of C and γ with the highest validation accuracy.
    pub best: Tried,
    /// All tested combinations in ascending order of γ, then of C.
    pub tried: Vec<Tried>,
    /// Number of solver runs, over all folds and candidates, that stopped at the iteration cap.
    pub n_capped: usize,
}

/// Evaluates every C with every γ on every fold, and returns the candidate with the highest accuracy on validation rows, averaged over the folds. If candidates are equally accurate, the smaller γ is chosen, then the
/// smaller C (smoother, more regularised, and faster).
///
/// `training` contains only scaled training rows; the scaling may be fitted to all of them, without labels. `folds` split these rows. All candidates share one
/// matrix of products. Duplicated candidates count once.
///
/// # Errors
/// If there are no candidates or folds, or a candidate is out of range. If a fold has a single class or contains a row beyond the training rows. If a model
/// cannot be trained, the rows have weights, or the matrix exceeds the memory limit.
pub fn choose(
    params: &SvmParams,
    training: &Dataset,
    folds: &[Split],
    candidates: &Candidates,
) -> Result<Chosen> {
    let path = ascending(&candidates.c);
    params.check(&path)?;
    let statistics = RowStatistics::new(training.records.view())?;
    check_labels(training.records.nrows(), training.targets.view())?;
    check_unweighted(training)?;
    check_folds(training, folds)?;
    let kernels = kernels(params, (training, &statistics), &candidates.gamma_scales)?;
    let goal = Goal {
        path: &path,
        tolerance: params.tolerance,
        memory: params.memory_bytes,
    };
    let (counts, n_capped) = on_one_matrix(params, (training, &statistics), folds, &kernels, goal)?;
    let mut tried = Vec::with_capacity(kernels.len() * path.len());
    for (kernel, counts) in kernels.iter().zip(counts.outer_iter()) {
        for (&c, counts) in path.iter().zip(counts.axis_iter(Axis(0))) {
            tried.push(Tried {
                c,
                gamma: kernel.gamma(),
                accuracy: mean_accuracy(folds, counts.iter().copied()),
            });
        }
    }
    Ok(Chosen::new(tried, n_capped))
}

/// Chooses the penalty C of a classifier by cross-validation. The function `train` trains a classifier on given rows with a given C. The result of `train` is a
/// prediction function and the number of solver runs that stopped at the iteration cap.
///
/// # Errors
/// Returns the errors of [`choose`] and of `train`.
pub fn choose_c<P, E>(
    train: impl Fn(&Dataset, f64) -> Result<(P, usize), E>,
    training: &Dataset,
    folds: &[Split],
    candidates: &[f64],
) -> Result<Chosen, E>
where
    P: Fn(&Dataset) -> Result<Array1<usize>, E>,
    E: From<Error>,
{
    let path = ascending(candidates);
    if path.is_empty() {
        return Err(Error::input("C", "none", "at least one is needed").into());
    }
    check_folds(training, folds)?;
    let mut n_capped = 0;
    let mut tried = Vec::new();
    for c in path {
        let mut n_correct = Vec::with_capacity(folds.len());
        for fold in folds {
            let (predict, capped) = train(&rows(training, &fold.train)?, c)?;
            let held_out = rows(training, &fold.test)?;
            n_correct.push(n_equal(&predict(&held_out)?, &held_out.targets));
            n_capped += capped;
        }
        tried.push(Tried {
            c,
            gamma: None,
            accuracy: mean_accuracy(folds, n_correct),
        });
    }
    Ok(Chosen::new(tried, n_capped))
}

impl Chosen {
    /// Creates the result of the parameter choice; if several candidates have the highest accuracy, the first is selected.
    fn new(tried: Vec<Tried>, n_capped: usize) -> Self {
        let better = |best: Tried, &tried: &Tried| {
            if tried.accuracy > best.accuracy {
                tried
            } else {
                best
            }
        };
        Self {
            best: tried.iter().fold(tried[0], better),
            tried,
            n_capped,
        }
    }
}

/// Returns the accuracy on the validation rows of a fold, averaged over the folds that have any, as in scikit-learn. `n_correct` contains the number of correctly
/// classified rows of each fold.
///
/// Counts of folds of equal size are added before the division. Candidates with equal counts in total are therefore equally accurate, without rounding errors.
fn mean_accuracy(folds: &[Split], n_correct: impl IntoIterator<Item = usize>) -> f64 {
    let mut of_size = BTreeMap::<usize, usize>::new();
    for (fold, n_correct) in folds.iter().zip(n_correct) {
        *of_size.entry(fold.test.len()).or_default() += n_correct;
    }
    of_size.remove(&0);
    let sum: f64 = of_size
        .iter()
        .map(|(&size, &n_correct)| n_correct as f64 / size as f64)
        .sum();
    sum / folds.iter().filter(|fold| !fold.test.is_empty()).count() as f64
}

fn n_equal(a: &Array1<usize>, b: &Array1<usize>) -> usize {
    a.iter().zip(b).filter(|(a, b)| a == b).count()
}

fn ascending(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// Returns the kernels with the candidate values of γ, in ascending order of γ.
fn kernels(
    params: &SvmParams,
    (training, statistics): (&Dataset, &RowStatistics),
    scales: &[f64],
) -> Result<Vec<KernelFunction>> {
    if scales.is_empty() || params.kernel == Kernel::Linear {
        return Ok(vec![
            params.kernel.resolve(training.records.view(), statistics)?,
        ]);
    }
    let unit = match params.kernel.gamma() {
        Some(Gamma::Value(gamma)) => gamma,
        _ => params.kernel.gamma_scale(training.records.view()),
    };
    ascending(scales)
        .into_iter()
        .map(|scale| {
            let kernel = params.kernel.with_gamma(Gamma::Value(scale * unit));
            kernel.resolve(training.records.view(), statistics)
        })
        .collect()
}

fn check_folds(training: &Dataset, folds: &[Split]) -> Result<()> {
    if folds.iter().all(|fold| fold.test.is_empty()) {
        return Err(Error::input(
            "folds",
            "no validation rows",
            "at least one is needed",
        ));
    }
    for fold in folds {
        for part in [&fold.train, &fold.test] {
            check_rows(training, part)?;
        }
        let labels = fold.train.iter().map(|&row| training.targets[row]);
        let classes = distinct(labels.collect::<Array1<_>>().view());
        if classes.len() < 2 {
            return Err(Error::input(
                "folds",
                format!("training rows of {} class", classes.len()),
                "at least two classes are needed",
            ));
        }
    }
    Ok(())
}

/// Returns the number of correctly classified validation rows for each kernel, C and fold (kernels.len() × path.len() × folds.len()). Also returns the number of
/// solver runs that stopped at the iteration cap.
fn on_one_matrix(
    params: &SvmParams,
    (training, statistics): (&Dataset, &RowStatistics),
    folds: &[Split],
    kernels: &[KernelFunction],
    goal: Goal,
) -> Result<(Array3<usize>, usize)> {
    let centre = kernels[0].centre(statistics);
    let n_rows = training.records.nrows();
    let needs_double = |rows: (f64, f64)| {
        let mut kernels = kernels.iter();
        kernels.any(|&kernel| params.needs_double(n_rows, kernel, goal.path, rows))
    };
    let data = (training, centre.view());
    if !needs_double((0.0, 1.0)) {
        let sorted = by_fold::<f32>(data, folds, kernels[0]).weighted(params.class_weight, &[]);
        if !needs_double(sorted.farthest_and_heaviest()) {
            return grid(params, &sorted, folds, kernels, goal);
        }
    }
    let sorted = by_fold::<f64>(data, folds, kernels[0]);
    grid(params, &sorted, folds, kernels, goal)
}

/// Sorts the training rows by class and by fold, so that the training rows of each fold form few contiguous ranges.
fn by_fold<T: SolverScalar>(
    (training, centre): (&Dataset, ArrayView1<f64>),
    folds: &[Split],
    kernel: KernelFunction,
) -> Sorted<T> {
    let classes = distinct(training.targets.view());
    let mut fold_of = vec![0; training.targets.len()];
    for (number, fold) in folds.iter().enumerate() {
        fold.test.iter().for_each(|&row| fold_of[row] = number);
    }
    let rows = LabelledRows::from(training);
    Sorted::new(rows, &classes, kernel, centre, |row| fold_of[row])
}

fn grid<T: SolverScalar>(
    params: &SvmParams,
    sorted: &Sorted<T>,
    folds: &[Split],
    kernels: &[KernelFunction],
    goal: Goal,
) -> Result<(Array3<usize>, usize)> {
    // Up to three matrices are in memory: the products, the kernel values, and the part of a fold's training rows.
    let most = (params.memory_bytes / (3 * size_of::<T>())).isqrt();
    let n_rows = sorted.points.len();
    if n_rows > most {
        return Err(Error::input(
            "training rows",
            format!("{n_rows} to choose C or gamma on"),
            format!("at most {most} fit in memory; let fewer touches take part in the choice"),
        ));
    }
    let grid = Grid {
        sorted,
        folds,
        multiclass: params.multiclass,
        class_weight: params.class_weight,
    };
    Ok(grid.n_correct(kernels, goal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::dataset;
    use ndarray::Array2;

    /// Three overlapping classes.
    fn overlapping(n: usize) -> Dataset {
        let features = Array2::from_shape_fn((n, 4), |(i, j)| {
            (i % 3) as f64 * 0.6 + ((i * 7 + j * 13) as f64 * 1.7).sin()
        });
        dataset(features, Array1::from_iter((0..n).map(|i| i % 3))).unwrap()
    }

    /// Returns folds of test rows; the classes of the rows alternate, so that every fold contains all classes.
    fn folds_of(n_rows: usize, k: usize) -> Vec<Split> {
        let fold_of = |row: usize| (row / 3) % k;
        let fold = |fold: usize| {
            let (test, train) = (0..n_rows).partition(|&row| fold_of(row) == fold);
            Split { train, test }
        };
        (0..k).map(fold).collect()
    }

    #[test]
    fn of_equally_good_candidates_the_smoothest_is_kept() {
        // The classes are far apart: with any C and γ, all rows are recognised.
        let features = Array2::from_shape_fn((60, 2), |(i, j)| {
            (i % 2) as f64 * 50.0 + ((i + j) as f64).sin()
        });
        let data = dataset(features, Array1::from_iter((0..60).map(|i| i % 2))).unwrap();
        let folds = folds_of(data.records.nrows(), 5);
        let params = SvmParams {
            kernel: Kernel::Rbf {
                gamma: Gamma::Scale,
            },
            ..SvmParams::default()
        };
        let candidates = Candidates {
            c: vec![10.0, 1.0, 1.0],
            gamma_scales: vec![2.0, 1.0],
        };
        let chosen = choose(&params, &data, &folds, &candidates).unwrap();
        assert_eq!(chosen.tried.len(), 4);
        assert_eq!(chosen.best, chosen.tried[0]);
        assert_eq!((chosen.best.c, chosen.best.accuracy), (1.0, 1.0));
    }

    #[test]
    fn a_candidate_is_as_good_as_its_mean_over_the_folds() {
        // One fold of one row and one of nine rows: 1/1 and 3/9 are better than 0/1 and 8/9 in the mean, and worse on all rows together.
        let fold = |n: usize| Split {
            train: Vec::new(),
            test: (0..n).collect(),
        };
        let folds = [fold(1), fold(9), fold(0)];
        assert!((mean_accuracy(&folds, [1, 3, 0]) - 2.0 / 3.0).abs() < 1e-15);
        assert!((mean_accuracy(&folds, [0, 8, 0]) - 4.0 / 9.0).abs() < 1e-15);
        let equal = [fold(7), fold(7), fold(7)];
        assert_eq!(
            mean_accuracy(&equal, [1, 2, 3]),
            mean_accuracy(&equal, [3, 1, 2])
        );
    }

    #[test]
    fn what_cannot_be_chosen_from_is_refused() {
        let data = overlapping(30);
        let folds = folds_of(data.records.nrows(), 3);
        let params = SvmParams::default();
        let refuse = |params: &SvmParams, c: &[f64], folds: &[Split]| {
            let candidates = Candidates {
                c: c.to_vec(),
                gamma_scales: Vec::new(),
            };
            choose(params, &data, folds, &candidates)
                .unwrap_err()
                .to_string()
        };
        assert!(refuse(&params, &[], &folds).starts_with("C: "));
        assert!(refuse(&params, &[-1.0], &folds).starts_with("C: "));
        assert!(refuse(&params, &[1.0], &[]).starts_with("folds: "));
        let beyond = Split {
            train: vec![0, 1, 2],
            test: vec![30],
        };
        assert!(refuse(&params, &[1.0], &[beyond]).starts_with("rows: "));
        let single = Split {
            train: vec![0, 3],
            test: vec![1],
        };
        assert!(refuse(&params, &[1.0], &[single]).starts_with("folds: "));
        let small = SvmParams {
            memory_bytes: 1000,
            ..params
        };
        assert!(refuse(&small, &[1.0], &folds).contains("at most 6 fit"));
    }
}
