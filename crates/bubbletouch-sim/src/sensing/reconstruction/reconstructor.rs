//! Reconstruction of frames from measurements with any of the solvers.

use super::lasso::Curvature;
use crate::error::Result;
use crate::sensing::{Lasso, Lmmse, Omp, SensedDictionary};
use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};

/// Method that computes dictionary coefficients from measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// Orthogonal matching pursuit: greedy, one atom after the other ([`Omp`]).
    Omp,
    /// The ℓ1 problem, solved by the FISTA algorithm ([`Lasso`]).
    L1,
    /// Linear estimate with the smallest mean square error ([`Lmmse`]).
    Lmmse,
}

/// Limits and tolerances of the solvers, which bound the computing time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Maximum number of atoms per frame in orthogonal matching pursuit.
    pub most_atoms: usize,
    /// Ratio of the ℓ1 penalty to the universal threshold ([`Lasso::universal_lambda`]); positive.
    pub lambda_scale: f64,
    /// Duality gap at which an ℓ1 problem counts as solved, relative to its objective; positive.
    pub tolerance: f64,
    /// Maximum number of steps of the ℓ1 solver per frame.
    pub most_steps: usize,
}

/// Reconstructed frames, with the number of atoms and the convergence of each frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Reconstruction {
    /// Reconstructed frames, shape (n_frames, n_taxels).
    pub frames: Array2<f64>,
    /// Number of nonzero coefficients of each frame; for the linear estimate, the number of atoms of the dictionary.
    pub n_atoms: Vec<usize>,
    /// Whether the solver stopped at its limit of atoms or steps before convergence, for each frame.
    pub capped: Vec<bool>,
}

/// Solver prepared for one projection, dictionary and noise level; it can reconstruct any number of frames.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::sensing::{Basis, Dictionary, Effort, Ensemble, Projection, Reconstructor, SensedDictionary, Solver};
/// use bubbletouch_sim::world::ImageShape;
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
/// let projection = Projection::new(Ensemble::Sbhe, ImageShape { ny: 16, nx: 16 }, 96, &seed)?;
/// let dictionary = Dictionary::learned(Basis::Pca, ImageShape { ny: 16, nx: 16 }, train.view(), Some(40), &seed)?;
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

/// Minimum noise for which the ℓ1 problem is solved, relative to the root mean square of the training frames. With a penalty of 0 the solver would not
/// converge.
const LEAST_NOISE: f64 = 1e-3;

impl<'a> Reconstructor<'a> {
    /// Prepares a solver for noise of standard deviation σ (in the unit of the frames, zero or positive) on each taxel.
    ///
    /// All solvers also treat the part of a frame that the atoms cannot represent as noise. The standard deviation of the total noise is √(σ² + τ) per
    /// taxel, where τ is the mean square of this part in training frames. For matching pursuit and the ℓ1 problem, the noise of a measurement is this noise
    /// times the root mean square norm of a row of Φ. The linear estimate uses ΦΦᵀ itself.
    ///
    /// # Errors
    /// If the linear estimate cannot be prepared. The limits in `effort` are checked by `reconstruct`.
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
                Prepared::L1(lasso, Curvature::new(sensed))
            }
        };
        Ok(Self { sensed, prepared })
    }

    /// Reconstructs frames from rows of measurements (n_frames × n_measurements).
    ///
    /// # Errors
    /// If a limit in `effort` is out of its range.
    ///
    /// # Panics
    /// If a row does not have m values.
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
            // The universal threshold is too large: on noisy touches the error is lowest at a third of it.
            lambda_scale: 0.3,
            // With 1e-3, the error changes by less than 0.3 % and noise-free frames take up to twice as many steps.
            tolerance: 1e-2,
            // Frames with a noise of 1 % are solved within 600 steps; frames without noise may need more than 2,000.
            most_steps: 2000,
        }
    }
}

/// Returns the root mean square of a taxel over the training frames after subtraction of their mean; 1 for a dictionary without training frames.
fn frame_scale(sensed: &SensedDictionary) -> f64 {
    let dictionary = sensed.dictionary();
    dictionary.energy().map_or(1.0, |energy| {
        let n = dictionary.n_taxels() as f64;
        (energy.of_atoms.sum() / n + energy.rest).sqrt()
    })
}
