//! Classification trees of a random forest [Breiman et al. 1984]: Gini impurity, binary splits `x_f ≤ threshold`, no pruning.
//!
//! A node is divided by the split with the lowest impurity, i.e. the largest `Σ_k l_k² / l + Σ_k r_k² / r`. Here l_k and r_k are the numbers of rows of class k
//! on the left and right, times the [weight](crate::class_weight) of the class. If splits are equal, the first visited feature and its lowest threshold are chosen. Thresholds are midpoints between values that
//! occur in the node.
//!
//! The crate linfa-trees 0.8.1 is not used, because it sums impurities in f32 in the order of a `HashMap`. Two of its trees grown on equal rows can differ
//! (2,000 rows, 20 classes: 3 of 500 predictions). The crate linfa-trees also treats values closer than 1e-5 as equal in any unit, and visits every row and
//! feature at every node.

use crate::classifiers::ranked::Ranked;
use crate::streams::Streams;
use crate::{Error, Result};
use ndarray::ArrayView1;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Returns an error if the maximum depth is 0.
pub(crate) fn check_depth(max_depth: Option<usize>) -> Result<()> {
    if max_depth == Some(0) {
        return Err(Error::input("depth", 0, "at least 1 is allowed"));
    }
    Ok(())
}

/// Binary decision tree, stored as a list of nodes with the root first.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
enum Node {
    Split {
        feature: usize,
        threshold: f64,
        /// Indices of the two child nodes: the first for values up to the threshold, the second for larger values.
        children: [usize; 2],
    },
    Leaf {
        /// Pairs (class, number of training rows) of a leaf, ascending by class; empty for other nodes.
        counts: Vec<(u32, u32)>,
    },
}

impl Tree {
    /// Returns the number of training rows of each class, as pairs (class, number), in the leaf that the given row reaches.
    pub(crate) fn leaf(&self, row: ArrayView1<f64>) -> &[(u32, u32)] {
        let mut at = 0;
        loop {
            match &self.nodes[at] {
                Node::Leaf { counts } => return counts,
                Node::Split {
                    feature,
                    threshold,
                    children,
                } => at = children[usize::from(row[*feature] > *threshold)],
            }
        }
    }
}

/// Parameters that limit the growth of a tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Growth<'a> {
    /// Weight of each class, shape (n_classes,).
    pub class_weights: &'a [f64],
    /// Number of features that are drawn for the split of a node, with those that are constant in the node. If all of them are constant, further ones are drawn
    /// until one varies, as in scikit-learn.
    pub n_candidates: usize,
    pub max_depth: Option<usize>,
}

/// Split of a node into two children: rows whose rank of a feature is at most `rank` go to the left child.
struct Split {
    feature: usize,
    rank: u32,
    threshold: f64,
    score: f64,
}

/// State during the growth of a tree: the training data and reusable memory.
struct Grower<'a> {
    ranked: &'a Ranked,
    label: &'a [usize],
    class_weights: &'a [f64],
    /// Sort keys of the rows in the current node: rank of the feature value (upper 32 bits) and class (lower 32 bits).
    keys: Vec<u64>,
    left: Vec<f64>,
    right: Vec<f64>,
}

impl Growth<'_> {
    /// Grows a tree on the given training rows, which may contain repetitions. The argument `label` contains the class of each row, as an index.
    pub(crate) fn grow(
        &self,
        ranked: &Ranked,
        label: &[usize],
        mut rows: Vec<u32>,
        seed: &dyn Streams,
    ) -> Tree {
        debug_assert_eq!(label.len(), ranked.n_rows());
        let mut rng = seed.rng();
        let mut grower = Grower {
            ranked,
            label,
            class_weights: self.class_weights,
            keys: Vec::with_capacity(rows.len()),
            left: vec![0.0; self.class_weights.len()],
            right: vec![0.0; self.class_weights.len()],
        };
        let mut features: Vec<usize> = (0..ranked.n_features()).collect();
        let mut nodes = vec![Node::Leaf { counts: Vec::new() }];
        // Pending nodes (node, rows, depth): an explicit stack, because a tree may be as deep as its number of rows.
        let mut open = vec![(0, 0..rows.len(), 0)];
        while let Some((node, range, depth)) = open.pop() {
            let counts = grower.counts(&rows[range.clone()]);
            let is_done = counts.len() < 2 || self.max_depth.is_some_and(|max| depth >= max);
            let split = if is_done {
                None
            } else {
                self.best_split(&mut grower, &rows[range.clone()], &mut features, &mut rng)
            };
            let Some(split) = split else {
                nodes[node] = Node::Leaf { counts };
                continue;
            };
            let middle = range.start + partition(&mut rows[range.clone()], ranked, &split);
            let children = [nodes.len(), nodes.len() + 1];
            nodes.extend([const { Node::Leaf { counts: Vec::new() } }; 2]);
            nodes[node] = Node::Split {
                feature: split.feature,
                threshold: split.threshold,
                children,
            };
            open.push((children[1], middle..range.end, depth + 1));
            open.push((children[0], range.start..middle, depth + 1));
        }
        Tree { nodes }
    }

    /// Returns the best split of the node that contains the given rows, among the candidate features; `None` if no feature varies.
    fn best_split(
        &self,
        grower: &mut Grower,
        rows: &[u32],
        features: &mut [usize],
        rng: &mut ChaCha8Rng,
    ) -> Option<Split> {
        let mut best: Option<Split> = None;
        for place in 0..features.len() {
            if place >= self.n_candidates && best.is_some() {
                break;
            }
            if self.n_candidates < features.len() {
                features.swap(place, rng.gen_range(place..features.len()));
            }
            let Some(split) = grower.split(features[place], rows) else {
                continue;
            };
            if best.as_ref().is_none_or(|best| split.score > best.score) {
                best = Some(split);
            }
        }
        best
    }
}

impl Grower<'_> {
    /// Counts the given rows by class: pairs (class, number of rows) in ascending order of the class.
    fn counts(&self, rows: &[u32]) -> Vec<(u32, u32)> {
        let mut counts = vec![0; self.class_weights.len()];
        for &row in rows {
            counts[self.label[row as usize]] += 1;
        }
        (0..).zip(counts).filter(|&(_, count)| count > 0).collect()
    }

    /// Returns the best split of the given rows by one feature; `None` if the feature has equal values in all rows.
    fn split(&mut self, feature: usize, rows: &[u32]) -> Option<Split> {
        self.keys.clear();
        self.keys.extend(rows.iter().map(|&row| {
            let rank = u64::from(self.ranked.rank(feature, row));
            (rank << 32) | self.label[row as usize] as u64
        }));
        let first = self.keys[0] >> 32;
        if self.keys.iter().all(|key| key >> 32 == first) {
            return None;
        }
        self.keys.sort_unstable();
        self.left.fill(0.0);
        self.right.fill(0.0);
        for &key in &self.keys {
            let class = key as u32 as usize;
            self.right[class] += self.class_weights[class];
        }
        // Σ l² and Σ r², updated while rows move from right to left; exact with weights of 1.
        let mut squares = [0.0, self.right.iter().map(|r| r * r).sum::<f64>()];
        let (mut n_left, n_rows) = (0.0, self.right.iter().sum::<f64>());
        let mut best: Option<(f64, u32, u32)> = None;
        for pair in self.keys.windows(2) {
            let class = pair[0] as u32 as usize;
            let weight = self.class_weights[class];
            squares[0] += weight * (2.0 * self.left[class] + weight);
            squares[1] -= weight * (2.0 * self.right[class] - weight);
            self.left[class] += weight;
            self.right[class] -= weight;
            n_left += weight;
            let (rank, next) = ((pair[0] >> 32) as u32, (pair[1] >> 32) as u32);
            if rank == next {
                continue;
            }
            let score = squares[0] / n_left + squares[1] / (n_rows - n_left);
            if best.is_none_or(|best| score > best.0) {
                best = Some((score, rank, next));
            }
        }
        best.map(|(score, rank, next)| Split {
            feature,
            rank,
            threshold: self.ranked.threshold(feature, rank, next),
            score,
        })
    }
}

/// Moves the rows of the left child to the front of the slice; returns their number.
fn partition(rows: &mut [u32], ranked: &Ranked, split: &Split) -> usize {
    let mut n_left = 0;
    for i in 0..rows.len() {
        if ranked.rank(split.feature, rows[i]) <= split.rank {
            rows.swap(i, n_left);
            n_left += 1;
        }
    }
    n_left
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array2, array};

    /// Grows a decision tree on all rows; every feature is a candidate for the split of each node.
    fn grow(features: &Array2<f64>, label: &[usize], max_depth: Option<usize>) -> Tree {
        let ranked = Ranked::new(features.view());
        let n_classes = label.iter().max().unwrap() + 1;
        let growth = Growth {
            class_weights: &vec![1.0; n_classes],
            n_candidates: ranked.n_features(),
            max_depth,
        };
        let rows = (0..label.len() as u32).collect();
        growth.grow(&ranked, label, rows, &(0))
    }

    /// Returns the most frequent class of the leaf that each row reaches; the first class if several are equally frequent.
    fn labels(tree: &Tree, features: &Array2<f64>) -> Vec<usize> {
        let label = |row| {
            let counts = tree.leaf(row).iter().rev();
            counts.max_by_key(|(_, count)| *count).unwrap().0 as usize
        };
        features.rows().into_iter().map(label).collect()
    }

    fn n_leaves(tree: &Tree) -> usize {
        let is_leaf = |node: &&Node| matches!(node, Node::Leaf { .. });
        tree.nodes.iter().filter(is_leaf).count()
    }

    /// Returns a test set of 60 rows with 5 features in three classes.
    fn waves() -> (Array2<f64>, Vec<usize>) {
        let value = |(i, j): (usize, usize)| {
            let wave = (1.7 * (i * 5 + j) as f64 + 0.3 * (j * j) as f64).sin();
            wave + 0.8 * (2.1 * ((i % 4) * (j + 1)) as f64).cos()
        };
        let features = Array2::from_shape_fn((60, 5), value);
        (features, (0..60).map(|i| i * i / 7 % 3).collect())
    }

    /// Tests that a shallow tree predicts the labels of scikit-learn 1.9.1, `DecisionTreeClassifier(max_depth=3)`. No two splits of these rows are equally
    /// good, so scikit-learn's tree does not depend on its `random_state`.
    #[test]
    fn a_shallow_tree_is_scikit_learns() {
        let (features, label) = waves();
        let tree = grow(&features, &label, Some(3));
        let Node::Split {
            feature, threshold, ..
        } = tree.nodes[0]
        else {
            panic!("the root is a leaf");
        };
        assert_eq!((feature, n_leaves(&tree)), (4, 5));
        assert!((threshold + 1.3317).abs() < 1e-5);
        let expected = [
            2, 0, 0, 0, 0, 0, 2, 0, 2, 2, 0, 2, 2, 0, 1, 2, 0, 2, 0, 0, 0, 0, 0, 0, 0, 2, 2, 0, 2,
            0, 2, 2, 2, 2, 2, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 1, 2, 0, 2, 0, 2, 2, 0, 2, 2, 0, 0, 2,
            0, 2,
        ];
        assert_eq!(labels(&tree, &features), expected);
    }

    #[test]
    fn an_unpruned_tree_fits_its_training_rows_in_any_order() {
        let (features, label) = waves();
        let tree = grow(&features, &label, None);
        assert_eq!(labels(&tree, &features), label);
        let order: Vec<usize> = (0..60).rev().collect();
        let reversed = features.select(ndarray::Axis(0), &order);
        let label: Vec<usize> = label.into_iter().rev().collect();
        let other = grow(&reversed, &label, None);
        let between = &features * 0.9 + 0.02;
        assert_eq!(labels(&tree, &between), labels(&other, &between));
    }

    #[test]
    fn exclusive_or_is_split_though_no_first_split_helps() {
        let features = array![[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
        let tree = grow(&features, &[0, 1, 1, 0], None);
        assert_eq!(labels(&tree, &features), [0, 1, 1, 0]);
        assert_eq!(n_leaves(&tree), 4);
    }

    #[test]
    fn rows_that_only_the_label_tells_apart_share_a_leaf() {
        let tree = grow(&array![[0.0], [-0.0], [0.0]], &[1, 0, 1], None);
        assert_eq!(n_leaves(&tree), 1);
        assert_eq!(tree.leaf(array![0.0].view()), [(0, 1), (1, 2)]);
    }

    #[test]
    fn a_weight_of_three_is_three_equal_rows() {
        let features = Array2::from_shape_fn((40, 3), |(i, j)| {
            ((i * 7 + j * 13) as f64 * 1.7).sin().round()
        });
        let label: Vec<usize> = (0..40).map(|i| usize::from(i * i % 7 < 2)).collect();
        let ranked = Ranked::new(features.view());
        let growth = |class_weights| Growth {
            class_weights,
            n_candidates: 3,
            max_depth: Some(3),
        };
        let rows = (0..40).collect();
        let weighted = growth(&[1.0, 3.0]).grow(&ranked, &label, rows, &0_u64);
        let repeated = (0..40)
            .flat_map(|row| vec![row; 1 + 2 * label[row as usize]])
            .collect();
        let repeated = growth(&[1.0, 1.0]).grow(&ranked, &label, repeated, &0_u64);
        for row in features.rows() {
            let counts = weighted
                .leaf(row)
                .iter()
                .map(|&(class, n)| (class, n * (1 + 2 * class)));
            assert_eq!(counts.collect::<Vec<_>>(), repeated.leaf(row));
        }
    }

    #[test]
    fn constant_features_are_drawn_but_the_last_draw_varies() {
        // One of 50 features varies. With 5 draws for each node, the tree still separates all rows.
        let features =
            Array2::from_shape_fn((20, 50), |(i, j)| if j == 31 { i as f64 } else { 1.0 });
        let label: Vec<usize> = (0..20).map(|i| i % 2).collect();
        let growth = Growth {
            class_weights: &[1.0; 2],
            n_candidates: 5,
            max_depth: None,
        };
        let ranked = Ranked::new(features.view());
        let tree = growth.grow(&ranked, &label, (0..20).collect(), &0_u64);
        assert_eq!(labels(&tree, &features), label);
        // Two of ten features vary. Three draws contain the better one in 3 of 10 trees; if they contain neither, in 56 of 120 trees, the next draws decide.
        let features = Array2::from_shape_fn((20, 10), |(i, j)| match j {
            3 => (i % 2) as f64,
            7 => i as f64,
            _ => 1.0,
        });
        let ranked = Ranked::new(features.view());
        let growth = Growth {
            n_candidates: 3,
            ..growth
        };
        let is_best_first = |seed: u64| {
            let tree = growth.grow(&ranked, &label, (0..20).collect(), &seed);
            matches!(tree.nodes[0], Node::Split { feature: 3, .. })
        };
        let n_best = (0..2000).filter(|seed| is_best_first(*seed)).count();
        // Within four standard deviations of 2000 (0.3 + 56 / 240).
        assert!((977..=1157).contains(&n_best), "{n_best}");
    }
}
