//! Linear soft-margin SVM; see the [crate documentation](crate), and [`crate::linear_svm`] for coordinate descent.

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::kernel::Kernel;

pub use crate::linear_svm::{Convergence, LinearSvm, LinearSvmParams, MAX_PASSES};

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_gamma: false,
    ..ClassifierAbout::svm("linear SVM", |_| Kernel::Linear)
};
