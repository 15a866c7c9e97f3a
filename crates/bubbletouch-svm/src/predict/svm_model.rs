//! A trained SVM: decision values and labels, by matrix products.
//!
//! A block of rows meets all support vectors of a class in one matrix product, and their coefficients for all binary
//! problems in a second one; a linear SVM is one product with its hyperplanes. Both run in the precision that the model was
//! trained in. Labels of one-vs-one SVMs with a kernel need the second product only where no class wins all its pairs
//! (`condorcet_winner`).

use std::borrow::Cow;

use linfa::traits::PredictInplace;
use ndarray::{Array1, Array2, ArrayBase, ArrayView2, Data, Ix2};

use crate::Result;
use crate::binary_problem::BinaryProblem;
use crate::dataset::check_width;
use crate::gram::sorted::Sorted;
use crate::linalg::scalar::Scalar;
use crate::multiclass::Multiclass;
use crate::precision::Precision;
use crate::predict::decision::DecisionFunctions;
use crate::predict::voting::Voting;
use crate::training::Trained;

/// A trained SVM. Implements linfa's [`PredictInplace`] and so its `Predict`.
#[derive(Clone, Debug)]
pub struct SvmModel {
    voting: Voting,
    problems: Vec<BinaryProblem>,
    n_features: usize,
    decision: Decision,
}

/// The decision function of all problems at once, in the precision of training.
#[derive(Clone, Debug)]
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
    /// Of the rows that it was trained on.
    pub(crate) fn new<T: Scalar>(
        sorted: Cow<Sorted<T>>,
        multiclass: Multiclass,
        Trained { problems, normals }: Trained<T>,
    ) -> Self
    where
        Decision: From<DecisionFunctions<T>>,
    {
        Self {
            n_features: sorted.centre().len(),
            voting: Voting::new(sorted.classes(), multiclass),
            decision: DecisionFunctions::new(sorted, &problems, normals).into(),
            problems,
        }
    }

    /// The classes of the training rows, ascending: what can be predicted.
    pub fn classes(&self) -> &[usize] {
        self.voting.classes()
    }

    /// The binary problems and their solutions, in the order of the decision values' columns.
    pub fn problems(&self) -> &[BinaryProblem] {
        &self.problems
    }

    /// How many binary problems stopped at the solver's iteration cap, short of its tolerance.
    pub fn n_capped(&self) -> usize {
        let is_capped = |problem: &&BinaryProblem| problem.solution.is_capped;
        self.problems.iter().filter(is_capped).count()
    }

    /// Decision values (n_rows × n_problems): above 0 speaks for a problem's positive class.
    ///
    /// # Errors
    /// Another number of columns than in training, or a NaN or infinite feature.
    pub fn decision_values(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.n_features)?;
        Ok(match &self.decision {
            Decision::Single(functions) => functions.values(features),
            Decision::Double(functions) => functions.values(features),
        })
    }

    /// The predicted label of each row.
    ///
    /// # Errors
    /// Another number of columns than in training, or a NaN or infinite feature.
    pub fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        check_width(&features, self.n_features)?;
        let between = (self.classes().len(), self.voting.multiclass());
        let winners = match &self.decision {
            Decision::Single(functions) => functions.winners(features, between),
            Decision::Double(functions) => functions.winners(features, between),
        };
        Ok(winners
            .into_iter()
            .map(|winner| self.classes()[winner])
            .collect())
    }

    /// The label that each row of decision values (n_rows × n_problems) speaks for. The rows may be sums over several
    /// touches of one object.
    pub fn labels_of_values(&self, values: ArrayView2<f64>) -> Array1<usize> {
        self.voting.labels(values)
    }
}

impl<F: Precision, D: Data<Elem = F>> PredictInplace<ArrayBase<D, Ix2>, Array1<usize>>
    for SvmModel
{
    /// Writes the predicted labels into `targets`.
    ///
    /// # Panics
    /// If `features` has another number of columns than in training or a value that is not finite, or `targets`
    /// another length: linfa's trait has no way to return an error. [`SvmModel::labels`] has.
    fn predict_inplace(&self, features: &ArrayBase<D, Ix2>, targets: &mut Array1<usize>) {
        match self.labels(F::double_features(features).view()) {
            Ok(labels) => targets.assign(&labels),
            Err(error) => panic!("{error}"),
        }
    }

    fn default_target(&self, features: &ArrayBase<D, Ix2>) -> Array1<usize> {
        Array1::zeros(features.nrows())
    }
}
