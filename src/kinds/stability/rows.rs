//! The result tables of a study of stability: one plain struct a row, one field a column.

use super::cell::Outcome;
use super::spec::{ContactMethod, StabilityScene};
use crate::columns;
use crate::study::pieces::any_number;
use serde::{Deserialize, Serialize};

/// What people call methods.
const METHODS: &[(&str, &str)] = &[
    ("quasi_static", "quasi-static (ours)"),
    ("semi_implicit", "semi-implicit Euler, penalty"),
    ("implicit_euler", "implicit Euler, exact contact"),
    ("rapier_skin_sim", "rapier as SkinSim's engine"),
    ("mujoco_euler", "MuJoCo as it comes"),
    ("mujoco_implicitfast", "MuJoCo, implicitfast"),
    ("mujoco_discrete", "MuJoCo, discrete, hard"),
];

columns! { StabilityCell {
    part: Subject "part of the study": Linear;
    scene: Condition;
    method: Choice named METHODS;
    solver_iterations: Choice: Linear;
    taxels: Condition "taxels a side": Linear;
    stiffness_n_per_m: Condition "taxel stiffness" in "N/m": Log;
    taxel_mass_kg: Condition "taxel mass" in "kg": Log;
    object_mass_kg: Condition "mass of the ball" in "kg": Log;
    dt_s: Choice "time step" in "s": Log;
} }
columns! { StabilityScore {
    mass_ratio: Note "mass ratio, ball to taxel": Log;
    explicit_limit_s: Note "limit of an explicit spring" in "s": Log;
    damping_n_s_per_m: Note "taxel damping" in "N s/m": Log;
    contact_stiffness_n_per_m: Note "contact stiffness" in "N/m": Log;
    outcome: Outcome;
    force_imbalance: Value(Less): Log;
    deflection_error: Value(Less): Log;
    n_steps: Note "steps": Log;
    simulated_s: Note "simulated time" in "s": Log;
} }
columns! { StabilityTime {
    wall_s: Cost "time" in "s": Log;
    per_simulated_s: Cost "computing a simulated second" in "s": Log;
} }
columns! { StabilitySummary {
    scene: Condition;
    method: Choice named METHODS;
    solver_iterations: Choice: Linear;
    n_cells: Note "cells": Linear;
    n_right: Value(More) "right": Linear;
    n_inaccurate: Value(Less) "inaccurate": Linear;
    n_missed_contact: Value(Less) "missed contact": Linear;
    n_energy_growth: Value(Less) "energy growth": Linear;
    n_not_finite: Value(Less) "not finite": Linear;
    worst_force_imbalance: Value(Less): Log;
    worst_deflection_error: Value(Less): Log;
} }
columns! { Joints {
    method: Choice named METHODS;
    solver_iterations: Choice: Linear;
    taxel_mass_kg: Condition "taxel mass" in "kg": Log;
    dt_s: Choice "time step" in "s": Log;
    joints: Condition: Log;
    carried_kg: Note "load of a taxel" in "kg": Log;
    outcome: Outcome;
    time_s: Cost "computing a simulated second" in "s": Log;
} }

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
    /// All taxels.
    pub fn n_taxels(&self) -> usize {
        self.taxels * self.taxels
    }

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

/// What a plunger costs whose taxels carry the same on all arrays: a row of `joints.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joints {
    /// How it is simulated.
    pub method: ContactMethod,
    /// Of an engine's solver, a step.
    pub solver_iterations: Option<usize>,
    /// m, kg.
    pub taxel_mass_kg: f64,
    /// Δt, s.
    pub dt_s: f64,
    /// Taxels: each is a body on a joint.
    pub joints: usize,
    /// M over the number of taxels, kg.
    pub carried_kg: f64,
    /// Right, or how it broke.
    pub outcome: Outcome,
    /// Seconds a simulated second; of what steps nothing, in all.
    pub time_s: f64,
}

/// Rows of work items.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StabilityRows {
    /// One a cell, in the order of the plan.
    pub stability: Vec<(StabilityCell, StabilityScore)>,
    /// The same.
    pub timing: Vec<(StabilityCell, StabilityTime)>,
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
