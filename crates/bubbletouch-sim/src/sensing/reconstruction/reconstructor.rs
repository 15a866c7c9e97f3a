//! Measurements → frames, by any solver.

use super::lasso::Curvature;
use crate::error::Result;
use crate::sensing::{Lasso, Lmmse, Omp, SensedDictionary};
use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};

/// How coefficients are found from measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// Orthogonal matching pursuit: greedy, one atom after the other ([`Omp`]).
    Omp,
    /// The ℓ1 problem by FISTA ([`Lasso`]).
    L1,
    /// The linear estimate of least mean square error ([`Lmmse`]).
    Lmmse,
}

/// What bounds the solvers' work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Atoms that matching pursuit may choose a frame.
    pub most_atoms: usize,
    /// λ of the ℓ1 problem as a multiple of [`Lasso::universal_lambda`]; positive.
    pub lambda_scale: f64,
    /// Relative duality gap at which an ℓ1 problem is solved; positive.
    pub tolerance: f64,
    /// Steps that the ℓ1 solver may take a frame.
    pub most_steps: usize,
}

/// Frames from measurements, and how it went.
#[derive(Clone, Debug, PartialEq)]
pub struct Reconstruction {
    /// n_frames × n.
    pub frames: Array2<f64>,
    /// Coefficients that are not zero, of each frame; all k for the linear estimate.
    pub n_atoms: Vec<usize>,
    /// Of each frame: whether its solver stopped at its cap before it was done.
    pub capped: Vec<bool>,
}

/// A solver prepared for one projection, dictionary and noise level; it serves any number of frames.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::sensing::{Basis, Dictionary, Effort, Ensemble, Projection, Reconstructor, SensedDictionary, Solver};
/// use ndarray::Array2;
///
/// // A bump that wanders over 16 × 16 taxels; every fourth is held out.
/// let bump = |i: usize, j: usize| {
///     let (y, x) = ((j / 16) as f64 - 4.0 - (i % 9) as f64, (j % 16) as f64 - 4.0 - (i / 9) as f64);
///     (1.0 - (x * x + y * y) / 16.0).max(0.0)
/// };
/// let train = Array2::from_shape_fn((81, 256), |(i, j)| if i % 4 == 0 { 0.0 } else { bump(i, j) });
/// let test = Array2::from_shape_fn((20, 256), |(i, j)| bump(4 * i, j));
///
/// let seed = Seed::new(2018);
/// let projection = Projection::new(Ensemble::Sbhe, (16, 16), 96, &seed)?;
/// let dictionary = Dictionary::learned(Basis::Pca, (16, 16), train.view(), Some(40), &seed)?;
/// let sensed = SensedDictionary::new(&projection, &dictionary)?;
/// let reconstructor = Reconstructor::new(Solver::Lmmse, &sensed, &Effort::default(), 0.0)?;
/// let found = reconstructor.reconstruct(projection.measure(test.view()).view())?;
/// let error = (&found.frames - &test).mapv(|e| e * e).sum() / test.mapv(|x| x * x).sum();
/// assert!(error < 0.02, "{error}");
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Reconstructor<'a> {
    sensed: &'a SensedDictionary<'a>,
    prepared: Prepared,
}

#[derive(Clone, Debug)]
enum Prepared {
    Omp(Omp),
    L1(Lasso, Curvature),
    Lmmse(Box<Lmmse>),
}

/// Noise that the ℓ1 problem always allows for, as a part of the training frames' root mean square: with a λ of zero it would
/// never converge.
const LEAST_NOISE: f64 = 1e-3;

impl<'a> Reconstructor<'a> {
    /// Prepares a solver for noise of standard deviation σ (the frames' unit, zero or positive) on each taxel.
    ///
    /// All solvers take what no atom shows for noise too: √(σ² + τ) a taxel, τ from training frames
    /// ([`Energy::rest`](crate::sensing::Energy)). Matching pursuit and the ℓ1 problem take a measurement's noise to be that times the root
    /// mean square norm of a row of Φ; the linear estimate uses ΦΦᵀ itself.
    ///
    /// # Errors
    /// What [`Lmmse::new`] refuses; limits of `effort` that are out of range are refused when frames are reconstructed.
    pub fn new(
        solver: Solver,
        sensed: &'a SensedDictionary<'a>,
        effort: &Effort,
        noise_std: f64,
    ) -> Result<Self> {
        let rest = sensed
            .dictionary()
            .energy()
            .map_or(0.0, |energy| energy.rest);
        let of_taxels = (noise_std * noise_std + rest).sqrt();
        let noise = of_taxels * sensed.projection().row_norm();
        let prepared = match solver {
            Solver::Lmmse => Prepared::Lmmse(Box::new(Lmmse::new(sensed, noise_std)?)),
            Solver::Omp => {
                let m = sensed.projection().n_measurements();
                Prepared::Omp(Omp::for_noise(effort.most_atoms, noise, m))
            }
            Solver::L1 => {
                let floor = LEAST_NOISE * frame_scale(sensed);
                let lasso = Lasso {
                    lambda: effort.lambda_scale * Lasso::universal_lambda(sensed, noise.max(floor)),
                    tolerance: effort.tolerance,
                    most_steps: effort.most_steps,
                };
                Prepared::L1(lasso, Curvature::of(sensed))
            }
        };
        Ok(Self { sensed, prepared })
    }

    /// Frames of rows of measurements (n_frames × m).
    ///
    /// # Errors
    /// Limits that are out of range: see [`Omp::solve`] and [`Lasso::solve`].
    ///
    /// # Panics
    /// When a row does not have m values.
    pub fn reconstruct(&self, measurements: ArrayView2<f64>) -> Result<Reconstruction> {
        let solved = match &self.prepared {
            Prepared::Omp(omp) => omp.solve(self.sensed, measurements)?,
            Prepared::L1(lasso, curvature) => {
                lasso.solve_with(curvature, self.sensed, measurements)?
            }
            Prepared::Lmmse(lmmse) => {
                let n_frames = measurements.nrows();
                return Ok(Reconstruction {
                    frames: lmmse.estimate(measurements),
                    n_atoms: vec![self.sensed.dictionary().n_atoms(); n_frames],
                    capped: vec![false; n_frames],
                });
            }
        };
        let rows = solved.coefficients.outer_iter();
        Ok(Reconstruction {
            frames: self
                .sensed
                .dictionary()
                .synthesise(solved.coefficients.view()),
            n_atoms: rows
                .map(|row| row.iter().filter(|&&a| a != 0.0).count())
                .collect(),
            capped: solved.capped,
        })
    }
}

impl Default for Effort {
    fn default() -> Self {
        Self {
            most_atoms: 128,
            // The universal threshold shrinks too much: on noisy touches the error is least at a third of it.
            lambda_scale: 0.3,
            tolerance: 1e-3,
            most_steps: 500,
        }
    }
}

/// Root mean square of a taxel over training frames about x₀; 1 for a dictionary that has seen none.
fn frame_scale(sensed: &SensedDictionary) -> f64 {
    let dictionary = sensed.dictionary();
    dictionary.energy().map_or(1.0, |energy| {
        let n = dictionary.n_taxels() as f64;
        (energy.of_atoms.sum() / n + energy.rest).sqrt()
    })
}
