//! Dense linear algebra: factorisations and orthonormal bases of small matrices.
//!
//! | item | matrix → result |
//! |---|---|
//! | [`Cholesky`] | symmetric positive definite → L with L Lᵀ, and solutions of many systems at a time |
//! | [`RowCholesky`] | the same, row by row in the memory of the caller |
//! | [`symmetric_eigen`] | symmetric → eigenvalues and eigenvectors |
//! | [`orthonormal_rows`] | rows → an orthonormal basis of their span |
//! | [`pivoted_columns`] | columns → those that span most, in the order of QR with column pivoting |
//!
//! No general crate replaces these functions: nalgebra adds 18 s to a build and is ten times slower for 256 equations.

mod cholesky;
mod orthonormal;
mod row_cholesky;
mod symmetric_eigen;

pub(crate) use cholesky::Cholesky;
pub(crate) use orthonormal::{orthonormal_rows, pivoted_columns};
pub(crate) use row_cholesky::RowCholesky;
pub(crate) use symmetric_eigen::symmetric_eigen;
