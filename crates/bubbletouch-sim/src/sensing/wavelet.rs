//! Orthonormal wavelet pyramids of arrays whose sides are powers of two: Haar, and Daubechies' wavelet with four taps.

use super::dictionary::Transform;
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
    /// Returns the Haar wavelet for ny × nx arrays: averages and differences of neighbours.
    pub(super) fn haar(grid: ImageShape) -> Result<Self> {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        Self::new(vec![h, h], grid)
    }

    /// Returns Daubechies' wavelet with two vanishing moments (1988) for ny × nx arrays, periodic at the edges.
    pub(super) fn daubechies4(grid: ImageShape) -> Result<Self> {
        let (root, scale) = (3f64.sqrt(), 1.0 / (4.0 * 2f64.sqrt()));
        let taps = [1.0 + root, 3.0 + root, 3.0 - root, 1.0 - root];
        Self::new(taps.iter().map(|tap| tap * scale).collect(), grid)
    }

    /// Returns the wavelet with this low-pass filter, or an error if a side of the array is no power of two.
    fn new(low: Vec<f64>, ImageShape { ny, nx }: ImageShape) -> Result<Self> {
        if !(ny.is_power_of_two() && nx.is_power_of_two()) {
            let allowed = "a power of two along each side (or the dct or pca dictionary)";
            let given = format!("{nx} × {ny} taxels");
            return Err(Error::input("wavelet dictionary", given, allowed));
        }
        let signs = [1.0, -1.0].into_iter().cycle();
        let high = low.iter().rev().zip(signs).map(|(h, sign)| h * sign);
        Ok(Self {
            high: high.collect(),
            low,
        })
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

/// Each level of the pyramid halves every side that is longer than one taxel.
impl Transform for Wavelet {
    fn analyse(&self, mut frame: ArrayViewMut2<f64>) {
        for (ny, nx) in levels(frame.dim()) {
            let corner = frame.slice_mut(s![..ny, ..nx]);
            change_lanes(corner, [Axis(1), Axis(0)], |lane| self.split(lane));
        }
    }

    fn synthesise(&self, mut frame: ArrayViewMut2<f64>) {
        for (ny, nx) in levels(frame.dim()).into_iter().rev() {
            let corner = frame.slice_mut(s![..ny, ..nx]);
            change_lanes(corner, [Axis(0), Axis(1)], |lane| self.join(lane));
        }
    }
}

/// Changes all lanes of a corner along one axis after the other; an axis with one taxel is left out.
fn change_lanes(
    mut corner: ArrayViewMut2<f64>,
    axes: [Axis; 2],
    change: impl Fn(ArrayViewMut1<f64>),
) {
    for axis in axes {
        if corner.len_of(axis) > 1 {
            corner.lanes_mut(axis).into_iter().for_each(&change);
        }
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
