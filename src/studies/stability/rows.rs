//! Rows of the result tables of a stability study: one plain struct for each kind of row, with one field per column.

use crate::engine::work_items::any_number;
use crate::studies::prelude::*;
use crate::studies::stability::spec::*;

/// Display names of the simulation methods.
const METHODS: &[(&str, &str)] = &[
    ("quasi_static", "quasi-static (ours)"),
    ("semi_implicit", "semi-implicit Euler, penalty"),
    ("implicit_euler", "implicit Euler, exact contact"),
    ("rapier_skin_sim", "rapier as SkinSim's engine"),
    ("mujoco_euler", "MuJoCo as it comes"),
    ("mujoco_implicitfast", "MuJoCo, implicitfast"),
    ("mujoco_discrete", "MuJoCo, discrete, hard"),
];

/// Descriptions of the scenes in titles.
const SCENES: &[(&str, &str)] = &[
    ("rest", "a ball let go on taxels"),
    (
        "press",
        "a ball pressed on taxels with 0.5 m/s, held and taken off",
    ),
    ("stack_of_two", "two balls in a stack, let go on taxels"),
    ("stack_of_four", "four balls in a stack, let go on taxels"),
    ("plunger", "a plunger let go on SkinSim's taxels"),
];

/// Display names of the outcomes; their order determines the colours in all charts.
const OUTCOMES: &[(&str, &str)] = &[
    ("right", "right"),
    ("inaccurate", "inaccurate"),
    ("missed_contact", "missed contact"),
    ("energy_growth", "energy grows"),
    ("not_finite", "not finite"),
];

row! {
/// Configuration of a simulation. Each row of `stability.csv` and `timing.csv` begins with these columns.
pub struct StabilityConfiguration {
    /// Number of the part of the study (a table `[[stability.parts]]`), from 1.
    part: usize => Subject "part": Linear;
    /// Scene that is simulated.
    scene: StabilityScene => Condition;
    /// Method that simulates the contact.
    method: ContactMethod => Choice named METHODS;
    /// Number of iterations of an engine's contact solver per step; empty for methods without such a solver.
    solver_iterations: Option<usize> => Choice: Linear;
    /// Number of taxels along a side of the square array.
    taxels: usize => Condition "taxels a side": Linear;
    /// Stiffness k of a taxel, N/m.
    stiffness_n_per_m: f64 => Condition "taxel stiffness" in "N/m": Log;
    /// Mass m of a taxel, kg.
    taxel_mass_kg: f64 => Condition "taxel mass" in "kg": Log;
    /// Mass M of a free ball, kg; empty if the ball's motion is imposed.
    object_mass_kg: Option<f64> => Condition "mass of the ball" in "kg": Log;
    /// Duration Δt of a time step, s.
    dt_s: f64 => Choice "time step" in "s": Log;
} }

impl StabilityConfiguration {
    /// Returns the number of taxels of the square array.
    pub fn n_taxels(&self) -> usize {
        self.taxels * self.taxels
    }
}

row! {
/// Accuracy and outcome of a simulation. A row of `stability.csv` is a [`StabilityConfiguration`] followed by a `StabilityScore`.
pub struct StabilityScore {
    /// Mass M of a free ball divided by the mass m of a taxel; empty if the ball's motion is imposed.
    mass_ratio: Option<f64> => Note "mass ratio, ball to taxel": Log;
    /// Largest stable time step 2 √(m / k) of an explicit method for a taxel of mass m on a spring of stiffness k without a damper, s.
    explicit_limit_s: f64 => Note "limit of an explicit spring" in "s": Log;
    /// Damping coefficient c of a taxel, N·s/m.
    damping_n_s_per_m: f64 => Note "taxel damping" in "N s/m": Log;
    /// Contact stiffness κ, N/m, of a method whose contact force is κ times the penetration; empty for other methods.
    contact_stiffness_n_per_m: Option<f64> => Note "contact stiffness" in "N/m": Log;
    /// Outcome of the simulation: a correct result, or the kind of failure.
    outcome: Outcome => Outcome named OUTCOMES;
    /// Relative error of the total contact force, |Σ f − expected| / expected, where f are the forces of the taxels; empty if the simulation failed.
    #[serde(with = "any_number")]
    force_imbalance: Option<f64> => Value(Less): Log;
    /// Relative deflection error Σ |δ − δ*| / Σ δ* of the computed deflections δ with respect to the exact δ*; empty if the simulation failed.
    #[serde(with = "any_number")]
    deflection_error: Option<f64> => Value(Less): Log;
    /// Number of completed time steps.
    n_steps: usize => Note "steps": Log;
    /// Simulated time, s; empty if the method does not step through time.
    simulated_s: Option<f64> => Note "simulated time" in "s": Log;
} }

row! {
/// Computing time of a simulation. A row of `timing.csv` is a [`StabilityConfiguration`] followed by a `StabilityTime`.
pub struct StabilityTime {
    /// Wall-clock time of the whole simulation, s, on one thread while other threads run other simulations.
    wall_s: f64 => Cost "time" in "s": Log;
    /// Wall-clock time divided by simulated time; empty if the method has no time steps.
    per_simulated_s: Option<f64> => Cost "computing a simulated second" in "s": Log;
} }

row! {
/// Results of a method in a scene, summarised over all configurations: a row of `stability_summary.csv`.
pub struct StabilitySummary {
    /// Scene that is simulated.
    scene: StabilityScene => Condition;
    /// Method that simulates the contact.
    method: ContactMethod => Choice named METHODS;
    /// Number of iterations of an engine's contact solver per step; empty for methods without such a solver.
    solver_iterations: Option<usize> => Choice: Linear;
    /// Number of simulated configurations of the method in the scene.
    n_configurations: usize => Note "configurations": Linear;
    /// Number of configurations whose result is correct.
    n_correct: usize => Value(More) "right": Linear;
    /// Number of configurations whose simulation ended with an inaccurate result.
    n_inaccurate: usize => Value(Less) "inaccurate": Linear;
    /// Number of configurations in which the simulation missed the contact.
    n_missed_contact: usize => Value(Less) "missed contact": Linear;
    /// Number of configurations in which the simulated energy grew beyond its limit.
    n_energy_growth: usize => Value(Less) "energy growth": Linear;
    /// Number of configurations in which the simulation produced infinite or NaN values.
    n_not_finite: usize => Value(Less) "not finite": Linear;
    /// Largest `force_imbalance` of the configurations whose simulation succeeded; empty if all failed.
    worst_force_imbalance: Option<f64> => Value(Less): Log;
    /// Largest `deflection_error` of the configurations whose simulation succeeded; empty if all failed.
    worst_deflection_error: Option<f64> => Value(Less): Log;
} }

row! {
/// Cost of simulating a ball that moves only vertically on growing arrays with equal loads per taxel: a row of `joints.csv`.
pub struct Joints {
    /// Method that simulates the contact.
    method: ContactMethod => Choice named METHODS;
    /// Number of iterations of an engine's contact solver per step; empty for methods without such a solver.
    solver_iterations: Option<usize> => Choice: Linear;
    /// Mass m of a taxel, kg.
    taxel_mass_kg: f64 => Condition "taxel mass" in "kg": Log;
    /// Duration Δt of a time step, s.
    dt_s: f64 => Choice "time step" in "s": Log;
    /// Number of joints in the simulation, which is the number of taxels: each taxel is a body on a joint.
    joints: usize => Condition: Log;
    /// Load of a taxel, kg: the mass M of the ball divided by the number of taxels.
    load_kg: f64 => Note "load of a taxel" in "kg": Log;
    /// Outcome of the simulation: a correct result, or the kind of failure.
    outcome: Outcome => Outcome named OUTCOMES;
    /// Wall-clock time per second of simulated time, s. If the method does not step through time, total wall-clock time, s.
    time_s: f64 => Cost "computing a simulated second" in "s": Log;
} }

row! {
/// Outcome of a method in a scene that all methods of its part have computed, with words for the two axes of a map of outcomes.
pub struct CommonScene {
    /// Number of the part of the study (a table `[[stability.parts]]`), from 1.
    part: usize => Condition "part": Linear;
    /// Scene of the part.
    scene: String => Condition named SCENES;
    /// Method that simulates the contact, with its number of iterations if several are compared.
    method: String => Choice;
    /// Time step and taxel mass.
    step: String => Choice "time step, taxel mass";
    /// Stiffness, and the mass of the ball and the number of taxels if they vary.
    load: String => Condition "taxel stiffness, mass of the ball";
    /// Outcome of the simulation: a correct result, or the kind of failure.
    outcome: String => Outcome named OUTCOMES;
    /// Wall-clock time of the whole simulation, s.
    wall_s: f64 => Cost "time" in "s": Log;
} }

row! {
/// Number of correct results of a method in the scenes that all methods of a part have computed, with the time of a scene.
pub struct MethodScore {
    /// Number of the part of the study (a table `[[stability.parts]]`), from 1.
    part: usize => Condition "part": Linear;
    /// Scene of the part.
    scene: String => Condition named SCENES;
    /// Method that simulates the contact, with its number of iterations if several are compared.
    method: String => Choice;
    /// Number of scenes that all methods of the part have computed.
    n_scenes: usize => Note "scenes": Linear;
    /// Number of these scenes in which the result is correct.
    n_right: usize => Value(More) "scenes right, of the same": Linear;
    /// Median wall-clock time of a scene, s.
    median_s: f64 => Cost "time to compute a scene, median" in "s": Log;
} }

/// Configuration of a work item, with its result and computing time.
pub type StabilityRow = (StabilityConfiguration, StabilityScore, StabilityTime);

/// Last columns of a row of another program: parameters of the scene that a [`StabilityConfiguration`] leaves out, and the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeerColumns {
    /// Distance between neighbouring taxels, mm.
    pub pitch_mm: f64,
    /// Stroke of a taxel, mm.
    pub stroke_mm: f64,
    /// Name of the other program, such as MuJoCo.
    pub program: String,
    /// Version of the other program that computed the result.
    pub version: String,
    /// Date on which the other program computed the result, year-month-day.
    pub date: String,
}

/// Outcome of a simulation: right, or the kind of failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The force imbalance and the deflection error are at most [`TOLERANCE`].
    Right,
    /// The simulation ended, but the force imbalance or the deflection error exceeds [`TOLERANCE`].
    Inaccurate,
    /// The contact was missed: the sum of deflections is below half or above twice the exact sum, or nothing supports the ball.
    MissedContact,
    /// The energy of the simulation exceeds four times the energy that was supplied to the scene.
    EnergyGrowth,
    /// The simulated state contains an infinite or NaN value.
    NotFinite,
}

/// Largest force imbalance and deflection error of a correct simulation, dimensionless.
pub const TOLERANCE: f64 = 0.01;

pub(super) const CONFIGURATIONS: File<(StabilityConfiguration, StabilityScore)> =
    File::new("stability.csv", "Every configuration", "");
pub(super) const SUMMARY: File<StabilitySummary> = File::new(
    "stability_summary.csv",
    "Scenes and methods",
    "Right: force balance and deflections within 1 %. Imbalance, deflection: largest relative errors of finished runs.",
)
.summary();
pub(super) const TIMING: File<(StabilityConfiguration, StabilityTime)> =
    File::new("timing.csv", "Time of every configuration", "").of_times();
pub(super) const JOINTS: File<Joints> = File::new(
    "joints.csv",
    "Taxels on joints",
    "Plungers on SkinSim's springs and dampers with an equal load per taxel on all arrays. The quasi-static method has no time steps; its time is for the whole solution.",
)
.summary()
.of_times();
