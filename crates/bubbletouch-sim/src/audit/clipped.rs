//! Clipped taxels: taxels whose largest reading is more frequent than the readings below it allow.
//!
//! Above the contact readings become rarer, so that the largest level of a taxel is at most as frequent as the level below it. If c readings equal the largest
//! level and b readings the level below, c has at most the binomial distribution of c + b trials with probability 1/2. Continuous readings have no equal
//! largest readings at all.

use ndarray::ArrayView1;
use statrs::distribution::{Binomial, DiscreteCDF};

/// Minimum number of readings at the largest level, and as a fraction of the readings.
const MIN_READINGS: usize = 3;
const MIN_SHARE: f64 = 0.005;
/// Maximum fraction of readings that equal another reading, apart from the largest ones, in continuous readings.
const MAX_EQUAL: f64 = 0.1;
/// Maximum fraction of readings at the largest level; a more frequent level is the reading at rest.
const MAX_SHARE: f64 = 0.5;

/// Returns the largest reading of a taxel if the taxel is clipped. `ascending` contains the readings in ascending order. `significance` is the probability of
/// reporting a taxel that is not clipped.
pub fn clipped_at(ascending: ArrayView1<f64>, significance: f64) -> Option<f64> {
    let n = ascending.len();
    let largest = *ascending.last()?;
    let n_largest = ascending
        .iter()
        .rev()
        .take_while(|&&x| x == largest)
        .count();
    let share = n_largest as f64 / n as f64;
    if n_largest < MIN_READINGS || !(MIN_SHARE..=MAX_SHARE).contains(&share) {
        return None;
    }
    let below = ascending.slice(ndarray::s![..n - n_largest]);
    let pairs = below.windows(2);
    let gaps = pairs.into_iter().map(|pair| pair[1] - pair[0]);
    let n_equal = gaps.clone().filter(|&gap| gap == 0.0).count();
    if (n_equal as f64) <= MAX_EQUAL * n as f64 {
        return Some(largest);
    }
    let step = gaps.filter(|&gap| gap > 0.0).fold(f64::INFINITY, f64::min);
    // The level of clipping need not be a multiple of the step.
    let is_next = |reading: &&f64| largest - **reading < 1.5 * step.max(f64::MIN_POSITIVE);
    let n_next = below.iter().rev().take_while(is_next).count();
    let binomial = Binomial::new(0.5, (n_largest + n_next) as u64).ok()?;
    let p_value = binomial.sf(n_largest as u64 - 1);
    (p_value <= significance && n_largest >= 3 * n_next).then_some(largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use ndarray::Array1;
    use rand::Rng;
    use rand_distr::StandardNormal;

    #[test]
    fn clipped_readings_are_found_and_tails_are_not() {
        let mut rng = Seed::new(9).named("clipped").rng();
        for levels in [f64::INFINITY, 200.0] {
            for trial in 0..40 {
                let readings = (0..300).map(|_| rng.sample::<f64, _>(StandardNormal));
                let mut readings: Vec<f64> = readings.collect();
                if levels.is_finite() {
                    readings
                        .iter_mut()
                        .for_each(|x| *x = (*x * levels / 6.0).round());
                }
                readings.sort_by(f64::total_cmp);
                let free = Array1::from(readings.clone());
                assert_eq!(clipped_at(free.view(), 1e-4), None, "{levels} {trial}");
                let level = readings[260];
                let clipped = free.mapv(|x| x.min(level));
                assert_eq!(
                    clipped_at(clipped.view(), 1e-4),
                    Some(level),
                    "{levels} {trial}"
                );
            }
        }
    }
}
