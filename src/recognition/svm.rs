//! Soft-margin support vector machines for many classes: parameters and training.

use linfa::traits::Fit;
use ndarray::{Array1, Array2, Axis};
use serde::{Deserialize, Serialize};

use crate::recognition::binary::{DualSolution, solve};
use crate::recognition::dataset::{Dataset, check_features, check_labels, distinct};
use crate::recognition::kernel::{Kernel, KernelFunction};
use crate::recognition::svm_model::SvmModel;
use crate::{Error, Result};

/// How binary classifiers make one for many classes.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Multiclass {
    /// One classifier per pair of classes; each votes, and the class with the most votes wins. On a tie, the lowest
    /// of the tied class indices wins (LIBSVM's rule).
    #[default]
    OneVsOne,
    /// One classifier per class against all others; the largest decision value wins. On a tie, the lowest index.
    OneVsRest,
    /// All classes in one problem, by Crammer and Singer: the true class must beat every other by a margin of 1. Linear
    /// only; see [`linear_svm`](crate::recognition::linear_svm). The largest decision value wins, on a tie the lowest index.
    CrammerSinger,
}

/// Which solver trains a soft-margin SVM.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// Sequential minimal optimisation.
    #[default]
    Smo,
    /// Dual coordinate descent: a linear kernel one-vs-rest, with a regularised bias; see
    /// [`linear_svm`](crate::recognition::linear_svm).
    CoordinateDescent,
    /// linfa-svm.
    Linfa,
}

/// What a soft-margin SVM is trained with. Implements linfa's [`Fit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvmParams {
    /// The kernel.
    pub kernel: Kernel,
    /// How binary classifiers make one for many classes.
    pub multiclass: Multiclass,
    /// C > 0: what a unit of margin violation costs. Larger fits the training rows more closely and trains longer.
    /// A binary problem may take up to 10 million steps: with few measurements of overlapping classes, a linear kernel
    /// at C = 1,000 trains 25 times longer than at C = 10 (20 classes of 30 rows, m = 16: 4.8 against 0.2 s).
    pub c: f64,
    /// How far the optimality (KKT) conditions may be violated when the solver stops, in units of the decision value;
    /// above 0. LIBSVM's default is 1e-3.
    pub tolerance: f64,
}

impl Default for SvmParams {
    /// Linear, one-vs-one, C = 1, tolerance 1e-3.
    fn default() -> Self {
        Self {
            kernel: Kernel::Linear,
            multiclass: Multiclass::OneVsOne,
            c: 1.0,
            tolerance: 1e-3,
        }
    }
}

/// A binary problem of a multi-class SVM and its solution.
#[derive(Clone, Debug, PartialEq)]
pub struct BinaryProblem {
    /// The class whose rows are positive.
    pub positive: usize,
    /// The class whose rows are negative; `None`: all others.
    pub negative: Option<usize>,
    /// The problem's rows, as indices of training rows.
    pub rows: Vec<usize>,
    /// The solution; its coefficients go with `rows`.
    pub solution: DualSolution,
}

impl SvmParams {
    /// Trains on labelled measurements.
    ///
    /// Deterministic. Binary problems come in ascending order of classes: for one-vs-one (0, 1), (0, 2), …, (1, 2), …
    ///
    /// # Errors
    /// C, tolerance or a kernel parameter out of range; empty data, a NaN or infinite feature (named by row and
    /// column), another number of labels than rows, a single class, or more than
    /// [`MAX_BINARY_ROWS`](crate::recognition::binary::MAX_BINARY_ROWS) rows in a binary problem.
    pub fn train(&self, data: &Dataset) -> Result<SvmModel> {
        self.check()?;
        check_features(data.records.view())?;
        check_labels(data.records.nrows(), data.targets.view())?;
        let classes = distinct(data.targets.view());
        if classes.len() < 2 {
            return Err(Error::input(
                "labels",
                format!("the single class {}", classes[0]),
                "at least two classes are needed",
            ));
        }
        let kernel = self.kernel.resolve(data.records.view())?;
        let problems = match self.multiclass {
            Multiclass::OneVsOne => self.solve_pairs(data, &classes, &kernel)?,
            Multiclass::OneVsRest => self.solve_against_rest(data, &classes, &kernel)?,
            Multiclass::CrammerSinger => {
                return Err(Error::input(
                    "multiclass",
                    "crammer_singer with a kernel",
                    "it is linear only: one_vs_one or one_vs_rest is allowed here",
                ));
            }
        };
        Ok(SvmModel::new(
            data,
            classes,
            kernel,
            self.multiclass,
            problems,
        ))
    }

    fn check(&self) -> Result<()> {
        for (name, value) in [("C", self.c), ("tolerance", self.tolerance)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::input(
                    name,
                    value,
                    "a finite number above 0 is allowed",
                ));
            }
        }
        Ok(())
    }

    fn solve_pairs(
        &self,
        data: &Dataset,
        classes: &[usize],
        kernel: &KernelFunction,
    ) -> Result<Vec<BinaryProblem>> {
        let rows_of: Vec<Vec<usize>> = classes
            .iter()
            .map(|&class| {
                (0..data.targets.len())
                    .filter(|&row| data.targets[row] == class)
                    .collect()
            })
            .collect();
        let mut problems = Vec::with_capacity(classes.len() * (classes.len() - 1) / 2);
        for (a, &positive) in classes.iter().enumerate() {
            for (b, &negative) in classes.iter().enumerate().skip(a + 1) {
                let rows = [rows_of[a].as_slice(), &rows_of[b]].concat();
                let is_positive: Vec<bool> =
                    (0..rows.len()).map(|i| i < rows_of[a].len()).collect();
                let features = data.records.select(Axis(0), &rows);
                let solution = solve(
                    features.view(),
                    &is_positive,
                    kernel,
                    self.c,
                    self.tolerance,
                )?;
                problems.push(BinaryProblem {
                    positive,
                    negative: Some(negative),
                    rows,
                    solution,
                });
            }
        }
        Ok(problems)
    }

    fn solve_against_rest(
        &self,
        data: &Dataset,
        classes: &[usize],
        kernel: &KernelFunction,
    ) -> Result<Vec<BinaryProblem>> {
        classes
            .iter()
            .map(|&positive| {
                let is_positive: Vec<bool> = data
                    .targets
                    .iter()
                    .map(|&label| label == positive)
                    .collect();
                let features = data.records.view();
                let solution = solve(features, &is_positive, kernel, self.c, self.tolerance)?;
                Ok(BinaryProblem {
                    positive,
                    negative: None,
                    rows: (0..data.targets.len()).collect(),
                    solution,
                })
            })
            .collect()
    }
}

impl Fit<Array2<f64>, Array1<usize>, Error> for SvmParams {
    type Object = SvmModel;

    fn fit(&self, dataset: &Dataset) -> Result<SvmModel> {
        self.train(dataset)
    }
}
