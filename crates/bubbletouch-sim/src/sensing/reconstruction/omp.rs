//! Orthogonal matching pursuit of many frames with one Gram matrix.
//!
//! Pati, Rezaiifar and Krishnaprasad (1993): choose the atom with the largest correlation with the residual, project onto all chosen atoms,
//! repeat. Rubinstein, Zibulevsky and Elad (2008, *Batch-OMP*): with G = AᵀA and b = Aᵀy the residual itself is never
//! computed. A Cholesky factor L of G on the chosen atoms gains one row per step. The squared norm of the residual decreases by the square of the newest
//! entry of L⁻¹b.

use crate::error::{Error, Result};
use crate::sensing::{SensedDictionary, Solved};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, ArrayViewMut1, Zip};

/// Smallest squared norm of the component of an atom orthogonal to the chosen atoms. An atom with a smaller norm counts as linearly dependent.
const DEPENDENT: f64 = 1e-10;
/// Smallest correlation of an atom with the residual, relative to the norm of the measurements; smaller correlations are rounding errors.
const ROUNDING: f64 = 1e-13;

/// Stopping rule of orthogonal matching pursuit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Omp {
    /// Maximum number of atoms per frame; at least 1.
    pub most_atoms: usize,
    /// Norm of the residual at which the pursuit stops; zero or positive, in the unit of the measurements.
    pub residual: f64,
}

impl Omp {
    /// Creates the rule that stops at the residual norm σ√m, which noise of standard deviation σ on each of the m measurements causes.
    pub fn for_noise(most_atoms: usize, noise_std: f64, n_measurements: usize) -> Self {
        Self {
            most_atoms,
            residual: noise_std * (n_measurements as f64).sqrt(),
        }
    }

    /// Computes the dictionary coefficients of each frame from rows of measurements (n_frames × m).
    ///
    /// A frame is marked as capped if it has `most_atoms` atoms and a residual above the limit.
    ///
    /// # Errors
    /// If `most_atoms` is 0, or if the residual is negative or not finite.
    ///
    /// # Panics
    /// If a row does not have m values.
    pub fn solve(
        &self,
        sensed: &SensedDictionary,
        measurements: ArrayView2<f64>,
    ) -> Result<Solved> {
        self.check()?;
        let scale = inverse_norms(sensed);
        let centred = sensed.centred(measurements);
        let correlations = centred.dot(&sensed.atoms().t());
        let mut solved = Solved::zeros(measurements.nrows(), scale.len());
        for (frame, (y, b)) in centred
            .outer_iter()
            .zip(correlations.outer_iter())
            .enumerate()
        {
            let mut pursuit = Pursuit::new(sensed.gram(), &scale, b, y.dot(&y));
            solved.capped[frame] = pursuit.run(self);
            pursuit.coefficients_into(solved.coefficients.row_mut(frame));
        }
        Ok(solved)
    }

    fn check(&self) -> Result<()> {
        if self.most_atoms == 0 {
            return Err(Error::input("most atoms", 0, "at least 1"));
        }
        if !(self.residual.is_finite() && self.residual >= 0.0) {
            let allowed = "zero or a positive number";
            return Err(Error::input("residual", self.residual, allowed));
        }
        Ok(())
    }
}

fn inverse_norms(sensed: &SensedDictionary) -> Array1<f64> {
    let norms = sensed.norms();
    let least = 1e-12 * norms.iter().copied().fold(0.0, f64::max);
    norms.mapv(|norm| if norm > least { 1.0 / norm } else { 0.0 })
}

/// State of the matching pursuit for one frame; atoms are scaled to norm 1.
struct Pursuit<'a> {
    gram: &'a Array2<f64>,
    /// Reciprocal norm of each measured atom; 0 for zero atoms, so that their correlation is always 0.
    scale: &'a Array1<f64>,
    /// Correlations of the measured atoms, scaled to norm 1, with the measurements.
    b: Array1<f64>,
    /// Correlations of the measured atoms, scaled to norm 1, with the residual.
    correlation: Array1<f64>,
    /// Squared norm of the residual.
    left: f64,
    rounding: f64,
    chosen: Vec<usize>,
    is_chosen: Vec<bool>,
    /// Rows of the Cholesky factor L of the chosen atoms' Gram matrix, one after the other: row i has i + 1 entries.
    factor: Vec<f64>,
    /// Forward substitution L⁻¹ b for the chosen atoms, where b are their correlations with the measurements.
    forward: Vec<f64>,
    /// Coefficients of the chosen atoms, scaled to norm 1.
    solution: Vec<f64>,
}

impl<'a> Pursuit<'a> {
    fn new(gram: &'a Array2<f64>, scale: &'a Array1<f64>, b: ArrayView1<f64>, square: f64) -> Self {
        let unit = &b * scale;
        Self {
            gram,
            scale,
            correlation: unit.clone(),
            b: unit,
            left: square,
            rounding: ROUNDING * square.sqrt(),
            chosen: Vec::new(),
            is_chosen: vec![false; scale.len()],
            factor: Vec::new(),
            forward: Vec::new(),
            solution: Vec::new(),
        }
    }

    /// Runs the matching pursuit. Returns whether it stopped at the maximum number of atoms with a residual above the limit.
    fn run(&mut self, rule: &Omp) -> bool {
        let enough = rule.residual * rule.residual;
        while self.left > enough {
            if self.chosen.len() == rule.most_atoms {
                return true;
            }
            let Some(atom) = self.best_atom() else {
                return false;
            };
            if !self.add(atom) {
                return false;
            }
            self.solve_chosen();
            self.update_correlation();
        }
        false
    }

    /// Returns the atom with the largest correlation with the residual (the first among equals); `None` if only rounding errors remain.
    fn best_atom(&self) -> Option<usize> {
        let mut best = (self.rounding, None);
        for (atom, value) in self.correlation.iter().enumerate() {
            if value.abs() > best.0 && !self.is_chosen[atom] {
                best = (value.abs(), Some(atom));
            }
        }
        best.1
    }

    /// Adds an atom: a row of the Cholesky factor L, and an entry of L⁻¹b. Returns false if the atom depends linearly on the chosen atoms.
    fn add(&mut self, atom: usize) -> bool {
        let start = self.factor.len();
        let mut square = 1.0;
        let mut entry = self.b[atom];
        for (i, &other) in self.chosen.iter().enumerate() {
            let above = &self.factor[i * (i + 1) / 2..][..=i];
            let row = &self.factor[start..];
            let sum: f64 = above[..i].iter().zip(row).map(|(a, b)| a * b).sum();
            let cosine = self.gram[[atom, other]] * self.scale[atom] * self.scale[other];
            let value = (cosine - sum) / above[i];
            square -= value * value;
            entry -= value * self.forward[i];
            self.factor.push(value);
        }
        if square < DEPENDENT {
            self.factor.truncate(start);
            return false;
        }
        let root = square.sqrt();
        self.factor.push(root);
        self.forward.push(entry / root);
        self.left -= (entry / root).powi(2);
        self.chosen.push(atom);
        self.is_chosen[atom] = true;
        true
    }

    /// Solves Lᵀα = L⁻¹b for the coefficients α of the chosen atoms by back substitution.
    fn solve_chosen(&mut self) {
        self.solution.clone_from(&self.forward);
        for i in (0..self.solution.len()).rev() {
            let row = &self.factor[i * (i + 1) / 2..][..=i];
            let value = self.solution[i] / row[i];
            self.solution[i] = value;
            for (earlier, entry) in self.solution[..i].iter_mut().zip(row) {
                *earlier -= entry * value;
            }
        }
    }

    fn update_correlation(&mut self) {
        let mut product: Array1<f64> = Array1::zeros(self.b.len());
        for (&atom, &value) in self.chosen.iter().zip(&self.solution) {
            product.scaled_add(value * self.scale[atom], &self.gram.row(atom));
        }
        Zip::from(&mut self.correlation)
            .and(&self.b)
            .and(&product)
            .and(self.scale)
            .for_each(|c, &b, &p, &scale| *c = b - p * scale);
    }

    fn coefficients_into(&self, mut row: ArrayViewMut1<f64>) {
        for (&atom, &value) in self.chosen.iter().zip(&self.solution) {
            row[atom] = value * self.scale[atom];
        }
    }
}
