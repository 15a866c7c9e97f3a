//! Pink noise: 1/f noise of an amplifier that reads the taxels one after another.
//!
//! Readings are numbered row after row and frame after frame. Reading r of a touch becomes xᵣ ← xᵣ + σ pᵣ. The noise p has variance 1 and a power spectrum
//! proportional to 1/f over K octaves below the readings' frequency. Voss and McCartney's method computes p as a sum: source k of K sources is
//! redrawn every 2ᵏ readings and constant in between,
//!
//! p = K^(−½) Σₖ zₖ,  E pᵣ pᵣ₊ₗ = K⁻¹ Σₖ max(0, 1 − l/2ᵏ),  k = 0 … K − 1.
//!
//! Readings that are adjacent in time have correlated errors, so averaging and smoothing reduce them less than white noise.
//! Readings are counted back from the last one, and each source starts at a random phase of its hold time. The noise of
//! the last frame therefore does not depend on the number of frames before it.

use super::sensor_error::{Effect, ErrorAbout, Strength, TouchRead};
use crate::random::Seed;
use rand::Rng;
use rand_distr::StandardNormal;

/// Number of random sources whose sum is the pink noise. The slowest source is constant for half a million readings, longer than a touch of most arrays. If
/// the value is smaller, slow noise is missing.
const N_SOURCES: usize = 20;

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    is_random_by_reading: true,
    spans_frames: true,
    ..ErrorAbout::new(
        "pink_noise",
        &[Strength::share(
            "pink_noise_std_full_scale",
            "pink noise",
            "zero or a positive fraction of the full scale",
        )],
        |&[std, _], skin| {
            let std = std * skin.full_scale;
            Ok(Box::new(PinkNoise { std }))
        },
    )
};

/// Pink noise whose standard deviation is equal for all taxels, in the unit of the frame (metres or newtons).
#[derive(Debug)]
struct PinkNoise {
    std: f64,
}

impl Effect for PinkNoise {
    fn apply(&self, frames: &mut [f64], touch: &TouchRead, _: &mut [f64]) {
        let readings = &mut frames[touch.n_before * touch.n_taxels..];
        let scale = self.std / (N_SOURCES as f64).sqrt();
        for source in 0..N_SOURCES {
            add_held(readings, scale, 1 << source, &stream(touch.seed, source));
        }
    }
}

fn stream(touch: &Seed, source: usize) -> Seed {
    touch.named("pink noise").numbered(source as u64)
}

/// Adds the noise of one random source, whose value changes after every `hold` readings, counted back from the end. The last value lasts for a random number
/// of readings, 1 to `hold`.
fn add_held(readings: &mut [f64], scale: f64, hold: usize, stream: &Seed) {
    let mut rng = stream.rng();
    let first = rng.gen_range(1..=hold);
    let n_first = readings.len().saturating_sub(first);
    let (earlier, last) = readings.split_at_mut(n_first);
    for held in std::iter::once(last).chain(earlier.rchunks_mut(hold)) {
        let value = scale * rng.sample::<f64, _>(StandardNormal);
        held.iter_mut().for_each(|reading| *reading += value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::standard_errors::{assert_expected, of_mean};

    /// Returns pink noise of standard deviation 1 for a touch with `n_readings` readings.
    fn noise(touch: u64, n_readings: usize) -> Vec<f64> {
        let mut readings = vec![0.0; n_readings];
        let seed = Seed::new(5).numbered(touch);
        let touch = TouchRead {
            n_taxels: n_readings,
            rates: None,
            n_before: 0,
            interval: None,
            time: None,
            seed: &seed,
        };
        PinkNoise { std: 1.0 }.apply(&mut readings, &touch, &mut []);
        readings
    }

    #[test]
    fn readings_vary_together_as_the_sum_of_sources_says() {
        const N: usize = 20_000;
        let touches: Vec<Vec<f64>> = (0..N as u64).map(|touch| noise(touch, 65)).collect();
        for lag in [0, 1, 2, 5, 16, 64] {
            let products = touches.iter().map(|noise| noise[0] * noise[lag]);
            let found = products.sum::<f64>() / N as f64;
            let of_source = |k: usize| (1.0 - lag as f64 / f64::from(1 << k)).max(0.0);
            let expected = (0..N_SOURCES).map(of_source).sum::<f64>() / N_SOURCES as f64;
            // Standard deviation of a product of two normal numbers of variance 1.
            let standard_error = of_mean((1.0 + expected * expected).sqrt(), N);
            assert_expected(&format!("lag {lag}"), found, expected, standard_error);
        }
    }

    #[test]
    fn the_power_falls_by_half_an_octave() {
        // In a 1/f spectrum, all octaves of frequency have equal power.
        const N: usize = 256;
        let mut octaves = [0.0; 6];
        for touch in 0..400 {
            let noise = noise(touch, N);
            for frequency in 2..128_usize {
                let turn = std::f64::consts::TAU * frequency as f64 / N as f64;
                let part = |f: fn(f64) -> f64| -> f64 {
                    let terms = noise.iter().enumerate();
                    terms.map(|(r, p)| p * f(turn * r as f64)).sum()
                };
                octaves[frequency.ilog2() as usize - 1] +=
                    part(f64::cos).powi(2) + part(f64::sin).powi(2);
            }
        }
        let (least, most) = octaves[1..5]
            .iter()
            .fold((f64::MAX, 0.0_f64), |(a, b), &p| (a.min(p), b.max(p)));
        assert!(most / least < 1.5, "{octaves:?}");
        // White noise would have 16 times the power in the last of these octaves.
    }

    #[test]
    fn the_last_frame_is_the_same_however_many_come_before() {
        let (few, many) = (noise(3, 64), noise(3, 64 * 5));
        assert_eq!(many[64 * 4..], few[..]);
    }
}
