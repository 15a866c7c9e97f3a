//! The result tables of a reconstruction study: one plain struct a row, one field a column.

use crate::columns;
use crate::kinds::names::ENSEMBLES;
use crate::sensing::{Basis, Ensemble, Solver};
use crate::signal::NoiseUnit;
use serde::{Deserialize, Serialize};

/// What people call ensembles, dictionaries and solvers.
const DICTIONARIES: &[(&str, &str)] = &[
    ("dct", "DCT"),
    ("haar", "Haar"),
    ("daubechies4", "Daubechies 4"),
    ("pca", "PCA"),
];
const SOLVERS: &[(&str, &str)] = &[("omp", "OMP"), ("l1", "ℓ1"), ("lmmse", "LMMSE")];

columns! { ReconstructionCell {
    cell: Note: Linear;
    noise_std: Condition "noise": Linear;
    noise_unit: Note;
    ensemble: Choice named ENSEMBLES;
    measurements: Choice "measurements": Log;
    ratio: Choice "compression" in ":1": Log;
    dictionary: Choice named DICTIONARIES;
    atoms: Note "atoms of the dictionary": Linear;
    solver: Choice named SOLVERS;
} }
columns! { ReconstructionScore {
    n_frames: Note "test frames": Linear;
    error: Value(Less): Log between [error_low, error_high];
    error_low: Note "95 % interval over touches, lower end": Log;
    error_high: Note "95 % interval over touches, upper end": Log;
    full_sampling_error: Note: Log;
    snr_db: Value(More) "SNR" in "dB": Linear;
    psnr_db: Value(More) "peak SNR" in "dB": Linear;
    atoms_used: Note "atoms used": Linear;
    n_capped: Note "capped frames": Linear;
} }
columns! { ReconstructionTime {
    prepare_s: Cost "time to prepare" in "s": Log;
    us_per_frame: Cost "time of a frame" in "us": Log;
    frames_per_s_per_core: Value(More) "frames a second on one core": Log;
} }
columns! { ReconstructionPareto {
    error: Value(Less): Log;
    us_per_frame: Cost "time of a frame on one core" in "us": Log;
    frames_per_s_per_core: Value(More) "frames a second on one core": Log;
    on_front: Outcome "on the front";
} }
columns! { ReconstructionBest {
    error: Value(Less): Log between [error_low, error_high];
    error_low: Note "95 % interval over touches, lower end": Log;
    error_high: Note "95 % interval over touches, upper end": Log;
    full_sampling_error: Note: Log;
    frames_per_s_per_core: Value(More) "frames a second on one core": Log;
} }
columns! { EnsembleStatistics {
    ensemble: Choice named ENSEMBLES;
    measurements: Choice: Log;
    ratio: Choice "compression" in ":1": Log;
    dictionary: Choice named DICTIONARIES;
    atoms: Note "atoms of the dictionary": Linear;
    coherence: Value(Less) "mutual coherence": Share;
    welch_bound: Note "Welch bound": Share;
    n_invisible: Note "invisible atoms": Linear;
    sparsity: Condition: Linear;
    n_subsets: Note "supports drawn": Linear;
    low_min: Value(More) "least σ²": Linear;
    low_median: Value(More) "median of the least σ²": Linear;
    high_median: Value(Less) "median of the largest σ²": Linear;
    high_max: Value(Less) "largest σ²": Linear;
    deviation_median: Value(Less) "median deviation": Linear;
    delta_lower_bound: Value(Less) "lower bound of δ": Linear;
} }

/// The settings of one cell: every axis at one value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReconstructionCell {
    /// Number of the cell, from 0.
    pub cell: usize,
    /// Noise standard deviation on each taxel, in `noise_unit`.
    pub noise_std: f64,
    /// What `noise_std` is measured in.
    pub noise_unit: NoiseUnit,
    /// How measurements are made.
    pub ensemble: Ensemble,
    /// Measurements a touch, m.
    pub measurements: usize,
    /// Compression ratio n / m.
    pub ratio: f64,
    /// What frames are made of.
    pub dictionary: Basis,
    /// Atoms of the dictionary.
    pub atoms: usize,
    /// How coefficients are found.
    pub solver: Solver,
}

impl ReconstructionCell {
    /// What it is called as a work item: by its settings, since its number is another where an axis has more values.
    pub(super) fn name(&self) -> String {
        let Self {
            noise_std,
            noise_unit,
            ensemble,
            measurements: m,
            dictionary,
            solver,
            ..
        } = self;
        format!(
            "{solver:?} in {dictionary:?} of {ensemble:?}, m = {m}, noise {noise_std} {noise_unit:?}"
        )
    }

    /// What the isometry of a dictionary through the same measurements is called.
    pub(super) fn isometry_name(&self, basis: Basis) -> String {
        let (ensemble, m) = (self.ensemble, self.measurements);
        format!("isometry of {ensemble:?}, m = {m}, {basis:?}")
    }
}

/// How well a cell's test frames came back (with the [`ReconstructionCell`] before it: a row of `reconstruction.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReconstructionScore {
    /// Test frames.
    pub n_frames: usize,
    /// √(Σ‖x̂ − x‖² / Σ‖x‖²) over test frames x without noise.
    pub error: f64,
    /// Lower end of the 95 % interval of `error` over touches.
    pub error_low: f64,
    /// Upper end of it.
    pub error_high: f64,
    /// The same error of the noisy frames themselves: all taxels read, nothing compressed.
    pub full_sampling_error: f64,
    /// −20 log₁₀ `error`, dB.
    pub snr_db: f64,
    /// 20 log₁₀ (full scale / root mean square error of a taxel), dB.
    pub psnr_db: f64,
    /// Coefficients that are not zero, mean over frames.
    pub atoms_used: f64,
    /// Frames whose solver stopped at its limit of atoms or steps.
    pub n_capped: usize,
}

/// What a cell cost (with the [`ReconstructionCell`] before it: a row of `timing.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReconstructionTime {
    /// Seconds to prepare the solver, the dictionary as measured not included.
    pub prepare_s: f64,
    /// Microseconds a frame, one core, frames in blocks.
    pub us_per_frame: f64,
    /// Frames a second on one core.
    pub frames_per_s_per_core: f64,
}

/// Error against time (with the [`ReconstructionCell`] before it: a row of `pareto.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReconstructionPareto {
    /// As in `reconstruction.csv`.
    pub error: f64,
    /// As in `timing.csv`.
    pub us_per_frame: f64,
    /// As in `timing.csv`.
    pub frames_per_s_per_core: f64,
    /// Whether no cell of the same noise is both faster and better.
    pub on_front: bool,
}

/// How well an ensemble keeps atoms apart: a row of `ensembles.csv`.
///
/// Squared singular values are of s columns of ΦΨ drawn at random, all columns scaled to a mean square norm of 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnsembleStatistics {
    /// How measurements are made.
    pub ensemble: Ensemble,
    /// m.
    pub measurements: usize,
    /// n / m.
    pub ratio: f64,
    /// What frames are made of.
    pub dictionary: Basis,
    /// k.
    pub atoms: usize,
    /// Mutual coherence over the atoms that are not invisible.
    pub coherence: f64,
    /// The least that any as many columns in m dimensions have.
    pub welch_bound: f64,
    /// Atoms that Φ maps to zero.
    pub n_invisible: usize,
    /// s, the atoms of a support.
    pub sparsity: usize,
    /// Supports drawn.
    pub n_subsets: usize,
    /// Smallest σ²_min over supports.
    pub low_min: f64,
    /// Median σ²_min.
    pub low_median: f64,
    /// Median σ²_max.
    pub high_median: f64,
    /// Largest σ²_max.
    pub high_max: f64,
    /// Median of max(1 − σ²_min, σ²_max − 1).
    pub deviation_median: f64,
    /// The largest: a lower bound on the isometry constant δₛ, whose exact value is NP-hard to compute.
    pub delta_lower_bound: f64,
}

/// The best of a noise level, m and solver (with the [`ReconstructionCell`] before it: a row of `best.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReconstructionBest {
    /// As in `reconstruction.csv`.
    pub error: f64,
    /// As in `reconstruction.csv`.
    pub error_low: f64,
    /// As in `reconstruction.csv`.
    pub error_high: f64,
    /// As in `reconstruction.csv`.
    pub full_sampling_error: f64,
    /// As in `timing.csv`.
    pub frames_per_s_per_core: f64,
}

/// Rows of work items.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReconstructionRows {
    /// One a cell.
    pub reconstruction: Vec<(ReconstructionCell, ReconstructionScore)>,
    /// One a cell.
    pub timing: Vec<(ReconstructionCell, ReconstructionTime)>,
    /// One an ensemble, m, dictionary and sparsity.
    pub ensembles: Vec<EnsembleStatistics>,
}
