//! The result tables of a reconstruction study: one plain struct a row, one field a column.

use crate::sensing::{Basis, Ensemble, Solver};
use crate::signal::NoiseUnit;
use serde::{Deserialize, Serialize};

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

/// All result tables of a reconstruction study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReconstructionTables {
    /// One row a cell.
    pub reconstruction: Vec<(ReconstructionCell, ReconstructionScore)>,
    /// One row a cell.
    pub timing: Vec<(ReconstructionCell, ReconstructionTime)>,
    /// One row a cell.
    pub pareto: Vec<(ReconstructionCell, ReconstructionPareto)>,
    /// One row an ensemble, m, dictionary and sparsity.
    pub ensembles: Vec<EnsembleStatistics>,
}
