//! Soft-margin SVM of a Laplacian kernel; see [`svm`](crate::recognition::svm).

use super::classifier_about::ClassifierAbout;
use crate::recognition::svm::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("Laplacian SVM", |classifier| Kernel::Laplacian {
        gamma: classifier.gamma,
    });
