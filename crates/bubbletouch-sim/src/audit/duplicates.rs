//! Near-duplicates: rows that are nearer to other rows than the distances to their further neighbours explain.
//!
//! Let r₁ ≤ r₂ ≤ … be the distances of a row to its nearest rows. If rows are drawn from a smooth density in d dimensions, the gaps
//! g_j = j ln(r_{j+1} / r_j) are independent exponential numbers of rate d for any density (Rényi's representation of the uniform order statistics r_jᵈ; compare
//! Facco et al., *Estimating the intrinsic dimension of datasets by a minimal neighborhood information*, 2017). A row with j copies has a large gap g_j.
//!
//! The dimension differs from row to row, because noise has other dimensions than poses. Within a class it is assumed to have a gamma distribution of shape a
//! and rate b, fitted to the sums T of the gaps other than g_j: ln(T/m) of m gaps has the median ψ(m) − ln m − ψ(a) + ln b and the variance ψ′(m) + ψ′(a).
//! Then P(g_j > x | T) = ((b + T) / (b + T + x))^{a + m}. The scale of g_j relative to other gaps is a power of j, because the dimension of the data depends on
//! the scale of distances. The power is fitted to all gaps robustly, so that the gap of copies remains.
//!
//! The p-value of a row is the smallest p-value of its gaps after Bonferroni's correction with weights: the p-value of g_j is multiplied by j (j + 1). Pairs,
//! which are the most frequent copies, are multiplied by two only.

use crate::statistics::quantile::{of_sorted, quantile};
use statrs::function::gamma::digamma;
use std::collections::BTreeMap;

/// Minimum number of rows from which a dimension is estimated.
const MIN_ROWS: usize = 10;
/// Minimum number of neighbours of a row, and maximum number of copies as a fraction of the rows of a class. Larger clusters are groups, not copies.
const MIN_NEIGHBOURS: usize = 8;
const MAX_COPIES: f64 = 0.25;
/// Number of standard deviations between the quartiles of a normal distribution.
const QUARTILES: f64 = 1.349;
/// Gap of rows at distance zero, in place of infinity.
const COPY: f64 = 50.0;

/// Tests each row for near-duplicates. Returns the p-value of each row: the probability that, by chance, its nearest rows are at least as near as observed,
/// relative to the further ones.
///
/// `distances` contains the ascending distances of each row to its k nearest rows, k ≥ 3. A row has the p-value 1 if `is_tested` is false, as for rows without
/// contact, or if its class has fewer than ten tested rows. Returns `None` if no class has ten tested rows.
pub fn test_duplicates(
    distances: &[Vec<f64>],
    is_tested: &[bool],
    labels: &[usize],
) -> Option<Vec<f64>> {
    let mut classes = BTreeMap::<usize, Vec<usize>>::new();
    for (row, &label) in labels.iter().enumerate() {
        let is_far = distances[row].last().is_some_and(|&last| last > 0.0);
        if is_tested[row] && distances[row].len() > 2 && is_far {
            classes.entry(label).or_default().push(row);
        }
    }
    classes.retain(|_, rows| rows.len() >= MIN_ROWS);
    if classes.is_empty() {
        return None;
    }
    let is_copied = |row: usize| is_tested[row] && distances[row].last() == Some(&0.0);
    // If all distances are zero, the row has copies.
    let mut p_values: Vec<f64> = (0..labels.len())
        .map(|row| f64::from(u8::from(!is_copied(row))))
        .collect();
    for rows in classes.into_values() {
        let most = (MAX_COPIES * rows.len() as f64) as usize;
        let k = rows.iter().map(|&row| distances[row].len()).min()?;
        let k = k.min(most.max(MIN_NEIGHBOURS)).max(3);
        let gaps: Vec<Vec<f64>> = rows.iter().map(|&row| gaps(&distances[row][..k])).collect();
        let gaps = with_equal_scales(gaps);
        for (row, p_value) in rows.into_iter().zip(test_gaps(&gaps)) {
            p_values[row] = p_value;
        }
    }
    Some(p_values)
}

/// Returns j ln(r_{j+1} / r_j) for j = 1, 2, …
fn gaps(distances: &[f64]) -> Vec<f64> {
    let pairs = distances.windows(2).enumerate();
    let gaps = pairs.map(|(j, pair)| {
        let gap = (pair[1] / pair[0]).ln().min(COPY);
        (j + 1) as f64 * if pair[1] > 0.0 { gap } else { 0.0 }
    });
    gaps.collect()
}

/// Divides the gaps by a power of their number, fitted to the medians over rows by the median of the slopes of all pairs (Theil and Sen).
fn with_equal_scales(mut gaps: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = gaps[0].len();
    let medians =
        (0..n).map(|j| quantile(&mut gaps.iter().map(|row| row[j]).collect::<Vec<_>>(), 0.5));
    let points = medians.enumerate().filter(|(_, median)| *median > 0.0);
    let points: Vec<(f64, f64)> = points
        .map(|(j, median)| (((j + 1) as f64).ln(), median.ln()))
        .collect();
    let mut slopes = Vec::new();
    for (place, first) in points.iter().enumerate() {
        slopes.extend(
            points[place + 1..]
                .iter()
                .map(|second| (second.1 - first.1) / (second.0 - first.0)),
        );
    }
    let slope = quantile(&mut slopes, 0.5);
    for row in &mut gaps {
        for (j, gap) in row.iter_mut().enumerate() {
            *gap /= ((j + 1) as f64).powf(slope);
        }
    }
    gaps
}

/// Returns the p-value of the largest gap of each row; shape (n_rows, n_gaps).
fn test_gaps(gaps: &[Vec<f64>]) -> Vec<f64> {
    let n_gaps = gaps[0].len();
    let m = (n_gaps - 1) as f64;
    let mut p_values = vec![1.0_f64; gaps.len()];
    for j in 0..n_gaps {
        let rests: Vec<f64> = gaps
            .iter()
            .map(|row| row.iter().sum::<f64>() - row[j])
            .collect();
        let known = rests.iter().filter(|&&rest| rest > 0.0);
        let mut logs: Vec<f64> = known.map(|rest| (rest / m).ln()).collect();
        if logs.len() < MIN_ROWS {
            continue;
        }
        let middle = quantile(&mut logs, 0.5);
        let std = (of_sorted(&logs, 0.75) - of_sorted(&logs, 0.25)) / QUARTILES;
        // The error of the dimension of a class of n rows is about 1/√n of it; twice this error is the least spread.
        let spread = (std * std - trigamma(m)).max(4.0 / logs.len() as f64);
        let a = inverse_trigamma(spread);
        let b = (middle - digamma(m) + m.ln() + digamma(a)).exp();
        for ((row, rest), p_value) in gaps.iter().zip(rests).zip(&mut p_values) {
            let log_p = (a + m) * ((b + rest) / (b + rest + row[j])).ln();
            // Bonferroni's correction with the weight 1 / (j (j + 1)) of g_j. The weights of all gaps add up to less than one.
            *p_value = p_value.min(log_p.exp() * ((j + 1) * (j + 2)) as f64);
        }
    }
    p_values
}

/// Returns ψ′(x) for x > 0, by the recurrence ψ′(x) = ψ′(x + 1) + 1/x² and the asymptotic series.
fn trigamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 10.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let y = 1.0 / x;
    sum + y + 0.5 * y * y + y.powi(3) / 6.0 - y.powi(5) / 30.0 + y.powi(7) / 42.0
}

/// Returns x > 0 with ψ′(x) = y, by bisection.
fn inverse_trigamma(y: f64) -> f64 {
    let (mut low, mut high) = (1e-3_f64, 1e6_f64);
    for _ in 0..100 {
        let middle = (low * high).sqrt();
        if trigamma(middle) > y {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low * high).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    fn nearest(points: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let distances = points.iter().map(|a| {
            let away = |b: &Vec<f64>| {
                a.iter()
                    .zip(b)
                    .map(|(a, b)| (a - b).powi(2))
                    .sum::<f64>()
                    .sqrt()
            };
            let mut all: Vec<f64> = points.iter().map(away).collect();
            all.sort_by(f64::total_cmp);
            all[1..=16].to_vec()
        });
        distances.collect()
    }

    /// Returns the p-values of random points in `d` dimensions; the last `n_copies` points are copies of the first ones, up to `apart`.
    fn p_values(d: usize, n_copies: usize, apart: f64) -> Vec<f64> {
        let mut rng = Seed::new(8).named("points").numbered(d as u64).rng();
        let mut points: Vec<Vec<f64>> = (0..300)
            .map(|_| (0..d).map(|_| rng.r#gen()).collect())
            .collect();
        for copy in 0..n_copies {
            points[299 - copy] = points[copy]
                .iter()
                .map(|x| x + apart * rng.r#gen::<f64>())
                .collect();
        }
        test_duplicates(&nearest(&points), &[true; 300], &[0; 300]).unwrap()
    }

    #[test]
    fn points_of_any_dimension_have_uniform_p_values() {
        for d in [2, 5, 20] {
            let found = p_values(d, 0, 0.0);
            let below = |bound: f64| found.iter().filter(|&&p| p < bound).count();
            assert!(below(0.5) > 30, "{d}: {}", below(0.5));
            assert!(below(0.01) <= 14, "{d}: {}", below(0.01));
            assert!(below(1e-4 / 300.0) == 0, "{d}");
        }
    }

    #[test]
    fn clusters_of_copies_are_found() {
        let mut rng = Seed::new(9).named("clusters").rng();
        // 75 poses in four dimensions, each with four rows that differ by noise in 40 dimensions.
        let poses: Vec<Vec<f64>> = (0..75)
            .map(|_| (0..4).map(|_| rng.r#gen()).collect())
            .collect();
        let points: Vec<Vec<f64>> = (0..300)
            .map(|row| {
                let noise = (0..40).map(|_| 0.005 * rng.r#gen::<f64>());
                poses[row / 4].iter().copied().chain(noise).collect()
            })
            .collect();
        let found = test_duplicates(&nearest(&points), &[true; 300], &[0; 300]).unwrap();
        let n_found = found.iter().filter(|&&p| p < 0.01 / 300.0).count();
        assert!(n_found > 200, "{n_found}");
    }

    #[test]
    fn rows_of_two_dimensions_are_no_duplicates() {
        // Half of the rows have three dimensions, the others thirty.
        let mut rng = Seed::new(10).named("mixed").rng();
        let points: Vec<Vec<f64>> = (0..1000)
            .map(|row| {
                let d = if row % 2 == 0 { 3 } else { 30 };
                (0..30)
                    .map(|k| if k < d { rng.r#gen() } else { 5.0 })
                    .collect()
            })
            .collect();
        let found = test_duplicates(&nearest(&points), &[true; 1000], &[0; 1000]).unwrap();
        assert!(
            found.iter().all(|&p| p > 0.01 / 1000.0),
            "{:?}",
            found.iter().copied().fold(1.0, f64::min)
        );
    }

    #[test]
    fn copies_are_found() {
        for (d, apart) in [(2, 1e-6), (5, 1e-3), (20, 0.03)] {
            let found = p_values(d, 10, apart);
            let n_found = found.iter().filter(|&&p| p < 0.01 / 300.0).count();
            assert_eq!(n_found, 20, "{d}");
        }
    }
}
