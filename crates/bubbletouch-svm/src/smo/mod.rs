//! Sequential minimal optimisation (SMO) of one binary soft-margin problem.
//!
//! With `β_i = y_i a_i`, the dual problem is: maximise `Σ_i y_i β_i − ½ Σ_ij β_i β_j K_ij` subject to `0 ≤ y_i β_i ≤ C w_i` and `Σ_i β_i = 0`, where
//! w_i is the weight of the row's class. The gradient is `f =
//! y − Kβ`. A solution β is optimal if max f over the variables that can increase does not exceed min f over the variables that can decrease. Each iteration
//! chooses one variable of each kind by second-order information [Fan, Chen, Lin 2005]. The iteration moves the two variables to the optimum along their line,
//! in two passes over f (`passes`).
//!
//! - **Shrinking** [Joachims 1999]: variables that are likely to stay at a bound are omitted. The remaining part of the Gram matrix is copied, so that
//!   iterations use short contiguous rows.
//! - **Warm start along C**: the last solution is scaled by the factor with the best objective.
//! - **Active-set steps**: if pairwise steps converge slowly, the solver periodically solves the equations of the free variables (`active_set`).
//! - **Precision**: the Gram matrix and f may be f32; the stopping criterion is checked in f64.

mod active_set;
mod iterations;
mod passes;
#[cfg(target_arch = "x86_64")]
mod passes_512;
mod problem;
pub(crate) mod reached;
mod shrinking;
mod solver;
mod solver_scalar;
mod start;
pub(crate) mod variables;

pub(crate) use active_set::SolverGoal;
pub(crate) use problem::Smo;
pub(crate) use solver_scalar::SolverScalar;
