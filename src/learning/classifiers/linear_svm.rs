//! Linear soft-margin SVMs; see [`svm`](bubbletouch_svm), and [`bubbletouch_svm::linear_svm`] for coordinate descent.

use crate::learning::classifiers::classifier_about::ClassifierAbout;
use bubbletouch_svm::kernel::Kernel;

pub use bubbletouch_svm::linear_svm::{Convergence, LinearSvm, LinearSvmParams, MAX_PASSES};

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_gamma: false,
    ..ClassifierAbout::svm("linear SVM", |_| Kernel::Linear)
};
