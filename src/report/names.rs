//! Names of what a study sweeps, for people.

use crate::recognition::ClassifierKind;
use crate::sensing::Ensemble;

/// An ensemble in words.
pub fn ensemble_name(ensemble: Ensemble) -> &'static str {
    match ensemble {
        Ensemble::Gaussian => "Gaussian",
        Ensemble::Bernoulli => "Bernoulli",
        Ensemble::Sparse => "sparse",
        Ensemble::Sbhe => "SBHE",
        Ensemble::BlockAverage => "block average",
        Ensemble::Subsample => "subsample",
        Ensemble::Identity => "identity",
    }
}

/// A classifier in words.
pub fn classifier_name(classifier: ClassifierKind) -> &'static str {
    match classifier {
        ClassifierKind::LinearSvm => "linear SVM",
        ClassifierKind::RbfSvm => "RBF SVM",
        ClassifierKind::PolynomialSvm => "polynomial SVM",
        ClassifierKind::LogisticRegression => "logistic regression",
        ClassifierKind::KNearest => "k nearest neighbours",
        ClassifierKind::NaiveBayes => "naive Bayes",
        ClassifierKind::DecisionTree => "decision tree",
        ClassifierKind::RandomForest => "random forest",
    }
}
