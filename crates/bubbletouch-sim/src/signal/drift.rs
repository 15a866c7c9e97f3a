//! Offset drift: the zero offset of each taxel changes randomly over a recording session.
//!
//! The zero offset of a taxel is a random walk over the time t of the session. The offset is 0 at the beginning (the skin has just been zeroed) and has the
//! standard deviation σ at the end: xᵢ ← xᵢ + σ Wᵢ(t). W is a Wiener process, the usual model of a sensor's bias instability. The walk is computed from its
//! Karhunen–Loève expansion
//!
//! W(t) = c Σₖ ξₖ √2 sin((k − ½) π t) / ((k − ½) π),  ξₖ ~ N(0, 1),  k = 1 … 64,
//!
//! The zero offset at any time can be computed without earlier times, so touches need no order. The 64 terms contain 99.7 % of the variance; the factor c
//! makes the variance at the end exactly σ².
//!
//! A `BodyReadout` uses counter-based random numbers. Its W is linear between 2⁶ + 1 equally spaced times of the session.

use super::sensor_error::{Effect, ErrorAbout, Strength, TouchRead};
use super::taxel_effect::TaxelEffect;
use crate::random::Seed;
use rand::Rng;
use rand_distr::StandardNormal;
use std::f64::consts::{PI, SQRT_2};

/// Number of terms of the Karhunen–Loève expansion. If the number is smaller, the zero offsets of all taxels vary in a space of few dimensions, which a
/// classifier can learn to ignore. With 8 terms, drift of any strength hardly affects a linear classifier; a real random walk does not allow this. If the
/// number is larger, time and memory increase.
const N_MODES: usize = 64;

/// Drifting zero offsets of the taxels of a skin. The offsets can be computed for any time of a recording session.
#[derive(Clone, Debug)]
struct Zeros {
    n_taxels: usize,
    /// Coefficients ξ of the Karhunen–Loève expansion, mode after mode, one per taxel.
    coefficients: Vec<f64>,
    /// Amplitude of each mode of the Karhunen–Loève expansion, in the unit of the frame.
    amplitudes: Vec<f64>,
}

impl Zeros {
    /// Draws the drift of a skin. `full_scale` is in the unit of the frames. `std` is the standard deviation of the zero offsets at the end of the recording
    /// session, relative to the full scale. The random pattern over the taxels does not depend on `std`.
    fn new(std: f64, skin: &Seed, n_taxels: usize, full_scale: f64) -> Self {
        let usual: Vec<f64> = (0..N_MODES).map(|mode| SQRT_2 / frequency(mode)).collect();
        let at_end = usual.iter().map(|a| a * a).sum::<f64>().sqrt();
        let mut rng = skin.named("drift").rng();
        Self {
            n_taxels,
            coefficients: (0..N_MODES * n_taxels)
                .map(|_| rng.sample(StandardNormal))
                .collect(),
            amplitudes: usual
                .iter()
                .map(|a| std * full_scale * a / at_end)
                .collect(),
        }
    }

    /// Writes the zero offset of each taxel at a time of the recording session (0 is the beginning, 1 the end).
    fn at(&self, time: f64, zeros: &mut [f64]) {
        zeros.fill(0.0);
        let modes = self.coefficients.chunks_exact(self.n_taxels);
        for (mode, coefficients) in modes.enumerate() {
            let weight = self.amplitudes[mode] * (frequency(mode) * time).sin();
            for (zero, coefficient) in zeros.iter_mut().zip(coefficients) {
                *zero += weight * coefficient;
            }
        }
    }
}

/// Returns the random time of a touch, as a fraction of the recording session, uniform in [0, 1).
fn time_of(touch: &Seed) -> f64 {
    touch.named("time").rng().r#gen()
}

/// Returns the angular frequency (k − ½) π of mode k of the Karhunen–Loève expansion, where k = `mode` + 1.
fn frequency(mode: usize) -> f64 {
    (mode as f64 + 0.5) * PI
}

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    is_of_skin: true,
    by_taxel: Some(|&[std, _], full_scale, key| {
        let std = std * full_scale;
        TaxelEffect::new(move |chunk, moment, values| {
            let terms = walk(moment.time).map(|(node, weight)| (node, std * weight));
            chunk.draw_sum(key, terms);
            chunk.each(values, |value, zero| value + zero);
        })
    }),
    is_random_by_reading: true,
    ..ErrorAbout::new(
        "drift",
        &[Strength::share(
            "drift_std_full_scale",
            "drift",
            "zero or a positive fraction of the full scale",
        )],
        |&[std, _], skin| {
            let (n_taxels, full_scale) = (skin.patch.n_taxels(), skin.full_scale);
            Ok(Box::new(Zeros::new(std, &skin.name, n_taxels, full_scale)))
        },
    )
};

impl Effect for Zeros {
    fn scratch_len(&self) -> usize {
        self.n_taxels
    }

    fn apply(&self, frames: &mut [f64], touch: &TouchRead, scratch: &mut [f64]) {
        let now = &mut scratch[..self.n_taxels];
        self.at(touch.time.unwrap_or_else(|| time_of(touch.seed)), now);
        for frame in frames.chunks_exact_mut(self.n_taxels) {
            for (value, zero) in frame.iter_mut().zip(&*now) {
                *value += zero;
            }
        }
    }
}

/// Number of times that Lévy's construction of the random walk halves the recording session: 2⁶ intervals, with as many random numbers per taxel as
/// [`N_MODES`].
const N_HALVINGS: u32 = 6;

/// Returns the indices and weights of the normal numbers whose weighted sum is a Wiener process at `time`, 0 to 1 (Lévy's construction). Number 0 is the
/// value at the end, and number 2ˡ + k displaces the middle of interval k of 2ˡ equal intervals.
fn walk(time: f64) -> [(u64, f64); 1 + N_HALVINGS as usize] {
    let mut terms = [(0, time); 1 + N_HALVINGS as usize];
    for (halving, term) in terms[1..].iter_mut().enumerate() {
        let n_pieces = 1u64 << halving;
        let within = time * n_pieces as f64;
        let piece = (within as u64).min(n_pieces - 1);
        let tent = 1.0 - (2.0 * (within - piece as f64) - 1.0).abs();
        *term = (n_pieces + piece, 0.5 * tent / (n_pieces as f64).sqrt());
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zeros_at(time: f64, n_taxels: usize) -> Vec<f64> {
        let zeros = Zeros::new(0.1, &Seed::new(3), n_taxels, 5e-3);
        let mut values = vec![f64::NAN; n_taxels];
        zeros.at(time, &mut values);
        values
    }

    fn covariance(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
    }

    #[test]
    fn zeros_wander_as_a_random_walk_does() {
        let n = 40_000;
        let (early, late, end) = (zeros_at(0.3, n), zeros_at(0.8, n), zeros_at(1.0, n));
        let variance = 0.5e-3f64.powi(2);
        // Four standard errors, and the 0.3 % that 64 terms omit.
        let near = |found: f64, of: f64| (found / variance - of).abs() < 0.003 + 4.0 * 1.5 / 200.0;
        assert!((covariance(&end, &end) / variance - 1.0).abs() < 4.0 * (2.0 / n as f64).sqrt());
        assert!(near(covariance(&early, &early), 0.3));
        assert!(near(covariance(&late, &late), 0.8));
        // Cov(W(s), W(t)) = min(s, t): later values include earlier ones.
        assert!(near(covariance(&early, &late), 0.3));
        assert!(near(covariance(&early, &end), 0.3));
        let neighbours = covariance(&end[1..], &end[..n - 1]);
        assert!(neighbours.abs() < 4.0 * variance / (n as f64).sqrt());
    }

    #[test]
    fn a_session_begins_with_every_zero_at_zero() {
        assert_eq!(zeros_at(0.0, 50), [0.0; 50]);
    }

    #[test]
    fn touches_come_evenly_over_the_session() {
        let mut times: Vec<f64> = (0..2000)
            .map(|t| time_of(&Seed::new(1).numbered(t)))
            .collect();
        times.sort_by(f64::total_cmp);
        for (rank, time) in times.iter().enumerate() {
            // The Kolmogorov–Smirnov distance is below 0.044 in 999 of 1000 series.
            assert!((time - rank as f64 / 2000.0).abs() < 0.044);
        }
    }
}
