//! The result tables of a study of stability: one plain struct a row, one field a column.

use crate::engine::work_items::any_number;
use crate::row;
use crate::studies::stability::spec::{ContactMethod, StabilityScene};
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

row! {
/// What is simulated, and how: a row of `stability.csv` begins with it, and one of `timing.csv`.
pub struct StabilityCell {
    /// The part of the study, from 1.
    part: usize => Subject "part of the study": Linear;
    /// What happens.
    scene: StabilityScene => Condition;
    /// How it is simulated.
    method: ContactMethod => Choice named METHODS;
    /// Of an engine's solver, a step.
    solver_iterations: Option<usize> => Choice: Linear;
    /// Taxels a side.
    taxels: usize => Condition "taxels a side": Linear;
    /// k, N/m.
    stiffness_n_per_m: f64 => Condition "taxel stiffness" in "N/m": Log;
    /// m, kg.
    taxel_mass_kg: f64 => Condition "taxel mass" in "kg": Log;
    /// M of a free ball, kg.
    object_mass_kg: Option<f64> => Condition "mass of the ball" in "kg": Log;
    /// Δt, s.
    dt_s: f64 => Choice "time step" in "s": Log;
} }

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

row! {
/// What came of it (with the [`StabilityCell`] before it: a row of `stability.csv`).
pub struct StabilityScore {
    /// M / m, of a free ball.
    mass_ratio: Option<f64> => Note "mass ratio, ball to taxel": Log;
    /// 2 √(m / k), s: an explicit spring without damper diverges beyond.
    explicit_limit_s: f64 => Note "limit of an explicit spring" in "s": Log;
    /// c, N·s/m.
    damping_n_s_per_m: f64 => Note "taxel damping" in "N s/m": Log;
    /// κ, N/m, where contact is a penalty.
    contact_stiffness_n_per_m: Option<f64> => Note "contact stiffness" in "N/m": Log;
    /// Right, or how it broke.
    outcome: Outcome => Outcome;
    /// |Σ f − what it must be| as a share of that; none if it broke before.
    #[serde(with = "any_number")]
    force_imbalance: Option<f64> => Value(Less): Log;
    /// Σ |δ − δ*| / Σ δ*; none if it broke before.
    #[serde(with = "any_number")]
    deflection_error: Option<f64> => Value(Less): Log;
    /// Steps that were made.
    n_steps: usize => Note "steps": Log;
    /// Seconds that were simulated; none where nothing is stepped.
    simulated_s: Option<f64> => Note "simulated time" in "s": Log;
} }

row! {
/// What it cost (with the [`StabilityCell`] before it: a row of `timing.csv`).
pub struct StabilityTime {
    /// Seconds of the whole cell, on one thread beside other cells on the others.
    wall_s: f64 => Cost "time" in "s": Log;
    /// Seconds a simulated second; none where nothing is stepped.
    per_simulated_s: Option<f64> => Cost "computing a simulated second" in "s": Log;
} }

row! {
/// A method in a scene over all cells: a row of `stability_summary.csv`.
pub struct StabilitySummary {
    /// What happens.
    scene: StabilityScene => Condition;
    /// How it is simulated.
    method: ContactMethod => Choice named METHODS;
    /// Of an engine's solver, a step.
    solver_iterations: Option<usize> => Choice: Linear;
    /// Cells.
    n_cells: usize => Note "cells": Linear;
    /// Cells that are right.
    n_right: usize => Value(More) "right": Linear;
    /// Cells that came to an end, but not to the right one.
    n_inaccurate: usize => Value(Less) "inaccurate": Linear;
    /// Cells in which contact was missed.
    n_missed_contact: usize => Value(Less) "missed contact": Linear;
    /// Cells that gained energy.
    n_energy_growth: usize => Value(Less) "energy growth": Linear;
    /// Cells that ended in numbers that are not finite.
    n_not_finite: usize => Value(Less) "not finite": Linear;
    /// The largest force imbalance of the cells that did not break; none if all did.
    worst_force_imbalance: Option<f64> => Value(Less): Log;
    /// The largest deflection error of the same.
    worst_deflection_error: Option<f64> => Value(Less): Log;
} }

row! {
/// What a plunger costs whose taxels carry the same on all arrays: a row of `joints.csv`.
pub struct Joints {
    /// How it is simulated.
    method: ContactMethod => Choice named METHODS;
    /// Of an engine's solver, a step.
    solver_iterations: Option<usize> => Choice: Linear;
    /// m, kg.
    taxel_mass_kg: f64 => Condition "taxel mass" in "kg": Log;
    /// Δt, s.
    dt_s: f64 => Choice "time step" in "s": Log;
    /// Taxels: each is a body on a joint.
    joints: usize => Condition: Log;
    /// M over the number of taxels, kg.
    carried_kg: f64 => Note "load of a taxel" in "kg": Log;
    /// Right, or how it broke.
    outcome: Outcome => Outcome;
    /// Seconds a simulated second; of what steps nothing, in all.
    time_s: f64 => Cost "computing a simulated second" in "s": Log;
} }

/// What came of a work item, and what it cost.
pub type StabilityRow = (StabilityCell, StabilityScore, StabilityTime);

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

/// What came of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Force imbalance and deflection error are at most [`TOLERANCE`].
    Right,
    /// It came to an end, but not to the right one.
    Inaccurate,
    /// At a moment of judgement the taxels that are to be pushed are in less than half as far as they must be, all together, or more than twice
    /// as far; or nothing holds the ball.
    MissedContact,
    /// More energy than the scene can have: at most four times what goes into it.
    EnergyGrowth,
    /// A number is not finite.
    NotFinite,
}

/// Errors up to this are right.
pub const TOLERANCE: f64 = 0.01;
