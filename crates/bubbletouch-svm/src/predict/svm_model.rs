//! Trained SVM that predicts decision values and labels by matrix products.
//!
//! For a block of rows, one matrix product computes the kernel values with all support vectors of a class. A second product applies their coefficients in all
//! binary problems. A linear SVM needs one product with its hyperplanes. The products have the precision of training. Labels of one-vs-one SVMs with a kernel
//! need the second product only for rows without a class that wins all its pairs (`condorcet_winner`).

use std::borrow::Cow;

use linfa::dataset::Label;
use linfa::traits::PredictInplace;
use ndarray::{Array1, Array2, ArrayBase, ArrayView2, Data, Ix2};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::Result;
use crate::binary_problem::BinaryProblem;
use crate::class_model::ClassModel;
use crate::dataset::check_width;
use crate::gram::sorted::Sorted;
use crate::linalg::scalar::Scalar;
use crate::multiclass::Multiclass;
use crate::precision::Precision;
use crate::predict::decision::DecisionFunctions;
use crate::predict::voting::Voting;
use crate::saved::{SavedModel, VERSION, check_version, damaged};
use crate::training::Trained;

/// Trained SVM for two or more classes, with labels of type `L`. The data of serde (see [`saved`](crate::saved)) contain all that prediction needs.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub struct SvmModel<L = usize> {
    /// Version of the data of serde.
    version: u32,
    classes: Vec<L>,
    voting: Voting,
    problems: Vec<BinaryProblem>,
    n_features: usize,
    decision: Decision,
}

impl<L: Serialize> Serialize for SvmModel<L> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // The function that serde derives, with all fields.
        Self::serialize(self, serializer)
    }
}

impl<'de, L: Label + Deserialize<'de>> Deserialize<'de> for SvmModel<L> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut model = Self::deserialize(deserializer)?;
        model.complete().map_err(D::Error::custom)?;
        Ok(model)
    }
}

impl<L: Label> SvmModel<L> {
    /// Checks the version and the sizes of all parts of a read model, and computes the parts that are not saved.
    fn complete(&mut self) -> Result<()> {
        check_version(self.version)?;
        let n_classes = self.voting.n_classes;
        let n_problems = self.voting.multiclass.problems(n_classes).len();
        let sizes = [n_problems, n_classes, self.n_features];
        let is_whole = self.classes.len() == n_classes
            && n_classes >= 2
            && self.classes.is_sorted_by(|a, b| a < b)
            && self.problems.len() == n_problems
            && match &mut self.decision {
                Decision::Single(functions) => functions.complete(sizes),
                Decision::Double(functions) => functions.complete(sizes),
            };
        match is_whole {
            true => Ok(()),
            false => Err(damaged("saved SVM")),
        }
    }
}

/// Decision functions of all binary problems, in the precision in which they were trained.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Decision {
    Single(DecisionFunctions<f32>),
    Double(DecisionFunctions<f64>),
}

impl From<DecisionFunctions<f32>> for Decision {
    fn from(functions: DecisionFunctions<f32>) -> Self {
        Self::Single(functions)
    }
}

impl From<DecisionFunctions<f64>> for Decision {
    fn from(functions: DecisionFunctions<f64>) -> Self {
        Self::Double(functions)
    }
}

impl SvmModel {
    /// Creates a model whose labels are the numbers of the classes, from its training rows and its solved binary problems.
    pub(crate) fn new<T: Scalar>(
        sorted: Cow<Sorted<T>>,
        multiclass: Multiclass,
        Trained { problems, normals }: Trained<T>,
    ) -> Self
    where
        Decision: From<DecisionFunctions<T>>,
    {
        Self {
            version: VERSION,
            n_features: sorted.centre.len(),
            classes: (0..sorted.ranges.len()).collect(),
            voting: Voting {
                n_classes: sorted.ranges.len(),
                multiclass,
            },
            decision: DecisionFunctions::new(sorted, &problems, normals).into(),
            problems,
        }
    }

    /// Returns the model with other labels of its classes.
    pub(crate) fn with_classes<L>(self, classes: Vec<L>) -> SvmModel<L> {
        SvmModel {
            version: self.version,
            classes,
            voting: self.voting,
            problems: self.problems,
            n_features: self.n_features,
            decision: self.decision,
        }
    }
}

impl<L: Clone> SvmModel<L> {
    /// Returns the class labels of the training rows, ascending. Every predicted label is one of them.
    pub fn classes(&self) -> &[L] {
        &self.classes
    }

    /// Returns the strategy that combines the binary problems.
    pub fn multiclass(&self) -> Multiclass {
        self.voting.multiclass
    }

    /// Returns the number of features of a row.
    pub fn n_features(&self) -> usize {
        self.n_features
    }

    /// Returns the solved binary problems, in the order of the columns of the decision values.
    pub fn problems(&self) -> &[BinaryProblem] {
        &self.problems
    }

    /// Returns the number of binary problems that stopped at the solver's iteration cap before reaching the tolerance.
    pub fn n_capped(&self) -> usize {
        let is_capped = |problem: &&BinaryProblem| problem.solution.is_capped;
        self.problems.iter().filter(is_capped).count()
    }

    /// Returns the decision value of each binary problem for each row (n_rows × n_problems); a positive value favours the positive class of the problem.
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn decision_values(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.n_features)?;
        Ok(match &self.decision {
            Decision::Single(functions) => functions.values(features),
            Decision::Double(functions) => functions.values(features),
        })
    }

    /// Returns the predicted label of each row of features (n_rows × m).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<L>> {
        check_width(&features, self.n_features)?;
        let winners = match &self.decision {
            Decision::Single(functions) => functions.winners(features, self.voting),
            Decision::Double(functions) => functions.winners(features, self.voting),
        };
        Ok(self.of_numbers(winners))
    }

    /// Returns the labels of classes, given the numbers of the classes.
    fn of_numbers(&self, numbers: impl IntoIterator<Item = usize>) -> Array1<L> {
        let labels = numbers
            .into_iter()
            .map(|number| self.classes[number].clone());
        labels.collect()
    }

    /// Returns the predicted label for each row of decision values (n_rows × n_problems). A row may be the sum over several touches of one object.
    pub fn labels_of_values(&self, values: ArrayView2<f64>) -> Array1<L> {
        self.of_numbers(self.voting.winners(values))
    }
}

impl ClassModel for SvmModel {
    fn saved(&self) -> Option<SavedModel> {
        Some(SavedModel::Svm(Box::new(self.clone())))
    }

    fn svm(&self) -> Option<&SvmModel> {
        Some(self)
    }

    fn classes(&self) -> &[usize] {
        self.classes()
    }

    fn n_capped(&self) -> usize {
        self.n_capped()
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        self.decision_values(features)
    }

    fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        self.labels(features)
    }

    fn labels_of_scores(&self, scores: ArrayView2<f64>) -> Array1<usize> {
        self.labels_of_values(scores)
    }

    fn class_scores(&self, scores: ArrayView2<f64>) -> Array2<f64> {
        self.voting.class_scores(scores)
    }
}

impl<F, D, L> PredictInplace<ArrayBase<D, Ix2>, Array1<L>> for SvmModel<L>
where
    F: Precision,
    D: Data<Elem = F>,
    L: Label,
{
    /// Writes the predicted labels into `targets`.
    ///
    /// # Panics
    /// If the number of columns differs from training, a feature is not finite, or `targets` has a wrong length. linfa's trait cannot return an error. The
    /// method `labels` returns errors instead.
    fn predict_inplace(&self, features: &ArrayBase<D, Ix2>, targets: &mut Array1<L>) {
        match self.labels(F::double_features(features).view()) {
            Ok(labels) => targets.assign(&labels),
            Err(error) => panic!("{error}"),
        }
    }

    fn default_target(&self, features: &ArrayBase<D, Ix2>) -> Array1<L> {
        Array1::default(features.nrows())
    }
}
