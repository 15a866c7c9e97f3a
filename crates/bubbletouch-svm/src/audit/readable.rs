//! Permutation test of the hypothesis that labels cannot be read from features.
//!
//! Two classifiers predict each row from all other rows: the nearest class mean, and the vote of the nearest rows. The statistic is the larger of the two
//! accuracies. If rows belong to units, such as the grasps of one object, a row is predicted from the rows of other units, because rows of one unit are alike
//! whatever their label. The labels are permuted many times; rows of one label and one unit keep a common label. The cells of a unit exchange their labels;
//! units of a single label exchange them with each other. The p-value is (1 + number of permutations with at least the observed accuracy) / (1 + number of
//! permutations). The p-value is exact for exchangeable rows (Phipson and Smyth, *Permutation p-values should never be zero*, 2010). The two classifiers need
//! only inner products of rows, so that a permutation costs n² additions for any number of features.

use crate::streams::Streams;
use ndarray::{Array2, ArrayView2, Axis};
use rand::seq::SliceRandom;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Number of nearest rows that vote.
const N_VOTES: usize = 5;

/// Accuracy with which labels can be read from features, and its distribution under permuted labels.
#[derive(Clone, Debug, PartialEq)]
pub struct Readability {
    /// Fraction of rows whose label the better classifier predicts from the other rows.
    pub accuracy: f64,
    /// Mean accuracy over permutations of the labels.
    pub chance: f64,
    /// 95 % quantile of the accuracy over permutations of the labels.
    pub bound: f64,
    /// Probability of at least this accuracy if features and labels are independent.
    pub p_value: f64,
    /// Whether the better classifier predicts each row correctly.
    pub is_correct: Vec<bool>,
}

/// Inner products of all pairs of rows, and the nearest rows of each row.
struct Pairs {
    products: Array2<f64>,
    nearest: Vec<Vec<usize>>,
}

/// Scratch memory of the two classifiers.
#[derive(Default)]
struct Workspace {
    /// Sums of the products of each row with the rows of each class.
    sums: Vec<f64>,
    /// Sums of the products of each row with the rows of each class in the row's own unit.
    own_sums: Vec<f64>,
    /// Number of rows, and squared norm of the sum of the rows, of each class outside each unit.
    outside: Vec<(usize, f64)>,
    is_correct: [Vec<bool>; 2],
}

/// Rows that are alike whatever their label, and rows that keep a common label.
struct Units {
    /// Unit of each row; without units, each row is a unit of its own.
    of: Vec<usize>,
    /// Rows of each unit.
    rows: Vec<Vec<usize>>,
    /// Rows of one label and one unit, for each label and unit.
    cells: Vec<Vec<usize>>,
    /// Cells that exchange their labels.
    strata: Vec<Vec<usize>>,
}

impl Units {
    fn new(units: Option<&[usize]>, labels: &[usize]) -> Self {
        let n = labels.len();
        let Some(units) = units else {
            return Self {
                of: (0..n).collect(),
                rows: (0..n).map(|row| vec![row]).collect(),
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
            rows: Vec::new(),
            cells: Vec::new(),
            strata: Vec::new(),
        };
        let mut single = Vec::new();
        for (unit, cells) in rows.into_values().enumerate() {
            let first = found.cells.len();
            found.cells.extend(cells.into_values());
            let numbers = first..found.cells.len();
            let of_unit: Vec<usize> = found.cells[first..].concat();
            of_unit.iter().for_each(|&row| found.of[row] = unit);
            found.rows.push(of_unit);
            match numbers.len() {
                1 => single.extend(numbers),
                _ => found.strata.push(numbers.collect()),
            }
        }
        found.strata.push(single);
        found
    }
}

/// Tests whether the labels (in 0..n_classes) can be read from the features. `units` contains the unit of each row, or `None` if all rows are independent.
/// The first number of the range `n_permutations` is made in any case; more permutations, up to the last number, only until one of them reaches the observed
/// accuracy. Returns `None` for fewer than two rows per class on average, or a single class.
pub fn readability(
    features: ArrayView2<f64>,
    labels: &[usize],
    units: Option<&[usize]>,
    n_permutations: RangeInclusive<usize>,
    seed: &dyn Streams,
) -> Option<Readability> {
    let n = labels.len();
    let n_classes = labels.iter().max()? + 1;
    let mut counts = vec![0_usize; n_classes];
    labels.iter().for_each(|&label| counts[label] += 1);
    let n_present = counts.iter().filter(|&&count| count > 0).count();
    if n_present < 2 || n < 2 * n_present {
        return None;
    }
    let units = Units::new(units, labels);
    let pairs = Pairs::new(features, &units.of);
    let mut workspace = Workspace::default();
    let best = |counts: [usize; 2]| usize::from(counts[1] > counts[0]);
    let observed = pairs.count_correct(labels, n_classes, &units, &mut workspace);
    let method = best(observed);
    let is_correct = workspace.is_correct[method].clone();
    let n_correct = observed[method];
    let mut permuted = labels.to_vec();
    let mut rng = seed.named("permutations").rng();
    let mut found = Vec::with_capacity(*n_permutations.start());
    let mut is_reached = false;
    // More permutations resolve smaller p-values.
    while found.len() < *n_permutations.start()
        || (!is_reached && found.len() < *n_permutations.end())
    {
        for cells in &units.strata {
            let label = |&cell: &usize| labels[units.cells[cell][0]];
            let mut shuffled: Vec<usize> = cells.iter().map(label).collect();
            shuffled.shuffle(&mut rng);
            for (&cell, label) in cells.iter().zip(shuffled) {
                units.cells[cell]
                    .iter()
                    .for_each(|&row| permuted[row] = label);
            }
        }
        let counts = pairs.count_correct(&permuted, n_classes, &units, &mut workspace);
        let count = counts[0].max(counts[1]);
        is_reached |= count >= n_correct;
        found.push(count);
    }
    let n_permutations = found.len();
    found.sort_unstable();
    let at_least = found.iter().filter(|&&count| count >= n_correct).count();
    let share = |count: usize| count as f64 / n as f64;
    let bound = found.get((0.95 * n_permutations as f64) as usize);
    Some(Readability {
        accuracy: share(n_correct),
        chance: found.iter().map(|&count| share(count)).sum::<f64>() / n_permutations.max(1) as f64,
        bound: bound.map_or(1.0, |&count| share(count)),
        p_value: (1 + at_least) as f64 / (1 + n_permutations) as f64,
        is_correct,
    })
}

impl Pairs {
    fn new(features: ArrayView2<f64>, units: &[usize]) -> Self {
        let mean = features.mean_axis(Axis(0));
        let centred = match mean {
            Some(mean) => &features - &mean,
            None => features.to_owned(),
        };
        // The product of single columns may have its columns in order.
        let products = centred.dot(&centred.t());
        let products = products.as_standard_layout().into_owned();
        let n = products.nrows();
        let nearest = (0..n).map(|row| {
            let distance =
                |other: &usize| products[(*other, *other)] - 2.0 * products[(row, *other)];
            let mut others: Vec<usize> =
                (0..n).filter(|&other| units[other] != units[row]).collect();
            let k = N_VOTES.min(others.len());
            if k < others.len() {
                others.select_nth_unstable_by(k, |a, b| {
                    distance(a).total_cmp(&distance(b)).then(a.cmp(b))
                });
                others.truncate(k);
            }
            others.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
            others
        });
        let nearest = nearest.collect();
        Self { products, nearest }
    }

    /// Returns the numbers of rows that the nearest class mean and the nearest rows predict correctly, from rows of other units.
    fn count_correct(
        &self,
        labels: &[usize],
        n_classes: usize,
        units: &Units,
        workspace: &mut Workspace,
    ) -> [usize; 2] {
        let n = labels.len();
        let (sums, own_sums) = (&mut workspace.sums, &mut workspace.own_sums);
        for sums in [&mut *sums, &mut *own_sums] {
            sums.clear();
            sums.resize(n * n_classes, 0.0);
        }
        let mut of_classes = vec![(0, 0.0); n_classes];
        for (row, sums) in sums.chunks_exact_mut(n_classes).enumerate() {
            for (product, &label) in self.products.row(row).iter().zip(labels) {
                sums[label] += product;
            }
            let (count, square) = &mut of_classes[labels[row]];
            *count += 1;
            *square += sums[labels[row]];
        }
        // Let S be the sum of the rows of a class, and U the sum of its rows within a unit: |S − U|² = |S|² − 2 S·U + |U|².
        let outside = &mut workspace.outside;
        outside.clear();
        for rows in &units.rows {
            let first = outside.len();
            outside.extend(&of_classes);
            for &row in rows {
                let own_sums = &mut own_sums[row * n_classes..][..n_classes];
                for &other in rows {
                    own_sums[labels[other]] += self.products[(row, other)];
                }
                let label = labels[row];
                let (count, square) = &mut outside[first + label];
                *count -= 1;
                *square += own_sums[label] - 2.0 * sums[row * n_classes + label];
            }
        }
        let [by_mean, by_votes] = &mut workspace.is_correct;
        by_mean.clear();
        by_votes.clear();
        let mut votes = vec![0_usize; n_classes];
        for (row, &own) in labels.iter().enumerate() {
            let (sums, own_sums) = (&sums[row * n_classes..], &own_sums[row * n_classes..]);
            let outside = &outside[units.of[row] * n_classes..];
            let distance = |class: usize| match outside[class] {
                (0, _) => f64::INFINITY,
                (count, square) => {
                    let sum = sums[class] - own_sums[class];
                    square / (count * count) as f64 - 2.0 * sum / count as f64
                }
            };
            let of_own = distance(own);
            by_mean.push(
                of_own.is_finite()
                    && (0..n_classes).all(|class| class == own || of_own < distance(class)),
            );
            let near = &self.nearest[row];
            near.iter().for_each(|&other| votes[labels[other]] += 1);
            let most = near.iter().map(|&other| votes[labels[other]]).max();
            // The nearest row among those with the most votes decides.
            let winner = near
                .iter()
                .find(|&&other| Some(votes[labels[other]]) == most);
            by_votes.push(winner.is_some_and(|&other| labels[other] == own));
            near.iter().for_each(|&other| votes[labels[other]] = 0);
        }
        [&*by_mean, &*by_votes].map(|correct| correct.iter().filter(|&&is| is).count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    fn noise(n: usize, m: usize, seed: u64) -> Array2<f64> {
        let mut rng = seed.rng();
        Array2::from_shape_simple_fn((n, m), || rng.r#gen::<f64>())
    }

    #[test]
    fn p_values_of_noise_are_uniform_and_those_of_labels_smallest() {
        let labels: Vec<usize> = (0..60).map(|row| row % 4).collect();
        let of = |features: Array2<f64>, seed: u64| {
            readability(features.view(), &labels, None, 99..=4000, &seed).unwrap()
        };
        let p_values: Vec<f64> = (0..100).map(|k| of(noise(60, 6, k), k).p_value).collect();
        let below = |bound: f64| p_values.iter().filter(|&&p| p <= bound).count();
        // Binomial counts of 100 with probabilities 0.05 and 0.5, within 4.5 standard deviations.
        assert!(below(0.05) <= 15, "{}", below(0.05));
        assert!((28..=72).contains(&below(0.5)), "{}", below(0.5));
        let mut features = noise(60, 6, 1);
        for (mut row, &label) in features.rows_mut().into_iter().zip(&labels) {
            row[0] += 2.0 * label as f64;
        }
        let found = of(features, 1);
        assert_eq!(found.p_value, 1.0 / 4001.0);
        assert!(found.accuracy > 0.95 && found.bound < 0.5, "{found:?}");
    }

    #[test]
    fn class_means_from_products_are_those_of_rows() {
        let labels: Vec<usize> = (0..40).map(|row| (row * row) % 3 % 2).collect();
        let features = noise(40, 3, 9);
        let grouped: Vec<usize> = (0..40).map(|row| 7 * row % 11).collect();
        for grouped in [None, Some(&grouped[..])] {
            let units = Units::new(grouped, &labels);
            let pairs = Pairs::new(features.view(), &units.of);
            let mut workspace = Workspace::default();
            pairs.count_correct(&labels, 2, &units, &mut workspace);
            for row in 0..40 {
                let is_other = |other: usize| match grouped {
                    Some(grouped) => grouped[other] != grouped[row],
                    None => other != row,
                };
                let distance = |class: usize| {
                    let others = (0..40).filter(|&other| is_other(other) && labels[other] == class);
                    let others: Vec<usize> = others.collect();
                    let mean = features.select(Axis(0), &others).mean_axis(Axis(0));
                    let mean = mean.unwrap();
                    (&mean - &features.row(row)).mapv(|x| x * x).sum()
                };
                let expected = distance(labels[row]) < distance(1 - labels[row]);
                assert_eq!(workspace.is_correct[0][row], expected);
            }
        }
    }

    /// The rows of each label and unit have a level of their own, which names the label of a row only if other rows of the unit are known.
    #[test]
    fn levels_of_units_do_not_count_as_levels_of_labels() {
        let levels = noise(24, 3, 2);
        let labels: Vec<usize> = (0..120).map(|row| row / 5 * 5 % 7 % 3).collect();
        // A unit contains rows of one label, or of two.
        for rows_of_unit in [5, 10] {
            let units: Vec<usize> = (0..120).map(|row| row / rows_of_unit).collect();
            let mut features = 0.05 * noise(120, 3, 3);
            for (row, mut features) in features.rows_mut().into_iter().enumerate() {
                features += &levels.row(row / 5);
            }
            let of = |features: &Array2<f64>, units: Option<&[usize]>| {
                readability(features.view(), &labels, units, 199..=4000, &5_u64).unwrap()
            };
            assert!(of(&features, None).p_value <= 0.005);
            let within = of(&features, Some(&units));
            assert!(within.p_value > 0.05, "{within:?}");
            for (mut row, &label) in features.rows_mut().into_iter().zip(&labels) {
                row[0] += 2.0 * label as f64;
            }
            assert!(of(&features, Some(&units)).p_value <= 0.005);
        }
    }
}
