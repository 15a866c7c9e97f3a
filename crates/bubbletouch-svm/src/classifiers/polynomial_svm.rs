//! Soft-margin SVM with a polynomial kernel ([crate documentation](crate)).

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::kernel::Kernel;

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_degree: true,
    ..ClassifierAbout::svm("polynomial SVM", |classifier| Kernel::Polynomial {
        gamma: classifier.gamma,
        coef0: classifier.coef0,
        degree: classifier.degree,
    })
};
