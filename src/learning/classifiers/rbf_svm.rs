//! Soft-margin SVM of a Gaussian kernel; see [`svm`](bubbletouch_svm).

use crate::learning::classifiers::classifier_about::ClassifierAbout;
use bubbletouch_svm::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("RBF SVM", |classifier| Kernel::Rbf {
        gamma: classifier.gamma,
    });
