//! Near-duplicates: rows that are nearer to another row than the distances to their other neighbours explain.
//!
//! Let r₁ ≤ r₂ ≤ … be the distances of a row to its nearest rows. If rows are drawn from a smooth density in d dimensions, the ratio of volumes
//! u = (r₁/r_k)ᵈ is the smallest of k − 1 uniform numbers. Therefore P(u ≤ x) = 1 − (1 − x)ᵏ⁻¹ for any density (Facco et al., *Estimating the intrinsic
//! dimension of datasets by a minimal neighborhood information*, 2017). The dimension d follows from the median of r₁/r_k. A row with a copy has r₁ ≈ 0, and
//! its p-value is far below the p-values of other rows.

use std::collections::BTreeMap;

/// Number of standard errors by which the dimension is reduced, so that its error makes no row a near-duplicate.
const DIMENSION_ERRORS: f64 = 2.0;
/// Minimum number of rows from which a dimension is estimated.
const MIN_ROWS: usize = 10;

/// Tests each row for a near-duplicate. Returns the p-value of each row: the probability that, by chance, the nearest row is at least as near as observed.
///
/// `distances` contains the ascending distances of each row to its k nearest rows, k ≥ 2. The dimension is estimated for each class of `labels` and reduced
/// by two standard errors. A row has the p-value 1 if `is_tested` is false, as for rows without contact, or if its class has fewer than ten tested rows.
/// Returns `None` if no class has ten tested rows.
pub fn test_duplicates(
    distances: &[Vec<f64>],
    is_tested: &[bool],
    labels: &[usize],
) -> Option<Vec<f64>> {
    let ratio = |row: &Vec<f64>| {
        let (first, last) = (*row.first()?, *row.last()?);
        (row.len() > 1 && last > 0.0).then(|| first / last)
    };
    let others = distances.iter().map(Vec::len).max()? as f64 - 1.0;
    let mut ratios = BTreeMap::<usize, Vec<f64>>::new();
    for ((row, _), &label) in distances
        .iter()
        .zip(is_tested)
        .zip(labels)
        .filter(|((_, is), _)| **is)
    {
        ratios
            .entry(label)
            .or_default()
            .extend(ratio(row).filter(|ratio| *ratio > 0.0));
    }
    ratios.retain(|_, ratios| ratios.len() >= MIN_ROWS);
    if ratios.is_empty() {
        return None;
    }
    // Median of the smallest of k − 1 uniform numbers.
    let median = 1.0 - 0.5_f64.powf(1.0 / others);
    let dimensions = ratios.into_iter().map(|(label, mut ratios)| {
        let n = ratios.len() as f64;
        let middle = crate::statistics::quantile::quantile(&mut ratios, 0.5);
        let dimension = median.ln() / middle.ln();
        let errors = 1.0 - DIMENSION_ERRORS / n.sqrt();
        (label, (dimension * errors).clamp(1.0, 1e3))
    });
    let dimensions: BTreeMap<usize, f64> = dimensions.collect();
    let p_value = |row: &Vec<f64>, label: &usize| match (ratio(row), dimensions.get(label)) {
        (_, None) => 1.0,
        // If all distances are zero, the row has copies.
        (None, _) => f64::from(u8::from(row.len() < 2)),
        (Some(ratio), Some(&dimension)) => -(others * (-ratio.powf(dimension)).ln_1p()).exp_m1(),
    };
    let rows = distances.iter().zip(is_tested).zip(labels);
    let p_values = rows.map(|((row, is_tested), label)| match is_tested {
        true => p_value(row, label),
        false => 1.0,
    });
    Some(p_values.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

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
            all[1..=8].to_vec()
        });
        let distances: Vec<Vec<f64>> = distances.collect();
        test_duplicates(&distances, &[true; 300], &[0; 300]).unwrap()
    }

    #[test]
    fn points_of_any_dimension_have_uniform_p_values() {
        for d in [2, 5, 20] {
            let found = p_values(d, 0, 0.0);
            let below = |bound: f64| found.iter().filter(|&&p| p < bound).count();
            assert!((90..=180).contains(&below(0.5)), "{d}: {}", below(0.5));
            assert!(below(0.01) <= 14, "{d}: {}", below(0.01));
            assert!(below(1e-4 / 300.0) == 0, "{d}");
        }
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
