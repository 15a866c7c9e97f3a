//! A reconstruction study as it is written.

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
    /// What is touched.
    pub objects: ObjectsSpec,
    /// What touches; one array.
    pub skin: SkinSpec,
    /// How it touches.
    pub touches: TouchesSpec,
    /// What happens to a frame before it is sensed; no smoothing.
    #[serde(default)]
    pub signal: SignalSpec,
    /// How a frame is compressed.
    pub sensing: SensingSpec,
    /// How a frame is reconstructed.
    pub reconstruction: ReconstructionSpec,
} }

/// `[reconstruction]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReconstructionSpec {
    /// Axis: how coefficients are found: `omp`, `l1`, `lmmse`.
    pub solver: Axis<Solver>,
    /// Axis: what frames are made of: `dct`, `haar`, `daubechies4`, `pca`.
    pub dictionary: Axis<Basis>,
    /// Atoms of a dictionary, at most: those that carry most of the training frames. All (of PCA 256) when left out.
    pub atoms: Option<usize>,
    /// Atoms that matching pursuit may choose a frame.
    #[serde(default = "default_most_atoms")]
    pub most_atoms: usize,
    /// λ of the ℓ1 problem, as a multiple of the universal threshold σ a √(2 ln k).
    #[serde(default = "default_lambda_scale")]
    pub lambda_scale: f64,
    /// Relative duality gap at which an ℓ1 problem is solved.
    #[serde(default = "default_tolerance")]
    pub tolerance: f64,
    /// Steps that the ℓ1 solver may take a frame.
    #[serde(default = "default_most_steps")]
    pub most_steps: usize,
    /// Fraction of the touches held out for testing.
    #[serde(default = "default_test_fraction")]
    pub test_fraction: f64,
    /// Sizes of the supports whose isometry is sampled.
    #[serde(default = "default_isometry_sparsity")]
    pub isometry_sparsity: Axis<usize>,
    /// Supports drawn for each size.
    #[serde(default = "count::<200>")]
    pub isometry_subsets: usize,
}

impl ReconstructionSpec {
    /// What bounds the solvers' work.
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
