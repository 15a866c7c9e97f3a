//! The classifier of a study's cell: one choice, trained and asked the same way whatever it is.
//!
//! [`Classifier`] and [`TrainedClassifier`] implement linfa's `Fit` and `PredictInplace`, so they stand wherever a
//! linfa classifier does; and whatever implements those traits is scored the same way by
//! [`predict_split`].

use linfa::traits::{Fit, PredictInplace};
use ndarray::{Array1, Array2, ArrayBase, ArrayView2, Data, Ix2};
use serde::{Deserialize, Serialize};

use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::choice::{Candidates, Chosen, choose};
use crate::recognition::dataset::{Dataset, rows};
use crate::recognition::kernel::{Gamma, Kernel};
use crate::recognition::scaling::{FittedScaling, Scaling};
use crate::recognition::split::{Split, stratified_hold_out};
use crate::recognition::svm::{Multiclass, SvmParams};
use crate::recognition::svm_model::SvmModel;
use crate::{Error, Result};

/// The C of a soft-margin SVM: given, or chosen on a validation split of the training rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cost {
    /// This C.
    Fixed(f64),
    /// The most accurate of these on the validation rows, the smaller on a tie; then all training rows are used.
    Chosen {
        /// Values of C to try.
        candidates: Vec<f64>,
        /// The share of the training rows that validates, between 0 and 1.
        validation_fraction: f64,
    },
}

/// A classifier and its options. Options that its kind has no use for are ignored (γ of a linear SVM).
#[derive(Clone, Debug, PartialEq)]
pub struct Classifier {
    /// Which.
    pub kind: ClassifierKind,
    /// How features are scaled, fitted on the training rows.
    pub scaling: Scaling,
    /// How binary classifiers make one for many classes.
    pub multiclass: Multiclass,
    /// C.
    pub c: Cost,
    /// γ of the RBF and polynomial kernels, in inverse squared units of the scaled features.
    pub gamma: Gamma,
    /// c₀ ≥ 0 of the polynomial kernel.
    pub coef0: f64,
    /// Degree of the polynomial kernel, 1 to 20.
    pub degree: u32,
    /// The solver's stopping tolerance, above 0; see [`SvmParams::tolerance`].
    pub tolerance: f64,
}

impl Classifier {
    /// A classifier with scikit-learn's defaults (C = 1, γ 'scale', degree 3; but c₀ = 1, since c₀ = 0 leaves out all
    /// lower powers) on standardised features, one-vs-one.
    pub fn new(kind: ClassifierKind) -> Self {
        Self {
            kind,
            scaling: Scaling::Standard,
            multiclass: Multiclass::OneVsOne,
            c: Cost::Fixed(1.0),
            gamma: Gamma::Scale,
            coef0: 1.0,
            degree: 3,
            tolerance: 1e-3,
        }
    }

    /// Trains on training rows; a C to be chosen is chosen on a stratified validation split drawn by `seed`.
    ///
    /// # Errors
    /// Parameters out of range, or data that [`SvmParams::train`] or [`stratified_hold_out`] refuses.
    pub fn train(&self, training: &Dataset, seed: &Seed) -> Result<TrainedClassifier> {
        match &self.c {
            Cost::Fixed(c) => self.train_with_c(training, *c, None),
            Cost::Chosen {
                validation_fraction,
                ..
            } => {
                let labels = training.targets.view();
                let seed = seed.named("validation");
                let split = stratified_hold_out(labels, *validation_fraction, &seed)?;
                self.train_validated(training, &split)
            }
        }
    }

    /// Trains on training rows; a C to be chosen is chosen on this validation split of them (such as one that keeps
    /// groups apart), given in positions within `training`.
    ///
    /// # Errors
    /// Parameters out of range, or data that [`SvmParams::train`] refuses.
    pub fn train_validated(
        &self,
        training: &Dataset,
        validation: &Split,
    ) -> Result<TrainedClassifier> {
        match &self.c {
            Cost::Fixed(c) => self.train_with_c(training, *c, None),
            Cost::Chosen { candidates, .. } => {
                let scaling = self.scaling.fit(training.records.view())?;
                let scaled = scaling.apply(training.records.view())?;
                let scaled = Dataset::new(scaled, training.targets.clone());
                let candidates = Candidates {
                    c: candidates.clone(),
                    gamma_scales: Vec::new(),
                };
                let folds = std::slice::from_ref(validation);
                let chosen = choose(&self.params(1.0), &scaled, folds, &candidates)?;
                self.train_with_c(training, chosen.best.c, Some(chosen))
            }
        }
    }

    fn train_with_c(
        &self,
        training: &Dataset,
        c: f64,
        chosen: Option<Chosen>,
    ) -> Result<TrainedClassifier> {
        let scaling = self.scaling.fit(training.records.view())?;
        let scaled = scaling.apply(training.records.view())?;
        let scaled = Dataset::new(scaled, training.targets.clone());
        Ok(TrainedClassifier {
            model: Model::Svm(self.params(c).train(&scaled)?),
            scaling,
            c,
            chosen,
        })
    }

    fn params(&self, c: f64) -> SvmParams {
        let gamma = self.gamma;
        SvmParams {
            kernel: match self.kind {
                ClassifierKind::LinearSvm => Kernel::Linear,
                ClassifierKind::RbfSvm => Kernel::Rbf { gamma },
                ClassifierKind::PolynomialSvm => Kernel::Polynomial {
                    gamma,
                    coef0: self.coef0,
                    degree: self.degree,
                },
            },
            multiclass: self.multiclass,
            c,
            tolerance: self.tolerance,
            ..SvmParams::default()
        }
    }
}

impl Fit<Array2<f64>, Array1<usize>, Error> for Classifier {
    type Object = TrainedClassifier;

    /// [`Classifier::train`] with the validation split of seed 0.
    fn fit(&self, training: &Dataset) -> Result<TrainedClassifier> {
        self.train(training, &Seed::new(0))
    }
}

/// A trained classifier: scaling and model.
#[derive(Clone, Debug)]
pub struct TrainedClassifier {
    scaling: FittedScaling,
    model: Model,
    c: f64,
    chosen: Option<Chosen>,
}

#[derive(Clone, Debug)]
enum Model {
    Svm(SvmModel),
}

impl TrainedClassifier {
    /// The predicted label of each row of unscaled features (n_rows × m).
    ///
    /// # Errors
    /// Another number of columns than in training, or a NaN or infinite feature.
    pub fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        let scaled = self.scaling.apply(features)?;
        match &self.model {
            Model::Svm(model) => model.labels(scaled.view()),
        }
    }

    /// Scores (n_rows × n_scores) of unscaled features, of which [`labels_of_scores`](Self::labels_of_scores) makes
    /// labels. The sum of the scores of several touches of one object is the score of all of them together.
    ///
    /// # Errors
    /// As [`labels`](Self::labels).
    pub fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        let scaled = self.scaling.apply(features)?;
        match &self.model {
            Model::Svm(model) => model.decision_values(scaled.view()),
        }
    }

    /// The label that each row of scores speaks for.
    pub fn labels_of_scores(&self, scores: ArrayView2<f64>) -> Array1<usize> {
        match &self.model {
            Model::Svm(model) => model.labels_of_values(scores),
        }
    }

    /// The C that it was trained with.
    pub fn c(&self) -> f64 {
        self.c
    }

    /// How C was chosen, if it was.
    pub fn chosen(&self) -> Option<&Chosen> {
        self.chosen.as_ref()
    }

    /// How many binary problems stopped at the solver's iteration cap, short of its tolerance.
    pub fn n_capped(&self) -> usize {
        match &self.model {
            Model::Svm(model) => model.n_capped(),
        }
    }

    /// The trained SVM, which takes scaled features; see [`scaling`](Self::scaling).
    pub fn svm(&self) -> Option<&SvmModel> {
        match &self.model {
            Model::Svm(model) => Some(model),
        }
    }

    /// The scaling, as fitted on the training rows.
    pub fn scaling(&self) -> &FittedScaling {
        &self.scaling
    }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<usize>> for TrainedClassifier {
    /// Writes the predicted labels into `targets`.
    ///
    /// # Panics
    /// As [`SvmModel`]'s; [`TrainedClassifier::labels`] returns an error instead.
    fn predict_inplace(&self, features: &ArrayBase<D, Ix2>, targets: &mut Array1<usize>) {
        match self.labels(features.view()) {
            Ok(labels) => targets.assign(&labels),
            Err(error) => panic!("{error}"),
        }
    }

    fn default_target(&self, features: &ArrayBase<D, Ix2>) -> Array1<usize> {
        Array1::zeros(features.nrows())
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
