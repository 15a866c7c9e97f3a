//! The choice of C and γ by cross-validation on training rows; test rows are never seen.

use ndarray::{Array1, Array2, ArrayView1};
use serde::{Deserialize, Serialize};

use crate::cross_validation::grid::Grid;
use crate::dataset::{Dataset, check_labels, distinct, rows};
use crate::gram::sorted::Sorted;
use crate::kernel::{Gamma, Kernel, KernelFunction};
use crate::row_statistics::RowStatistics;
use crate::smo::SolverScalar;
use crate::split::Split;
use crate::svm_params::SvmParams;
use crate::training::Goal;
use crate::{Error, Result};

/// What may be chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidates {
    /// Values of C; at least one.
    pub c: Vec<f64>,
    /// Values of γ as multiples of the kernel's own γ, which is [`Gamma::Scale`]'s of the training rows unless it is a number; empty: the kernel's own γ.
    /// A linear kernel has none.
    pub gamma_scales: Vec<f64>,
}

/// A candidate and how it did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// C.
    pub c: f64,
    /// γ as a number; `None` for a linear kernel.
    pub gamma: Option<f64>,
    /// Validation rows recognised, over all folds, as a fraction.
    pub accuracy: f64,
}

/// What was chosen, and from what.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// The most accurate candidate.
    pub best: Tried,
    /// All of them: γ by γ, ascending, C ascending within.
    pub tried: Vec<Tried>,
    /// Solves, of all folds and candidates, that stopped at the iteration cap.
    pub n_capped: usize,
}

/// Tries every C with every γ on every fold, and keeps the most accurate; of equals the smaller γ, then the smaller C
/// (smoother, more regularised, and faster).
///
/// `training` holds scaled training rows alone; the scaling may have seen all of them (not their labels). `folds` split
/// those rows. The whole grid is evaluated on one matrix of products. A duplicated candidate counts once.
///
/// # Errors
/// No candidates or one out of range, no folds, a row beyond the training rows, a fold whose training rows have a single
/// class, what [`SvmParams::train`] refuses, or more rows than the matrix has memory for.
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
    check_folds(training, folds)?;
    let kernels = kernels(params, (training, &statistics), &candidates.gamma_scales)?;
    let goal = Goal {
        path: &path,
        tolerance: params.tolerance,
        memory: params.memory_bytes,
    };
    let (counts, n_capped) = on_one_matrix(params, (training, &statistics), folds, &kernels, goal)?;
    let n_validated: usize = folds.iter().map(|fold| fold.test.len()).sum();
    let tried = counts
        .indexed_iter()
        .map(|((kernel, c), &n_correct)| Tried {
            c: path[c],
            gamma: kernels[kernel].gamma(),
            accuracy: n_correct as f64 / n_validated as f64,
        });
    Ok(Chosen::of(tried.collect(), n_capped))
}

/// [`choose`] of C alone, for any classifier: `train` learns from rows with a C, and gives what labels others and how many
/// of its solves stopped at their cap.
///
/// # Errors
/// As [`choose`], and what `train` refuses.
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
    let n_validated: usize = folds.iter().map(|fold| fold.test.len()).sum();
    let mut n_capped = 0;
    let mut tried = Vec::new();
    for c in path {
        let mut n_correct = 0;
        for fold in folds {
            let (predict, capped) = train(&rows(training, &fold.train)?, c)?;
            let held_out = rows(training, &fold.test)?;
            n_correct += n_equal(&predict(&held_out)?, &held_out.targets);
            n_capped += capped;
        }
        tried.push(Tried {
            c,
            gamma: None,
            accuracy: n_correct as f64 / n_validated as f64,
        });
    }
    Ok(Chosen::of(tried, n_capped))
}

impl Chosen {
    /// The first of the most accurate.
    fn of(tried: Vec<Tried>, n_capped: usize) -> Self {
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

fn n_equal(a: &Array1<usize>, b: &Array1<usize>) -> usize {
    a.iter().zip(b).filter(|(a, b)| a == b).count()
}

fn ascending(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The kernel with every γ that is asked for, ascending.
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
            rows_exist(training, part)?;
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

fn rows_exist(training: &Dataset, part: &[usize]) -> Result<()> {
    let n_rows = training.records.nrows();
    match part.iter().find(|&&row| row >= n_rows) {
        None => Ok(()),
        Some(&row) => Err(Error::input(
            "rows",
            row,
            format!("an index below {n_rows} is allowed"),
        )),
    }
}

/// Validation rows recognised (kernels.len() × path.len()), and capped solves.
fn on_one_matrix(
    params: &SvmParams,
    (training, statistics): (&Dataset, &RowStatistics),
    folds: &[Split],
    kernels: &[KernelFunction],
    goal: Goal,
) -> Result<(Array2<usize>, usize)> {
    let centre = kernels[0].centre(statistics);
    let n_rows = training.records.nrows();
    let needs_double = |farthest: f64| {
        let mut kernels = kernels.iter();
        kernels.any(|&kernel| params.needs_double(n_rows, kernel, goal.path, farthest))
    };
    let data = (training, centre.view());
    if !needs_double(0.0) {
        let sorted = by_fold::<f32>(data, folds, kernels[0]);
        if !needs_double(sorted.farthest()) {
            return grid(params, &sorted, folds, kernels, goal);
        }
    }
    let sorted = by_fold::<f64>(data, folds, kernels[0]);
    grid(params, &sorted, folds, kernels, goal)
}

/// Rows by class, and within a class by fold: what a fold trains on then lies in few runs.
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
    Sorted::within_classes(training, &classes, kernel, centre, |row| fold_of[row])
}

fn grid<T: SolverScalar>(
    params: &SvmParams,
    sorted: &Sorted<T>,
    folds: &[Split],
    kernels: &[KernelFunction],
    goal: Goal,
) -> Result<(Array2<usize>, usize)> {
    // Three matrices at most: products, the kernel made of them, and the part that a fold trains on.
    let most = (params.memory_bytes / (3 * size_of::<T>())).isqrt();
    let n_rows = sorted.points().len();
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
    };
    Ok(grid.n_correct(kernels, goal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::dataset;
    use crate::multiclass::Multiclass;

    /// Three overlapping classes.
    fn overlapping(n: usize) -> Dataset {
        let features = Array2::from_shape_fn((n, 4), |(i, j)| {
            (i % 3) as f64 * 0.6 + ((i * 7 + j * 13) as f64 * 1.7).sin()
        });
        dataset(features, Array1::from_iter((0..n).map(|i| i % 3))).unwrap()
    }

    /// Folds of rows whose classes take turns: all classes are in each.
    fn folds_of(n_rows: usize, k: usize) -> Vec<Split> {
        let fold_of = |row: usize| (row / 3) % k;
        let fold = |fold: usize| {
            let (test, train) = (0..n_rows).partition(|&row| fold_of(row) == fold);
            Split { train, test }
        };
        (0..k).map(fold).collect()
    }

    /// The same by training a model for each fold and candidate.
    fn one_by_one(
        params: &SvmParams,
        training: &Dataset,
        folds: &[Split],
        kernels: &[KernelFunction],
        goal: Goal,
    ) -> Result<(Array2<usize>, usize)> {
        let mut counts = Array2::zeros((kernels.len(), goal.path.len()));
        let mut n_capped = 0;
        for fold in folds {
            let fitting = rows(training, &fold.train)?;
            let held_out = rows(training, &fold.test)?;
            for (kernel, mut counts) in kernels.iter().zip(counts.rows_mut()) {
                let kernel = match kernel.gamma() {
                    Some(gamma) => params.kernel.with_gamma(Gamma::Value(gamma)),
                    None => params.kernel,
                };
                let models = SvmParams { kernel, ..*params }.train_path(&fitting, goal.path)?;
                for (count, model) in counts.iter_mut().zip(models) {
                    let labels = model.labels(held_out.records.view())?;
                    *count += n_equal(&labels, &held_out.targets);
                    n_capped += model.n_capped();
                }
            }
        }
        Ok((counts, n_capped))
    }

    #[test]
    fn one_matrix_gives_the_accuracies_of_training_every_candidate() {
        let data = overlapping(150);
        let folds = folds_of(data.records.nrows(), 3);
        let path = [0.01, 1.0, 100.0];
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            for kernel in [
                Kernel::Linear,
                Kernel::Rbf {
                    gamma: Gamma::Scale,
                },
            ] {
                let params = SvmParams {
                    kernel,
                    multiclass,
                    tolerance: 1e-8,
                    ..SvmParams::default()
                };
                let statistics = RowStatistics::new(data.records.view()).unwrap();
                let kernels = kernels(&params, (&data, &statistics), &[0.3, 3.0]).unwrap();
                let goal = Goal {
                    path: &path,
                    tolerance: params.tolerance,
                    memory: params.memory_bytes,
                };
                let rows = (&data, &statistics);
                let fast = on_one_matrix(&params, rows, &folds, &kernels, goal).unwrap();
                let slow = one_by_one(&params, &data, &folds, &kernels, goal).unwrap();
                assert_eq!(fast, slow, "{kernel:?} {multiclass:?}");
                assert_eq!(fast.0.nrows(), if kernel == Kernel::Linear { 1 } else { 2 });
            }
        }
    }

    #[test]
    fn of_equally_good_candidates_the_smoothest_is_kept() {
        // Far apart: whatever C and gamma, everything is recognised.
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
