//! What a method did in a scene, over all cells.

use super::cell::Outcome;
use super::table::{StabilityCell, StabilityScore, StabilitySummary};

/// A row a scene, method and number of iterations, in the order of first occurrence.
pub(super) fn summary(rows: &[(StabilityCell, StabilityScore)]) -> Vec<StabilitySummary> {
    let mut found: Vec<StabilitySummary> = Vec::new();
    for (cell, _) in rows {
        let is_known = found.iter().any(|row| is_of(row, cell));
        if !is_known {
            let of_it = rows.iter().filter(|(other, _)| is_like(other, cell));
            let scores: Vec<&StabilityScore> = of_it.map(|(_, score)| score).collect();
            found.push(summarise(cell, &scores));
        }
    }
    found
}

fn is_of(row: &StabilitySummary, cell: &StabilityCell) -> bool {
    (row.scene, row.method, row.solver_iterations)
        == (cell.scene, cell.method, cell.solver_iterations)
}

fn is_like(a: &StabilityCell, b: &StabilityCell) -> bool {
    (a.scene, a.method, a.solver_iterations) == (b.scene, b.method, b.solver_iterations)
}

fn summarise(cell: &StabilityCell, scores: &[&StabilityScore]) -> StabilitySummary {
    let count = |outcome| scores.iter().filter(|s| s.outcome == outcome).count();
    let worst = |of: fn(&StabilityScore) -> Option<f64>| {
        scores.iter().filter_map(|score| of(score)).reduce(f64::max)
    };
    StabilitySummary {
        scene: cell.scene,
        method: cell.method,
        solver_iterations: cell.solver_iterations,
        n_cells: scores.len(),
        n_right: count(Outcome::Right),
        n_inaccurate: count(Outcome::Inaccurate),
        n_missed_contact: count(Outcome::MissedContact),
        n_energy_growth: count(Outcome::EnergyGrowth),
        n_not_finite: count(Outcome::NotFinite),
        worst_force_imbalance: worst(|score| score.force_imbalance),
        worst_deflection_error: worst(|score| score.deflection_error),
    }
}
