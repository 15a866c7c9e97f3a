//! The result tables of a reconstruction study: one plain struct a row, one field a column.

use crate::row;
use crate::sensing::{Basis, Ensemble, Solver};
use crate::signal::NoiseUnit;

/// What people call ensembles, dictionaries and solvers.
const ENSEMBLES: &[(&str, &str)] = &[("sbhe", "SBHE"), ("gaussian", "Gaussian")];
const DICTIONARIES: &[(&str, &str)] = &[
    ("dct", "DCT"),
    ("haar", "Haar"),
    ("daubechies4", "Daubechies 4"),
    ("pca", "PCA"),
];
const SOLVERS: &[(&str, &str)] = &[("omp", "OMP"), ("l1", "ℓ1"), ("lmmse", "LMMSE")];

row! {
/// The settings of one cell: every axis at one value.
pub struct ReconstructionCell {
    /// Number of the cell, from 0.
    cell: usize => Note: Linear;
    /// Noise standard deviation on each taxel, in `noise_unit`.
    noise_std: f64 => Condition "noise": Linear;
    /// What `noise_std` is measured in.
    noise_unit: NoiseUnit => Note;
    /// How measurements are made.
    ensemble: Ensemble => Choice named ENSEMBLES;
    /// Measurements a touch, m.
    measurements: usize => Choice "measurements": Log;
    /// Compression ratio n / m.
    ratio: f64 => Choice "compression" in ":1": Log;
    /// What frames are made of.
    dictionary: Basis => Choice named DICTIONARIES;
    /// Atoms of the dictionary.
    atoms: usize => Note "atoms of the dictionary": Linear;
    /// How coefficients are found.
    solver: Solver => Choice named SOLVERS;
} }

impl ReconstructionCell {
    /// What it is called as a work item: by its settings, since its number is another where an axis has more values.
    pub(super) fn name(&self) -> String {
        format!(
            "{:?} in {:?} of {:?}, m = {}, noise {} {:?}",
            self.solver,
            self.dictionary,
            self.ensemble,
            self.measurements,
            self.noise_std,
            self.noise_unit
        )
    }

    /// What the isometry of a dictionary through the same measurements is called.
    pub(super) fn isometry_name(&self, basis: Basis) -> String {
        let (ensemble, m) = (self.ensemble, self.measurements);
        format!("isometry of {ensemble:?}, m = {m}, {basis:?}")
    }
}

row! {
/// How well a cell's test frames came back (with the [`ReconstructionCell`] before it: a row of `reconstruction.csv`).
pub struct ReconstructionScore {
    /// Test frames.
    n_frames: usize => Note "test frames": Linear;
    /// √(Σ‖x̂ − x‖² / Σ‖x‖²) over test frames x without noise.
    error: f64 => Value(Less): Log between [error_low, error_high];
    /// Lower end of the 95 % interval of `error` over touches.
    error_low: f64 => Note "95 % interval over touches, lower end": Log;
    /// Upper end of it.
    error_high: f64 => Note "95 % interval over touches, upper end": Log;
    /// The same error of the noisy frames themselves: all taxels read, nothing compressed.
    full_sampling_error: f64 => Note: Log;
    /// −20 log₁₀ `error`, dB.
    snr_db: f64 => Value(More) "SNR" in "dB": Linear;
    /// 20 log₁₀ (full scale / root mean square error of a taxel), dB.
    psnr_db: f64 => Value(More) "peak SNR" in "dB": Linear;
    /// Coefficients that are not zero, mean over frames.
    atoms_used: f64 => Note "atoms used": Linear;
    /// Frames whose solver stopped at its limit of atoms or steps.
    n_capped: usize => Note "capped frames": Linear;
} }

row! {
/// What a cell cost (with the [`ReconstructionCell`] before it: a row of `timing.csv`).
pub struct ReconstructionTime {
    /// Seconds to prepare the solver, the dictionary as measured not included.
    prepare_s: f64 => Cost "time to prepare" in "s": Log;
    /// Microseconds a frame, one core, frames in blocks.
    us_per_frame: f64 => Cost "time of a frame" in "us": Log;
    /// Frames a second on one core.
    frames_per_s_per_core: f64 => Value(More) "frames a second on one core": Log;
} }

row! {
/// Error against time (with the [`ReconstructionCell`] before it: a row of `pareto.csv`).
pub struct ReconstructionPareto {
    /// As in `reconstruction.csv`.
    error: f64 => Value(Less): Log;
    /// As in `timing.csv`.
    us_per_frame: f64 => Cost "time of a frame on one core" in "us": Log;
    /// As in `timing.csv`.
    frames_per_s_per_core: f64 => Value(More) "frames a second on one core": Log;
    /// Whether no cell of the same noise is both faster and better.
    on_front: bool => Outcome "on the front";
} }

row! {
/// How well an ensemble keeps atoms apart: a row of `ensembles.csv`.
///
/// Squared singular values are of s columns of ΦΨ drawn at random, all columns scaled to a mean square norm of 1.
pub struct EnsembleStatistics {
    /// How measurements are made.
    ensemble: Ensemble => Choice named ENSEMBLES;
    /// m.
    measurements: usize => Choice: Log;
    /// n / m.
    ratio: f64 => Choice "compression" in ":1": Log;
    /// What frames are made of.
    dictionary: Basis => Choice named DICTIONARIES;
    /// k.
    atoms: usize => Note "atoms of the dictionary": Linear;
    /// Mutual coherence over the atoms that are not invisible.
    coherence: f64 => Value(Less) "mutual coherence": Share;
    /// The least that any as many columns in m dimensions have.
    welch_bound: f64 => Note "Welch bound": Share;
    /// Atoms that Φ maps to zero.
    n_invisible: usize => Note "invisible atoms": Linear;
    /// s, the atoms of a support.
    sparsity: usize => Condition: Linear;
    /// Supports drawn.
    n_subsets: usize => Note "supports drawn": Linear;
    /// Smallest σ²_min over supports.
    low_min: f64 => Value(More) "least σ²": Linear;
    /// Median σ²_min.
    low_median: f64 => Value(More) "median of the least σ²": Linear;
    /// Median σ²_max.
    high_median: f64 => Value(Less) "median of the largest σ²": Linear;
    /// Largest σ²_max.
    high_max: f64 => Value(Less) "largest σ²": Linear;
    /// Median of max(1 − σ²_min, σ²_max − 1).
    deviation_median: f64 => Value(Less) "median deviation": Linear;
    /// The largest: a lower bound on the isometry constant δₛ, whose exact value is NP-hard to compute.
    delta_lower_bound: f64 => Value(Less) "lower bound of δ": Linear;
} }

/// What came of a cell, and what it cost.
pub type ReconstructionRow = (ReconstructionCell, ReconstructionScore, ReconstructionTime);

/// Rows of work items: of cells, and of ensembles, m, dictionaries and sparsities.
pub type ReconstructionRows = (Vec<ReconstructionRow>, Vec<EnsembleStatistics>);
