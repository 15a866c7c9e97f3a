//! Gram matrices: kernel values of training rows, and the matrices of binary problems.
//!
//! | stage | input → output |
//! |---|---|
//! | `centered_rows` | rows and their centre → centred rows with their norms, kernel values between them |
//! | `sorted` | a data set → its rows sorted by class |
//! | `between` | classes → kernel values within and between groups of classes |
//! | `product_kernel` | all rows → one matrix of products, from which kernels of several γ follow |
//! | `matrix` | kernel values → the Gram matrix of a problem, held whole |
//! | `part`, `cached` | blocks stored elsewhere, or rows computed on demand → the Gram matrix of a problem |
//! | `curvatures`, `row_sums` | a row → inverse curvatures; β → weighted sums of rows |

pub(crate) mod between;
pub(crate) mod cached;
pub(crate) mod centered_rows;
pub(crate) mod curvatures;
pub(crate) mod matrix;
pub(crate) mod part;
pub(crate) mod product_kernel;
pub(crate) mod row_sums;
pub(crate) mod sorted;
