//! A study's multinomial logistic regression: [`bubbletouch_svm::classifiers::logistic_regression`].

use std::sync::Arc;

use crate::learning::classifiers::classifier_about::ClassifierAbout;

pub use bubbletouch_svm::classifiers::logistic_regression::{
    Logistic, LogisticParams, MAX_ITERATIONS,
};

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_c: true,
    ..ClassifierAbout::new("logistic regression", |classifier, scaled, c, _| {
        let params = LogisticParams {
            c,
            tolerance: 0.1 * classifier.tolerance,
            ..LogisticParams::default()
        };
        Ok(Arc::new(params.train(scaled)?))
    })
};
