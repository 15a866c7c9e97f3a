//! A study's Gaussian naive Bayes: [`bubbletouch_svm::classifiers::naive_bayes`].

use std::sync::Arc;

use crate::learning::classifiers::classifier_about::ClassifierAbout;

pub use bubbletouch_svm::classifiers::naive_bayes::{NaiveBayes, VARIANCE_SMOOTHING};

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout::new("naive Bayes", |_, scaled, _, _| {
    Ok(Arc::new(NaiveBayes::train(scaled)?))
});
