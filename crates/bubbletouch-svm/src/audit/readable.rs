//! Permutation test of the hypothesis that labels cannot be read from features.
//!
//! Two classifiers predict each row from all other rows: the nearest class mean, and the vote of the nearest rows. The statistic is the larger of the two
//! accuracies. The labels are permuted many times. The p-value is (1 + number of permutations with at least the observed accuracy) / (1 + number of
//! permutations). The p-value is exact for exchangeable rows (Phipson and Smyth, *Permutation p-values should never be zero*, 2010). The two classifiers need
//! only inner products of rows, so that a permutation costs n² additions for any number of features.

use crate::streams::Streams;
use ndarray::{Array2, ArrayView2, Axis};
use rand::seq::SliceRandom;

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
    sums: Vec<f64>,
    is_correct: [Vec<bool>; 2],
}

/// Tests whether the labels (in 0..n_classes) can be read from the features. Returns `None` for fewer than two rows per class on average, or a single class.
pub fn readability(
    features: ArrayView2<f64>,
    labels: &[usize],
    n_permutations: usize,
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
    let pairs = Pairs::new(features);
    let mut workspace = Workspace::default();
    let best = |counts: [usize; 2]| usize::from(counts[1] > counts[0]);
    let observed = pairs.count_correct(labels, &counts, &mut workspace);
    let method = best(observed);
    let is_correct = workspace.is_correct[method].clone();
    let n_correct = observed[method];
    let mut permuted = labels.to_vec();
    let mut rng = seed.named("permutations").rng();
    let mut found = Vec::with_capacity(n_permutations);
    for _ in 0..n_permutations {
        permuted.shuffle(&mut rng);
        let counts = pairs.count_correct(&permuted, &counts, &mut workspace);
        found.push(counts[0].max(counts[1]));
    }
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
    fn new(features: ArrayView2<f64>) -> Self {
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
            let mut others: Vec<usize> = (0..n).filter(|&other| other != row).collect();
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

    /// Returns the numbers of rows that the nearest class mean and the nearest rows predict correctly.
    fn count_correct(
        &self,
        labels: &[usize],
        counts: &[usize],
        workspace: &mut Workspace,
    ) -> [usize; 2] {
        let (n, n_classes) = (labels.len(), counts.len());
        let sums = &mut workspace.sums;
        sums.clear();
        sums.resize(n * n_classes, 0.0);
        let mut squares = vec![0.0; n_classes];
        for (row, sums) in sums.chunks_exact_mut(n_classes).enumerate() {
            for (product, &label) in self.products.row(row).iter().zip(labels) {
                sums[label] += product;
            }
            squares[labels[row]] += sums[labels[row]];
        }
        let [by_mean, by_votes] = &mut workspace.is_correct;
        by_mean.clear();
        by_votes.clear();
        let mut votes = vec![0_usize; n_classes];
        for (row, sums) in sums.chunks_exact(n_classes).enumerate() {
            let own = labels[row];
            let square = self.products[(row, row)];
            let distance = |class: usize| {
                let (sum, squares, count) = match class == own {
                    // The row itself does not belong to the mean of its class.
                    true => (
                        sums[class] - square,
                        squares[class] - 2.0 * sums[class] + square,
                        counts[class] - 1,
                    ),
                    false => (sums[class], squares[class], counts[class]),
                };
                match count {
                    0 => f64::INFINITY,
                    count => squares / (count * count) as f64 - 2.0 * sum / count as f64,
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
            readability(features.view(), &labels, 99, &seed).unwrap()
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
        assert_eq!(found.p_value, 0.01);
        assert!(found.accuracy > 0.95 && found.bound < 0.5, "{found:?}");
    }

    #[test]
    fn class_means_from_products_are_those_of_rows() {
        let labels: Vec<usize> = (0..40).map(|row| (row * row) % 3 % 2).collect();
        let features = noise(40, 3, 9);
        let pairs = Pairs::new(features.view());
        let counts = [0, 1].map(|class| labels.iter().filter(|&&label| label == class).count());
        let mut workspace = Workspace::default();
        pairs.count_correct(&labels, &counts, &mut workspace);
        for row in 0..40 {
            let distance = |class: usize| {
                let others = (0..40).filter(|&other| other != row && labels[other] == class);
                let others: Vec<usize> = others.collect();
                let mean = features
                    .select(Axis(0), &others)
                    .mean_axis(Axis(0))
                    .unwrap();
                (&mean - &features.row(row)).mapv(|x| x * x).sum()
            };
            let expected = distance(labels[row]) < distance(1 - labels[row]);
            assert_eq!(workspace.is_correct[0][row], expected);
        }
    }
}
