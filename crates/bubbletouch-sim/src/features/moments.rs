//! Moments of an image that are invariant to shifts and rotations.
//!
//! Let μ_pq = Σ w (x − x̄)ᵖ (y − ȳ)^q / Σ w be moments about the centroid of the weights w. The complex moments C_pq use the coordinates z = x + iy:
//! C₁₁ = μ₂₀ + μ₀₂, C₂₀ = μ₂₀ − μ₀₂ + 2i μ₁₁, C₃₀ = Σ w z³ / Σ w, C₂₁ = Σ w z² z̄ / Σ w. A rotation by φ multiplies C_pq by exp(i (p − q) φ). The following nine numbers
//! are therefore invariant, and roots convert each of them to a length:
//!
//! √C₁₁, the standard deviations along both principal axes √((C₁₁ ± |C₂₀|) / 2), √|C₂₀|, |C₃₀|^⅓, |C₂₁|^⅓, and
//! the products Re(C₂₀ C̄₂₁²), Re(C₃₀ C̄₂₁³), Im(C₃₀ C̄₂₁³), signed roots of them.
//!
//! The last number changes its sign in a mirror image. All nine are functions of Hu's seven moments.
//!
//! Sources: Hu (1962), IRE Transactions on Information Theory 8, 179, and Flusser (2000), *On the independence of rotation moment invariants*, Pattern
//! Recognition 33, 1405 (the complex form).

use super::image::{Image, Touched};
use multiversion::multiversion;
use realfft::num_complex::Complex;

/// Number of moments for each kind of weight.
pub const N_MOMENTS: usize = 9;

/// Weight of a touched taxel in the moments of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    /// Weight equal to the pressure of the taxel.
    Pressure,
    /// Weight 1 for every touched taxel.
    Touched,
    /// Weight 1 for taxels above a pressure level, 0 for other taxels.
    Above(f64),
}

/// Number of weights for which the sums are computed at a time.
const LANES: usize = 4;

/// Returns the nine moments of an image for each of up to four weights, in units of columns and rows. The moments are zero if the sum of the weights is 0.
pub fn moments<const N: usize>(image: &Image, weights: [Weight; N]) -> [[f64; N_MOMENTS]; N] {
    const { assert!(N <= LANES) };
    let mut lanes = [Weight::Touched; LANES];
    lanes[..N].copy_from_slice(&weights);
    let sums = central_sums(&image.touched, lanes);
    std::array::from_fn(|lane| match sums.total[lane] == 0.0 {
        true => [0.0; N_MOMENTS],
        false => sums.invariants(lane),
    })
}

/// Sum of the weights, and the sums from which the complex moments are computed.
#[derive(Default)]
struct Sums {
    total: [f64; LANES],
    c11: [f64; LANES],
    /// Real and imaginary part of the sum from which the complex moment C₂₀ is computed, for each weight.
    c20: [[f64; LANES]; 2],
    c21: [[f64; LANES]; 2],
    c30: [[f64; LANES]; 2],
}

#[multiversion(targets("x86_64+avx2"))]
fn central_sums(Touched { x, y, value }: &Touched, weights: [Weight; LANES]) -> Sums {
    let (mut is_pressure, mut level) = ([false; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        match weights[lane] {
            Weight::Pressure => is_pressure[lane] = true,
            Weight::Touched => {}
            Weight::Above(above) => level[lane] = above,
        }
    }
    let mut sums = Sums::default();
    let (mut x_mean, mut y_mean) = ([0.0; LANES], [0.0; LANES]);
    for at in 0..value.len() {
        for lane in 0..LANES {
            let one = if value[at] > level[lane] { 1.0 } else { 0.0 };
            let weight = if is_pressure[lane] { value[at] } else { one };
            sums.total[lane] += weight;
            x_mean[lane] += weight * x[at];
            y_mean[lane] += weight * y[at];
        }
    }
    for lane in 0..LANES {
        x_mean[lane] /= sums.total[lane];
        y_mean[lane] /= sums.total[lane];
    }
    for at in 0..value.len() {
        for lane in 0..LANES {
            let one = if value[at] > level[lane] { 1.0 } else { 0.0 };
            let weight = if is_pressure[lane] { value[at] } else { one };
            let (re, im) = (x[at] - x_mean[lane], y[at] - y_mean[lane]);
            let square = (re * re - im * im, re * im + im * re);
            let norm = re * re + im * im;
            let cube = (square.0 * re - square.1 * im, square.0 * im + square.1 * re);
            sums.c11[lane] += weight * norm;
            sums.c20[0][lane] += square.0 * weight;
            sums.c20[1][lane] += square.1 * weight;
            sums.c21[0][lane] += re * (weight * norm);
            sums.c21[1][lane] += im * (weight * norm);
            sums.c30[0][lane] += cube.0 * weight;
            sums.c30[1][lane] += cube.1 * weight;
        }
    }
    sums
}

impl Sums {
    /// Returns the nine moments that do not change under shifts and rotations, for the weight with index `lane`.
    fn invariants(&self, lane: usize) -> [f64; N_MOMENTS] {
        let total = self.total[lane];
        let c11 = self.c11[lane] / total;
        let [c20, c21, c30] =
            [self.c20, self.c21, self.c30].map(|[re, im]| Complex::new(re[lane], im[lane]) / total);
        let spread = c20.norm();
        let second = c20 * (c21 * c21).conj();
        let third = c30 * (c21 * c21 * c21).conj();
        let root = |value: f64, power: f64| value.abs().powf(1.0 / power).copysign(value);
        [
            c11.sqrt(),
            (0.5 * (c11 + spread)).sqrt(),
            (0.5 * (c11 - spread)).max(0.0).sqrt(),
            spread.sqrt(),
            c30.norm().cbrt(),
            c21.norm().cbrt(),
            root(second.re, 8.0),
            root(third.re, 12.0),
            root(third.im, 12.0),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::Cut;
    use super::*;

    #[test]
    fn a_rectangle_spreads_as_the_textbook_says() {
        let (width, height) = (11, 5);
        let frame: Vec<f64> = (0..400)
            .map(|i| {
                f64::from((3..3 + width).contains(&(i % 20)) && (6..6 + height).contains(&(i / 20)))
            })
            .collect();
        let mut image = Image::default();
        image.read(&frame, 20, Cut::default());
        let variance = |n: usize| ((n * n - 1) as f64) / 12.0;
        let (x, y) = (variance(width), variance(height));
        let weights = [Weight::Touched, Weight::Pressure, Weight::Above(1.0)];
        let [found, by_pressure, above] = moments(&image, weights);
        let expected = [(x + y).sqrt(), x.sqrt(), y.sqrt(), (x - y).sqrt(), 0.0, 0.0];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
        assert_eq!(found, by_pressure);
        assert_eq!(above, [0.0; 9]);
    }
}
