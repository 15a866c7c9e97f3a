//! Moments of an image that do not change when it is shifted or turned.
//!
//! With μ_pq = Σ w (x − x̄)ᵖ (y − ȳ)^q / Σ w about the centroid of the weights w, and C_pq those of complex coordinates z = x + iy
//! (C₁₁ = μ₂₀ + μ₀₂, C₂₀ = μ₂₀ − μ₀₂ + 2i μ₁₁, C₃₀ = Σ w z³ / Σ w, C₂₁ = Σ w z² z̄ / Σ w), to turn by φ multiplies C_pq by exp(i (p − q) φ).
//! So these nine do not change, each as the length that its unit is a power of:
//!
//! √C₁₁, the standard deviations along both principal axes √((C₁₁ ± |C₂₀|) / 2), √|C₂₀|, |C₃₀|^⅓, |C₂₁|^⅓, and
//! the products Re(C₂₀ C̄₂₁²), Re(C₃₀ C̄₂₁³), Im(C₃₀ C̄₂₁³), signed roots of them.
//!
//! The last changes its sign in a mirror image. They are functions of Hu's seven.
//!
//! Sources: Hu (1962), IRE Transactions on Information Theory 8, 179; Flusser (2000), *On the independence of rotation moment
//! invariants*, Pattern Recognition 33, 1405 (the complex form).

use super::image::Image;
use realfft::num_complex::Complex;

/// How many there are.
pub const N_MOMENTS: usize = 9;

/// What a touched taxel counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    /// Its δ.
    Pressure,
    /// One.
    Touched,
    /// One, of those above a level.
    Above(f64),
}

/// The nine of an image, in columns and rows; zeros of one that weighs nothing.
pub fn moments(image: &Image, weight: Weight) -> [f64; N_MOMENTS] {
    let weighted = || {
        let touched = image.touched.iter();
        touched.map(move |&(x, y, value)| {
            let weight = match weight {
                Weight::Pressure => value,
                Weight::Touched => 1.0,
                Weight::Above(level) => f64::from(value > level),
            };
            (x as f64, y as f64, weight)
        })
    };
    let (mut total, mut x_mean, mut y_mean) = (0.0, 0.0, 0.0);
    for (x, y, weight) in weighted() {
        total += weight;
        x_mean += weight * x;
        y_mean += weight * y;
    }
    if total == 0.0 {
        return [0.0; N_MOMENTS];
    }
    (x_mean, y_mean) = (x_mean / total, y_mean / total);
    let mut c11 = 0.0;
    let [mut c20, mut c21, mut c30] = [Complex::<f64>::default(); 3];
    for (x, y, weight) in weighted() {
        let z = Complex::new(x - x_mean, y - y_mean);
        let (square, norm) = (z * z, z.norm_sqr());
        c11 += weight * norm;
        c20 += square * weight;
        c21 += z * (weight * norm);
        c30 += square * z * weight;
    }
    c11 /= total;
    [c20, c21, c30] = [c20, c21, c30].map(|c| c / total);
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
        let found = moments(&image, Weight::Touched);
        let expected = [(x + y).sqrt(), x.sqrt(), y.sqrt(), (x - y).sqrt(), 0.0, 0.0];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
        assert_eq!(found, moments(&image, Weight::Pressure));
        assert_eq!(moments(&image, Weight::Above(1.0)), [0.0; 9]);
    }
}
