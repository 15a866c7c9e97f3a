//! Linear soft-margin SVMs trained by coordinate descent, without a kernel matrix. By default, the [SMO solver](crate) trains linear SVMs.
//!
//! With `solver = "coordinate_descent"` and `multiclass = "one_vs_rest"`, this module trains linear SVMs with n × m values in memory. The bias is the weight of
//! an additional feature with the constant value 1, and is regularised with the other weights, as in LIBLINEAR (`intercept_scaling = 1`). Centre the features;
//! otherwise the bias is closer to 0 than the bias of the kernel SVM.
//!
//! One-vs-rest: for each class, dual coordinate descent minimises `½|w|² + C Σ_i max(0, 1 − y_i w·x_i)`.

mod coordinate_descent;
mod model;
mod params;

pub use model::{Convergence, LinearSvm};
pub use params::{LinearSvmParams, MAX_PASSES};
