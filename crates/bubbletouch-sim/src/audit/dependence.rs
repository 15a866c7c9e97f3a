//! Numbers of independent rows that dependent rows are worth.
//!
//! Rows are residuals: features less the mean of the class. The mean of n rows whose correlations are ρᵢⱼ has the variance of the mean of n/(1 + Σ ρᵢⱼ/n)
//! independent rows, where the sum is over all ordered pairs of different rows.

use ndarray::{Array1, Array2, ArrayView2, Axis};
use std::collections::BTreeMap;

/// Returns rows less the means of their classes.
pub fn without_class_means(rows: ArrayView2<f64>, labels: &[usize]) -> Array2<f64> {
    let n_classes = labels.iter().max().map_or(0, |last| last + 1);
    let mut means = Array2::<f64>::zeros((n_classes, rows.ncols()));
    let mut counts = vec![0.0_f64; n_classes];
    for (row, &label) in rows.rows().into_iter().zip(labels) {
        let mut mean = means.row_mut(label);
        mean += &row;
        counts[label] += 1.0;
    }
    for (mut mean, count) in means.rows_mut().into_iter().zip(counts) {
        mean /= count.max(1.0);
    }
    let mut residuals = rows.to_owned();
    for (mut row, &label) in residuals.rows_mut().into_iter().zip(labels) {
        row -= &means.row(label);
    }
    residuals
}

/// Returns the number of independent rows that rows in the order of recording are worth. The correlation of rows k places apart is summed over k up to the first
/// pair of distances 2m, 2m + 1 without a positive sum (Geyer, *Practical Markov chain Monte Carlo*, 1992).
pub fn effective_by_order(residuals: ArrayView2<f64>) -> f64 {
    let n = residuals.nrows();
    let scale = residuals.iter().map(|x| x * x).sum::<f64>() / n.max(1) as f64;
    if scale <= 0.0 {
        return n as f64;
    }
    let correlation = |lag: usize| {
        let pairs = residuals.outer_iter().zip(residuals.outer_iter().skip(lag));
        let sum: f64 = pairs.map(|(a, b)| a.dot(&b)).sum();
        sum / (n as f64 * scale)
    };
    let mut sum = correlation(1);
    for lag in (2..n.saturating_sub(1) / 2).step_by(2) {
        let pair = correlation(lag) + correlation(lag + 1);
        if sum <= 0.0 || pair <= 0.0 {
            break;
        }
        sum += pair;
    }
    (n as f64 / (1.0 + 2.0 * sum.max(0.0))).max(1.0)
}

/// Returns the number of independent rows that rows in groups are worth. Rows of one group and class have one correlation, rows of one group and different
/// classes another: the part of the group that the classes share.
pub fn effective_by_groups(residuals: ArrayView2<f64>, labels: &[usize], groups: &[usize]) -> f64 {
    let n = labels.len() as f64;
    let square: f64 = residuals.iter().map(|x| x * x).sum();
    if square <= 0.0 {
        return n;
    }
    let of_cells = pairs(residuals, |row| (groups[row], labels[row]));
    let of_groups = pairs(residuals, |row| (groups[row], 0));
    let shared = (of_groups.0 - of_cells.0, of_groups.1 - of_cells.1);
    // Sum of the correlations of ordered pairs: mean product of the pairs over the mean square, times the number of pairs.
    let sum = |(product, n_pairs): (f64, f64)| match n_pairs > 0.0 {
        true => (product / (square / n)).max(0.0),
        false => 0.0,
    };
    n / (1.0 + (sum(of_cells) + sum(shared)) / n)
}

/// Returns the sum of the inner products of ordered pairs of different rows of one unit, and the number of these pairs.
fn pairs(residuals: ArrayView2<f64>, unit: impl Fn(usize) -> (usize, usize)) -> (f64, f64) {
    let mut units = BTreeMap::<(usize, usize), Vec<usize>>::new();
    (0..residuals.nrows()).for_each(|row| units.entry(unit(row)).or_default().push(row));
    let mut found = (0.0, 0.0);
    for rows in units.values() {
        let own = residuals.select(Axis(0), rows);
        let sum: Array1<f64> = own.sum_axis(Axis(0));
        found.0 += sum.dot(&sum) - own.iter().map(|x| x * x).sum::<f64>();
        found.1 += (rows.len() * (rows.len() - 1)) as f64;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;
    use rand_distr::StandardNormal;

    /// AR(1) with coefficient 0.8 is worth n (1 − 0.8)/(1 + 0.8) rows; runs of 8 copies are worth n/8.
    #[test]
    fn rows_in_order_are_worth_the_independent_rows_of_theory() {
        let mut rng = Seed::new(1).named("order").rng();
        let mut rows = Array2::from_shape_simple_fn((600, 30), || rng.sample(StandardNormal));
        let independent: Array2<f64> = rows.clone();
        for row in 1..600 {
            let last = rows.row(row - 1).to_owned();
            rows.row_mut(row)
                .zip_mut_with(&last, |x, last| *x = 0.6 * *x + 0.8 * last);
        }
        let found = effective_by_order(rows.view());
        assert!((57.0..80.0).contains(&found), "{found}");
        let places: Vec<usize> = (0..600).map(|row| row / 8).collect();
        let found = effective_by_order(independent.select(Axis(0), &places).view());
        assert!((65.0..85.0).contains(&found), "{found}");
        let found = effective_by_order(independent.view());
        assert!(found > 500.0, "{found}");
    }

    /// 20 groups of 6 classes of 4 rows. The style of a cell of variance 1 and noise of variance 1 are worth 480/(1 + 3/2) = 192 rows; the style of a
    /// group of variance 1 is worth 480/(1 + 23/2) = 38 rows.
    #[test]
    fn rows_in_groups_are_worth_the_independent_rows_of_theory() {
        let mut rng = Seed::new(2).named("groups").rng();
        let mut normal = |n: usize| -> Array2<f64> {
            Array2::from_shape_simple_fn((n, 30), || rng.sample(StandardNormal))
        };
        let noise = normal(480);
        let groups: Vec<usize> = (0..480).map(|row| row / 24).collect();
        let labels: Vec<usize> = (0..480).map(|row| row / 4 % 6).collect();
        for (n_styles, run, expected) in [(120, 4, 192.0), (20, 24, 38.0)] {
            let styles = normal(n_styles);
            let of_rows: Vec<usize> = (0..480).map(|row| row / run).collect();
            let rows = &noise + &styles.select(Axis(0), &of_rows);
            let found = effective_by_groups(rows.view(), &labels, &groups);
            assert!((0.75..1.33).contains(&(found / expected)), "{found}");
        }
    }
}
