//! Gain mismatch: each taxel has its own sensitivity.
//!
//! The operation is xᵢ ← gᵢ xᵢ with gᵢ = exp(s zᵢ − s²/2), zᵢ ~ N(0, 1), s² = ln(1 + std²). The gains are log-normal with mean 1 and standard deviation `std`,
//! and positive at any strength. The effect is called fixed-pattern noise in imaging and mismatching in \[SD\].

use super::sensor_error::{Effect, ErrorAbout, Strength};
use super::taxel_effect::TaxelEffect;
use crate::random::Seed;
use rand::Rng;
use rand_distr::StandardNormal;

/// Returns one random gain per taxel of a skin, constant over all touches. The random pattern over the taxels does not depend on `std`.
fn gains(std: f64, skin: &Seed, n_taxels: usize) -> Vec<f64> {
    let variance = std.powi(2).ln_1p();
    let mut rng = skin.named("gain").rng();
    let gain = |z: f64| (variance.sqrt() * z - 0.5 * variance).exp();
    (0..n_taxels)
        .map(|_| gain(rng.sample(StandardNormal)))
        .collect()
}

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    is_of_skin: true,
    by_taxel: Some(|&[std, _], _, key| {
        let s = std.powi(2).ln_1p().sqrt();
        TaxelEffect::new(move |chunk, _, values| {
            chunk.draw_sum(key, [(0, s)]);
            chunk.each(values, |value, z| value * (z - 0.5 * s * s).exp());
        })
    }),
    ..ErrorAbout::new(
        "gain",
        &[Strength::share(
            "gain_std",
            "gain mismatch",
            "zero or a positive number",
        )],
        |&[std, _], skin| {
            let gains = gains(std, &skin.name, skin.patch.n_taxels());
            Ok(Box::new(Gains(gains)))
        },
    )
};

/// Gain of each taxel, dimensionless.
#[derive(Debug)]
struct Gains(Vec<f64>);

impl Effect for Gains {
    fn apply_to_frame(&self, frame: &mut [f64], _: &mut [f64]) {
        for (value, gain) in frame.iter_mut().zip(&self.0) {
            *value *= gain;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gains(std: f64, n_taxels: usize) -> Vec<f64> {
        super::gains(std, &Seed::new(7).named("skin"), n_taxels)
    }

    #[test]
    fn gains_have_mean_one_the_asked_spread_and_are_above_zero() {
        for std in [0.05, 0.3, 1.0] {
            let gains = gains(std, 200_000);
            let n = gains.len() as f64;
            let mean = gains.iter().sum::<f64>() / n;
            let variance = gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / n;
            assert!(gains.iter().all(|&g| g > 0.0));
            assert!((mean - 1.0).abs() < 4.0 * std / n.sqrt(), "{std}: {mean}");
            // The tails of a log-normal distribution make its spread uncertain: 3 % at std = 1.
            assert!((variance.sqrt() / std - 1.0).abs() < 0.03, "{std}");
        }
    }

    #[test]
    fn a_stronger_mismatch_is_the_same_pattern_exaggerated() {
        let (weak, strong) = (gains(0.1, 64), gains(0.4, 64));
        let mut order: Vec<usize> = (0..64).collect();
        order.sort_by(|&a, &b| weak[a].total_cmp(&weak[b]));
        assert!(order.windows(2).all(|w| strong[w[0]] < strong[w[1]]));
        // A larger array of this skin continues the pattern.
        assert_eq!(gains(0.1, 80)[..64], weak[..]);
    }

    #[test]
    fn no_mismatch_is_gain_one_exactly() {
        assert_eq!(gains(0.0, 9), [1.0; 9]);
    }
}
