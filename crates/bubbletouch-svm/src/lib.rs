//! Soft-margin support vector machines for [`linfa`]: LIBSVM's problem and results, computed from shared kernel matrices.
//!
//! ```
//! use bubbletouch_svm::kernel::{Gamma, Kernel};
//! use bubbletouch_svm::SvmParams;
//! use linfa::dataset::DatasetBase;
//! use linfa::traits::{Fit, Predict};
//! use ndarray::{Array1, Array2};
//!
//! // Three classes on a circle, forty rows each.
//! let features = Array2::from_shape_fn((120, 2), |(row, column)| {
//!     let angle = 2.1 * (row % 3) as f64 + 0.4 * (row as f64).sin();
//!     if column == 0 { angle.cos() } else { angle.sin() }
//! });
//! let data = DatasetBase::new(features, Array1::from_iter((0..120).map(|row| row % 3)));
//!
//! let kernel = Kernel::Rbf { gamma: Gamma::Scale };
//! let model = SvmParams { kernel, c: 10.0, ..SvmParams::default() }.fit(&data)?;
//! assert_eq!(model.predict(&data.records), data.targets);
//! # Ok::<(), bubbletouch_svm::Error>(())
//! ```
//!
//! # Glossary
//!
//! | word | meaning |
//! |---|---|
//! | **row** | the features of one example; a **label** is the class of a row, a `usize` |
//! | **data set** | a linfa data set: features (n_rows × m, `f32` or `f64`) and one label per row |
//! | **split** | training rows and test rows |
//! | **group** | rows that are never on both sides of a split, such as touches of one pose |
//! | **fold** | one of k splits of the training rows whose test parts are disjoint |
//! | **scaling** | the linear map of features that is computed from training rows |
//! | **kernel** | the function K(x, z) of two rows; **γ** is its width parameter |
//! | **Gram matrix** | the kernel values of all pairs of rows of a problem |
//! | **binary problem** | the separation of the rows of a positive class from a negative class, or from all other rows ([`Multiclass`]) |
//! | **C** | the penalty per unit of margin violation |
//! | **multiplier** | the dual variable of a row, 0 ≤ a ≤ C; the row is a **support vector** if it is above 0 |
//! | **decision value** | the value of a binary problem's decision function for a row: positive for the positive class |
//! | **path** | the solutions of one problem for several C, each started from the previous one |
//! | **alpha seeding** | the start of a fold from the multipliers of another fold |
//! | **stream** | a source of random numbers that is named after the drawn quantity ([`streams`]) |
//!
//! # How it works
//!
//! The decision function is `f(x) = Σ_i y_i a_i K(x_i, x) − ρ`; its sign gives the class. The multipliers minimise
//! `½ Σ_ij a_i a_j y_i y_j K(x_i, x_j) − Σ_i a_i` over `0 ≤ a_i ≤ C`, `Σ_i y_i a_i = 0`.
//!
//! 1. **Rows** are checked, sorted by class and centred, in single or double precision (`gram::sorted`, `row_statistics`).
//! 2. **Kernel values** `K(x_i, x_j)` between two classes are computed once for all problems, by matrix products of the rows (`gram`, `linalg`).
//! 3. **Each problem** is solved by sequential minimal optimisation (`smo`). If convergence is slow, the linear equations of the free variables are solved
//!    (`smo::active_set`). Well separated classes are solved on the rows near the margin (`screening`).
//! 4. **Along C and over folds**, each solution starts from the previous solution ([`cross_validation`]).
//! 5. **Prediction** computes one matrix product for all problems and counts the votes of their signs ([`predict`]).
//!
//! | module | input → output |
//! |---|---|
//! | `linalg` | matrices → products, factors; f32 and f64 |
//! | `row_statistics`, [`dataset`] | features and labels → checked rows, their mean and size |
//! | [`kernel`], `gram` | rows → kernel values, Gram matrices of binary problems |
//! | `smo` | a Gram matrix and C → the solution of a binary problem |
//! | `screening` | one-vs-one linear problems → their solutions from the rows near the margins |
//! | `training` | a data set → all binary problems of a path of C |
//! | [`predict`] | solved problems and rows → decision values and labels |
//! | [`probabilities`] | decision values of held-out rows → probabilities of the classes |
//! | [`cross_validation`] | candidates of C and γ → the best ones |
//! | [`linear_svm`], [`classifiers`] | a data set → linear SVMs and other classifiers |
//! | [`audit`] | labelled rows → nearest rows, scores of held-out rows, permutation tests |
//!
//! # Solvers
//!
//! | parameters | solver | stopping criterion | memory |
//! |---|---|---|---|
//! | [`SvmParams`], any kernel, rows ≥ 1,000, C · K ≤ 1e5, tolerance ≥ 1e-4 | SMO on kernel values in `f32` | KKT violation ≤ `tolerance` in decision values, or 10 million iterations (100 a row if more) | n² · 4 bytes, or the latest rows within `memory_bytes` |
//! | [`SvmParams`], any kernel, otherwise | SMO on kernel values in `f64` | as for `f32` | n² · 8 bytes, or the latest rows within `memory_bytes` |
//! | [`linear_svm::LinearSvmParams`] | dual coordinate descent, one-vs-rest, regularised bias (LIBLINEAR's problem) | spread of projected gradients ≤ `tolerance`, or `max_passes` | n · m |
//!
//! The module [`classifiers`] contains other kinds of classifiers with exactly reproducible results, and states how they differ from linfa's classifiers.
//!
//! # From linfa-svm
//!
//! | linfa-svm | this crate |
//! |---|---|
//! | `Svm::<_, Pr>::params()`, `Svm::<_, bool>::params()` | [`SvmParams`]; labels are of any type that linfa supports, for two or more classes |
//! | `.pos_neg_weights(c₊, c₋)` | `c`, and weights of rows ([`DatasetBase::with_weights`](linfa::DatasetBase::with_weights)) or [`class_weight`] |
//! | `.linear_kernel()` | [`Kernel::Linear`](kernel::Kernel::Linear), the default |
//! | `.gaussian_kernel(ε)` | [`Kernel::Rbf`](kernel::Kernel::Rbf) with γ = 1 / ε |
//! | `.polynomial_kernel(c₀, d)` | [`Kernel::Polynomial`](kernel::Kernel::Polynomial) with γ = 1 |
//! | `.eps(ε)` | `tolerance` |
//! | `.shrinking(true)` | always |
//! | `Pr` by Platt scaling of training rows | [`probabilities`], of held-out rows; the order of the classes is ascending |
//! | `MultiClassModel` of `one_vs_all` | [`Multiclass`]: one-vs-one or one-vs-rest |
//! | ν-SVM, one-class SVM, regression, own kernels | absent |
//!
//! The feature `linfa-svm` adds linfa-svm's solver to the [`classifiers`], for comparisons.
//!
//! # Sources
//!
//! - Fan, Chen, Lin, *Working set selection using second order information for training support vector machines*, JMLR 2005.
//! - DeCoste, Wagstaff, *Alpha seeding for support vector machines*, KDD 2000.
//! - Hsieh et al., *A dual coordinate descent method for large-scale linear SVM*, ICML 2008.
//! - Joachims, *Making large-scale SVM learning practical*, Advances in Kernel Methods 1999.
//! - Scheinberg, *An efficient implementation of an active set method for SVMs*, JMLR 2006.
//! - Wen et al., *Improving efficiency of SVM k-fold cross-validation by alpha seeding*, AAAI 2017.
//! - Goto, van de Geijn, *Anatomy of high-performance matrix multiplication*, ACM TOMS 2008.
#![warn(missing_docs)]
#![warn(clippy::missing_errors_doc)]
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

pub mod audit;
mod binary_problem;
pub mod class_model;
pub mod class_weight;
pub mod classifiers;
pub mod cross_validation;
pub mod dataset;
pub mod dual;
pub mod error;
mod fold_search;
pub(crate) mod gram;
pub mod kernel;
pub(crate) mod linalg;
pub mod linear_model;
pub mod linear_svm;
mod multiclass;
pub mod precision;
pub mod predict;
pub mod probabilities;
pub(crate) mod row_statistics;
pub mod saved;
pub mod scaling;
pub(crate) mod screening;
pub(crate) mod smo;
pub mod split;
pub mod streams;
mod svm_params;
pub(crate) mod training;

pub use binary_problem::BinaryProblem;
pub use error::{Error, Result};
pub use multiclass::Multiclass;
pub use svm_params::{DEFAULT_MEMORY_BYTES, SvmParams, SvmSolver};
