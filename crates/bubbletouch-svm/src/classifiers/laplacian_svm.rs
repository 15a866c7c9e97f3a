//! Soft-margin SVM with a Laplacian kernel ([crate documentation](crate)).

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::classifiers::parameters::GAMMA;
use crate::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("Laplacian SVM", &[GAMMA], |parameters| Kernel::Laplacian {
        gamma: parameters.gamma(),
    });
