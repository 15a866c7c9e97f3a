//! Fusion of several touches of one object into one decision.
//!
//! The scores of k touches are summed, and the sum determines one label. If scores are log-probabilities, the sum gives the decision for independent
//! observations. If scores are decision values of an SVM, the sum is a vote weighted by margins.

use std::collections::BTreeMap;

use ndarray::{Array2, ArrayView1, ArrayView2};
use rand::seq::SliceRandom;

use crate::random::Seed;

/// Groups of test rows; one decision is made for each group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FusedRows {
    /// Positions of the k rows of each group. All rows of a group have the same class; groups are disjoint and ordered by class.
    pub groups: Vec<Vec<usize>>,
    /// Number of rows that do not fill a complete group.
    pub n_left_out: usize,
}

/// Divides the rows into random groups of k rows with equal labels. For k = 1, each row is a group, in the order of the rows.
///
/// The rows of each class are shuffled by a separate stream of `seed` and cut into groups. The groups of a class therefore do not depend on other classes.
///
/// # Panics
/// If k is 0.
pub fn fuse_rows(labels: ArrayView1<usize>, k: usize, seed: &Seed) -> FusedRows {
    assert!(k > 0, "at least one row a group");
    if k == 1 {
        return FusedRows {
            groups: (0..labels.len()).map(|row| vec![row]).collect(),
            n_left_out: 0,
        };
    }
    let mut rows_of = BTreeMap::<usize, Vec<usize>>::new();
    for (row, &class) in labels.iter().enumerate() {
        rows_of.entry(class).or_default().push(row);
    }
    let mut fused = FusedRows {
        groups: Vec::new(),
        n_left_out: 0,
    };
    for (class, mut rows) in rows_of {
        rows.shuffle(&mut seed.named("class").numbered(class as u64).rng());
        let groups = rows.chunks_exact(k);
        fused.n_left_out += groups.remainder().len();
        fused.groups.extend(groups.map(<[usize]>::to_vec));
    }
    fused
}

/// Adds the scores of the rows in each group: shape (n_rows, n_scores) becomes (n_groups, n_scores).
pub fn fuse_scores(scores: ArrayView2<f64>, groups: &[Vec<usize>]) -> Array2<f64> {
    let mut sums = Array2::zeros((groups.len(), scores.ncols()));
    for (mut sum, group) in sums.outer_iter_mut().zip(groups) {
        for &row in group {
            sum += &scores.row(row);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array1, array};
    use std::collections::BTreeSet;

    fn labels() -> Array1<usize> {
        (0..36).map(|row| [0, 1, 2, 2, 1, 0][row % 6]).collect()
    }

    #[test]
    fn groups_are_disjoint_of_one_class_and_leave_out_less_than_k_of_each() {
        let labels = array![0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 0, 2, 2, 0, 2];
        for k in 1..=4 {
            let fused = fuse_rows(labels.view(), k, &Seed::new(1));
            let mut seen = BTreeSet::new();
            for group in &fused.groups {
                assert_eq!(group.len(), k);
                assert!(group.iter().all(|&row| labels[row] == labels[group[0]]));
                assert!(group.iter().all(|&row| seen.insert(row)), "disjoint");
            }
            assert_eq!(seen.len() + fused.n_left_out, labels.len());
            let rests: usize = [6, 4, 6].iter().map(|n| n % k).sum();
            assert_eq!(fused.n_left_out, rests, "k = {k}");
        }
    }

    #[test]
    fn a_class_is_grouped_by_the_seed_whatever_other_classes_there_are() {
        let all = fuse_rows(labels().view(), 3, &Seed::new(1)).groups;
        assert_eq!(fuse_rows(labels().view(), 3, &Seed::new(1)).groups, all);
        assert_ne!(fuse_rows(labels().view(), 3, &Seed::new(2)).groups, all);
        // Only the rows of class 1, at unchanged positions.
        let rows: Vec<usize> = (0..36).filter(|&row| labels()[row] == 1).collect();
        let alone = fuse_rows(Array1::ones(rows.len()).view(), 3, &Seed::new(1)).groups;
        let moved: Vec<Vec<usize>> = alone
            .iter()
            .map(|group| group.iter().map(|&place| rows[place]).collect())
            .collect();
        let among: Vec<Vec<usize>> = all.into_iter().filter(|g| labels()[g[0]] == 1).collect();
        assert_eq!(moved, among);
    }

    #[test]
    fn one_touch_alone_keeps_its_scores() {
        let scores = array![[0.1, -0.2], [1e300, 5e-324], [-0.0, 3.0]];
        let fused = fuse_rows(array![0, 1, 0].view(), 1, &Seed::new(1));
        assert_eq!(fused.groups, [[0], [1], [2]]);
        assert_eq!(fuse_scores(scores.view(), &fused.groups), scores);
        let together = fuse_scores(scores.view(), &[vec![0, 2]]);
        assert_eq!(together, array![[0.1, 2.8]]);
    }
}
