//! Soft-margin SVM of a Gaussian kernel; see [`svm`](super::svm).

use super::classifier_about::ClassifierAbout;
use super::kernel::Kernel;

pub(super) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("RBF SVM", |classifier| Kernel::Rbf {
        gamma: classifier.gamma,
    });
