//! Soft-margin SVM with a polynomial kernel ([crate documentation](crate)).

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::classifiers::parameters::{DefaultValue, GAMMA, Parameter};
use crate::kernel::Kernel;

const DEGREE: Parameter = Parameter::integer(
    "degree",
    "degree d of the polynomial kernel",
    [1.0, 20.0],
    DefaultValue::Number(3.0),
)
.always_written();

/// Constant of the polynomial kernel; the default 1 (0 in scikit-learn) includes all lower powers.
const COEF0: Parameter = Parameter::real(
    "coef0",
    "constant c₀ of the polynomial kernel",
    [0.0, 1e6],
    DefaultValue::Number(1.0),
)
.always_written();

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::svm("polynomial SVM", &[GAMMA, DEGREE, COEF0], |parameters| {
        Kernel::Polynomial {
            gamma: parameters.gamma(),
            coef0: COEF0.number(parameters),
            degree: DEGREE.number(parameters) as u32,
        }
    });
