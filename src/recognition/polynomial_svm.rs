//! Soft-margin SVM of a polynomial kernel; see [`svm`](super::svm).

use super::classifier_about::ClassifierAbout;
use super::kernel::Kernel;

pub(super) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("polynomial SVM", |classifier| Kernel::Polynomial {
        gamma: classifier.gamma,
        coef0: classifier.coef0,
        degree: classifier.degree,
    });
