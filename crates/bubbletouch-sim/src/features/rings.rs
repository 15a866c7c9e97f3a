//! Magnitudes of harmonics around rings, which do not depend on the reference angle.

use multiversion::multiversion;
use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};
use std::fmt;
use std::sync::Arc;

/// Transform that computes the low-order harmonics hₖ of values f at equal angles around several rings:
///
/// hₖ = |Σⱼ f(θⱼ) exp(−2πi j k / n)| / n, k = 0 … `n_harmonics` − 1.
///
/// A rotation of a ring by j₀ steps multiplies the complex harmonic k by exp(2πi j₀ k / n), so its magnitude hₖ does not change.
pub(super) struct Rings {
    n_angles: usize,
    n_harmonics: usize,
    around: Arc<dyn RealToComplex<f64>>,
}

/// Scratch memory for the harmonics.
#[derive(Clone, Debug, Default)]
pub struct RingWorkspace {
    /// Sampled values, ring after ring, `n_angles` values each; the transform overwrites them.
    pub(super) values: Vec<f64>,
    of_ring: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl Rings {
    pub(super) fn new(n_angles: usize, n_harmonics: usize) -> Self {
        Self {
            n_angles,
            n_harmonics,
            around: RealFftPlanner::new().plan_fft_forward(n_angles),
        }
    }

    /// Writes the harmonics of `workspace.values` to `out`, ring after ring.
    pub(super) fn write(&self, workspace: &mut RingWorkspace, out: &mut [f64]) {
        let RingWorkspace {
            values,
            of_ring,
            scratch,
        } = workspace;
        of_ring.resize(self.n_angles / 2 + 1, Complex::default());
        scratch.resize(self.around.get_scratch_len(), Complex::default());
        let rings = values.chunks_exact_mut(self.n_angles);
        for (ring, out) in rings.zip(out.chunks_exact_mut(self.n_harmonics)) {
            let done = self.around.process_with_scratch(ring, of_ring, scratch);
            done.expect("rings of n values");
            for (to, value) in out.iter_mut().zip(&*of_ring) {
                *to = value.norm_sqr();
            }
        }
        roots(out);
        out.iter_mut()
            .for_each(|value| *value /= self.n_angles as f64);
    }
}

/// Replaces the values by their square roots, using vector instructions.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn roots(values: &mut [f64]) {
    for value in values {
        *value = value.sqrt();
    }
}

impl fmt::Debug for Rings {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} harmonics of {}", self.n_harmonics, self.n_angles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn harmonics_are_those_of_the_definition_and_a_turned_ring_has_the_same() {
        let (n, n_harmonics) = (12, 7);
        let ring: Vec<f64> = (0..n).map(|j| ((j * j) as f64).sin()).collect();
        let rings = Rings::new(n, n_harmonics);
        let found = |values: &[f64]| {
            let mut workspace = RingWorkspace {
                values: values.to_vec(),
                ..RingWorkspace::default()
            };
            let mut out = vec![0.0; n_harmonics];
            rings.write(&mut workspace, &mut out);
            out
        };
        let harmonics = found(&ring);
        let mut turned = ring.clone();
        turned.rotate_left(5);
        for (k, (a, b)) in harmonics.iter().zip(found(&turned)).enumerate() {
            let angle = |j: usize| -TAU * (j * k) as f64 / n as f64;
            let terms = ring.iter().enumerate();
            let terms = terms.map(|(j, value)| Complex::from_polar(*value, angle(j)));
            let expected = terms.sum::<Complex<f64>>().norm() / n as f64;
            assert!((a - expected).abs() < 1e-14 && (a - b).abs() < 1e-14, "{k}");
        }
    }
}
