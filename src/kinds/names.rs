//! What people call the codes of tables.

/// Classifiers.
pub(super) const CLASSIFIERS: &[(&str, &str)] = &[
    ("linear_svm", "linear SVM"),
    ("rbf_svm", "RBF SVM"),
    ("polynomial_svm", "polynomial SVM"),
    ("k_nearest", "k nearest neighbours"),
    ("naive_bayes", "naive Bayes"),
];

/// Ensembles.
pub(super) const ENSEMBLES: &[(&str, &str)] = &[("sbhe", "SBHE"), ("gaussian", "Gaussian")];
