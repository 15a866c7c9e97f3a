//! Soft-margin SVM with a Gaussian kernel ([crate documentation](crate)).

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::classifiers::parameters::GAMMA;
use crate::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("RBF SVM", &[GAMMA], |parameters| Kernel::Rbf {
        gamma: parameters.gamma(),
    });
