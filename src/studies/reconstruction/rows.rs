//! Rows of the result tables of a reconstruction study: one plain struct for each kind of row, with one field per column.

use crate::sensing::Solver;
use crate::signal::NoiseUnit;
use crate::studies::prelude::*;

/// Display names of the ensembles (random measurement matrices), each preceded by the name in result tables.
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
    /// Noise standard deviation of each taxel's reading, in `noise_unit`.
    noise_std: f64 => Condition "noise" in "%": Share;
    /// Unit of `noise_std`: fraction of full scale, mm or N.
    noise_unit: NoiseUnit => Note "noise unit";
    /// Ensemble from which the measurement matrix is drawn.
    ensemble: Ensemble => Choice named ENSEMBLES;
    /// Number m of measurements per frame.
    measurements: usize => Choice "measurements": Log;
    /// Compression ratio n / m: number n of taxels divided by the number m of measurements.
    ratio: f64 => Choice "compression" in ":1": Log;
    /// Dictionary (set of atoms) in which frames are sparse: a frame is the sum of few atoms.
    dictionary: Basis => Choice named DICTIONARIES;
    /// Number of atoms that the dictionary has.
    atoms: usize => Note "atoms of the dictionary": Linear;
    /// Solver that computes the dictionary coefficients of a frame.
    solver: Solver => Choice named SOLVERS;
} }

impl ReconstructionConfiguration {
    /// Returns the name of the work item that computes the configuration. The name contains the settings, because the configuration's number changes if an axis
    /// has more values.
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

    /// Returns the name of the work item that computes the isometry statistics of a dictionary with the measurements of this configuration.
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
    /// Relative error √(Σ‖x̂ − x‖² / Σ‖x‖²) of the reconstructed frames x̂ with respect to the noise-free test frames x, dimensionless.
    error: f64 => Value(Less): Log between [error_low, error_high];
    /// Lower end of the 95 % interval of `error`, which covers its variation over touches.
    error_low: f64 => Note "95 % interval over touches, lower end": Log;
    /// Upper end of the 95 % interval of `error`, which covers its variation over touches.
    error_high: f64 => Note "95 % interval over touches, upper end": Log;
    /// Relative error √(Σ‖y − x‖² / Σ‖x‖²) of the noisy frames y with respect to the frames x without noise. The value is the error if all taxels are read
    /// without compression.
    full_sampling_error: f64 => Note: Log;
    /// Signal-to-noise ratio of the reconstructed frames, −20 log₁₀ `error`, dB.
    snr_db: f64 => Value(More) "SNR" in "dB": Linear;
    /// Peak signal-to-noise ratio of the reconstructed frames, 20 log₁₀ (full scale / root mean square error of a taxel), dB.
    psnr_db: f64 => Value(More) "peak SNR" in "dB": Linear;
    /// Number of non-zero coefficients of a reconstructed frame, averaged over frames.
    atoms_used: f64 => Note "atoms used": Linear;
    /// Number of frames for which the solver stopped at its maximum number of atoms or steps.
    n_capped: usize => Note "capped frames": Linear;
} }

row! {
/// Computing time of a configuration. A row of `timing.csv` is a [`ReconstructionConfiguration`] followed by a `ReconstructionTime`.
pub struct ReconstructionTime {
    /// Time to prepare the solver, s, without the time to multiply the measurement matrix by the dictionary.
    prepare_s: f64 => Cost "time to prepare" in "s": Log;
    /// Reconstruction time per frame on one core, µs, for frames that are reconstructed in blocks.
    us_per_frame: f64 => Cost "time of a frame" in "us": Log;
    /// Number of frames reconstructed per second on one core.
    frames_per_s_per_core: f64 => Value(More) "frames a second on one core": Log;
} }

row! {
/// Error and computing time of a configuration. A row of `pareto.csv` is a [`ReconstructionConfiguration`] followed by a `ReconstructionPareto`.
pub struct ReconstructionPareto {
    /// Relative reconstruction error, dimensionless; the value of the column `error` in `reconstruction.csv`.
    error: f64 => Value(Less): Log;
    /// Reconstruction time per frame on one core, µs; the value of the column `us_per_frame` in `timing.csv`.
    us_per_frame: f64 => Cost "time of a frame on one core" in "us": Log;
    /// Number of frames reconstructed per second on one core; the value of the column `frames_per_s_per_core` in `timing.csv`.
    frames_per_s_per_core: f64 => Value(More) "frames a second on one core": Log;
    /// Whether the configuration is on the Pareto front. On the front, no other configuration with equal noise is at least as fast and as accurate, and better
    /// in one of the two.
    on_front: bool => Outcome "on the front";
} }

row! {
/// Isometry statistics of an ensemble and a dictionary: a row of `ensembles.csv`. A support is a randomly drawn set of s atoms.
///
/// For each support, σ_min and σ_max are the smallest and largest singular values of the matrix of its s measured atoms. A measured atom is an atom multiplied
/// by the measurement matrix. All measured atoms are scaled to a mean square norm of 1.
pub struct EnsembleStatistics {
    /// Ensemble from which the measurement matrix is drawn.
    ensemble: Ensemble => Choice named ENSEMBLES;
    /// Number m of measurements per frame.
    measurements: usize => Choice: Log;
    /// Compression ratio n / m: number n of taxels divided by the number m of measurements.
    ratio: f64 => Choice "compression" in ":1": Log;
    /// Dictionary (set of atoms) in which frames are sparse: a frame is the sum of few atoms.
    dictionary: Basis => Choice named DICTIONARIES;
    /// Number k of atoms that the dictionary has.
    atoms: usize => Note "atoms of the dictionary": Linear;
    /// Mutual coherence of the measured atoms, 0 to 1: the largest absolute cosine of the angle between two atoms. Atoms that the measurement matrix maps to
    /// zero are excluded.
    coherence: f64 => Value(Less) "mutual coherence": Share;
    /// Welch bound, 0 to 1: the smallest possible mutual coherence of this number of atoms with m measurements.
    welch_bound: f64 => Note "Welch bound": Share;
    /// Number of atoms that the measurement matrix Φ maps to zero.
    n_invisible: usize => Note "invisible atoms": Linear;
    /// Number s of atoms in each randomly drawn set of atoms (support).
    sparsity: usize => Condition: Linear;
    /// Number of randomly drawn sets of atoms (supports) of this size.
    n_subsets: usize => Note "supports drawn": Linear;
    /// Smallest value of σ²_min over all drawn sets of atoms (supports). Here σ_min is the smallest singular value of the matrix of a set's measured atoms.
    low_min: f64 => Value(More) "least σ²": Linear;
    /// Median of σ²_min over all drawn sets of atoms (supports). Here σ_min is the smallest singular value of the matrix of a set's measured atoms.
    low_median: f64 => Value(More) "median of the least σ²": Linear;
    /// Median of σ²_max over all drawn sets of atoms (supports). Here σ_max is the largest singular value of the matrix of a set's measured atoms.
    high_median: f64 => Value(Less) "median of the largest σ²": Linear;
    /// Largest σ²_max over all drawn sets of atoms (supports). Here σ_max is the largest singular value of the matrix of a set's measured atoms.
    high_max: f64 => Value(Less) "largest σ²": Linear;
    /// Median deviation over all drawn sets of atoms (supports). The deviation is max(1 − σ²_min, σ²_max − 1) for the smallest and largest singular value of
    /// the matrix of a set's measured atoms.
    deviation_median: f64 => Value(Less) "median deviation": Linear;
    /// Largest deviation max(1 − σ²_min, σ²_max − 1) over all drawn sets of atoms. σ_min and σ_max are singular values of a set's measured atoms. The value
    /// is a lower bound on the isometry constant δₛ, whose exact value is NP-hard to compute.
    delta_lower_bound: f64 => Value(Less) "lower bound of δ": Linear;
} }

/// Name of the table of errors and times, which is not written to a file.
pub(super) const BOTH: &str = "configurations.csv";

/// Configuration of a work item, with its reconstruction error and computing time.
pub type ReconstructionRow = (
    ReconstructionConfiguration,
    ReconstructionScore,
    ReconstructionTime,
);

/// Results of all work items: the configurations with their errors and times, and the isometry statistics.
pub type ReconstructionRows = (Vec<ReconstructionRow>, Vec<EnsembleStatistics>);

pub(super) const CONFIGURATIONS: File<(ReconstructionConfiguration, ReconstructionScore)> =
    File::new(
        "reconstruction.csv",
        "Every configuration",
        "Errors are relative to the clean frames: 0 is perfect, 1 is as wrong as an empty frame.",
    );
pub(super) const ISOMETRY: File<EnsembleStatistics> = File::new(
    "ensembles.csv",
    "Isometry of ensembles and dictionaries",
    "Squared singular values of supports drawn at random, whose columns have a mean square norm of 1.",
);
pub(super) const TIMING: File<(ReconstructionConfiguration, ReconstructionTime)> =
    File::new("timing.csv", "Time of every configuration", "").of_times();
pub(super) const PARETO: File<(ReconstructionConfiguration, ReconstructionPareto)> = File::new(
    "pareto.csv",
    "Error and time of every configuration",
    "One core, frames in blocks of 64.",
)
.summary()
.of_times();
