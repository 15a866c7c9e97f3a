//! Statistics that are robust against outliers, and their confidence intervals.

use super::Measured;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Number of groups of data in the jackknife method. If smaller, the interval is less accurate; if larger, the computation takes longer.
const N_GROUPS: usize = 20;
/// Deviation from the median at which the weight of a value becomes 0, in median absolute deviations. If smaller, precision is lost for normal data; if larger,
/// the estimate is less robust.
const REACH: f64 = 9.0;
/// Value of the biweight midvariance before normalisation for normal data of variance 1.
const OF_NORMAL: f64 = 1.018442;

/// Returns the median of some values; NaN if there are none.
pub fn median(values: &mut [f64]) -> f64 {
    match values.is_empty() {
        true => f64::NAN,
        false => crate::statistics::quantile::quantile(values, 0.5),
    }
}

/// Returns the mean of some values; NaN if there are none.
pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
    sum / f64::from(n)
}

/// Returns the biweight midvariance of the values, divided by its value for normal data of variance 1 (Mosteller and Tukey, *Data analysis and regression*,
/// 1977). Let M be the median, MAD the median absolute deviation, and u = (x − M) / (9 MAD). The biweight midvariance is n Σ (x − M)² (1 − u²)⁴ / (Σ (1 −
/// u²)(1 − 5u²))² over |u| < 1. If most values are equal, returns the ordinary variance.
pub fn variance(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = median(&mut sorted);
    let mut apart: Vec<f64> = values.iter().map(|value| (value - middle).abs()).collect();
    let reach = REACH * median(&mut apart);
    if reach == 0.0 {
        return mean(values.iter().map(|value| (value - middle).powi(2)));
    }
    let (mut squares, mut weights) = (0.0, 0.0);
    for value in values {
        let u = ((value - middle) / reach).powi(2);
        if u < 1.0 {
            squares += (value - middle).powi(2) * (1.0 - u).powi(4);
            weights += (1.0 - u) * (1.0 - 5.0 * u);
        }
    }
    values.len() as f64 * squares / (weights * weights * OF_NORMAL)
}

/// Returns the half-sample mode (Bickel and Frühwirth, Computational Statistics & Data Analysis 50, 2006), refined until convergence. The refinement
/// repeatedly replaces the mode by the mean of the values within a window around the mode. The half width of the window is three times the median distance of
/// the values below the mode. Sorts the values; returns NaN if there are none.
pub fn mode(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let mut densest = &*values;
    while densest.len() > 3 {
        let n = densest.len().div_ceil(2);
        let width = |from: &usize| densest[from + n - 1] - densest[*from];
        let from = (0..=densest.len() - n).min_by(|a, b| width(a).total_cmp(&width(b)));
        let from = from.unwrap_or(0);
        densest = &densest[from..from + n];
    }
    let mut found = mean(densest.iter().copied());
    for _ in 0..20 {
        let below = values.partition_point(|&value| value < found);
        let mut spread: Vec<f64> = values[..below].iter().map(|value| found - value).collect();
        let window = 3.0 * median(&mut spread);
        let near = values
            .iter()
            .filter(|&value| (value - found).abs() <= window);
        let next = mean(near.copied());
        if !next.is_finite() || next == found {
            break;
        }
        found = next;
    }
    found
}

/// Returns an estimate from n ordered units with its 95 % interval, by the jackknife over [`N_GROUPS`] runs of adjacent units with Student's t. Source: Efron
/// and Tibshirani, *An introduction to the bootstrap*, 1993, chapter 11. The function `estimate` computes the estimate from the units for which its argument
/// returns true; it returns `None` if an estimate is impossible.
pub fn jackknife(
    n: usize,
    estimate: impl Fn(&dyn Fn(usize) -> bool) -> Option<f64>,
) -> Option<Measured> {
    let value = estimate(&|_| true).filter(|value| value.is_finite())?;
    let group = |unit: usize| unit * N_GROUPS / n.max(1);
    let without = (0..N_GROUPS).filter_map(|left_out| estimate(&|unit| group(unit) != left_out));
    let without: Vec<f64> = without.filter(|value| value.is_finite()).collect();
    let k = without.len() as f64;
    let middle = mean(without.iter().copied());
    let squares: f64 = without.iter().map(|one| (one - middle).powi(2)).sum();
    let half = student(k - 1.0)? * ((k - 1.0) / k * squares).sqrt();
    Some(Measured {
        value,
        interval: [value - half, value + half],
    })
}

/// Returns the 97.5 % quantile of Student's t distribution with the given degrees of freedom.
fn student(freedom: f64) -> Option<f64> {
    let distribution = StudentsT::new(0.0, 1.0, freedom).ok()?;
    Some(distribution.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;
    use rand_distr::StandardNormal;

    fn normal(n: usize, name: &str) -> Vec<f64> {
        let mut rng = Seed::new(1).named(name).rng();
        (0..n).map(|_| rng.sample(StandardNormal)).collect()
    }

    #[test]
    fn wild_values_move_neither_spread_nor_mode() {
        let mut values = normal(20_000, "values");
        assert!((variance(&values) - 1.0).abs() < 0.02);
        assert!(mode(&mut values).abs() < 0.1);
        values.extend((0..2000).map(|k| 50.0 + f64::from(k)));
        assert!((variance(&values) - 1.0).abs() < 0.25);
        assert!(mode(&mut values).abs() < 0.1);
        assert_eq!(variance(&[2.0, 2.0, 2.0, 5.0]), 9.0 / 4.0);
    }

    #[test]
    fn the_interval_of_a_mean_holds_it_as_often_as_it_says() {
        let holds = (0..200).filter(|k| {
            let values = normal(400, &format!("{k}"));
            let of = |keep: &dyn Fn(usize) -> bool| {
                let kept = values.iter().enumerate().filter(|(unit, _)| keep(*unit));
                Some(mean(kept.map(|(_, value)| *value)))
            };
            jackknife(values.len(), of).is_some_and(|found| {
                let [low, high] = found.interval;
                low <= 0.0 && 0.0 <= high
            })
        });
        assert!((180..=199).contains(&holds.count()));
    }
}
