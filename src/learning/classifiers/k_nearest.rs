//! A study's k nearest neighbours: [`bubbletouch_svm::classifiers::k_nearest`].

use std::sync::Arc;

use crate::learning::classifiers::classifier_about::ClassifierAbout;

pub use bubbletouch_svm::classifiers::k_nearest::KNearest;

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_neighbours: true,
    ..ClassifierAbout::new("k nearest neighbours", |classifier, scaled, _, _| {
        Ok(Arc::new(KNearest::train(scaled, classifier.n_neighbours)?))
    })
};
