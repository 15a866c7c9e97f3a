//! Soft-margin SVM of a Gaussian kernel; see [`svm`](crate).

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("RBF SVM", |classifier| Kernel::Rbf {
        gamma: classifier.gamma,
    });
