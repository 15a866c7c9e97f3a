//! Classifiers of a study's configurations. All kinds share one interface for training and prediction.
//!
//! [`Classifier`] and [`TrainedClassifier`] implement linfa's `Fit` and `PredictInplace`, so they can replace any linfa classifier. [`predict_split`]
//! evaluates any classifier that implements these traits.

use std::borrow::Cow;
use std::sync::Arc;

use linfa::DatasetBase;
use linfa::dataset::AsSingleTargets;
use linfa::traits::{Fit, PredictInplace};
use ndarray::{Array1, Array2, ArrayBase, Data, Ix2};
use serde::{Deserialize, Serialize, Serializer};

use crate::class_model::ClassModel;
use crate::class_weight::ClassWeight;
use crate::classifiers::ClassifierKind;
use crate::classifiers::parameters::{Parameter, Parameters};
use crate::cross_validation::choice::{Candidates, Chosen, choose, choose_c};
use crate::dataset::{Dataset, check_unweighted, rows};
use crate::kernel::Gamma;
use crate::linear_svm::LinearSvmParams;
use crate::precision::Precision;
use crate::scaling::{FittedScaling, Scaling};
use crate::split::Split;
use crate::split::stratified_k_fold;
use crate::streams::Streams;
use crate::{DEFAULT_MEMORY_BYTES, Multiclass, SvmParams, SvmSolver};
use crate::{Error, Result};

pub use crate::classifiers::trained_classifier::TrainedClassifier;

/// Penalty C of a soft-margin SVM or logistic regression: fixed, or chosen by cross-validation on the training rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cost {
    /// Fixed value of C.
    Fixed(f64),
    /// C and γ are selected by the highest accuracy on validation rows. If candidates are equally accurate, the smaller γ is chosen, then the smaller C. The
    /// final model is trained on all training rows.
    Chosen(Candidates),
}

/// Default number of cross-validation folds for the choice of C and γ: 5, as in scikit-learn.
const FOLDS: usize = 5;

/// Kind of classifier and its parameters. Fields that the kind does not use are ignored, for example the solver of a random forest. Only SVMs and logistic
/// regression use C.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Classifier {
    /// Kind of classifier, for example a linear SVM or a random forest. A classifier from outside of this crate is written with its version.
    #[serde(serialize_with = "with_version")]
    pub kind: ClassifierKind,
    /// Scaling of the features, fitted on the training rows.
    pub scaling: Scaling,
    /// Strategy that combines binary SVMs into a multi-class classifier.
    pub multiclass: Multiclass,
    /// Solver that trains an SVM.
    pub solver: SvmSolver,
    /// Penalty C: a fixed value, or candidate values from which it is chosen.
    pub c: Cost,
    /// Weights of the classes in training; SVMs, logistic regression and random forests have them.
    pub class_weight: ClassWeight,
    /// Values of the parameters that the kind of classifier declares; see [`with`](Self::with).
    pub parameters: Parameters,
    /// Stopping tolerance of the solver, above 0, in units of the decision value; relative to the objective for logistic regression.
    pub tolerance: f64,
    /// Maximum size of the kernel values that an SVM's solver keeps in memory, bytes.
    pub memory_bytes: usize,
    /// Group of each training row, for a foreign classifier that uses groups; `None` without groups.
    pub groups: Option<Vec<usize>>,
}

/// Writes a kind of classifier as in a study file: its name, with the version of a classifier from outside of this crate.
///
/// # Errors
/// If the serialiser fails.
pub fn with_version<S: Serializer>(
    kind: &ClassifierKind,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    match kind {
        ClassifierKind::Foreign(foreign) => serializer.collect_str(foreign),
        kind => kind.serialize(serializer),
    }
}

impl Classifier {
    /// Creates a classifier with scikit-learn's defaults on standardised features: C = 1, γ 'scale', degree 3, 5 neighbours, 100 trees of unlimited depth. SVMs
    /// are one-vs-one. The default c₀ = 1 differs from scikit-learn, because c₀ = 0 omits all lower powers.
    pub fn new(kind: ClassifierKind) -> Self {
        Self {
            kind,
            scaling: Scaling::Standard,
            multiclass: Multiclass::OneVsOne,
            solver: SvmSolver::Smo,
            c: Cost::Fixed(1.0),
            class_weight: ClassWeight::Uniform,
            parameters: Parameters::new(kind),
            tolerance: 1e-3,
            memory_bytes: DEFAULT_MEMORY_BYTES,
            groups: None,
        }
    }

    /// Returns a copy of the classifier with another value of the parameter `key`.
    ///
    /// ```
    /// # use bubbletouch_svm::classifiers::{ClassifierKind, classifier::Classifier};
    /// let forest = Classifier::new(ClassifierKind::RandomForest).with("n_trees", 10.0)?;
    /// assert_eq!(forest.parameters.get("n_trees"), Some(10.0));
    /// # Ok::<(), bubbletouch_svm::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the kind has no such parameter, or if the value is not allowed.
    pub fn with(&self, key: &str, value: f64) -> Result<Self> {
        let mut changed = self.clone();
        changed.parameters.set(self.kind, key, value)?;
        Ok(changed)
    }

    /// Returns a copy of the classifier with another kernel parameter γ. The unit of γ is in inverse squared units of the scaled features.
    pub fn with_gamma(&self, gamma: Gamma) -> Self {
        let mut changed = self.clone();
        changed.parameters.set_gamma(gamma);
        changed
    }

    /// Returns the kernel parameter γ.
    pub fn gamma(&self) -> Gamma {
        self.parameters.gamma()
    }

    /// Trains the classifier on the training rows. All random draws use `seed`: the five stratified folds that choose C, the trees of a forest, and the order
    /// of coordinate descent.
    ///
    /// # Errors
    /// If a parameter is out of range, or the training of the kind or [`stratified_k_fold`] rejects the data.
    pub fn train(&self, training: &Dataset, seed: &dyn Streams) -> Result<TrainedClassifier> {
        let folds = match &self.c {
            Cost::Chosen(_) if self.kind.has_c() => {
                let labels = training.targets.view();
                stratified_k_fold(labels, FOLDS, &*seed.named("validation"))?
            }
            _ => Vec::new(),
        };
        self.train_validated(training, &folds, seed)
    }

    /// Trains the classifier on the training rows, with given cross-validation folds for the choice of C. The folds contain positions within `training` and
    /// may, for example, keep groups apart. The scaling is fitted to all training rows, without their labels. Other random draws use `seed`.
    ///
    /// # Errors
    /// If a parameter is out of range, the candidates or folds are invalid, or the data cannot be used for training.
    pub fn train_validated(
        &self,
        training: &Dataset,
        folds: &[Split],
        seed: &dyn Streams,
    ) -> Result<TrainedClassifier> {
        let (c, chosen) = match &self.c {
            _ if !self.kind.has_c() => (None, None),
            Cost::Fixed(c) => (Some(*c), None),
            Cost::Chosen(candidates) => {
                let chosen = self.choose(training, folds, candidates, seed)?;
                (Some(chosen.best.c), Some(chosen))
            }
        };
        let classifier = match &chosen {
            Some(chosen) => Cow::Owned(self.with_choice(chosen)),
            None => Cow::Borrowed(self),
        };
        let (scaling, scaled) = self.scaled(training)?;
        let model = classifier.train_model(&scaled, c.unwrap_or(1.0), seed)?;
        Ok(TrainedClassifier::new(scaling, model, c, chosen))
    }

    /// Chooses C and γ by cross-validation on the training rows; see the function [`choose`].
    ///
    /// # Errors
    /// Returns the errors of [`choose`].
    pub fn choose(
        &self,
        training: &Dataset,
        folds: &[Split],
        candidates: &Candidates,
        seed: &dyn Streams,
    ) -> Result<Chosen> {
        let (_, scaled) = self.scaled(training)?;
        if let Some(params) = self.kernel_svm(1.0) {
            return choose(&params, &scaled, folds, candidates);
        }
        let train = |fitting: &Dataset, c| {
            let model = self.train_model(fitting, c, seed)?;
            let n_capped = model.n_capped();
            let predict = move |rows: &Dataset| model.labels(rows.records.view());
            Ok((predict, n_capped))
        };
        choose_c(train, &scaled, folds, &candidates.c)
    }

    /// Returns a copy of the classifier with C and γ fixed to the chosen values.
    pub fn with_choice(&self, chosen: &Chosen) -> Self {
        Self {
            c: Cost::Fixed(chosen.best.c),
            ..match chosen.best.gamma {
                Some(gamma) => self.with_gamma(Gamma::Value(gamma)),
                None => self.clone(),
            }
        }
    }

    /// Trains one classifier per value of C, in the order of `path`. Kernel SVMs share one Gram matrix.
    ///
    /// # Errors
    /// If the kind has no C, a parameter is out of range, or the data cannot be used for training.
    pub fn train_path(
        &self,
        training: &Dataset,
        path: &[f64],
        seed: &dyn Streams,
    ) -> Result<Vec<TrainedClassifier>> {
        if !self.kind.has_c() {
            let given = format!("for {:?}", self.kind);
            return Err(Error::input("C", given, "it has none"));
        }
        let (scaling, scaled) = self.scaled(training)?;
        let models: Vec<Arc<dyn ClassModel>> = match self.kernel_svm(1.0) {
            Some(params) => {
                let models = params.train_path(&scaled, path)?.into_iter();
                models.map(|model| Arc::new(model) as _).collect()
            }
            None => {
                let models = path.iter().map(|&c| self.train_model(&scaled, c, seed));
                models.collect::<Result<_>>()?
            }
        };
        let trained = models.into_iter().zip(path);
        Ok(trained
            .map(|(model, &c)| TrainedClassifier::new(scaling.clone(), model, Some(c), None))
            .collect())
    }

    /// Returns the fitted scaling and the scaled training rows, which are borrowed if the scaling changes nothing.
    fn scaled<'a>(&self, training: &'a Dataset) -> Result<(FittedScaling, Cow<'a, Dataset>)> {
        check_unweighted(training)?;
        let scaling = self.scaling.fit(training.records.view())?;
        if scaling.changes_nothing() {
            return Ok((scaling, Cow::Borrowed(training)));
        }
        let scaled = scaling.apply(training.records.view())?;
        let scaled = Dataset::new(scaled, training.targets.clone());
        Ok((scaling, Cow::Owned(scaled)))
    }

    /// Trains the model on rows with scaled features. Classifiers without a penalty C ignore `c`.
    fn train_model(
        &self,
        scaled: &Dataset,
        c: f64,
        seed: &dyn Streams,
    ) -> Result<Arc<dyn ClassModel>> {
        match self.kernel_svm(c) {
            Some(params) => Ok(Arc::new(params.train(scaled)?)),
            None => (self.kind.about().train)(self, scaled, c, seed),
        }
    }

    /// Trains a linear SVM by coordinate descent, which needs no kernel matrix.
    pub(crate) fn train_kernel_free(
        &self,
        scaled: &Dataset,
        c: f64,
        seed: &dyn Streams,
    ) -> Result<Arc<dyn ClassModel>> {
        let seed = seed.named("descent");
        Ok(Arc::new(self.linear_svm(c)?.train(scaled, &*seed)?))
    }

    /// Returns the parameters of the kernel SVM; `None` if the classifier is not a kernel SVM or uses coordinate descent.
    fn kernel_svm(&self, c: f64) -> Option<SvmParams> {
        let kernel = self.kind.about().kernel?(&self.parameters);
        (self.solver != SvmSolver::CoordinateDescent).then_some(SvmParams {
            kernel,
            multiclass: self.multiclass,
            c,
            class_weight: self.class_weight,
            tolerance: self.tolerance,
            memory_bytes: self.memory_bytes,
        })
    }

    /// Estimates the memory of training on classes of equal size, bytes, beside the given rows: scaled rows, rows sorted by class, and kernel values. C is
    /// chosen on `n_choice` rows, or on none if it is given. Classifiers other than kernel SVMs store no kernel values.
    pub fn training_bytes(
        &self,
        [n_rows, n_choice]: [usize; 2],
        n_classes: usize,
        n_features: usize,
    ) -> usize {
        // Folds are chosen on a copy of their rows.
        let rows = |n_rows: usize, n_copies: usize| 8 * n_copies * n_rows * n_features;
        let (trained, chosen) = (rows(n_rows, 2), rows(n_choice, 3));
        let Some(params) = self.kernel_svm(1.0) else {
            return trained.max(chosen);
        };
        let trained = trained + params.kernel_bytes(n_rows, n_classes, n_features);
        trained.max(chosen + params.choice_bytes(n_choice))
    }

    /// Checks that the parameters allow training on `n_rows` rows.
    ///
    /// # Errors
    /// If a parameter that the number of rows limits is larger; the error names the parameter.
    pub fn check_rows(&self, n_rows: usize) -> Result<()> {
        let mut limited = self.kind.about().parameters.iter();
        let value = |one: &Parameter| one.value(&self.parameters).unwrap_or(0.0);
        match limited.find(|one| one.is_at_most_rows && value(one) > n_rows as f64) {
            None => Ok(()),
            Some(one) => {
                let allowed = format!("at most {n_rows}, the training rows");
                Err(Error::input(one.key, value(one), allowed))
            }
        }
    }

    /// Checks that the solver supports this classifier, if the classifier is an SVM.
    ///
    /// # Errors
    /// If the solver is coordinate descent, and the kernel is not linear or the strategy is not one-vs-rest.
    pub fn check_solver(&self) -> Result<()> {
        let is_linear = self.kind == ClassifierKind::LinearSvm;
        let is_possible = is_linear && self.multiclass == Multiclass::OneVsRest;
        let is_svm = self.kind.is_kernel_svm();
        if self.solver != SvmSolver::CoordinateDescent || !is_svm || is_possible {
            return Ok(());
        }
        let (kind, multiclass) = (self.kind, self.multiclass);
        let given = format!("coordinate_descent with {kind:?} and {multiclass:?}");
        let allowed = "it trains linear_svm with one_vs_rest alone";
        Err(Error::input("solver", given, allowed))
    }

    /// Returns the parameters of a linear SVM that is trained by coordinate descent.
    fn linear_svm(&self, c: f64) -> Result<LinearSvmParams> {
        self.check_solver()?;
        Ok(LinearSvmParams {
            c,
            tolerance: self.tolerance,
            ..LinearSvmParams::default()
        })
    }
}

impl<F, D, T> Fit<ArrayBase<D, Ix2>, T, Error> for Classifier
where
    F: Precision,
    D: Data<Elem = F>,
    T: AsSingleTargets<Elem = usize>,
{
    type Object = TrainedClassifier;

    /// Trains the classifier with the random seed 0. Weights of rows are refused.
    fn fit(&self, training: &DatasetBase<ArrayBase<D, Ix2>, T>) -> Result<TrainedClassifier> {
        let features = F::double_features(&training.records).into_owned();
        let labels = training.targets.as_single_targets().to_owned();
        let owned = Dataset::new(features, labels).with_weights(training.weights.clone());
        self.train(&owned, &0_u64)
    }
}

/// Trains any classifier that implements linfa's traits on the training rows of a split. Returns the predicted labels of the test rows, in the order of
/// `split.test`.
///
/// # Errors
/// If the split contains a row beyond the data, or the classifier returns an error.
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

/// Returns an error of this crate unchanged; converts any other error into an input error that contains its message.
fn own_or_wrapped(error: impl std::error::Error + 'static) -> Error {
    let error: Box<dyn std::error::Error> = Box::new(error);
    match error.downcast::<Error>() {
        Ok(own) => *own,
        Err(other) => Error::input("classifier", other, "see its documentation"),
    }
}
