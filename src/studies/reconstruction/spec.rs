//! Specification of a reconstruction study: the keys of its TOML file.

use crate::engine::axis::Axis;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::inputs::params::{named, params};
use crate::inputs::range::COUNT;
use crate::inputs::range::Range::{Any, Count, Part, Positive};
use crate::sensing::{Basis, Effort, Solver};
use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
use crate::studies::recognition::spec::signal::SignalSpec;
use crate::studies::recognition::spec::study::SensingSpec;
use crate::study_file::study_file;

study_file! {
pub struct ReconstructionStudySpec {
    /// Table `[objects]`: the touched objects.
    objects: ObjectsSpec;
    /// Table `[skin]`: a single array of taxels.
    skin: SkinSpec;
    /// Table `[touches]`: poses and depths of the touches.
    touches: TouchesSpec;
    /// Table `[signal]`: noise and processing of frames before compression. Smoothing is not allowed.
    signal: SignalSpec = SignalSpec::default();
    /// Table `[sensing]`: compression of frames into measurements.
    sensing: SensingSpec;
    /// Table `[reconstruction]`: solvers and dictionaries that reconstruct frames.
    reconstruction: ReconstructionSpec;
} }

/// Maximum value of the key `isometry_subsets`, the number of randomly drawn sets of atoms (supports) per size. All drawn supports are in memory together.
const MAX_SUBSETS: usize = 1_000_000;

/// Maximum value of the key `atoms` (number of atoms of a dictionary), more than any array has taxels. The minimum is two, because λ = √(2 ln k) vanishes for k
/// = 1 atom.
const MAX_ATOMS: usize = 100_000_000;

named!(Solver, Basis);

params! {
    /// Keys of `[reconstruction]`: solvers and dictionaries that reconstruct frames.
    pub struct ReconstructionSpec {
        /// Axis: solver for the dictionary coefficients of a frame: `omp` (matching pursuit), `l1` (ℓ1 minimisation) or `lmmse` (linear estimation).
        solver: Axis<Solver> => Any, Choice, Table;
        /// Axis: dictionary (set of atoms that represent frames), `dct`, `haar`, `daubechies4` or `pca`.
        dictionary: Axis<Basis> => Any, Choice, Table;
        /// Maximum number of atoms of a dictionary, at least 2. The atoms with the most energy in the training frames are used. Default: all, or 256 for PCA.
        atoms: Option<usize> => Count(2, MAX_ATOMS), Choice, Never;
        /// Maximum number of atoms per frame that matching pursuit may select, at least 1. Default: 128.
        most_atoms: usize = Effort::default().most_atoms => COUNT, Choice, Never;
        /// Regularisation parameter λ of the ℓ1 problem, as a multiple of the universal threshold σ a √(2 ln k), positive. Here σ is the noise standard deviation,
        /// a the root mean square norm of the columns of ΦΨ, and k the number of atoms. σ is at least 0.001 of the root mean square of the training frames.
        /// Default: 0.3.
        lambda_scale: f64 = Effort::default().lambda_scale => Positive, Choice, Never;
        /// Duality gap at which the ℓ1 solver stops, relative to the minimised objective, positive. Default: 0.01.
        tolerance: f64 = Effort::default().tolerance => Positive, Choice, Never;
        /// Maximum number of steps of the ℓ1 solver per frame, at least 1. `n_capped` counts the frames that need more, as frames without noise may do. Default:
        /// 2000.
        most_steps: usize = Effort::default().most_steps => COUNT, Choice, Never;
        /// Fraction of the touches that are held out for testing, between 0 and 1. Default: 0.25.
        test_fraction: f64 = 0.25 => Part, Condition, Never;
        /// Axis: number of atoms in each randomly drawn set (support) for which isometry statistics are computed. Default: 8 and 32.
        isometry_sparsity: Axis<usize> = Axis::Many(vec![8, 32]) => COUNT, Condition, Table;
        /// Number of randomly drawn sets of atoms (supports) for each size in `isometry_sparsity`, at least 1. Default: 200.
        isometry_subsets: usize = 200 => Count(1, MAX_SUBSETS), Note, Never;
    }
}

impl ReconstructionSpec {
    /// Returns the limits of the solvers: atoms, regularisation, tolerance and steps.
    pub fn effort(&self) -> Effort {
        Effort {
            most_atoms: self.most_atoms,
            lambda_scale: self.lambda_scale,
            tolerance: self.tolerance,
            most_steps: self.most_steps,
        }
    }
}
