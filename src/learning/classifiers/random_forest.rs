//! A study's random forest: [`bubbletouch_svm::classifiers::random_forest`].

use std::sync::Arc;

use crate::learning::classifiers::classifier_about::ClassifierAbout;

pub use bubbletouch_svm::classifiers::random_forest::RandomForest;

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_trees: true,
    has_depth: true,
    ..ClassifierAbout::new("random forest", |classifier, scaled, _, seed| {
        let (n_trees, depth) = (classifier.n_trees, classifier.max_depth);
        let forest = RandomForest::train(scaled, n_trees, depth, &seed.named("forest"))?;
        Ok(Arc::new(forest))
    })
};
