//! Permutation tests of dependence between rows: neighbours in time, and members of a group.
//!
//! All statistics are sums of inner products of pairs of rows, where the mean of the class is subtracted from each row. A permutation exchanges rows of one
//! class. Therefore the classes and their order in time are preserved.

use crate::random::Seed;
use ndarray::{Array2, ArrayView2};
use rand::seq::SliceRandom;
use std::collections::BTreeMap;

/// Maximum distance in time of two rows that count as neighbours.
const MAX_LAG: usize = 10;

/// Minimum number of permutations if none of fewer permutations reaches the observed value. A p-value of 1/4,001 remains significant after a correction for 40
/// tests.
const N_EXTENDED: usize = 4000;

/// Returns the maximum number of permutations of a test of `n_permutations` permutations, none of which reaches the observed value.
pub fn max_permutations(n_permutations: usize) -> usize {
    N_EXTENDED.max(4 * n_permutations)
}

/// Returns whether a test of `n_permutations` permutations needs another one after `n_done` permutations, of which `at_least` reach the observed value. If none
/// of them does, more permutations resolve smaller p-values.
pub fn permutes_again(n_permutations: usize, n_done: usize, at_least: usize) -> bool {
    n_done < n_permutations || (at_least == 0 && n_done < max_permutations(n_permutations))
}

/// Correlation of pairs of rows, and its permutation test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dependence {
    /// Mean inner product of the pairs, relative to the mean squared norm of a row; 0 for independent rows, 1 for equal rows.
    pub correlation: f64,
    /// Probability of at least this correlation if rows of a class are exchangeable.
    pub p_value: f64,
}

/// Tests whether rows at most ten places apart in time are more alike than other rows of their classes. `residuals` are rows less the means of their classes.
/// Returns `None` for fewer than 20 rows, or rows without spread.
pub fn serial_dependence(
    residuals: ArrayView2<f64>,
    labels: &[usize],
    n_permutations: usize,
    seed: &Seed,
) -> Option<Dependence> {
    let n = labels.len();
    if n < 20 {
        return None;
    }
    let lag = MAX_LAG.min(n / 10);
    let pairs = (0..n).flat_map(|row| (1..=lag).map(move |lag| (row, row + lag)));
    let pairs: Vec<(usize, usize)> = pairs.filter(|(_, other)| *other < n).collect();
    test(residuals, labels, &pairs, n_permutations, seed)
}

/// Tests whether rows of one class and one group are more alike than other rows of the class. Returns `None` if no group has two rows of a class, each class
/// is in a single group, or rows have no spread.
pub fn group_dependence(
    residuals: ArrayView2<f64>,
    labels: &[usize],
    groups: &[usize],
    n_permutations: usize,
    seed: &Seed,
) -> Option<Dependence> {
    let mut cells = BTreeMap::<(usize, usize), Vec<usize>>::new();
    for (row, (&label, &group)) in labels.iter().zip(groups).enumerate() {
        cells.entry((label, group)).or_default().push(row);
    }
    let n_classes = labels
        .iter()
        .collect::<std::collections::BTreeSet<_>>()
        .len();
    if cells.len() == n_classes {
        return None;
    }
    let mut pairs = Vec::new();
    for rows in cells.values() {
        for (place, &row) in rows.iter().enumerate() {
            pairs.extend(rows[place + 1..].iter().map(|&other| (row, other)));
        }
    }
    test(residuals, labels, &pairs, n_permutations, seed)
}

fn test(
    residuals: ArrayView2<f64>,
    labels: &[usize],
    pairs: &[(usize, usize)],
    n_permutations: usize,
    seed: &Seed,
) -> Option<Dependence> {
    let products: Array2<f64> = residuals.dot(&residuals.t());
    let scale = products.diag().mean().unwrap_or(0.0);
    if pairs.is_empty() || scale <= 0.0 {
        return None;
    }
    let mut classes = BTreeMap::<usize, Vec<usize>>::new();
    for (row, &label) in labels.iter().enumerate() {
        classes.entry(label).or_default().push(row);
    }
    let sum = |place: &[usize]| -> f64 {
        let pairs = pairs.iter();
        pairs.map(|&(a, b)| products[(place[a], place[b])]).sum()
    };
    let mut places: Vec<usize> = (0..labels.len()).collect();
    let observed = sum(&places);
    let mut rng = seed.named("dependence").rng();
    let (mut at_least, mut n_done) = (0, 0);
    while permutes_again(n_permutations, n_done, at_least) {
        n_done += 1;
        for rows in classes.values() {
            let mut shuffled = rows.clone();
            shuffled.shuffle(&mut rng);
            for (&row, place) in rows.iter().zip(shuffled) {
                places[row] = place;
            }
        }
        // Equal sums in another order of addition differ by rounding.
        at_least += usize::from(sum(&places) >= observed - 1e-9 * observed.abs());
    }
    Some(Dependence {
        correlation: observed / pairs.len() as f64 / scale,
        p_value: (1 + at_least) as f64 / (1 + n_done) as f64,
    })
}

/// Returns the standard deviation over taxels of the change of their level between the first and the last third of the rows. The part that noise explains
/// is subtracted. `residuals` are the readings of untouched taxels, less the means of their classes.
pub fn change_of_level(residuals: ArrayView2<f64>) -> f64 {
    let n = residuals.nrows() / 3;
    if n < 2 {
        return 0.0;
    }
    let mut squares = 0.0;
    for taxel in residuals.columns() {
        let ends = [0..n, taxel.len() - n..taxel.len()].map(|rows| {
            let rows = taxel.slice(ndarray::s![rows]);
            (rows.mean().unwrap_or(0.0), rows.var(1.0) / n as f64)
        });
        squares += (ends[1].0 - ends[0].0).powi(2) - ends[0].1 - ends[1].1;
    }
    (squares / residuals.ncols().max(1) as f64).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_distr::StandardNormal;

    #[test]
    fn drift_and_groups_are_found_and_noise_is_not() {
        let labels: Vec<usize> = (0..120).map(|row| row / 40).collect();
        let groups: Vec<usize> = (0..120).map(|row| row / 8).collect();
        let mut rng = Seed::new(2).named("noise").rng();
        let mut found = Vec::new();
        for trial in 0..40 {
            let noise =
                Array2::from_shape_simple_fn((120, 9), || rng.sample::<f64, _>(StandardNormal));
            let noise = crate::audit::taxels::without_class_means(noise.view(), &labels);
            let seed = Seed::new(trial);
            let serial = serial_dependence(noise.view(), &labels, 99, &seed).unwrap();
            let grouped = group_dependence(noise.view(), &labels, &groups, 99, &seed).unwrap();
            found.extend([serial.p_value, grouped.p_value]);
            if trial == 0 {
                let drifting = Array2::from_shape_fn((120, 9), |(row, taxel)| {
                    noise[(row, taxel)] + 0.01 * (row % 40) as f64 * (taxel as f64 - 4.0)
                });
                let drifting = crate::audit::taxels::without_class_means(drifting.view(), &labels);
                let found = serial_dependence(drifting.view(), &labels, 99, &seed).unwrap();
                assert_eq!(found.p_value, 1.0 / 4001.0);
                let mut grouped = noise.clone();
                for (row, mut readings) in grouped.rows_mut().into_iter().enumerate() {
                    readings[groups[row] % 9] += 1.0;
                }
                let found = group_dependence(grouped.view(), &labels, &groups, 99, &seed).unwrap();
                assert_eq!(found.p_value, 1.0 / 4001.0);
            }
        }
        let n_low = found.iter().filter(|&&p| p <= 0.05).count();
        assert!(n_low <= 12, "{n_low} of 80");
    }
}
