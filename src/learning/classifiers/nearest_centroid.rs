//! A study's nearest centroid: [`bubbletouch_svm::classifiers::nearest_centroid`].

use std::sync::Arc;

use crate::learning::classifiers::classifier_about::ClassifierAbout;

pub use bubbletouch_svm::classifiers::nearest_centroid::NearestCentroid;

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::new("nearest centroid", |_, scaled, _, _| {
        Ok(Arc::new(NearestCentroid::train(scaled)?))
    });
