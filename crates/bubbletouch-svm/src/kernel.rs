//! Kernels of the support vector machines. A new kernel is added as a case of each `match` in this file.
//!
//! A kernel value is computed from the inner product of two rows and from their squared norms.

use ndarray::{Array1, ArrayView1, ArrayView2};
use serde::{Deserialize, Serialize};

use crate::linalg::scalar::Scalar;
use crate::row_statistics::RowStatistics;
use crate::{Error, Result};

/// Maximum exponent of an RBF kernel (γ times the squared distance of two rows) for computation in f32. The rounding error of the exponent is the relative
/// error of the kernel value.
const SINGLE_EXPONENT: f64 = 1e4;

/// Width parameter γ of a kernel, in inverse squared feature units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Gamma {
    /// scikit-learn's default `1 / (m · var(X))`, where the variance is taken over all training features; 1 if the variance is 0.
    Scale,
    /// Given value of γ, above 0.
    Value(f64),
}

/// Kernel function `K(x, z)` of a support vector machine, whose width parameter γ is a setting or, during training, a number (`Kernel<f64>`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Kernel<G = Gamma> {
    /// Linear kernel `x·z`.
    Linear,
    /// Gaussian kernel `exp(−γ|x − z|²)`.
    Rbf {
        /// Width parameter γ.
        gamma: G,
    },
    /// Polynomial kernel `(γ x·z + c₀)^d`.
    Polynomial {
        /// Scale parameter γ.
        gamma: G,
        /// Constant c₀ ≥ 0 in the polynomial kernel (a negative constant makes the dual problem non-convex).
        coef0: f64,
        /// Degree d of the polynomial, at least 1.
        degree: u32,
    },
}

/// Kernel function whose γ is a number.
pub(crate) type KernelFunction = Kernel<f64>;

impl<G: Copy> Kernel<G> {
    /// Returns a copy of the kernel with another γ; a linear kernel is unchanged.
    pub fn with_gamma<H>(self, gamma: H) -> Kernel<H> {
        match self {
            Self::Linear => Kernel::Linear,
            Self::Rbf { .. } => Kernel::Rbf { gamma },
            Self::Polynomial { coef0, degree, .. } => Kernel::Polynomial {
                gamma,
                coef0,
                degree,
            },
        }
    }

    /// Returns the kernel's γ, or `None` for a linear kernel.
    pub fn gamma(&self) -> Option<G> {
        match *self {
            Self::Linear => None,
            Self::Rbf { gamma } | Self::Polynomial { gamma, .. } => Some(gamma),
        }
    }
}

impl Kernel {
    /// Returns the default γ of the kernel ('scale') for the training features (n_rows × m).
    pub fn gamma_scale(&self, features: ArrayView2<f64>) -> f64 {
        let scale = features.ncols() as f64 * variance(features);
        if scale > 0.0 { 1.0 / scale } else { 1.0 }
    }

    /// Returns the kernel with a numeric γ, computed from the training features (n_rows × m) and their statistics.
    pub(crate) fn resolve(
        &self,
        features: ArrayView2<f64>,
        statistics: &RowStatistics,
    ) -> Result<KernelFunction> {
        if let Self::Polynomial { coef0, degree, .. } = *self {
            if !(coef0 >= 0.0 && coef0.is_finite()) {
                let allowed = "a finite number of at least 0 is allowed";
                return Err(Error::input("coef0", coef0, allowed));
            }
            if !(1..=20).contains(&degree) {
                return Err(Error::input("degree", degree, "1 to 20 is allowed"));
            }
        }
        let function = match self.gamma() {
            None => Kernel::Linear,
            Some(Gamma::Scale) => self.with_gamma(self.gamma_scale(features)),
            Some(Gamma::Value(gamma)) if gamma > 0.0 && gamma.is_finite() => self.with_gamma(gamma),
            Some(Gamma::Value(gamma)) => {
                let allowed = "'scale' or a finite number above 0 is allowed";
                return Err(Error::input("gamma", gamma, allowed));
            }
        };
        function.check(statistics.largest_norm)?;
        Ok(function)
    }
}

/// Returns the variance over all entries of the feature matrix.
fn variance(features: ArrayView2<f64>) -> f64 {
    // Two simple passes; ndarray's variance performs a division for every value.
    let n = features.len() as f64;
    let mean = features.sum() / n;
    let of_row = |row: ArrayView1<f64>| match row.as_slice() {
        Some(row) => squares_about(mean, row),
        None => squares_about(mean, &row.to_vec()),
    };
    features.rows().into_iter().map(of_row).sum::<f64>() / n
}

/// Returns the sum of the squared differences between the values and `mean`.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn squares_about(mean: f64, values: &[f64]) -> f64 {
    let (lanes, last) = values.as_chunks::<8>();
    let mut squares = [0.0; 8];
    for values in lanes {
        for lane in 0..8 {
            squares[lane] += (values[lane] - mean) * (values[lane] - mean);
        }
    }
    let last = last.iter().map(|value| (value - mean) * (value - mean));
    squares.iter().sum::<f64>() + last.sum::<f64>()
}

impl KernelFunction {
    /// Returns an error if kernel values can exceed the range of numbers; `norm` is the largest squared norm of a row. No kernel value exceeds `K(x, x)` of the
    /// row x with the largest norm, and no squared distance exceeds four times this norm.
    fn check(&self, norm: f64) -> Result<()> {
        let largest = match *self {
            Self::Linear | Self::Rbf { .. } => 4.0 * norm,
            Self::Polynomial {
                gamma,
                coef0,
                degree,
            } => (gamma * norm + coef0).powi(degree as i32),
        };
        if largest.is_finite() {
            return Ok(());
        }
        Err(Error::input(
            "features",
            format!("a row of squared length {norm:e}"),
            "its kernel value must be a finite number: scale the features, or take a smaller gamma or degree",
        ))
    }

    /// Returns the centre of the rows, which is subtracted from every row. If a constant added to all features changes only the offset ρ, this is the mean of
    /// the rows, otherwise the origin. Products of rows about the mean are small and lose fewer digits.
    pub(crate) fn centre(&self, statistics: &RowStatistics) -> Array1<f64> {
        match self {
            Self::Linear | Self::Rbf { .. } => statistics.mean.clone(),
            Self::Polynomial { .. } => Array1::zeros(statistics.mean.len()),
        }
    }

    /// Returns an upper bound of `K(x, x)` over all rows x for computation in f32, given their largest squared distance from the centre. Returns `None` if f32
    /// is not accurate enough.
    pub(crate) fn largest_in_single(&self, farthest: f64) -> Option<f64> {
        match *self {
            Self::Linear => Some(farthest),
            // If exponents are large, K is nearly the identity and coefficients are near 1 for any C.
            Self::Rbf { gamma } if 4.0 * gamma * farthest > SINGLE_EXPONENT => None,
            Self::Rbf { .. } => Some(1.0),
            // Each multiplication of a power adds a rounding error. Most centred products are far below the maximum; powers about the origin are not.
            // Example: for a cubic kernel at C K = 4e3, the violation of the optimality conditions is three times the tolerance of 1e-3.
            Self::Polynomial { degree, .. } => {
                Some(10.0 * f64::from(degree) * self.of_norm(farthest))
            }
        }
    }

    /// Returns the kernel value `K(x, x)` of a row x with itself, given the squared norm of x.
    pub(crate) fn of_norm<T: Scalar>(&self, norm: T) -> T {
        match *self {
            Self::Linear => norm,
            Self::Rbf { .. } => T::one(),
            Self::Polynomial {
                gamma,
                coef0,
                degree,
            } => {
                let mut value = [norm];
                polynomials(&mut value, (T::from_f64(gamma), T::from_f64(coef0)), degree);
                value[0]
            }
        }
    }

    /// Converts the inner products of one row with other rows to kernel values, given the squared norms of the rows.
    pub(crate) fn of_products<T: Scalar>(&self, products: &mut [T], norm: T, norms: &[T]) {
        match *self {
            Self::Linear => {}
            Self::Rbf { gamma } => {
                distances(products, norm, norms);
                T::exponentials(products, gamma);
            }
            Self::Polynomial {
                gamma,
                coef0,
                degree,
            } => polynomials(products, (T::from_f64(gamma), T::from_f64(coef0)), degree),
        }
    }
}

/// Replaces each inner product p by the value `(γ p + c₀)^d` of a polynomial kernel; `base` is (γ, c₀), and `degree` is d.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn polynomials<T: Scalar>(products: &mut [T], base: (T, T), degree: u32) {
    let (lanes, last) = products.as_chunks_mut::<16>();
    for values in lanes {
        *values = powers(*values, base, degree);
    }
    for value in last {
        [*value] = powers([*value], base, degree);
    }
}

/// Returns the polynomial kernel values `(γ p + c₀)^d` of N inner products p, computed in parallel by repeated squaring.
#[inline(always)]
fn powers<T: Scalar, const N: usize>(
    mut values: [T; N],
    (gamma, coef0): (T, T),
    degree: u32,
) -> [T; N] {
    let mut powers = [T::one(); N];
    for value in &mut values {
        *value = gamma * *value + coef0;
    }
    for bit in 0..u32::BITS - degree.leading_zeros() {
        for lane in 0..N {
            if degree >> bit & 1 == 1 {
                powers[lane] *= values[lane];
            }
            values[lane] *= values[lane];
        }
    }
    powers
}

/// Replaces each inner product of a row x with a row z by their squared distance `|x|² + |z|² − 2 x·z`, at least 0.
#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
fn distances<T: Scalar>(products: &mut [T], norm: T, norms: &[T]) {
    let two = T::one() + T::one();
    for (value, &other) in products.iter_mut().zip(norms) {
        let distance = norm + other - two * *value;
        *value = if distance > T::zero() {
            distance
        } else {
            T::zero()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array2, array};

    #[test]
    fn gamma_scale_is_the_inverse_of_columns_times_variance() {
        let features = array![[1.0, 3.0], [5.0, 7.0]];
        let gamma = Gamma::Scale;
        let rbf = Kernel::Rbf { gamma };
        assert_eq!(rbf.gamma_scale(features.view()), 1.0 / (2.0 * 5.0));
        assert_eq!(rbf.gamma_scale(Array2::ones((3, 2)).view()), 1.0);
    }

    #[test]
    fn a_squared_distance_is_never_negative() {
        let mut products = [1.0 + 1e-15, 0.5];
        distances(&mut products, 1.0, &[1.0, 1.0]);
        assert_eq!(products, [0.0, 1.0]);
    }

    fn assert_powers<T: Scalar>(tolerance: f64) {
        // The length is not a multiple of the register width.
        let products: Vec<f64> = (0..37).map(|i| f64::from(i) * 0.03 - 0.4).collect();
        for degree in 1..=20 {
            let mut powers: Vec<T> = products
                .iter()
                .map(|&product| T::from_f64(product))
                .collect();
            polynomials(&mut powers, (T::from_f64(0.7), T::from_f64(1.0)), degree);
            for (power, product) in powers.iter().zip(&products) {
                let exact = (0.7 * product + 1.0).powi(degree as i32);
                let error = (power.wide() - exact).abs();
                assert!(error <= f64::from(degree) * tolerance * exact, "{degree}");
            }
        }
    }

    #[test]
    fn polynomial_values_are_powers_in_both_precisions() {
        assert_powers::<f32>(2.0 * f64::from(f32::EPSILON));
        assert_powers::<f64>(2.0 * f64::EPSILON);
    }

    #[test]
    fn parameters_out_of_range_are_refused() {
        let features = array![[1.0]];
        for gamma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let gamma = Gamma::Value(gamma);
            let statistics = RowStatistics::new(features.view()).unwrap();
            let kernel = Kernel::Rbf { gamma };
            assert!(kernel.resolve(features.view(), &statistics).is_err());
        }
        for (coef0, degree) in [(-1.0, 2), (f64::NAN, 2), (0.0, 0), (0.0, 21)] {
            let gamma = Gamma::Scale;
            let kernel = Kernel::Polynomial {
                gamma,
                coef0,
                degree,
            };
            let statistics = RowStatistics::new(features.view()).unwrap();
            assert!(kernel.resolve(features.view(), &statistics).is_err());
        }
    }
}
