//! Soft-margin SVM of a Laplacian kernel; see [`svm`](crate).

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("Laplacian SVM", |classifier| Kernel::Laplacian {
        gamma: classifier.gamma,
    });
