//! Linear soft-margin SVMs. By default [`svm`](crate) trains them, on a kernel matrix, as it does other kernels.
//!
//! With `solver = "coordinate_descent"` and `multiclass = "one_vs_rest"` this module trains them without a kernel matrix: memory n × m, whatever n.
//! The bias is the weight of an added feature of constant 1, and so is regularised with the others, as in LIBLINEAR
//! (`intercept_scaling = 1`): centre the features, or expect a bias closer to 0 than the kernel SVM's.
//!
//! One-vs-rest: for each class `½|w|² + C Σ_i max(0, 1 − y_i w·x_i)`, by dual coordinate descent.

mod coordinate_descent;
mod model;
mod params;

pub use model::{Convergence, LinearSvm};
pub use params::{LinearSvmParams, MAX_PASSES};
