//! Linear soft-margin SVMs; see [`svm`](crate::recognition::svm), and [`bubbletouch_svm::linear_svm`] for coordinate descent.

use ndarray::{Array2, ArrayView2};

use crate::Result;
use crate::recognition::classifiers::class_model::ClassModel;
use crate::recognition::classifiers::classifier_about::{ClassifierAbout, PRODUCT_S};
use crate::recognition::svm::kernel::Kernel;

pub use bubbletouch_svm::linear_svm::{Convergence, LinearSvm, LinearSvmParams, MAX_PASSES};

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_gamma: false,
    test_s: |_, m, n_classes| n_classes * n_classes * (PRODUCT_S * m + 5e-9),
    ..ClassifierAbout::svm("linear SVM", |_| Kernel::Linear)
};

impl ClassModel for LinearSvm {
    fn classes(&self) -> &[usize] {
        LinearSvm::classes(self)
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        Ok(self.model().scores(features)?)
    }

    fn n_capped(&self) -> usize {
        self.convergence()
            .iter()
            .filter(|end| end.is_capped)
            .count()
    }
}
