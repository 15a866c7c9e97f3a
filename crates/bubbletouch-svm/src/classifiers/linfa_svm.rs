//! Linear SVM of the crate linfa-svm, for comparison with [`linear_svm`](super::linear_svm).
//!
//! linfa-svm solves binary problems. Its multi-class scheme is linfa's `MultiClassModel`: one SVM separates each class from all others. Platt scaling fits a
//! probability to the decision values of each SVM on the training rows. The class with the highest probability is predicted. If probabilities are equal, the
//! lower label is predicted.

use crate::class_model::ClassModel;
use crate::classifiers::classifier_about::ClassifierAbout;
use crate::dataset::{Dataset, check_width, checked_classes};
use crate::error::check_above_zero;
use crate::{Error, Result};
use linfa::dataset::{DatasetBase, Pr};
use linfa::traits::{Fit, PredictInplace};
use linfa_svm::{Svm, SvmParams};
use ndarray::{Array1, Array2, ArrayView2};
use std::sync::Arc;

/// Kernel of linfa-svm.
#[derive(Clone, Copy, Debug)]
pub enum LinfaKernel {
    /// Linear kernel.
    Linear,
    /// Gaussian kernel `exp(−γ|x − z|²)` with a given γ.
    Rbf(f64),
}

/// Trained SVMs of linfa-svm, one per class. Scores are `ln p` of the probability that the SVM of the class gives.
#[derive(Clone, Debug)]
pub struct LinfaSvm {
    classes: Vec<usize>,
    models: Vec<Svm<f64, Pr>>,
    n_features: usize,
}

impl LinfaSvm {
    /// Trains one SVM per class with the penalty `c`. `tolerance` bounds the violation of the optimality conditions.
    ///
    /// # Errors
    /// If C or the tolerance is not a positive number, or linfa-svm returns an error. If the data are empty or have a single class, a feature is not
    /// finite, or the numbers of labels and rows differ.
    pub fn train(data: &Dataset, kernel: LinfaKernel, c: f64, tolerance: f64) -> Result<Self> {
        let classes = checked_classes(data)?;
        check_above_zero("C", c)?;
        check_above_zero("tolerance", tolerance)?;
        let params: SvmParams<f64, Pr> = Svm::<f64, Pr>::params()
            .pos_neg_weights(c, c)
            .eps(tolerance);
        let params = match kernel {
            LinfaKernel::Linear => params.linear_kernel(),
            // linfa's kernel is exp(−|x − z|² / ε).
            LinfaKernel::Rbf(gamma) => params.gaussian_kernel(1.0 / gamma),
        };
        let train = |class: &usize| {
            let is_of_class: Array1<bool> = data.targets.mapv(|label| label == *class);
            let binary = DatasetBase::new(data.records.view(), is_of_class.view());
            let model: std::result::Result<Svm<f64, Pr>, linfa_svm::SvmError> = params.fit(&binary);
            model
                .map_err(|error| Error::input("classifier", error, "see linfa-svm's documentation"))
        };
        Ok(Self {
            models: classes.iter().map(train).collect::<Result<_>>()?,
            classes,
            n_features: data.records.ncols(),
        })
    }
}

impl ClassModel for LinfaSvm {
    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn n_capped(&self) -> usize {
        // linfa-svm gives the reason for stopping only in the text of a model.
        let is_capped = |model: &&Svm<f64, Pr>| model.to_string().starts_with("Reached");
        self.models.iter().filter(is_capped).count()
    }

    fn is_probabilistic(&self) -> bool {
        true
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.n_features)?;
        let mut scores = Array2::zeros((features.nrows(), self.classes.len()));
        for (mut column, model) in scores.columns_mut().into_iter().zip(&self.models) {
            let mut probabilities = model.default_target(&features);
            model.predict_inplace(&features, &mut probabilities);
            // A probability of 0 has a finite score, so that the sum over touches is never NaN.
            let log = |pr: &Pr| f64::from(**pr).max(f64::MIN_POSITIVE).ln();
            column
                .iter_mut()
                .zip(&probabilities)
                .for_each(|(to, pr)| *to = log(pr));
        }
        Ok(scores)
    }
}

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_c: true,
    ..ClassifierAbout::new("linfa-svm, linear", |classifier, scaled, c, _| {
        let tolerance = classifier.tolerance;
        let model = LinfaSvm::train(scaled, LinfaKernel::Linear, c, tolerance)?;
        Ok(Arc::new(model))
    })
};
