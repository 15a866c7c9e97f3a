//! Coherence and restricted isometry: measures of how well measurements distinguish the atoms of a dictionary.
//!
//! Coherence and isometry refer to A = ΦΨ, with all columns divided by their root mean square norm, so that ensembles of different
//! scale are comparable.
//!
//! - **Mutual coherence** μ = max |aᵢ·aⱼ| / ‖aᵢ‖‖aⱼ‖, i ≠ j: OMP and ℓ1 recover every frame of fewer than (1 + 1/μ)/2 atoms
//!   (Tropp 2004). The lower limit for any A is Welch's bound √((k − m)/(m(k − 1))).
//! - **Restricted isometry**: δₛ is the smallest δ with (1 − δ)‖α‖² ≤ ‖Aα‖² ≤ (1 + δ)‖α‖² for every α of s atoms (Candès and
//!   Tao 2005). Computing its exact value is NP-hard (Tillmann and Pfetsch 2014). Here s atoms are drawn at random many
//!   times. The largest deviation found is a **lower bound** on δₛ, and the distribution describes typical supports.

use super::SensedDictionary;
use crate::error::{Error, Result};
use crate::linalg::symmetric_eigen;
use crate::random::Seed;
use ndarray::Array2;

/// Mutual coherence of the measured atoms of a dictionary, with its lower bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coherence {
    /// Mutual coherence of the measured atoms that are not zero; 0 if there are fewer than two such atoms.
    pub mutual: f64,
    /// Welch's lower bound of the mutual coherence. 0 if the number of measured atoms that are not zero is at most the number of measurements.
    pub welch_bound: f64,
    /// Number of atoms whose measurements are all zero, so that the projection cannot detect them.
    pub n_invisible: usize,
}

/// Extreme squared singular values of a random subset of the measured atoms, scaled so that the mean squared norm of all measured atoms is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Smallest squared singular value of the subset, 0 or more.
    pub low: f64,
    /// Largest squared singular value of the subset.
    pub high: f64,
}

impl Extremes {
    /// Returns the isometry constant of this subset, max(1 − `low`, `high` − 1).
    pub fn deviation(&self) -> f64 {
        (1.0 - self.low).max(self.high - 1.0)
    }
}

impl SensedDictionary<'_> {
    /// Returns the mutual coherence of the measured atoms and its lower bound.
    pub fn coherence(&self) -> Coherence {
        let (gram, norms) = (self.gram(), self.norms());
        let largest = norms.iter().copied().fold(0.0, f64::max);
        let visible: Vec<usize> = (0..norms.len())
            .filter(|&j| norms[j] > 1e-12 * largest)
            .collect();
        let mut mutual: f64 = 0.0;
        for (place, &i) in visible.iter().enumerate() {
            for &j in &visible[..place] {
                mutual = mutual.max(gram[[i, j]].abs() / (norms[i] * norms[j]));
            }
        }
        let (k, m) = (visible.len() as f64, self.atoms().ncols() as f64);
        Coherence {
            mutual,
            welch_bound: ((k - m).max(0.0) / (m * (k - 1.0).max(1.0))).sqrt(),
            n_invisible: norms.len() - visible.len(),
        }
    }

    /// Returns the extreme singular values of `n_subsets` random subsets of `sparsity` measured atoms. Each subset has its own random stream of `seed`.
    ///
    /// # Errors
    /// If the sparsity is 0 or above the number of atoms, or if all columns of the sensed dictionary are zero.
    pub fn isometry(
        &self,
        sparsity: usize,
        n_subsets: usize,
        seed: &Seed,
    ) -> Result<Vec<Extremes>> {
        let gram = self.gram();
        let k = gram.nrows();
        if sparsity == 0 || sparsity > k {
            return Err(Error::input(
                "sparsity",
                sparsity,
                format!("1 to {k}, the number of atoms"),
            ));
        }
        let scale = gram.diag().sum() / k as f64;
        if scale <= 0.0 {
            return Err(Error::input(
                "dictionary",
                "no atom that the projection sees",
                "at least one",
            ));
        }
        let subsets = (0..n_subsets as u64).map(|subset| {
            let mut rng = seed.named("isometry").numbered(subset).rng();
            let atoms = rand::seq::index::sample(&mut rng, k, sparsity).into_vec();
            let part = Array2::from_shape_fn((sparsity, sparsity), |(i, j)| {
                gram[[atoms[i], atoms[j]]] / scale
            });
            let (values, _) = symmetric_eigen(part.view());
            Extremes {
                low: values[0].max(0.0),
                high: values[sparsity - 1],
            }
        });
        Ok(subsets.collect())
    }
}
