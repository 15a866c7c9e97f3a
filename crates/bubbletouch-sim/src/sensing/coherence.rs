//! How well an ensemble keeps apart what a dictionary can say.
//!
//! Both statistics are of A = ΦΨ with all columns divided by their root mean square norm, so that ensembles of different
//! scale compare.
//!
//! - **Mutual coherence** μ = max |aᵢ·aⱼ| / ‖aᵢ‖‖aⱼ‖, i ≠ j: OMP and ℓ1 recover every frame of fewer than (1 + 1/μ)/2 atoms
//!   (Tropp 2004). No A has less than Welch's bound √((k − m)/(m(k − 1))).
//! - **Restricted isometry**: δₛ is the smallest δ with (1 − δ)‖α‖² ≤ ‖Aα‖² ≤ (1 + δ)‖α‖² for every α of s atoms (Candès and
//!   Tao 2005). Its exact value is NP-hard to compute (Tillmann and Pfetsch 2014). Here s atoms are drawn at random many
//!   times, so the largest deviation found is a **lower bound** on δₛ, and the distribution says what typical supports meet.

use super::SensedDictionary;
use super::symmetric_eigen::symmetric_eigen;
use crate::error::{Error, Result};
use crate::random::Seed;
use ndarray::Array2;

/// Mutual coherence of a sensed dictionary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coherence {
    /// μ, over atoms that can be sensed; 0 when there are fewer than two.
    pub mutual: f64,
    /// Welch's bound for as many atoms as can be sensed and m measurements; 0 when there are at most m.
    pub welch_bound: f64,
    /// Atoms that the projection cannot see: their column is zero.
    pub n_invisible: usize,
}

/// Extreme squared singular values of one random choice of s columns, scaled so that their mean over all columns is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// σ²_min, 0 or more.
    pub low: f64,
    /// σ²_max.
    pub high: f64,
}

impl Extremes {
    /// max(1 − σ²_min, σ²_max − 1): the isometry constant of this choice alone.
    pub fn deviation(&self) -> f64 {
        (1.0 - self.low).max(self.high - 1.0)
    }
}

impl SensedDictionary<'_> {
    /// Mutual coherence and its bound.
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

    /// Extremes of `n_subsets` random choices of `sparsity` atoms, each from its own stream of `seed`.
    ///
    /// # Errors
    /// A sparsity of 0 or above the number of atoms; a dictionary that the projection cannot see at all.
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
