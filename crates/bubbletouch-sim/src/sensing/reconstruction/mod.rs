//! Reconstruction: computes frames from measurements.
//!
//! | file | solver |
//! |---|---|
//! | `omp` | orthogonal matching pursuit ([`Omp`]) |
//! | `lasso` | the ℓ1 problem by FISTA ([`Lasso`]) |
//! | `lmmse` | the linear estimate of least mean square error ([`Lmmse`]) |
//! | `solved` | the result of a solver ([`Solved`]) |
//! | `reconstructor` | a solver, prepared for a projection and a dictionary ([`Reconstructor`]) |

mod lasso;
mod lmmse;
mod omp;
mod reconstructor;
mod solved;

pub use lasso::Lasso;
pub use lmmse::Lmmse;
pub use omp::Omp;
pub use reconstructor::{Effort, Reconstruction, Reconstructor, Solver};
pub use solved::Solved;
