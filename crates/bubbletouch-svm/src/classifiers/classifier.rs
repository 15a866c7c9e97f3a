//! The classifier of a study's cell: one choice, trained and asked the same way whatever it is.
//!
//! [`Classifier`] and [`TrainedClassifier`] implement linfa's `Fit` and `PredictInplace`, so they stand wherever a
//! linfa classifier does; and whatever implements those traits is scored the same way by
//! [`predict_split`].

use std::borrow::Cow;
use std::sync::Arc;

use linfa::traits::{Fit, PredictInplace};
use ndarray::{Array1, Array2};
use serde::{Deserialize, Serialize};

use crate::class_model::ClassModel;
use crate::classifiers::ClassifierKind;
use crate::classifiers::trained_classifier::Model;
use crate::cross_validation::choice::{Candidates, Chosen, choose, choose_c};
use crate::dataset::{Dataset, rows};
use crate::kernel::Gamma;
use crate::linear_svm::LinearSvmParams;
use crate::scaling::{FittedScaling, Scaling};
use crate::split::Split;
use crate::split::stratified_k_fold;
use crate::streams::DynStreams;
use crate::{DEFAULT_MEMORY_BYTES, Multiclass, Solver, SvmParams};
use crate::{Error, Result};

pub use crate::classifiers::trained_classifier::TrainedClassifier;

/// The C of a soft-margin SVM or a logistic regression: given, or chosen by cross-validation of the training rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cost {
    /// This C.
    Fixed(f64),
    /// The most accurate of these (and of the γ beside them) on validation rows; of equals the smaller γ, then the smaller
    /// C. Then all training rows are used.
    Chosen(Candidates),
}

/// Folds of the cross-validation that chooses C and γ, unless others are given: scikit-learn's default.
const FOLDS: usize = 5;

/// A classifier and its options. Options that its kind has no use for are ignored: γ of a linear SVM, C of all but SVMs
/// and logistic regression ([`ClassifierKind::has_c`]; [`TrainedClassifier::c`] is then `None`).
#[derive(Clone, Debug, PartialEq)]
pub struct Classifier {
    /// Which.
    pub kind: ClassifierKind,
    /// How features are scaled, fitted on the training rows.
    pub scaling: Scaling,
    /// How binary SVMs make one for many classes.
    pub multiclass: Multiclass,
    /// Which solver trains an SVM.
    pub solver: Solver,
    /// C.
    pub c: Cost,
    /// γ of the RBF and polynomial kernels, in inverse squared units of the scaled features.
    pub gamma: Gamma,
    /// c₀ ≥ 0 of the polynomial kernel.
    pub coef0: f64,
    /// Degree of the polynomial kernel, 1 to 20.
    pub degree: u32,
    /// The solver's stopping tolerance, above 0; see [`SvmParams::tolerance`] and [`LinearSvmParams::tolerance`].
    /// Logistic regression takes a tenth of it as its own tolerance.
    pub tolerance: f64,
    /// k of the k nearest neighbours, 1 to the number of training rows.
    pub n_neighbours: usize,
    /// Trees of a random forest, at least 1.
    pub n_trees: usize,
    /// Splits below each other in a tree or in a forest's trees, at least 1; `None`: until leaves are pure.
    pub max_depth: Option<usize>,
    /// Most bytes of kernel values that an SVM's solver holds at once; see [`SvmParams::memory_bytes`].
    pub memory_bytes: usize,
}

impl Classifier {
    /// A classifier with scikit-learn's defaults (C = 1, γ 'scale', degree 3, 5 neighbours, 100 trees of any depth; but
    /// c₀ = 1, since c₀ = 0 leaves out all lower powers) on standardised features; SVMs one-vs-one.
    pub fn new(kind: ClassifierKind) -> Self {
        Self {
            kind,
            scaling: Scaling::Standard,
            multiclass: Multiclass::OneVsOne,
            solver: Solver::Smo,
            c: Cost::Fixed(1.0),
            gamma: Gamma::Scale,
            coef0: 1.0,
            degree: 3,
            tolerance: 1e-3,
            n_neighbours: 5,
            n_trees: 100,
            max_depth: None,
            memory_bytes: DEFAULT_MEMORY_BYTES,
        }
    }

    /// Trains on training rows. Whatever is drawn comes from `seed`: the five stratified folds on which a C to be chosen is
    /// chosen, a forest's trees, the order of coordinate descent.
    ///
    /// # Errors
    /// Parameters out of range, or data that the kind's training or [`stratified_k_fold`] refuses.
    pub fn train(&self, training: &Dataset, seed: &dyn DynStreams) -> Result<TrainedClassifier> {
        let folds = match &self.c {
            Cost::Chosen(_) if self.kind.has_c() => {
                let labels = training.targets.view();
                stratified_k_fold(labels, FOLDS, &*seed.named("validation"))?
            }
            _ => Vec::new(),
        };
        self.train_validated(training, &folds, seed)
    }

    /// Trains on training rows; a C to be chosen is chosen on these folds of them (such as some that keep groups apart),
    /// given in positions within `training`. The scaling sees all training rows, but not their labels, before they are
    /// folded. Whatever else is drawn comes from `seed`.
    ///
    /// # Errors
    /// Parameters out of range, or data that the kind's training or [`choose`](Self::choose) refuses.
    pub fn train_validated(
        &self,
        training: &Dataset,
        folds: &[Split],
        seed: &dyn DynStreams,
    ) -> Result<TrainedClassifier> {
        match &self.c {
            Cost::Chosen(candidates) if self.kind.has_c() => {
                let chosen = self.choose(training, folds, candidates, seed)?;
                self.with_choice(&chosen).train_with_c(
                    training,
                    Some(chosen.best.c),
                    Some(chosen),
                    seed,
                )
            }
            _ => self.train_without_choice(training, seed),
        }
    }

    /// The best of the candidates on folds of the training rows; see [`choose`].
    ///
    /// # Errors
    /// As [`choose`].
    pub fn choose(
        &self,
        training: &Dataset,
        folds: &[Split],
        candidates: &Candidates,
        seed: &dyn DynStreams,
    ) -> Result<Chosen> {
        let (_, scaled) = self.scaled(training)?;
        if let Some(params) = self.kernel_svm(1.0) {
            return choose(&params, &scaled, folds, candidates);
        }
        let train = |fitting: &Dataset, c| {
            let model = self.train_model(fitting, Some(c), seed)?;
            let n_capped = model.n_capped();
            let predict = move |rows: &Dataset| model.labels(rows.records.view());
            Ok((predict, n_capped))
        };
        choose_c(train, &scaled, folds, &candidates.c)
    }

    /// The same classifier with C and γ as they were chosen.
    pub fn with_choice(&self, chosen: &Chosen) -> Self {
        Self {
            c: Cost::Fixed(chosen.best.c),
            gamma: chosen.best.gamma.map_or(self.gamma, Gamma::Value),
            ..self.clone()
        }
    }

    /// With the C that was given, if the kind has one.
    fn train_without_choice(
        &self,
        training: &Dataset,
        seed: &dyn DynStreams,
    ) -> Result<TrainedClassifier> {
        let c = match self.c {
            Cost::Fixed(c) if self.kind.has_c() => Some(c),
            _ => None,
        };
        self.train_with_c(training, c, None, seed)
    }

    /// Trains for several C, in the order asked; kernel SVMs from one Gram matrix ([`SvmParams::train_path`]).
    ///
    /// # Errors
    /// As [`train`](Self::train); a kind without C.
    pub fn train_path(
        &self,
        training: &Dataset,
        path: &[f64],
        seed: &dyn DynStreams,
    ) -> Result<Vec<TrainedClassifier>> {
        if !self.kind.has_c() {
            let given = format!("for {:?}", self.kind);
            return Err(Error::input("C", given, "it has none"));
        }
        let (scaling, scaled) = self.scaled(training)?;
        let models: Vec<Model> = match self.kernel_svm(1.0) {
            Some(params) => params
                .train_path(&scaled, path)?
                .into_iter()
                .map(|model| Model::Svm(Box::new(model)))
                .collect(),
            None => path
                .iter()
                .map(|&c| self.train_model(&scaled, Some(c), seed))
                .collect::<Result<_>>()?,
        };
        let trained = models.into_iter().zip(path);
        Ok(trained
            .map(|(model, &c)| TrainedClassifier::new(scaling.clone(), model, Some(c), None))
            .collect())
    }

    /// The scaling, and the training rows scaled: themselves, where it changes nothing.
    fn scaled<'a>(&self, training: &'a Dataset) -> Result<(FittedScaling, Cow<'a, Dataset>)> {
        let scaling = self.scaling.fit(training.records.view())?;
        if scaling.changes_nothing() {
            return Ok((scaling, Cow::Borrowed(training)));
        }
        let scaled = scaling.apply(training.records.view())?;
        let scaled = Dataset::new(scaled, training.targets.clone());
        Ok((scaling, Cow::Owned(scaled)))
    }

    fn train_with_c(
        &self,
        training: &Dataset,
        c: Option<f64>,
        chosen: Option<Chosen>,
        seed: &dyn DynStreams,
    ) -> Result<TrainedClassifier> {
        let (scaling, scaled) = self.scaled(training)?;
        let model = self.train_model(&scaled, c, seed)?;
        Ok(TrainedClassifier::new(scaling, model, c, chosen))
    }

    /// The model on scaled rows.
    fn train_model(
        &self,
        scaled: &Dataset,
        c: Option<f64>,
        seed: &dyn DynStreams,
    ) -> Result<Model> {
        let c = c.unwrap_or(1.0);
        Ok(match self.kernel_svm(c) {
            Some(params) => Model::Svm(Box::new(params.train(scaled)?)),
            None => Model::Classes((self.kind.about().train)(self, scaled, c, seed)?),
        })
    }

    /// An SVM without a kernel matrix.
    pub(crate) fn train_kernel_free(
        &self,
        scaled: &Dataset,
        c: f64,
        seed: &dyn DynStreams,
    ) -> Result<Arc<dyn ClassModel>> {
        let seed = seed.named("descent");
        Ok(Arc::new(self.linear_svm(c)?.train(scaled, &*seed)?))
    }

    /// What the kernel SVM is trained with, if that is what the options ask for.
    fn kernel_svm(&self, c: f64) -> Option<SvmParams> {
        let kernel = self.kind.about().kernel?(self);
        (self.solver != Solver::CoordinateDescent).then_some(SvmParams {
            kernel,
            multiclass: self.multiclass,
            c,
            tolerance: self.tolerance,
            solver: self.solver,
            memory_bytes: self.memory_bytes,
        })
    }

    /// Checks that the solver can train this classifier, if it is an SVM.
    ///
    /// # Errors
    /// If coordinate descent is to train another kernel than the linear one, or another scheme than one-vs-rest.
    pub fn check_solver(&self) -> Result<()> {
        let is_linear = self.kind == ClassifierKind::LinearSvm;
        let is_possible = is_linear && self.multiclass == Multiclass::OneVsRest;
        let is_svm = self.kind.about().kernel.is_some();
        if self.solver != Solver::CoordinateDescent || !is_svm || is_possible {
            return Ok(());
        }
        let (kind, multiclass) = (self.kind, self.multiclass);
        let given = format!("coordinate_descent with {kind:?} and {multiclass:?}");
        let allowed = "it trains linear_svm with one_vs_rest alone";
        Err(Error::input("solver", given, allowed))
    }

    /// What the linear SVM without a kernel matrix is trained with.
    fn linear_svm(&self, c: f64) -> Result<LinearSvmParams> {
        self.check_solver()?;
        Ok(LinearSvmParams {
            c,
            tolerance: self.tolerance,
            ..LinearSvmParams::default()
        })
    }
}

impl Fit<Array2<f64>, Array1<usize>, Error> for Classifier {
    type Object = TrainedClassifier;

    /// [`Classifier::train`] with the seed 0_u64.
    fn fit(&self, training: &Dataset) -> Result<TrainedClassifier> {
        self.train(training, &0_u64)
    }
}

/// Trains any classifier that speaks linfa's traits on a split's training rows, and predicts its test rows (in the
/// order of `split.test`).
///
/// # Errors
/// A row beyond the data, or what the classifier refuses.
pub fn predict_split<P, E>(params: &P, data: &Dataset, split: &Split) -> Result<Array1<usize>>
where
    P: Fit<Array2<f64>, Array1<usize>, E>,
    P::Object: PredictInplace<Array2<f64>, Array1<usize>>,
    E: std::error::Error + From<linfa::Error> + 'static,
{
    let model = params
        .fit(&rows(data, &split.train)?)
        .map_err(own_or_wrapped)?;
    let test = rows(data, &split.test)?;
    let mut labels = model.default_target(&test.records);
    model.predict_inplace(&test.records, &mut labels);
    Ok(labels)
}

/// Our own errors as they are; another crate's as bad input to its classifier.
fn own_or_wrapped(error: impl std::error::Error + 'static) -> Error {
    let error: Box<dyn std::error::Error> = Box::new(error);
    match error.downcast::<Error>() {
        Ok(own) => *own,
        Err(other) => Error::input("classifier", other, "see its documentation"),
    }
}
