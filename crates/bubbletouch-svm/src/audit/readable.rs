//! Permutation tests of the accuracy with which labels can be read from features.
//!
//! Two classifiers predict each row from the rows of other units: the nearest class mean, and the vote of the nearest rows. They need only inner products of
//! rows, so that a permutation costs n² additions for any number of features.

use crate::audit::permutation::{Permuted, Units, exchange_within, generator, permute};
use crate::streams::Streams;
use ndarray::{Array2, ArrayView1, ArrayView2, Axis};
use std::ops::RangeInclusive;

/// Number of nearest rows that vote.
const N_VOTES: usize = 5;

/// Accuracy with which labels can be read from features, and its distribution under exchanged labels.
#[derive(Clone, Debug, PartialEq)]
pub struct Readability {
    /// Fraction of rows whose label the better classifier predicts from the rows of other units. All cells of a unit and a label have the same weight.
    pub accuracy: f64,
    /// The same over permutations of the labels.
    pub permuted: Permuted,
}

/// Weights of rows, inner products of each row with each other weighted row, and the other rows of each row, nearest first.
struct Pairs<'a> {
    weights: &'a [f64],
    products: Array2<f64>,
    order: Vec<Vec<u32>>,
}

/// Rows that are held out together.
struct Folds<'a> {
    /// Fold of each row.
    of: &'a [usize],
    /// Number of folds.
    n: usize,
    /// Number of folds that are tested, from fold 0.
    n_tested: usize,
}

/// Tests whether the labels (in 0..n_classes) can be read from the features. `units` contains the unit of each row, or `None` if all rows are independent: rows
/// of one unit can be alike whatever their label, so that a row is predicted from other units, and the rows of a cell keep a common label. `n_permutations` is
/// the range of [`permute`]. Returns `None` for fewer than two rows per class on average, or a single class.
pub fn readability(
    features: ArrayView2<f64>,
    labels: &[usize],
    units: Option<&[usize]>,
    n_permutations: &RangeInclusive<usize>,
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
    let pairs = Pairs::new(features, &units.weights);
    let folds = Folds {
        of: &units.of,
        n: units.n,
        n_tested: units.n,
    };
    let total: f64 = units.weights.iter().sum();
    let accuracy = |labels: &[usize]| {
        let [by_mean, by_votes] = pairs.n_recognised(labels, n_classes, &folds);
        by_mean.max(by_votes) / total
    };
    let observed = accuracy(labels);
    let mut permuted = labels.to_vec();
    let mut rng = generator(seed);
    let draw = || {
        units.exchange(labels, &mut permuted, &mut rng);
        accuracy(&permuted)
    };
    Some(Readability {
        accuracy: observed,
        permuted: permute(n_permutations, observed, draw),
    })
}

/// Tests whether rows of other folds recognise a row less often than equally many rows drawn at random from the same classes. `folds` contains the fold of each
/// row; the folds from 0 to `n_tested` − 1 are tested. A permutation exchanges the folds of rows of one class, so that both arms train on equally many rows of
/// each class. The statistic is the fraction of wrong predictions, averaged over both classifiers.
pub fn held_out_loss(
    features: ArrayView2<f64>,
    labels: &[usize],
    (folds, n_tested): (&[usize], usize),
    n_permutations: &RangeInclusive<usize>,
    seed: &dyn Streams,
) -> Option<Permuted> {
    let n_classes = labels.iter().max()? + 1;
    let n_folds = folds.iter().max()? + 1;
    let n = folds.iter().filter(|&&fold| fold < n_tested).count();
    let weights = vec![1.0; labels.len()];
    let pairs = Pairs::new(features, &weights);
    let wrong = |of: &[usize]| {
        let folds = Folds {
            of,
            n: n_folds,
            n_tested,
        };
        let counts = pairs.n_recognised(labels, n_classes, &folds);
        1.0 - counts.iter().sum::<f64>() / (2 * n.max(1)) as f64
    };
    let observed = wrong(folds);
    let mut permuted = folds.to_vec();
    let mut rng = generator(seed);
    Some(permute(n_permutations, observed, || {
        exchange_within(labels, &mut permuted, &mut rng);
        wrong(&permuted)
    }))
}

impl<'a> Pairs<'a> {
    fn new(features: ArrayView2<f64>, weights: &'a [f64]) -> Self {
        let mean = features.mean_axis(Axis(0));
        let centred = match mean {
            Some(mean) => &features - &mean,
            None => features.to_owned(),
        };
        // The product of single columns may have its columns in order.
        let weighted = &centred.t() * &ArrayView1::from(weights);
        let products = centred.dot(&weighted);
        let products = products.as_standard_layout().into_owned();
        let n = products.nrows();
        let order = (0..n).map(|row| {
            let distance = |other: u32| {
                let other = other as usize;
                (products[(other, other)] - 2.0 * products[(row, other)]) / weights[other]
            };
            let mut others: Vec<u32> = (0..n as u32)
                .filter(|&other| other as usize != row)
                .collect();
            others.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
            others
        });
        let order = order.collect();
        Self {
            weights,
            products,
            order,
        }
    }

    /// Returns the weights of the rows that the nearest class mean and the nearest rows recognise.
    fn n_recognised(&self, labels: &[usize], n_classes: usize, folds: &Folds) -> [f64; 2] {
        let found = self.recognised(labels, n_classes, folds);
        found.map(|found| {
            let rows = found.into_iter().zip(self.weights);
            rows.filter(|(is, _)| *is).map(|(_, weight)| weight).sum()
        })
    }

    /// Returns whether the nearest class mean, and whether the nearest rows predict each row correctly from rows of other folds; false if it is not tested.
    fn recognised(&self, labels: &[usize], n_classes: usize, folds: &Folds) -> [Vec<bool>; 2] {
        let n = labels.len();
        // Sums of the products of each row with the rows of each class, and with those in its own fold.
        let mut sums = vec![0.0; n * n_classes];
        let mut own_sums = sums.clone();
        let mut of_classes = vec![(0.0, 0.0); n_classes];
        for (row, sums) in sums.chunks_exact_mut(n_classes).enumerate() {
            for (product, &label) in self.products.row(row).iter().zip(labels) {
                sums[label] += product;
            }
            let (count, square) = &mut of_classes[labels[row]];
            *count += self.weights[row];
            *square += self.weights[row] * sums[labels[row]];
        }
        let mut rows_of = vec![Vec::new(); folds.n];
        for (row, &fold) in folds.of.iter().enumerate() {
            rows_of[fold].push(row);
        }
        // Let S be the weighted sum of the rows of a class, and U that of its rows within a fold: |S − U|² = |S|² − 2 S·U + |U|².
        let mut outside: Vec<(f64, f64)> = Vec::with_capacity(folds.n * n_classes);
        for rows in &rows_of {
            let first = outside.len();
            outside.extend(&of_classes);
            for &row in rows {
                let own_sums = &mut own_sums[row * n_classes..][..n_classes];
                for &other in rows {
                    own_sums[labels[other]] += self.products[(row, other)];
                }
                let label = labels[row];
                let (count, square) = &mut outside[first + label];
                let weight = self.weights[row];
                *count -= weight;
                *square += weight * (own_sums[label] - 2.0 * sums[row * n_classes + label]);
            }
        }
        let mut found = [vec![false; n], vec![false; n]];
        let mut votes = vec![0.0; n_classes];
        // A difference of sums of weights that is smaller is rounding.
        let least = 0.5 * self.weights.iter().copied().fold(1.0, f64::min);
        for (row, &own) in labels.iter().enumerate() {
            let fold = folds.of[row];
            if fold >= folds.n_tested {
                continue;
            }
            let (sums, own_sums) = (&sums[row * n_classes..], &own_sums[row * n_classes..]);
            let outside = &outside[fold * n_classes..];
            let distance = |class: usize| match outside[class] {
                (count, _) if count < least => f64::INFINITY,
                (count, square) => {
                    let sum = sums[class] - own_sums[class];
                    square / (count * count) - 2.0 * sum / count
                }
            };
            let of_own = distance(own);
            let mut others = (0..n_classes).filter(|&class| class != own);
            found[0][row] = of_own.is_finite() && others.all(|class| of_own < distance(class));
            let near = self.order[row].iter().map(|&other| other as usize);
            let near = near.filter(|&other| folds.of[other] != fold).take(N_VOTES);
            near.clone()
                .for_each(|other| votes[labels[other]] += self.weights[other]);
            let most = near
                .clone()
                .map(|other| votes[labels[other]])
                .fold(0.0, f64::max);
            // The nearest row among those with the most votes decides.
            let winner = near.clone().find(|&other| votes[labels[other]] == most);
            found[1][row] = winner.is_some_and(|other| labels[other] == own);
            near.for_each(|other| votes[labels[other]] = 0.0);
        }
        found
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
            readability(features.view(), &labels, None, &(99..=4000), &seed).unwrap()
        };
        let p_values: Vec<f64> = (0..100)
            .map(|k| of(noise(60, 6, k), k).permuted.p_value)
            .collect();
        let below = |bound: f64| p_values.iter().filter(|&&p| p <= bound).count();
        // Binomial counts of 100 with probabilities 0.05 and 0.5, within 4.5 standard deviations.
        assert!(below(0.05) <= 15, "{}", below(0.05));
        assert!((28..=72).contains(&below(0.5)), "{}", below(0.5));
        let mut features = noise(60, 6, 1);
        for (mut row, &label) in features.rows_mut().into_iter().zip(&labels) {
            row[0] += 2.0 * label as f64;
        }
        let found = of(features, 1);
        assert_eq!(found.permuted.p_value, 1.0 / 4001.0);
        assert!(
            found.accuracy > 0.95 && found.permuted.bound < 0.5,
            "{found:?}"
        );
    }

    #[test]
    fn class_means_from_products_are_those_of_rows() {
        let labels: Vec<usize> = (0..40).map(|row| (row * row) % 3 % 2).collect();
        let features = noise(40, 3, 9);
        let grouped: Vec<usize> = (0..40).map(|row| 7 * row % 11).collect();
        for grouped in [None, Some(&grouped[..])] {
            let units = Units::new(grouped, &labels);
            let pairs = Pairs::new(features.view(), &units.weights);
            let folds = Folds {
                of: &units.of,
                n: units.n,
                n_tested: units.n,
            };
            let found = pairs.recognised(&labels, 2, &folds);
            for row in 0..40 {
                let is_other = |other: usize| match grouped {
                    Some(grouped) => grouped[other] != grouped[row],
                    None => other != row,
                };
                let distance = |class: usize| {
                    let others = (0..40).filter(|&other| is_other(other) && labels[other] == class);
                    let (mut mean, mut total) = (ndarray::Array1::zeros(3), 0.0);
                    for other in others {
                        mean.scaled_add(units.weights[other], &features.row(other));
                        total += units.weights[other];
                    }
                    mean /= total;
                    (&mean - &features.row(row)).mapv(|x| x * x).sum()
                };
                let expected = distance(labels[row]) < distance(1 - labels[row]);
                assert_eq!(found[0][row], expected);
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
                readability(features.view(), &labels, units, &(199..=4000), &5_u64)
                    .unwrap()
                    .permuted
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

    /// Groups without an effect: the p-values of both tests are uniform. Groups with an effect: held-out groups cost accuracy.
    #[test]
    fn tests_with_groups_keep_their_level() {
        let labels: Vec<usize> = (0..96).map(|row| row / 4 % 4).collect();
        let groups: Vec<usize> = (0..96).map(|row| row / 16).collect();
        let range = 199..=199;
        let (mut read, mut lost) = (0, 0);
        for k in 0..200 {
            let mut features = noise(96, 4, 1000 + k);
            let p = held_out_loss(features.view(), &labels, (&groups, 6), &range, &k).unwrap();
            lost += usize::from(p.p_value <= 0.05);
            // Each cell of a group and a class has a style of its own.
            let styles = noise(24, 4, 5000 + k);
            for (row, mut own) in features.rows_mut().into_iter().enumerate() {
                own += &(&styles.row(row / 4) * 3.0);
            }
            let found = readability(features.view(), &labels, Some(&groups), &range, &k).unwrap();
            read += usize::from(found.permuted.p_value <= 0.05);
            if k < 5 {
                let p = held_out_loss(features.view(), &labels, (&groups, 6), &range, &k).unwrap();
                assert!(p.p_value <= 0.01, "{p:?}");
            }
        }
        // 3 to 7 % of 200 null sets.
        assert!((6..=14).contains(&read), "{read}");
        assert!((6..=14).contains(&lost), "{lost}");
    }
}
