//! Linear soft-margin SVM, trained by SMO or by [coordinate descent](crate::linear_svm).

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::kernel::Kernel;

pub use crate::linear_svm::{Convergence, LinearSvm, LinearSvmParams, MAX_PASSES};

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("linear SVM", &[], |_| Kernel::Linear);
