//! Orthonormal wavelet pyramids of arrays whose sides are powers of two: Haar, and Daubechies' wavelet with four taps.

use crate::error::{Error, Result};
use crate::world::ImageShape;
use ndarray::{Array1, ArrayViewMut1, ArrayViewMut2, Axis, s};

/// Orthonormal wavelet, given by its low-pass filter h of length L; the high-pass filter is gₖ = (−1)ᵏ h₍L₋₁₋ₖ₎.
#[derive(Clone, Debug)]
pub(super) struct Wavelet {
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Wavelet {
    /// Returns the Haar wavelet: averages and differences of neighbours.
    pub(super) fn haar() -> Self {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        Self::from_low(vec![h, h])
    }

    /// Returns Daubechies' wavelet with two vanishing moments (1988), periodic at the edges.
    pub(super) fn daubechies4() -> Self {
        let (root, scale) = (3f64.sqrt(), 1.0 / (4.0 * 2f64.sqrt()));
        let taps = [1.0 + root, 3.0 + root, 3.0 - root, 1.0 - root];
        Self::from_low(taps.iter().map(|tap| tap * scale).collect())
    }

    fn from_low(low: Vec<f64>) -> Self {
        let signs = [1.0, -1.0].into_iter().cycle();
        let high = low.iter().rev().zip(signs).map(|(h, sign)| h * sign);
        Self {
            high: high.collect(),
            low,
        }
    }

    /// Checks that both sides of an ny × nx array are powers of two.
    pub(super) fn check(ImageShape { ny, nx }: ImageShape) -> Result<()> {
        if ny.is_power_of_two() && nx.is_power_of_two() {
            return Ok(());
        }
        Err(Error::input(
            "wavelet dictionary",
            format!("{nx} × {ny} taxels"),
            "a power of two along each side (or the dct or pca dictionary)",
        ))
    }

    /// Computes the wavelet pyramid of a frame in place: averages and details. Each level of the pyramid halves every side that is longer than one taxel.
    pub(super) fn analyse(&self, mut frame: ArrayViewMut2<f64>) {
        for (ny, nx) in levels(frame.dim()) {
            let mut corner = frame.slice_mut(s![..ny, ..nx]);
            for (axis, length) in [(Axis(1), nx), (Axis(0), ny)] {
                if length > 1 {
                    corner
                        .lanes_mut(axis)
                        .into_iter()
                        .for_each(|lane| self.split(lane));
                }
            }
        }
    }

    /// Computes the frame from its wavelet pyramid in place; the function inverts `analyse`.
    pub(super) fn synthesise(&self, mut frame: ArrayViewMut2<f64>) {
        for (ny, nx) in levels(frame.dim()).into_iter().rev() {
            let mut corner = frame.slice_mut(s![..ny, ..nx]);
            for (axis, length) in [(Axis(0), ny), (Axis(1), nx)] {
                if length > 1 {
                    corner
                        .lanes_mut(axis)
                        .into_iter()
                        .for_each(|lane| self.join(lane));
                }
            }
        }
    }

    /// Replaces a row or column of even length by its averages, followed by its details.
    fn split(&self, mut lane: ArrayViewMut1<f64>) {
        let n = lane.len();
        let mut parts = Array1::zeros(n);
        for half in 0..n / 2 {
            for (tap, (low, high)) in self.low.iter().zip(&self.high).enumerate() {
                let x = lane[(2 * half + tap) % n];
                parts[half] += low * x;
                parts[n / 2 + half] += high * x;
            }
        }
        lane.assign(&parts);
    }

    fn join(&self, mut lane: ArrayViewMut1<f64>) {
        let n = lane.len();
        let mut whole = Array1::zeros(n);
        for half in 0..n / 2 {
            for (tap, (low, high)) in self.low.iter().zip(&self.high).enumerate() {
                whole[(2 * half + tap) % n] += low * lane[half] + high * lane[n / 2 + half];
            }
        }
        lane.assign(&whole);
    }
}

/// Returns the sides (rows, columns) of the corner that each level of the pyramid splits, finest level first.
fn levels((mut ny, mut nx): (usize, usize)) -> Vec<(usize, usize)> {
    let mut levels = Vec::new();
    while ny > 1 || nx > 1 {
        levels.push((ny, nx));
        (ny, nx) = (ny.div_ceil(2), nx.div_ceil(2));
    }
    levels
}
