//! Rows of the result tables of a reconstruction study: one plain struct for each kind of row, with one field per column.

use crate::row;
use crate::sensing::{Basis, Ensemble, Solver};
use crate::signal::NoiseUnit;

/// Display names of ensembles, dictionaries and solvers.
const ENSEMBLES: &[(&str, &str)] = &[("sbhe", "SBHE"), ("gaussian", "Gaussian")];
const DICTIONARIES: &[(&str, &str)] = &[
    ("dct", "DCT"),
    ("haar", "Haar"),
    ("daubechies4", "Daubechies 4"),
    ("pca", "PCA"),
];
const SOLVERS: &[(&str, &str)] = &[("omp", "OMP"), ("l1", "ℓ1"), ("lmmse", "LMMSE")];

row! {
/// Configuration of a reconstruction study: one value of every axis.
pub struct ReconstructionConfiguration {
    /// Number of the configuration in sweep order, from 0.
    configuration: usize => Note: Linear;
    /// Noise standard deviation on each taxel, in `noise_unit`.
    noise_std: f64 => Condition "noise": Linear;
    /// Unit of `noise_std`: fraction of full scale, mm or N.
    noise_unit: NoiseUnit => Note;
    /// Ensemble of the measurement matrix.
    ensemble: Ensemble => Choice named ENSEMBLES;
    /// Number m of measurements per frame.
    measurements: usize => Choice "measurements": Log;
    /// Compression ratio n / m: taxels per measurement.
    ratio: f64 => Choice "compression" in ":1": Log;
    /// Dictionary in which the frames are sparse.
    dictionary: Basis => Choice named DICTIONARIES;
    /// Number of atoms of the dictionary.
    atoms: usize => Note "atoms of the dictionary": Linear;
    /// Solver that computes the coefficients of a frame.
    solver: Solver => Choice named SOLVERS;
} }

impl ReconstructionConfiguration {
    /// Returns the name of the configuration's work item. The name contains the settings, because the number changes if an axis has more values.
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

    /// Returns the name of the work item that computes a dictionary's isometry statistics with the same measurements.
    pub(super) fn isometry_name(&self, basis: Basis) -> String {
        let (ensemble, m) = (self.ensemble, self.measurements);
        format!("isometry of {ensemble:?}, m = {m}, {basis:?}")
    }
}

row! {
/// Reconstruction error of a configuration. A row of `reconstruction.csv` is a [`ReconstructionConfiguration`] followed by a `ReconstructionScore`.
pub struct ReconstructionScore {
    /// Number of test frames that were reconstructed.
    n_frames: usize => Note "test frames": Linear;
    /// Relative error √(Σ‖x̂ − x‖² / Σ‖x‖²) of the reconstructed frames x̂ with respect to the clean test frames x, dimensionless.
    error: f64 => Value(Less): Log between [error_low, error_high];
    /// Lower end of the 95 % interval of `error` over touches.
    error_low: f64 => Note "95 % interval over touches, lower end": Log;
    /// Upper end of the 95 % interval of `error` over touches.
    error_high: f64 => Note "95 % interval over touches, upper end": Log;
    /// Relative error of the noisy frames without compression (all taxels are read), dimensionless.
    full_sampling_error: f64 => Note: Log;
    /// Signal-to-noise ratio of the reconstruction, −20 log₁₀ `error`, dB.
    snr_db: f64 => Value(More) "SNR" in "dB": Linear;
    /// Peak signal-to-noise ratio 20 log₁₀ (full scale / root mean square error of a taxel), dB.
    psnr_db: f64 => Value(More) "peak SNR" in "dB": Linear;
    /// Number of non-zero coefficients per frame, averaged over frames.
    atoms_used: f64 => Note "atoms used": Linear;
    /// Number of frames for which the solver stopped at its limit of atoms or steps.
    n_capped: usize => Note "capped frames": Linear;
} }

row! {
/// Computing time of a configuration. A row of `timing.csv` is a [`ReconstructionConfiguration`] followed by a `ReconstructionTime`.
pub struct ReconstructionTime {
    /// Time to prepare the solver, s, without the computation of ΦΨ.
    prepare_s: f64 => Cost "time to prepare" in "s": Log;
    /// Reconstruction time per frame on one core, µs; frames are processed in blocks.
    us_per_frame: f64 => Cost "time of a frame" in "us": Log;
    /// Number of frames reconstructed per second on one core.
    frames_per_s_per_core: f64 => Value(More) "frames a second on one core": Log;
} }

row! {
/// Error and computing time of a configuration. A row of `pareto.csv` is a [`ReconstructionConfiguration`] followed by a `ReconstructionPareto`.
pub struct ReconstructionPareto {
    /// Relative reconstruction error, as in `reconstruction.csv`.
    error: f64 => Value(Less): Log;
    /// Reconstruction time per frame on one core, µs, as in `timing.csv`.
    us_per_frame: f64 => Cost "time of a frame on one core" in "us": Log;
    /// Number of frames reconstructed per second on one core, as in `timing.csv`.
    frames_per_s_per_core: f64 => Value(More) "frames a second on one core": Log;
    /// Whether the configuration is on the Pareto front: no other one with the same noise is both faster and more accurate.
    on_front: bool => Outcome "on the front";
} }

row! {
/// Isometry statistics of an ensemble and a dictionary: a row of `ensembles.csv`.
///
/// The statistics are squared singular values of s randomly drawn columns of ΦΨ; all columns are scaled to a mean square norm of 1.
pub struct EnsembleStatistics {
    /// Ensemble of the measurement matrix.
    ensemble: Ensemble => Choice named ENSEMBLES;
    /// Number m of measurements per frame.
    measurements: usize => Choice: Log;
    /// Compression ratio n / m: taxels per measurement.
    ratio: f64 => Choice "compression" in ":1": Log;
    /// Dictionary in which the frames are sparse.
    dictionary: Basis => Choice named DICTIONARIES;
    /// Number k of atoms of the dictionary.
    atoms: usize => Note "atoms of the dictionary": Linear;
    /// Mutual coherence over all atoms that Φ does not map to zero, 0 to 1.
    coherence: f64 => Value(Less) "mutual coherence": Share;
    /// Welch bound: the smallest possible mutual coherence of this number of columns in m dimensions.
    welch_bound: f64 => Note "Welch bound": Share;
    /// Number of atoms that Φ maps to zero.
    n_invisible: usize => Note "invisible atoms": Linear;
    /// Number s of atoms in each drawn support.
    sparsity: usize => Condition: Linear;
    /// Number of randomly drawn supports.
    n_subsets: usize => Note "supports drawn": Linear;
    /// Smallest σ²_min over all drawn supports.
    low_min: f64 => Value(More) "least σ²": Linear;
    /// Median of σ²_min over all drawn supports.
    low_median: f64 => Value(More) "median of the least σ²": Linear;
    /// Median of σ²_max over all drawn supports.
    high_median: f64 => Value(Less) "median of the largest σ²": Linear;
    /// Largest σ²_max over all drawn supports.
    high_max: f64 => Value(Less) "largest σ²": Linear;
    /// Median of max(1 − σ²_min, σ²_max − 1) over all drawn supports.
    deviation_median: f64 => Value(Less) "median deviation": Linear;
    /// Largest max(1 − σ²_min, σ²_max − 1) over all drawn supports: a lower bound on the isometry constant δₛ, whose exact value is NP-hard to compute.
    delta_lower_bound: f64 => Value(Less) "lower bound of δ": Linear;
} }

/// Configuration of a work item, with its score and computing time.
pub type ReconstructionRow = (
    ReconstructionConfiguration,
    ReconstructionScore,
    ReconstructionTime,
);

/// Rows of work items: configurations and isometry statistics.
pub type ReconstructionRows = (Vec<ReconstructionRow>, Vec<EnsembleStatistics>);
