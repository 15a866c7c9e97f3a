//! Soft-margin support vector machines for [`linfa`]: LIBSVM's problem and answers, from shared kernel matrices.
//!
//! ```
//! use bubbletouch_svm::kernel::{Gamma, Kernel};
//! use bubbletouch_svm::SvmParams;
//! use linfa::dataset::DatasetBase;
//! use linfa::traits::{Fit, Predict};
//! use ndarray::{Array1, Array2};
//!
//! // Three classes on a circle, forty rows each.
//! let features = Array2::from_shape_fn((120, 2), |(row, column)| {
//!     let angle = 2.1 * (row % 3) as f64 + 0.4 * (row as f64).sin();
//!     if column == 0 { angle.cos() } else { angle.sin() }
//! });
//! let data = DatasetBase::new(features, Array1::from_iter((0..120).map(|row| row % 3)));
//!
//! let kernel = Kernel::Rbf { gamma: Gamma::Scale };
//! let model = SvmParams { kernel, c: 10.0, ..SvmParams::default() }.fit(&data)?;
//! assert_eq!(model.predict(&data.records), data.targets);
//! # Ok::<(), bubbletouch_svm::Error>(())
//! ```
//!
//! # Words
//!
//! - A **data set** is linfa's: features (n_rows × m, `f32` or `f64`) and one label (a `usize`) for each row.
//! - A **binary problem** separates the rows of a positive class from those of a negative class, or of all others ([`Multiclass`]).
//! - A **decision value** is what a binary problem gives a row: above 0 for the positive class.
//! - **C** is the cost of a unit of margin violation; **γ** is the width parameter of a kernel.
//!
//! # How it works
//!
//! A binary problem decides by the sign of `f(x) = Σ_i y_i a_i K(x_i, x) − ρ`. The multipliers minimise
//! `½ Σ_ij a_i a_j y_i y_j K(x_i, x_j) − Σ_i a_i` over `0 ≤ a_i ≤ C`, `Σ_i y_i a_i = 0`.
//!
//! 1. **Rows** are checked, sorted by class and centred, in single or double precision (`gram::sorted`, `gram::extent`).
//! 2. **Kernel values** `K(x_i, x_j)` between two classes are computed once for all problems, by matrix products of the rows (`gram`, `linalg`).
//! 3. **Each problem** is solved by sequential minimal optimisation (`smo`). With `β_i = y_i a_i`, a solution is optimal when no variable that can
//!    be raised has a larger `y_i − (Kβ)_i` than one that can be lowered. Long runs end by the linear equations of the free variables
//!    (`active_set`); well separated classes are solved on the rows near the margin (`screening`).
//! 4. **Along C and over folds**, each solution starts from the previous one ([`cross_validation`]).
//! 5. **Prediction** is one matrix product for all problems, and the vote of their signs ([`predict`]).
//!
//! # Which solver trains which SVM
//!
//! | parameters | solver | stops when | memory |
//! |---|---|---|---|
//! | [`SvmParams`], any kernel, rows ≥ 1,000, C · K ≤ 1e5, tolerance ≥ 1e-4 | SMO on kernel values in `f32` | KKT violation ≤ `tolerance` in decision values, or 10 million iterations (100 a row if more) | n² · 4 bytes, or the latest rows within `memory_bytes` |
//! | [`SvmParams`], any kernel, otherwise | the same in `f64` | the same | n² · 8 bytes, or as above |
//! | [`linear_svm::LinearSvmParams`] | dual coordinate descent, one-vs-rest, regularised bias (LIBLINEAR's problem) | spread of projected gradients ≤ `tolerance`, or `max_passes` | n · m |
//!
//! The module [`classifiers`] has classifiers of other kinds which repeat exactly, with their reasons to differ from linfa's.
//!
//! # Sources
//!
//! - Fan, Chen, Lin, *Working set selection using second order information for training support vector machines*, JMLR 2005.
//! - DeCoste, Wagstaff, *Alpha seeding for support vector machines*, KDD 2000.
//! - Hsieh et al., *A dual coordinate descent method for large-scale linear SVM*, ICML 2008.
//! - Joachims, *Making large-scale SVM learning practical*, Advances in Kernel Methods 1999.
//! - Scheinberg, *An efficient implementation of an active set method for SVMs*, JMLR 2006.
//! - Wen et al., *Improving efficiency of SVM k-fold cross-validation by alpha seeding*, AAAI 2017.
//! - Goto, van de Geijn, *Anatomy of high-performance matrix multiplication*, ACM TOMS 2008.
#![warn(missing_docs)]
#![warn(clippy::missing_errors_doc)]
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

pub(crate) mod active_set;
pub mod classifiers;
pub(crate) mod coordinate_descent;
pub mod cross_validation;
pub mod dataset;
pub mod dual;
pub mod error;
pub(crate) mod gram;
pub mod kernel;
pub(crate) mod linalg;
pub mod linear_model;
pub mod linear_svm;
pub mod precision;
pub mod predict;
pub mod scaling;
pub(crate) mod screening;
pub(crate) mod smo;
pub mod split;
pub mod streams;
pub(crate) mod training;

use std::borrow::Cow;

use linfa::DatasetBase;
use linfa::traits::Fit;
use ndarray::{Array1, Array2, ArrayView1};
use serde::{Deserialize, Serialize};

use crate::dataset::{Dataset, check_labels, distinct};
use crate::dual::DualSolution;
use crate::gram::extent::Extent;
use crate::gram::sorted::Sorted;
use crate::kernel::{Kernel, KernelFunction};
use crate::linalg::scalar::Scalar;
use crate::precision::Precision;
use crate::predict::decision::DecisionFunctions;
use crate::predict::svm_model::{Decision, SvmModel};
use crate::training::Goal;
pub use error::{Error, Result};

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
}

impl Multiclass {
    /// The binary problems between n classes: the positive class, and the negative one (`None`: all others).
    pub(crate) fn problems(self, n: usize) -> Vec<(usize, Option<usize>)> {
        match self {
            Self::OneVsOne => (0..n)
                .flat_map(|first| (first + 1..n).map(move |second| (first, Some(second))))
                .collect(),
            Self::OneVsRest => (0..n).map(|class| (class, None)).collect(),
        }
    }
}

/// What solves the binary problems.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// Our own sequential minimal optimisation on shared Gram matrices.
    #[default]
    Smo,
    /// Dual coordinate descent: linear kernel and one-vs-rest, with a regularised bias (LIBLINEAR's problem); see
    /// [`linear_svm`].
    CoordinateDescent,
}

/// Rows below which kernel values are always f64: it costs nothing that a person would notice.
const SINGLE_FROM_ROWS: usize = 1000;
/// The smallest tolerance that f32 kernel values can be trusted with.
const SINGLE_TOLERANCE: f64 = 1e-4;
/// The largest C · K(x, x), and the largest K(x, x), for f32: rounding of K, 6e-8 of it, is multiplied by coefficients of at
/// most C.
const SINGLE_MOST: f64 = 1e5;
/// Bytes of kernel values held at once, unless asked otherwise: one-vs-rest on 16,384 rows in f32.
pub const DEFAULT_MEMORY_BYTES: usize = 2 << 30;

/// What a soft-margin SVM is trained with. Implements linfa's [`Fit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvmParams {
    /// The kernel.
    pub kernel: Kernel,
    /// How binary classifiers make one for many classes.
    pub multiclass: Multiclass,
    /// C > 0: what a unit of margin violation costs. Larger fits the training rows more closely and trains longer.
    /// A binary problem may take up to 10 million iterations, or 100 a row.
    pub c: f64,
    /// How far the optimality (KKT) conditions may be violated when the solver stops, in units of the decision value;
    /// above 0. LIBSVM's default is 1e-3.
    pub tolerance: f64,
    /// What solves the binary problems.
    pub solver: Solver,
    /// Most bytes of kernel values held at once. Where they do not fit, rows are computed when asked
    /// for and the latest kept: slower, the same solution.
    pub memory_bytes: usize,
}

impl Default for SvmParams {
    /// Linear, one-vs-one, C = 1, tolerance 1e-3, our own solver within 2 GiB.
    fn default() -> Self {
        Self {
            kernel: Kernel::Linear,
            multiclass: Multiclass::OneVsOne,
            c: 1.0,
            tolerance: 1e-3,
            solver: Solver::Smo,
            memory_bytes: DEFAULT_MEMORY_BYTES,
        }
    }
}

/// Rows, their classes, the kernel, and where it is taken about.
type Sorting<'a> = (
    &'a Dataset,
    &'a [usize],
    KernelFunction,
    ArrayView1<'a, f64>,
);

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
    /// column), another number of labels than rows, a single class; what the [`Solver`] does not do.
    pub fn train(&self, data: &Dataset) -> Result<SvmModel> {
        let mut models = self.train_path(data, &[self.c])?;
        Ok(models.swap_remove(0))
    }

    /// Trains for several C (in place of `self.c`) from the same kernel values, each solution starting from that of the
    /// next smaller C; the models come in the order asked.
    ///
    /// # Errors
    /// As [`train`](Self::train).
    pub fn train_path(&self, data: &Dataset, path: &[f64]) -> Result<Vec<SvmModel>> {
        self.check(path)?;
        let extent = Extent::of(data.records.view())?;
        check_labels(data.records.nrows(), data.targets.view())?;
        let classes = distinct(data.targets.view());
        if classes.len() < 2 {
            return Err(Error::input(
                "labels",
                format!("the single class {}", classes[0]),
                "at least two classes are needed",
            ));
        }
        let kernel = self.kernel.resolve(data.records.view(), &extent)?;
        let mut ascending = path.to_vec();
        ascending.sort_by(f64::total_cmp);
        ascending.dedup();
        let centre = extent.centre(&kernel);
        let goal = Goal {
            path: &ascending,
            tolerance: self.tolerance,
            memory: self.memory_bytes,
        };
        let trained = self.train_smo((data, &classes, kernel, centre.view()), goal);
        if ascending == path {
            return Ok(trained);
        }
        let at = |c: f64| ascending.partition_point(|&other| other < c);
        Ok(path.iter().map(|&c| trained[at(c)].clone()).collect())
    }

    fn train_smo(&self, sorting: Sorting, goal: Goal) -> Vec<SvmModel> {
        let (data, classes, kernel, centre) = sorting;
        let n_rows = data.records.nrows();
        if !self.wants_double(n_rows, kernel, goal.path, 0.0) {
            let sorted = Sorted::<f32>::new(data, classes, kernel, centre);
            if !self.wants_double(n_rows, kernel, goal.path, sorted.farthest()) {
                return self.solve_sorted(sorted, goal);
            }
        }
        let sorted = Sorted::<f64>::new(data, classes, kernel, centre);
        self.solve_sorted(sorted, goal)
    }

    /// Whether f32 kernel values would not do for rows of which the farthest is so far from the centre (squared): few rows (then f64 costs nothing), a tolerance near f32's rounding, or
    /// coefficients that multiply that rounding.
    pub(crate) fn wants_double(
        &self,
        n_rows: usize,
        kernel: KernelFunction,
        path: &[f64],
        farthest: f64,
    ) -> bool {
        let Some(largest) = kernel.largest_in_single(farthest) else {
            return true;
        };
        let c = path.iter().copied().fold(0.0, f64::max);
        n_rows < SINGLE_FROM_ROWS
            || self.tolerance < SINGLE_TOLERANCE
            || c * largest > SINGLE_MOST
            || largest > SINGLE_MOST
    }

    fn solve_sorted<T: Scalar>(&self, sorted: Sorted<T>, goal: Goal) -> Vec<SvmModel>
    where
        Decision: From<DecisionFunctions<T>>,
    {
        let trained = match self.multiclass {
            Multiclass::OneVsOne => sorted.one_vs_one(goal),
            _ => sorted.one_vs_rest(goal),
        };
        let mut trained = trained.into_iter();
        // The last model may have the rows.
        let last = trained.next_back();
        let mut models: Vec<SvmModel> = trained
            .map(|trained| SvmModel::new(Cow::Borrowed(&sorted), self.multiclass, trained))
            .collect();
        models.extend(
            last.map(|trained| SvmModel::new(Cow::Owned(sorted), self.multiclass, trained)),
        );
        models
    }

    /// Refuses what no data set could be trained with.
    pub(crate) fn check(&self, path: &[f64]) -> Result<()> {
        if path.is_empty() {
            return Err(Error::input("C", "none", "at least one is needed"));
        }
        let penalties = path.iter().map(|&c| ("C", c));
        for (name, value) in penalties.chain([("tolerance", self.tolerance)]) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::input(
                    name,
                    value,
                    "a finite number above 0 is allowed",
                ));
            }
        }
        if self.solver == Solver::CoordinateDescent {
            return Err(Error::input(
                "solver",
                "coordinate_descent",
                "smo solves the dual problem of a kernel; coordinate_descent is for linear SVMs, one-vs-rest",
            ));
        }
        Ok(())
    }
}

impl<F: Precision> Fit<Array2<F>, Array1<usize>, Error> for SvmParams {
    type Object = SvmModel;

    fn fit(&self, dataset: &DatasetBase<Array2<F>, Array1<usize>>) -> Result<SvmModel> {
        self.train(&F::double(dataset))
    }
}
