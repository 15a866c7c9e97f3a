//! Specification of a reconstruction study: the keys of its TOML file.

use crate::engine::axis::Axis;
use crate::inputs::defaults::count;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::sensing::{Basis, Effort, Solver};
use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
use crate::studies::recognition::spec::signal::SignalSpec;
use crate::studies::recognition::spec::study::SensingSpec;
use crate::study_file::study_file;
use serde::{Deserialize, Serialize};

study_file! {
pub struct ReconstructionStudySpec {
    /// Touched objects.
    pub objects: ObjectsSpec,
    /// The skin, a single array.
    pub skin: SkinSpec,
    /// The touches.
    pub touches: TouchesSpec,
    /// Processing of a frame before it is compressed; smoothing is not allowed.
    #[serde(default)]
    pub signal: SignalSpec,
    /// Compression of a frame.
    pub sensing: SensingSpec,
    /// Reconstruction of a frame.
    pub reconstruction: ReconstructionSpec,
} }

/// `[reconstruction]`: solvers and dictionaries that reconstruct frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReconstructionSpec {
    /// Axis: solver of the coefficients, `omp`, `l1` or `lmmse`.
    pub solver: Axis<Solver>,
    /// Axis: dictionary, `dct`, `haar`, `daubechies4` or `pca`.
    pub dictionary: Axis<Basis>,
    /// Largest number of atoms of a dictionary; the atoms with the most energy in the training frames are kept. Default: all, or 256 for PCA.
    pub atoms: Option<usize>,
    /// Largest number of atoms that matching pursuit may select per frame.
    #[serde(default = "default_most_atoms")]
    pub most_atoms: usize,
    /// Regularisation λ of the ℓ1 problem, as a multiple of the universal threshold σ a √(2 ln k).
    #[serde(default = "default_lambda_scale")]
    pub lambda_scale: f64,
    /// Relative duality gap at which the ℓ1 solver stops.
    #[serde(default = "default_tolerance")]
    pub tolerance: f64,
    /// Largest number of steps of the ℓ1 solver per frame.
    #[serde(default = "default_most_steps")]
    pub most_steps: usize,
    /// Fraction of the touches held out for testing.
    #[serde(default = "default_test_fraction")]
    pub test_fraction: f64,
    /// Sizes of the supports for the isometry statistics.
    #[serde(default = "default_isometry_sparsity")]
    pub isometry_sparsity: Axis<usize>,
    /// Number of supports drawn for each size.
    #[serde(default = "count::<200>")]
    pub isometry_subsets: usize,
}

impl ReconstructionSpec {
    /// Returns the limits of the solvers' work.
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
