//! Faults: dead taxels read 0, and stuck taxels read a constant level.
//!
//! The faulty taxels and their levels are fixed for a skin. Taxels fail in a random order: dead taxels are taken from its beginning and stuck
//! taxels from its end. If a fraction increases, taxels that were faulty at the lower fraction remain faulty.
//!
//! In a `BodyReadout` each taxel fails independently, and the fractions are probabilities.

use super::sensor_error::{Effect, ErrorAbout, Strength};
use super::taxel_effect::{CHUNK, TaxelEffect};
use crate::random::Seed;
use rand::Rng;
use rand::seq::SliceRandom;

/// Indices and constant readings of the faulty taxels.
#[derive(Debug)]
struct Levels(Vec<(usize, f64)>);

impl Levels {
    /// Draws the faulty taxels of a skin: dead taxels, then stuck taxels with levels uniform between `least` and `largest`. The fractions `dead` and `stuck`
    /// are rounded to whole taxels; their sum is at most 1.
    fn draw(
        [dead, stuck]: [f64; 2],
        skin: &Seed,
        n_taxels: usize,
        [least, largest]: [f64; 2],
    ) -> Self {
        let mut rng = skin.named("faults").rng();
        let levels: Vec<f64> = (0..n_taxels)
            .map(|_| least + (largest - least) * rng.r#gen::<f64>())
            .collect();
        let mut order: Vec<usize> = (0..n_taxels).collect();
        order.shuffle(&mut rng);
        let count = |fraction: f64| (fraction * n_taxels as f64).round() as usize;
        let n_dead = count(dead);
        let n_stuck = count(stuck).min(n_taxels - n_dead);
        let dead = order.iter().take(n_dead).map(|&taxel| (taxel, 0.0));
        let stuck = order.iter().rev().take(n_stuck);
        let stuck = stuck.map(|&taxel| (taxel, levels[taxel]));
        Self(dead.chain(stuck).collect())
    }
}

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    is_of_skin: true,
    by_taxel: Some(|&[dead, stuck], full_scale, key| {
        TaxelEffect::new(move |chunk, _, values| {
            let mut levels = [0.0; CHUNK];
            if stuck > 0.0 {
                chunk.draw_uniforms(key, 1);
                let levels = &mut levels[..values.len()];
                chunk.each(levels, |_, level| full_scale * level);
            }
            chunk.draw_uniforms(key, 0);
            let mut levels = levels.iter();
            chunk.each(values, |value, luck| match levels.next() {
                _ if luck < dead => 0.0,
                Some(&level) if luck > 1.0 - stuck => level,
                _ => value,
            });
        })
    }),
    ..ErrorAbout::new(
        "faults",
        &[
            Strength::fraction("dead_fraction", "dead taxels"),
            Strength::fraction("stuck_fraction", "stuck taxels"),
        ],
        |strengths, skin| {
            let (n_taxels, range) = (skin.patch.n_taxels(), [skin.least, skin.full_scale]);
            let levels = Levels::draw(*strengths, &skin.name, n_taxels, range);
            Ok(Box::new(levels))
        },
    )
};

impl Effect for Levels {
    fn apply_to_frame(&self, frame: &mut [f64], _: &mut [f64]) {
        for &(taxel, level) in &self.0 {
            frame[taxel] = level;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taxels(dead: f64, stuck: f64) -> Vec<(usize, f64)> {
        Levels::draw([dead, stuck], &Seed::new(11), 1000, [0.0, 5e-3]).0
    }

    #[test]
    fn as_many_taxels_fail_as_asked_and_none_twice() {
        for (dead, stuck) in [(0.0, 0.0), (0.1, 0.0), (0.0, 0.25), (0.3, 0.2), (0.4, 0.6)] {
            let faults = taxels(dead, stuck);
            let n_dead = faults.iter().filter(|fault| fault.1 == 0.0).count();
            assert_eq!(n_dead as f64, 1000.0 * dead);
            assert_eq!((faults.len() - n_dead) as f64, 1000.0 * stuck);
            let mut failed: Vec<usize> = faults.iter().map(|fault| fault.0).collect();
            failed.sort_unstable();
            failed.dedup();
            assert_eq!(failed.len(), faults.len());
        }
    }

    #[test]
    fn stuck_levels_are_spread_evenly_over_the_full_scale() {
        let mut levels: Vec<f64> = taxels(0.0, 1.0).iter().map(|f| f.1).collect();
        levels.sort_by(f64::total_cmp);
        for (rank, level) in levels.iter().enumerate() {
            // The Kolmogorov–Smirnov distance is below 0.062 in 999 of 1000 skins.
            assert!((level / 5e-3 - rank as f64 / 1000.0).abs() < 0.062);
        }
    }

    #[test]
    fn a_skin_with_more_faults_has_those_of_a_skin_with_fewer() {
        let (few, many) = (taxels(0.05, 0.1), taxels(0.2, 0.4));
        assert!(few.iter().all(|fault| many.contains(fault)));
    }
}
