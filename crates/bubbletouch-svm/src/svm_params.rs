//! Parameters of soft-margin SVMs, and their training.

use std::borrow::Cow;

use linfa::DatasetBase;
use linfa::dataset::{AsSingleTargets, Label};
use linfa::traits::Fit;
use ndarray::{ArrayBase, ArrayView1, Data, Ix2};
use serde::{Deserialize, Serialize};

use crate::class_weight::ClassWeight;
use crate::dataset::{Dataset, LabelledRows, check_two_classes, numbered};
use crate::error::check_above_zero;
use crate::gram::sorted::Sorted;
use crate::kernel::{Kernel, KernelFunction};
use crate::multiclass::Multiclass;
use crate::precision::Precision;
use crate::predict::decision::DecisionFunctions;
use crate::predict::svm_model::{Decision, SvmModel};
use crate::row_statistics::RowStatistics;
use crate::smo::SolverScalar;
use crate::training::{Goal, KernelStorage, Stored};
use crate::{Error, Result};

/// Solver that trains the binary classifiers of an SVM.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SvmSolver {
    /// Sequential minimal optimisation on shared Gram matrices.
    #[default]
    Smo,
    /// Dual coordinate descent for the linear kernel and one-vs-rest, with a regularised bias (LIBLINEAR's problem).
    CoordinateDescent,
}

/// Number of training rows below which kernel values are always f64, because f64 then costs little time.
const SINGLE_FROM_ROWS: usize = 1000;
/// Minimum tolerance for f32 kernel values; smaller tolerances are near the rounding error of f32.
const SINGLE_TOLERANCE: f64 = 1e-4;
/// Maximum of C · K(x, x), and of K(x, x), for f32 kernel values. Coefficients of up to C multiply the rounding error of K, which is 6e-8 of K.
const SINGLE_MOST: f64 = 1e5;
/// Default memory limit of the kernel values, bytes: 2 GiB, enough for one-vs-rest on 16,384 rows in f32.
pub const DEFAULT_MEMORY_BYTES: usize = 2 << 30;

/// Parameters of a soft-margin SVM, which is trained by [`train`](SvmParams::train).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvmParams {
    /// Kernel function.
    pub kernel: Kernel,
    /// Strategy that combines binary classifiers into a multi-class classifier.
    pub multiclass: Multiclass,
    /// Penalty C > 0 per unit of margin violation. With a larger C, the training rows are fitted more closely, and training takes longer. The solver of a
    /// binary problem stops after 10 million iterations, or 100 per row if that is more.
    pub c: f64,
    /// Weights of the classes: the penalty of a row is C times the weight of its class among all training rows. LIBLINEAR's one-vs-rest differs: rows of the
    /// other classes have the weight 1 there.
    pub class_weight: ClassWeight,
    /// Stopping tolerance, above 0: the largest violation of the optimality (KKT) conditions, in units of the decision value. LIBSVM's default is 1e-3.
    pub tolerance: f64,
    /// Maximum size of the kernel values in memory at one time, bytes. If the kernel values do not fit, rows are computed on demand and the most recent rows
    /// are cached. Training is then slower, with equal solutions.
    pub memory_bytes: usize,
}

impl Default for SvmParams {
    /// Returns the defaults: linear kernel, one-vs-one, C = 1, tolerance 1e-3, SMO within 2 GiB.
    fn default() -> Self {
        Self {
            kernel: Kernel::Linear,
            multiclass: Multiclass::OneVsOne,
            c: 1.0,
            class_weight: ClassWeight::Uniform,
            tolerance: 1e-3,
            memory_bytes: DEFAULT_MEMORY_BYTES,
        }
    }
}

impl SvmParams {
    /// Trains an SVM on labelled rows. The result is deterministic. If the data set has weights, the penalty of a row is C times its weight.
    ///
    /// The binary problems are in ascending order of classes: for one-vs-one (0, 1), (0, 2), …, (1, 2), …
    ///
    /// # Errors
    /// If C, the tolerance or a kernel parameter is out of range. If the data are empty, or a feature is NaN or infinite (the error names row and column). If the
    /// number of labels or weights differs from the number of rows, a weight is not above 0, or there is a single class.
    pub fn train(&self, data: &Dataset) -> Result<SvmModel> {
        let mut models = self.train_path(data, &[self.c])?;
        Ok(models.swap_remove(0))
    }

    /// Trains one model for each C in `path` (in place of `self.c`) with shared kernel values. Returns the models in the order of `path`. The solver starts
    /// from the solution of the next smaller C.
    ///
    /// # Errors
    /// If a parameter is out of range, or the data cannot be used for training.
    pub fn train_path(&self, data: &Dataset, path: &[f64]) -> Result<Vec<SvmModel>> {
        let (classes, labels) = numbered(data.targets.view());
        let rows = LabelledRows {
            labels: labels.view(),
            ..LabelledRows::from(data)
        };
        self.train_rows(rows, &classes, path)
    }

    /// Trains one model for each C in `path`. `classes` contains the label of each class.
    fn train_rows<L: Label>(
        &self,
        rows: LabelledRows,
        classes: &[L],
        path: &[f64],
    ) -> Result<Vec<SvmModel<L>>> {
        self.check(path)?;
        let statistics = RowStatistics::new(rows.features)?;
        rows.check()?;
        check_two_classes(classes)?;
        let kernel = self.kernel.resolve(rows.features, &statistics)?;
        let mut ascending = path.to_vec();
        ascending.sort_by(f64::total_cmp);
        ascending.dedup();
        let centre = kernel.centre(&statistics);
        let goal = Goal {
            path: &ascending,
            tolerance: self.tolerance,
            memory: self.memory_bytes,
        };
        let numbers: Vec<usize> = (0..classes.len()).collect();
        let trained = self.train_smo(rows, &numbers, kernel, centre.view(), goal);
        let label = |model: SvmModel| model.with_classes(classes.to_vec());
        let trained: Vec<SvmModel<L>> = trained.into_iter().map(label).collect();
        if ascending == path {
            return Ok(trained);
        }
        let at = |c: f64| ascending.partition_point(|&other| other < c);
        Ok(path.iter().map(|&c| trained[at(c)].clone()).collect())
    }

    /// Trains models with kernel values in the precision that the rows need. `classes` contains the labels of the rows' classes, ascending.
    fn train_smo(
        &self,
        rows: LabelledRows,
        classes: &[usize],
        kernel: KernelFunction,
        centre: ArrayView1<f64>,
        goal: Goal,
    ) -> Vec<SvmModel> {
        let n_rows = rows.features.nrows();
        if !self.needs_double(n_rows, kernel, goal.path, (0.0, 1.0)) {
            let sorted = Sorted::<f32>::new(rows, classes, kernel, centre, |_| 0)
                .weighted(self.class_weight, rows.weights);
            if !self.needs_double(n_rows, kernel, goal.path, sorted.farthest_and_heaviest()) {
                return self.solve_sorted(sorted, goal);
            }
        }
        let sorted = Sorted::<f64>::new(rows, classes, kernel, centre, |_| 0)
            .weighted(self.class_weight, rows.weights);
        self.solve_sorted(sorted, goal)
    }

    /// Returns whether kernel values must be computed in f64, depending on the number of rows, the tolerance and the penalty. The largest squared distance of a
    /// row from the centre is `farthest`, and the largest weight of a row is `heaviest`.
    pub(crate) fn needs_double(
        &self,
        n_rows: usize,
        kernel: KernelFunction,
        path: &[f64],
        (farthest, heaviest): (f64, f64),
    ) -> bool {
        let Some(largest) = kernel.largest_in_single(farthest) else {
            return true;
        };
        let c = heaviest * path.iter().copied().fold(0.0, f64::max);
        self.scalar_bytes(n_rows) == size_of::<f64>()
            || c * largest > SINGLE_MOST
            || largest > SINGLE_MOST
    }

    fn solve_sorted<T: SolverScalar>(&self, sorted: Sorted<T>, goal: Goal) -> Vec<SvmModel>
    where
        Decision: From<DecisionFunctions<T>>,
    {
        let mut trained = sorted.solve_all(self.multiclass, goal).into_iter();
        // The last model takes ownership of the rows.
        let last = trained.next_back();
        let mut models: Vec<SvmModel> = trained
            .map(|trained| SvmModel::new(Cow::Borrowed(&sorted), self.multiclass, trained))
            .collect();
        models.extend(
            last.map(|trained| SvmModel::new(Cow::Owned(sorted), self.multiclass, trained)),
        );
        models
    }

    /// Estimates the size of the kernel values in memory while the SVM is trained on classes of equal size, bytes. For the choice of C and γ by cross-validation,
    /// see [`choice_bytes`](Self::choice_bytes).
    pub fn kernel_bytes(&self, n_rows: usize, n_classes: usize, n_features: usize) -> usize {
        let start = |class: usize| class * n_rows / n_classes.max(1);
        let ranges: Vec<_> = (0..n_classes)
            .map(|class| start(class)..start(class + 1))
            .collect();
        let storage = KernelStorage {
            multiclass: self.multiclass,
            is_linear: self.kernel == Kernel::Linear,
            n_features,
            has_row_weights: false,
            ranges: &ranges,
        };
        let stored = match self.scalar_bytes(n_rows) {
            4 => storage.within::<f32>(self.memory_bytes),
            _ => storage.within::<f64>(self.memory_bytes),
        };
        match stored {
            Stored::NearMargin(bytes) | Stored::Whole(bytes) => bytes,
            Stored::Rows => self.memory_bytes,
        }
    }

    /// Estimates the size of the kernel values in memory while C and γ are chosen by cross-validation, bytes: the products, the kernel values, and the part of
    /// a fold's training rows.
    pub fn choice_bytes(&self, n_rows: usize) -> usize {
        3 * n_rows * n_rows * self.scalar_bytes(n_rows)
    }

    /// Returns the size of a kernel value, bytes, unless large features or penalties need f64.
    fn scalar_bytes(&self, n_rows: usize) -> usize {
        match n_rows < SINGLE_FROM_ROWS || self.tolerance < SINGLE_TOLERANCE {
            true => size_of::<f64>(),
            false => size_of::<f32>(),
        }
    }

    /// Checks the parameters; returns an error if they are invalid for every data set.
    pub(crate) fn check(&self, path: &[f64]) -> Result<()> {
        if path.is_empty() {
            return Err(Error::input("C", "none", "at least one is needed"));
        }
        for &c in path {
            check_above_zero("C", c)?;
        }
        check_above_zero("tolerance", self.tolerance)
    }
}

/// Trains on arrays and views of `f32` or `f64`, with labels of any type that linfa supports: `usize`, `bool`, texts.
impl<F, D, T, L> Fit<ArrayBase<D, Ix2>, T, Error> for SvmParams
where
    F: Precision,
    D: Data<Elem = F>,
    T: AsSingleTargets<Elem = L>,
    L: Label,
{
    type Object = SvmModel<L>;

    /// Trains an SVM; weights of rows multiply C, as in [`train`](SvmParams::train).
    fn fit(&self, dataset: &DatasetBase<ArrayBase<D, Ix2>, T>) -> Result<SvmModel<L>> {
        let (classes, labels) = numbered(dataset.targets.as_single_targets());
        let features = F::double_features(&dataset.records);
        let rows = LabelledRows {
            features: features.view(),
            labels: labels.view(),
            weights: dataset.weights().unwrap_or_default(),
        };
        let mut models = self.train_rows(rows, &classes, &[self.c])?;
        Ok(models.swap_remove(0))
    }
}
