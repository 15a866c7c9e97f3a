//! Soft-margin SVM of a Gaussian kernel; see [`svm`](crate::recognition::svm).

use super::classifier_about::ClassifierAbout;
use crate::recognition::svm::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("RBF SVM", |classifier| Kernel::Rbf {
        gamma: classifier.gamma,
    });
