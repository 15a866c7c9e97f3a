//! Soft-margin SVM of a Laplacian kernel; see [`svm`](bubbletouch_svm).

use crate::learning::classifiers::classifier_about::ClassifierAbout;
use bubbletouch_svm::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("Laplacian SVM", |classifier| Kernel::Laplacian {
        gamma: classifier.gamma,
    });
