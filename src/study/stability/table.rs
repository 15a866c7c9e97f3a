//! The result tables of a study of stability: one plain struct a row, one field a column.

use super::cell::Outcome;
use super::spec::{ContactMethod, StabilityScene};
use crate::study::pieces::any_number;
use serde::{Deserialize, Serialize};

/// What is simulated, and how: a row of `stability.csv` begins with it, and one of `timing.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StabilityCell {
    /// The part of the study, from 1.
    pub part: usize,
    /// What happens.
    pub scene: StabilityScene,
    /// How it is simulated.
    pub method: ContactMethod,
    /// Of an engine's solver, a step.
    pub solver_iterations: Option<usize>,
    /// Taxels a side.
    pub taxels: usize,
    /// k, N/m.
    pub stiffness_n_per_m: f64,
    /// m, kg.
    pub taxel_mass_kg: f64,
    /// M of a free ball, kg.
    pub object_mass_kg: Option<f64>,
    /// Δt, s.
    pub dt_s: f64,
}

impl StabilityCell {
    /// M / m, of a free ball.
    pub fn mass_ratio(&self) -> Option<f64> {
        self.object_mass_kg.map(|mass| mass / self.taxel_mass_kg)
    }
}

/// What came of it (with the [`StabilityCell`] before it: a row of `stability.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StabilityScore {
    /// M / m, of a free ball.
    pub mass_ratio: Option<f64>,
    /// 2 √(m / k), s: an explicit spring without damper diverges beyond.
    pub explicit_limit_s: f64,
    /// c, N·s/m.
    pub damping_n_s_per_m: f64,
    /// κ, N/m, where contact is a penalty.
    pub contact_stiffness_n_per_m: Option<f64>,
    /// Right, or how it broke.
    pub outcome: Outcome,
    /// |Σ f − what it must be| as a share of that; none if it broke before.
    #[serde(with = "any_number")]
    pub force_imbalance: Option<f64>,
    /// Σ |δ − δ*| / Σ δ*; none if it broke before.
    #[serde(with = "any_number")]
    pub deflection_error: Option<f64>,
    /// Steps that were made.
    pub n_steps: usize,
    /// Seconds that were simulated; none where nothing is stepped.
    pub simulated_s: Option<f64>,
}

/// What it cost (with the [`StabilityCell`] before it: a row of `timing.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StabilityTime {
    /// Seconds of the whole cell, on one thread beside other cells on the others.
    pub wall_s: f64,
    /// Seconds a simulated second; none where nothing is stepped.
    pub per_simulated_s: Option<f64>,
}

/// A method in a scene over all cells: a row of `stability_summary.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StabilitySummary {
    /// What happens.
    pub scene: StabilityScene,
    /// How it is simulated.
    pub method: ContactMethod,
    /// Of an engine's solver, a step.
    pub solver_iterations: Option<usize>,
    /// Cells.
    pub n_cells: usize,
    /// Cells that are right.
    pub n_right: usize,
    /// Cells that came to an end, but not to the right one.
    pub n_inaccurate: usize,
    /// Cells in which contact was missed.
    pub n_missed_contact: usize,
    /// Cells that gained energy.
    pub n_energy_growth: usize,
    /// Cells that ended in numbers that are not finite.
    pub n_not_finite: usize,
    /// The largest force imbalance of the cells that did not break; none if all did.
    pub worst_force_imbalance: Option<f64>,
    /// The largest deflection error of the same.
    pub worst_deflection_error: Option<f64>,
}

/// All result tables of a study of stability.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StabilityTables {
    /// One row a cell, in the order of the plan.
    pub stability: Vec<(StabilityCell, StabilityScore)>,
    /// One row a scene, method and number of iterations, in the order in which the plan first has them.
    pub summary: Vec<StabilitySummary>,
    /// One row a cell, in the order of the plan.
    pub timing: Vec<(StabilityCell, StabilityTime)>,
    /// Who measured the rows of other programs, and when: `MuJoCo 4.0.0, 2026-11-22`; empty without such rows. They are in the tables
    /// above, at the end of the parts that they belong to.
    pub peers: String,
}

/// Who measured a row of another program: it ends with these columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeerSource {
    /// Which program.
    pub program: String,
    /// Of the program.
    pub version: String,
    /// Year-month-day.
    pub date: String,
}
