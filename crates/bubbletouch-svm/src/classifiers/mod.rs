//! Registry of classifiers with a common interface: SVMs with all kernels, and classifiers without a kernel.
//!
//! Equal rows and equal seeds give equal models on every machine. [`Classifier`](classifier::Classifier) contains the parameters of all kinds.
//! Classifiers from outside of this crate are [foreign].

use serde::{Deserialize, Serialize};

#[macro_use]
mod classifier_about;
pub mod classifier;
pub mod foreign;
pub(crate) mod logistic_loss;
mod logistic_preconditioner;
pub mod parameters;
pub(crate) mod ranked;
pub mod trained_classifier;
pub(crate) mod tree;

pub use crate::class_model;
pub use classifier_about::{ClassifierAbout, Train};

// Each line declares a classifier and names the file that contains its descriptor.
classifiers! {
    LinearSvm linear_svm "Soft-margin SVM, linear kernel.";
    RbfSvm rbf_svm "Soft-margin SVM, Gaussian kernel `exp(−γ|x − z|²)`.";
    PolynomialSvm polynomial_svm "Soft-margin SVM, polynomial kernel `(γ x·z + c₀)^d`.";
    LogisticRegression logistic_regression "Multinomial [logistic regression](logistic_regression).";
    KNearest k_nearest "[k nearest neighbours](k_nearest).";
    NearestCentroid nearest_centroid "The class whose mean is nearest: [nearest centroid](nearest_centroid).";
    NaiveBayes naive_bayes "Gaussian [naive Bayes](naive_bayes).";
    RandomForest random_forest "A [random forest](random_forest).";
    #[cfg(feature = "linfa-svm")] LinfaSvm linfa_svm "The [linear SVM of the crate linfa-svm](linfa_svm).";
    #[cfg(feature = "linfa-svm")] LinfaRbfSvm linfa_rbf_svm "The [SVM with a Gaussian kernel of the crate linfa-svm](linfa_rbf_svm).";
}
