//! The engine of all permutation tests of an audit, and the units that it exchanges.
//!
//! A test computes a statistic of the data and of data whose independent units are exchanged. The p-value is (1 + L + E/2) / (1 + n) for n
//! permutations, of which L have a larger and E an equal statistic (Phipson and Smyth, *Permutation p-values should never be zero*, 2010). A test ends early
//! once 50 permutations reach the statistic (Besag and Clifford, *Sequential Monte Carlo p-values*, 1991).

use crate::streams::Streams;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Number of permutations that reach the statistic after which a test ends. With fewer, large p-values are less precise.
const N_REACHED: f64 = 50.0;
/// Minimum number of permutations, for the mean and the 95 % quantile.
const N_LEAST: usize = 99;

/// Distribution of a statistic over permutations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permuted {
    /// Probability of a statistic that is at least as large if the units are exchangeable.
    pub p_value: f64,
    /// Mean of the statistic over permutations.
    pub mean: f64,
    /// 95 % quantile of the statistic over permutations.
    pub bound: f64,
    /// Whether no permutation reaches the statistic, so that the p-value is the smallest one that the permutations resolve.
    pub is_end: bool,
}

/// Tests whether the statistic `observed` is larger than those of permutations; `draw` makes a permutation and returns its statistic. The first number of the
/// range `n` is made unless the test ends early. More permutations, up to the last number, are made only until one of them reaches the statistic.
pub fn permute(
    n: &RangeInclusive<usize>,
    observed: f64,
    mut draw: impl FnMut() -> f64,
) -> Permuted {
    let mut values = Vec::with_capacity(*n.start());
    let mut reached = 0.0;
    // Equal sums in another order of addition differ by rounding.
    let tolerance = 1e-9 * observed.abs();
    while (values.len() < *n.start() && (values.len() < N_LEAST || reached < N_REACHED))
        || (reached == 0.0 && values.len() < *n.end())
    {
        let value = draw();
        reached += match value - observed {
            above if above > tolerance => 1.0,
            equal if equal >= -tolerance => 0.5,
            _ => 0.0,
        };
        values.push(value);
    }
    let n_done = values.len() as f64;
    values.sort_by(f64::total_cmp);
    let bound = values.get((0.95 * n_done) as usize);
    Permuted {
        p_value: (1.0 + reached) / (1.0 + n_done),
        mean: values.iter().sum::<f64>() / n_done.max(1.0),
        bound: bound.copied().unwrap_or(f64::NAN),
        is_end: reached == 0.0,
    }
}

/// Independent units of labelled rows, and the cells that exchange their labels.
///
/// A cell contains the rows of one label and one unit; they keep a common label. The cells of a unit exchange their labels. Units of a single label exchange
/// them with each other.
#[derive(Clone, Debug)]
pub struct Units {
    /// Unit of each row, from 0; without units, each row is a unit of its own.
    pub of: Vec<usize>,
    /// Number of units.
    pub n: usize,
    /// Weight of each row, such that all cells have the weight 1: exchanged labels then have the same weights, also if the cells of a label are larger.
    pub weights: Vec<f64>,
    /// Rows of one label and one unit, for each label and unit.
    cells: Vec<Vec<usize>>,
    /// Cells that exchange their labels.
    strata: Vec<Vec<usize>>,
}

impl Units {
    /// Finds the cells of labelled rows. `units` contains the unit of each row, or `None` if all rows are independent.
    pub fn new(units: Option<&[usize]>, labels: &[usize]) -> Self {
        let n = labels.len();
        let Some(units) = units else {
            return Self {
                of: (0..n).collect(),
                n,
                weights: vec![1.0; n],
                cells: (0..n).map(|row| vec![row]).collect(),
                strata: vec![(0..n).collect()],
            };
        };
        let mut rows = BTreeMap::<usize, BTreeMap<usize, Vec<usize>>>::new();
        for (row, (&unit, &label)) in units.iter().zip(labels).enumerate() {
            let cells = rows.entry(unit).or_default();
            cells.entry(label).or_default().push(row);
        }
        let mut found = Self {
            of: vec![0; n],
            n: rows.len(),
            weights: vec![0.0; n],
            cells: Vec::new(),
            strata: Vec::new(),
        };
        let mut single = Vec::new();
        for (unit, cells) in rows.into_values().enumerate() {
            let first = found.cells.len();
            found.cells.extend(cells.into_values());
            let numbers = first..found.cells.len();
            for cell in &found.cells[numbers.clone()] {
                for &row in cell {
                    (found.of[row], found.weights[row]) = (unit, 1.0 / cell.len() as f64);
                }
            }
            match numbers.len() {
                1 => single.extend(numbers),
                _ => found.strata.push(numbers.collect()),
            }
        }
        found.strata.push(single);
        found
    }

    /// Exchanges the labels of cells at random, and writes them to `permuted`.
    pub fn exchange(&self, labels: &[usize], permuted: &mut [usize], rng: &mut ChaCha8Rng) {
        for cells in &self.strata {
            let label = |&cell: &usize| labels[self.cells[cell][0]];
            let mut shuffled: Vec<usize> = cells.iter().map(label).collect();
            shuffled.shuffle(rng);
            for (&cell, label) in cells.iter().zip(shuffled) {
                let rows = self.cells[cell].iter();
                rows.for_each(|&row| permuted[row] = label);
            }
        }
    }
}

/// Exchanges values among rows of one label, such as their folds.
#[doc(hidden)]
pub fn exchange_within(labels: &[usize], values: &mut [usize], rng: &mut ChaCha8Rng) {
    let mut rows = BTreeMap::<usize, Vec<usize>>::new();
    for (row, &label) in labels.iter().enumerate() {
        rows.entry(label).or_default().push(row);
    }
    for rows in rows.into_values() {
        let mut shuffled: Vec<usize> = rows.iter().map(|&row| values[row]).collect();
        shuffled.shuffle(rng);
        for (row, value) in rows.into_iter().zip(shuffled) {
            values[row] = value;
        }
    }
}

/// Returns the random generator of a test.
#[doc(hidden)]
pub fn generator(seed: &dyn Streams) -> ChaCha8Rng {
    seed.named("permutations").rng()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_exchanged_within_units_and_between_units_of_one_label() {
        let (units, labels) = ([0, 0, 1, 1, 2, 3], [0, 1, 2, 3, 4, 5]);
        let found = Units::new(Some(&units), &labels);
        let (mut permuted, mut rng) = (labels, 3_u64.rng());
        let mut n_changed = 0;
        for _ in 0..40 {
            found.exchange(&labels, &mut permuted, &mut rng);
            n_changed += usize::from(permuted != labels);
            for first in [0, 2, 4] {
                let mut pair = [permuted[first], permuted[first + 1]];
                pair.sort_unstable();
                assert_eq!(pair, [first, first + 1]);
            }
        }
        assert!(n_changed > 20, "{n_changed}");
    }
}
