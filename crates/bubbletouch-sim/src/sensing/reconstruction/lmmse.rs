//! Linear estimate of least mean square error (LMMSE): one or two matrix products per frame.
//!
//! Frames are modelled as x = x₀ + Σⱼ αⱼ ψⱼ + r, with uncorrelated αⱼ of the mean square eⱼ in training frames
//! (`Energy`), and a remainder r of mean square τ per taxel. Every taxel has noise of standard deviation σ **before** the
//! projection, so y − Φx₀ = Aα + Φ(r + noise) and, with E = diag(eⱼ),
//!
//! α̂ = E Aᵀ (A E Aᵀ + (τ + σ²) Φ Φᵀ)⁻¹ (y − Φx₀).
//!
//! With PCA atoms this is the estimate from the training covariance; with a fixed basis it is a Wiener filter in this basis.

use crate::error::{Error, Result};
use crate::linalg::Cholesky;
use crate::sensing::SensedDictionary;
use ndarray::{Array1, Array2, ArrayView2};

/// Smallest noise variance relative to the mean variance of the measurements. Without noise, the matrix to be inverted may be singular.
const LEAST_NOISE: f64 = 1e-12;

/// Linear minimum mean square error estimator of frames, prepared for any number of frames.
#[derive(Clone, Debug)]
pub struct Lmmse {
    form: Form,
    /// Estimate for zero measurements, shape (n_taxels,). The estimate for measurements y is this constant plus a linear map of y.
    constant: Array1<f64>,
}

/// Representation of the linear map as one matrix or a product of two; the constructor chooses the one with fewer operations per frame.
#[derive(Clone, Debug)]
enum Form {
    /// Matrix from measurements to frames, shape (n_measurements, n_taxels).
    Direct(Array2<f64>),
    /// Matrices from measurements to coefficients (m × k) and from coefficients to frames (k × n).
    Through(Array2<f64>, Array2<f64>),
}

impl Lmmse {
    /// Prepares the estimator for taxel noise of standard deviation `noise_std` (zero or positive, in the unit of the frames).
    ///
    /// # Errors
    /// If the dictionary has no training frames, if σ is negative or not finite, or if the training frames or the projection are zero.
    pub fn new(sensed: &SensedDictionary, noise_std: f64) -> Result<Self> {
        Self::shrunk(sensed, noise_std, None)
    }

    /// Prepares the estimator; each of the k coefficients is multiplied by its factor in `shrinkage`, from 0 to 1, if given.
    ///
    /// # Errors
    /// If `new` would fail for these arguments.
    pub(crate) fn shrunk(
        sensed: &SensedDictionary,
        noise_std: f64,
        shrinkage: Option<&Array1<f64>>,
    ) -> Result<Self> {
        let dictionary = sensed.dictionary();
        let energy = dictionary.energy().ok_or_else(|| {
            let given = "a dictionary that has seen no training frames";
            Error::input("lmmse", given, "a learned dictionary")
        })?;
        if !(noise_std.is_finite() && noise_std >= 0.0) {
            return Err(Error::input(
                "noise std",
                noise_std,
                "zero or a positive number",
            ));
        }
        // E Aᵀ with one atom per row, shape (k, m).
        let weighted = &sensed.atoms() * &energy.of_atoms.view().insert_axis(ndarray::Axis(1));
        let mut covariance = weighted.t().dot(&sensed.atoms());
        let of_noise = sensed.projection().row_gram();
        covariance.scaled_add(energy.rest + noise_std * noise_std, &of_noise);
        let m = covariance.nrows();
        let least = LEAST_NOISE * covariance.diag().sum() / m as f64;
        covariance.diag_mut().iter_mut().for_each(|v| *v += least);
        let factor = Cholesky::new(covariance).ok_or_else(|| {
            Error::input(
                "lmmse",
                "measurements without variance",
                "training frames and rows of Φ that are not zero",
            )
        })?;
        // Shape (m, k). A row of measurements times this matrix is a row of coefficients.
        let mut to_coefficients = factor.solve(weighted.t());
        if let Some(shrinkage) = shrinkage {
            to_coefficients *= shrinkage;
        }
        Ok(Self::from_coefficients(sensed, to_coefficients))
    }

    fn from_coefficients(sensed: &SensedDictionary, to_coefficients: Array2<f64>) -> Self {
        let dictionary = sensed.dictionary();
        let (m, k) = to_coefficients.dim();
        let n = dictionary.n_taxels();
        let form = if k * (m + n) < m * n {
            Form::Through(to_coefficients, dictionary.atoms(0..k))
        } else {
            Form::Direct(dictionary.combine(to_coefficients.view()))
        };
        let mut lmmse = Self {
            form,
            constant: Array1::zeros(n),
        };
        let zero = Array2::zeros((1, m));
        let shift = lmmse.estimate(sensed.centred(zero.view()).view());
        lmmse.constant = dictionary.origin() + &shift.row(0);
        lmmse
    }

    /// Estimates frames, shape (n_frames, n_taxels), from rows of measurements, shape (n_frames, n_measurements).
    ///
    /// # Panics
    /// If a row does not have m values.
    pub fn estimate(&self, measurements: ArrayView2<f64>) -> Array2<f64> {
        let mut frames = self.linear(measurements);
        frames += &self.constant;
        frames
    }

    /// Returns the linear part of the estimate, without the constant (the estimate for zero measurements).
    pub(crate) fn linear(&self, measurements: ArrayView2<f64>) -> Array2<f64> {
        match &self.form {
            Form::Direct(matrix) => measurements.dot(matrix),
            Form::Through(first, second) => measurements.dot(first).dot(second),
        }
    }
}
