//! Gram matrices: kernel values of training rows, and the matrices of binary problems.
//!
//! | stage | input → output |
//! |---|---|
//! | `centered_rows` | rows and their centre → centred rows with their norms, kernel values between them |
//! | `sorted` | a data set → its rows sorted by class |
//! | `matrix` | a source of rows and a memory limit → the Gram matrix of a problem |
//! | `pairs` | blocks of kernel values of classes → the Gram matrices of their pairs |
//! | `curvatures`, `row_sums` | a row → inverse curvatures; β → weighted sums of rows |

pub(crate) mod centered_rows;
pub(crate) mod curvatures;
pub(crate) mod matrix;
pub(crate) mod pairs;
pub(crate) mod row_sums;
pub(crate) mod sorted;
