//! Specification of a reconstruction study: the keys of its TOML file.

use crate::engine::axis::Axis;
use crate::inputs::defaults::count;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::inputs::schema_types::Names;
use crate::sensing::{Basis, Effort, Solver};
use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
use crate::studies::recognition::spec::signal::SignalSpec;
use crate::studies::recognition::spec::study::SensingSpec;
use crate::study_file::study_file;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

study_file! {
pub struct ReconstructionStudySpec {
    /// Table `[objects]`: the touched objects.
    pub objects: ObjectsSpec,
    /// Table `[skin]`: a single array of taxels.
    pub skin: SkinSpec,
    /// Table `[touches]`: poses and depths of the touches.
    pub touches: TouchesSpec,
    /// Table `[signal]`: noise and processing of frames before compression. Smoothing is not allowed.
    #[serde(default)]
    pub signal: SignalSpec,
    /// Table `[sensing]`: compression of frames into measurements.
    pub sensing: SensingSpec,
    /// Table `[reconstruction]`: solvers and dictionaries that reconstruct frames.
    pub reconstruction: ReconstructionSpec,
} }

/// Keys of `[reconstruction]`: solvers and dictionaries that reconstruct frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReconstructionSpec {
    /// Axis: solver for the dictionary coefficients of a frame: `omp` (matching pursuit), `l1` (ℓ1 minimisation) or `lmmse` (linear estimation).
    #[schemars(with = "Axis<Names<Solver>>")]
    pub solver: Axis<Solver>,
    /// Axis: dictionary (set of atoms that represent frames), `dct`, `haar`, `daubechies4` or `pca`.
    #[schemars(with = "Axis<Names<Basis>>")]
    pub dictionary: Axis<Basis>,
    /// Maximum number of atoms of a dictionary, at least 2. The atoms with the most energy in the training frames are used. Default: all, or 256 for PCA.
    pub atoms: Option<usize>,
    /// Maximum number of atoms per frame that matching pursuit may select, at least 1. Default: 128.
    #[serde(default = "default_most_atoms")]
    pub most_atoms: usize,
    /// Regularisation parameter λ of the ℓ1 problem, as a multiple of the universal threshold σ a √(2 ln k), positive. Here σ is the noise standard deviation,
    /// a the root mean square norm of the columns of ΦΨ, and k the number of atoms. σ is at least 0.001 of the root mean square of the training frames.
    /// Default: 0.3.
    #[serde(default = "default_lambda_scale")]
    pub lambda_scale: f64,
    /// Duality gap at which the ℓ1 solver stops, relative to the minimised objective, positive. Default: 0.01.
    #[serde(default = "default_tolerance")]
    pub tolerance: f64,
    /// Maximum number of steps of the ℓ1 solver per frame, at least 1. `n_capped` counts the frames that need more, as frames without noise may do. Default:
    /// 2000.
    #[serde(default = "default_most_steps")]
    pub most_steps: usize,
    /// Fraction of the touches that are held out for testing, between 0 and 1. Default: 0.25.
    #[serde(default = "default_test_fraction")]
    pub test_fraction: f64,
    /// Axis: number of atoms in each randomly drawn set (support) for which isometry statistics are computed. Default: 8 and 32.
    #[serde(default = "default_isometry_sparsity")]
    pub isometry_sparsity: Axis<usize>,
    /// Number of randomly drawn sets of atoms (supports) for each size in `isometry_sparsity`, at least 1. Default: 200.
    #[serde(default = "count::<200>")]
    pub isometry_subsets: usize,
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

fn default_most_atoms() -> usize {
    Effort::default().most_atoms
}

fn default_lambda_scale() -> f64 {
    Effort::default().lambda_scale
}

fn default_tolerance() -> f64 {
    Effort::default().tolerance
}

fn default_most_steps() -> usize {
    Effort::default().most_steps
}

fn default_test_fraction() -> f64 {
    0.25
}

fn default_isometry_sparsity() -> Axis<usize> {
    Axis::Many(vec![8, 32])
}
