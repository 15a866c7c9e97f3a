//! The SVM with a Gaussian kernel of the crate linfa-svm; see [`linfa_svm`](super::linfa_svm) for its multi-class scheme.

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::classifiers::linfa_svm::{LinfaKernel, LinfaSvm};
use crate::classifiers::parameters::GAMMA;
use crate::kernel::{Gamma, Kernel};
use std::sync::Arc;

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_c: true,
    parameters: &[GAMMA],
    ..ClassifierAbout::new("linfa-svm, RBF", |classifier, scaled, c, _| {
        let gamma = classifier.gamma();
        let gamma = match gamma {
            Gamma::Scale => Kernel::Rbf { gamma }.gamma_scale(scaled.records.view()),
            Gamma::Value(gamma) => gamma,
        };
        let kernel = LinfaKernel::Rbf(gamma);
        Ok(Arc::new(LinfaSvm::train(
            scaled,
            kernel,
            c,
            classifier.tolerance,
        )?))
    })
};
