//! What a cell takes, about: for the time left.

use super::cell::{LEAST_STEPS, N_REPEATS, SHORT};
use super::scene::planned_end;
use super::spec::ContactMethod;
use super::table::StabilityCell;

/// Seconds of one thread, measured on one core of a 2-core x86-64 server.
pub(super) fn planned_s(cell: &StabilityCell) -> f64 {
    let n_taxels = (cell.taxels * cell.taxels) as f64;
    let n_steps = (planned_end(cell) / cell.dt_s).max(LEAST_STEPS);
    let iterations = cell.solver_iterations.unwrap_or(1) as f64;
    let per_step_s = match cell.method {
        ContactMethod::QuasiStatic => 1e-6 / n_steps,
        ContactMethod::ImplicitEuler => 8e-9,
        ContactMethod::SemiImplicit => 8e-9,
        ContactMethod::RapierTuned => 2.4e-6 * iterations,
        ContactMethod::RapierAsItComes => 2e-6 * iterations,
        ContactMethod::RapierSkinSim => 3e-6 + 1.2e-7 * iterations,
        // Other programs ran elsewhere.
        _ => 0.0,
    };
    let once_s = per_step_s * n_steps * n_taxels;
    match once_s < SHORT {
        true => N_REPEATS as f64 * once_s,
        false => once_s,
    }
}
