//! Combination of the decision values of all binary problems into one predicted class.

use ndarray::{Array2, ArrayView1, ArrayView2, Axis};
use serde::{Deserialize, Serialize};

use crate::linalg::scalar::Scalar;
use crate::multiclass::Multiclass;

/// Rule that converts decision values into a class. One-vs-one has one value per pair of class positions (0, 1), (0, 2), …, (1, 2), …; the first class of a
/// pair is positive. One-vs-rest has one value per class.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Voting {
    /// Number of classes.
    pub n_classes: usize,
    /// Multi-class strategy.
    pub multiclass: Multiclass,
}

impl Voting {
    /// Returns the number of the predicted class for each row of decision values, shape n_rows × n_problems.
    pub fn winners(&self, values: ArrayView2<f64>) -> Vec<usize> {
        let mut votes = Vec::new();
        let rows = values.rows().into_iter();
        rows.map(|row| self.winner(row, &mut votes)).collect()
    }

    /// Returns one value per class for each row of decision values: the value of the class for one-vs-rest, otherwise its votes and a part below 1/3 that orders
    /// classes of equal votes.
    pub fn class_scores(&self, values: ArrayView2<f64>) -> Array2<f64> {
        if self.multiclass == Multiclass::OneVsRest {
            return values.to_owned();
        }
        let n = self.n_classes;
        let (mut scores, mut sums) = (Array2::zeros((values.nrows(), n)), vec![0.0; n]);
        for (row, mut scores) in values.outer_iter().zip(scores.outer_iter_mut()) {
            sums.fill(0.0);
            for ((first, second), &value) in self.multiclass.problems(n).into_iter().zip(row) {
                let second = second.expect("a pair of classes");
                scores[if value > 0.0 { first } else { second }] += 1.0;
                sums[first] += value;
                sums[second] -= value;
            }
            for (score, sum) in scores.iter_mut().zip(&sums) {
                *score += sum / (3.0 * (sum.abs() + 1.0));
            }
        }
        scores
    }

    /// Returns the number of the predicted class for one row of decision values, using `votes` as temporary memory.
    fn winner(&self, values: ArrayView1<f64>, votes: &mut Vec<u32>) -> usize {
        match self.multiclass {
            Multiclass::OneVsRest => first_maximum(values),
            _ => {
                votes.clear();
                votes.resize(self.n_classes, 0);
                count(values, votes);
                first_maximum(votes.iter().copied())
            }
        }
    }
}

/// Vote counter for many rows, to which the binary problems are added one after the other.
#[derive(Clone, Debug)]
pub(crate) enum VoteCounter {
    /// For one-vs-one: number of votes for each class and row, n_classes × n_rows.
    Counts(Array2<u16>),
    /// Votes for one-vs-rest: for each row, the largest decision value found so far and its class.
    Best(Vec<f64>, Vec<usize>),
}

impl VoteCounter {
    /// Creates a vote counter without votes.
    pub fn new(n_classes: usize, n_rows: usize, multiclass: Multiclass) -> Self {
        match multiclass {
            Multiclass::OneVsRest => Self::Best(vec![f64::NEG_INFINITY; n_rows], vec![0; n_rows]),
            _ => Self::Counts(Array2::zeros((n_classes, n_rows))),
        }
    }

    /// Adds the votes of one binary problem. A value above the offset ρ is a vote for the positive class, any other value for the negative class. Problems must
    /// be added in the order of all problems of the multi-class strategy.
    pub fn take<T: Scalar>(
        &mut self,
        (positive, negative): (usize, Option<usize>),
        values: &[T],
        rho: f64,
    ) {
        match self {
            Self::Counts(votes) => {
                for (vote, &value) in votes.row_mut(positive).iter_mut().zip(values) {
                    *vote += u16::from(value.wide() > rho);
                }
                for (vote, &value) in votes
                    .row_mut(negative.unwrap_or(positive))
                    .iter_mut()
                    .zip(values)
                {
                    *vote += u16::from(value.wide() <= rho);
                }
            }
            Self::Best(best, winners) => {
                for ((best, winner), &value) in best.iter_mut().zip(winners).zip(values) {
                    let value = value.wide() - rho;
                    if value > *best {
                        (*best, *winner) = (value, positive);
                    }
                }
            }
        }
    }

    /// Returns the position of the predicted class for each row, from the weighted sums (n_problems × n_rows) and offsets ρ of the binary problems. Problems
    /// with an excluded class are ignored.
    pub fn elect<T: Scalar>(
        sums: &Array2<T>,
        rho: ArrayView1<f64>,
        (n_classes, multiclass): (usize, Multiclass),
        takes_part: impl Fn(usize) -> bool,
    ) -> Vec<usize> {
        let mut counter = Self::new(n_classes, sums.ncols(), multiclass);
        let problems = multiclass.problems(n_classes).into_iter();
        for (((positive, negative), sums), &rho) in problems.zip(sums.rows()).zip(rho) {
            if takes_part(positive) && negative.is_none_or(&takes_part) {
                let sums = sums.to_slice().expect("sums are stored problem by problem");
                counter.take((positive, negative), sums, rho);
            }
        }
        counter.winners()
    }

    /// Returns the position of the class with the most votes for each row; the first class if several have equally many.
    pub fn winners(&self) -> Vec<usize> {
        match self {
            Self::Best(_, winners) => winners.clone(),
            Self::Counts(votes) => votes
                .columns()
                .into_iter()
                .map(|votes| first_maximum(votes.iter().copied()))
                .collect(),
        }
    }
}

/// Adds the votes of one row, as in LIBSVM: a positive value is a vote for the positive class, other values for the negative class. The values are in the order
/// of all pairs of classes, so the pairs of a class with all later classes are contiguous.
fn count(values: ArrayView1<f64>, votes: &mut [u32]) {
    let mut rest = values;
    for class in 0..votes.len() {
        let (own, later) = votes[class..].split_at_mut(1);
        let (values, after) = rest.split_at(Axis(0), later.len());
        rest = after;
        for (vote, &value) in later.iter_mut().zip(values) {
            let is_own = u32::from(value > 0.0);
            own[0] += is_own;
            *vote += 1 - is_own;
        }
    }
}

/// Returns the index of the largest value; the first index if several values are equal.
#[doc(hidden)]
pub fn first_maximum<V: PartialOrd>(values: impl IntoIterator<Item = V>) -> usize {
    let values = values.into_iter().enumerate();
    let best = values.reduce(|best, next| if next.1 > best.1 { next } else { best });
    best.map_or(0, |(place, _)| place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn values_of_classes_are_those_of_scikit_learn() {
        // sklearn.utils.multiclass._ovr_decision_function of scikit-learn 1.9.1, whose pairs have the opposite sign: predictions (v < 0), confidences -v.
        let values = array![[0.5, -1.0, 2.0], [-0.25, -0.5, 0.0]];
        let expected = array![
            [1.0 - 0.5 / 4.5, 1.0 + 1.5 / 7.5, 1.0 - 1.0 / 6.0],
            [0.0 - 0.75 / 5.25, 1.0 + 0.25 / 3.75, 2.0 + 0.5 / 4.5]
        ];
        let voting = Voting {
            n_classes: 3,
            multiclass: Multiclass::OneVsOne,
        };
        let found = voting.class_scores(values.view());
        assert!(
            (found - expected)
                .iter()
                .all(|difference: &f64| difference.abs() < 1e-15)
        );
    }

    #[test]
    fn ties_go_to_the_lowest_class() {
        let voting = |multiclass| Voting {
            n_classes: 3,
            multiclass,
        };
        // A cycle: one vote for each class.
        let values = array![[1.0, -1.0, 1.0], [-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]];
        let one_vs_one = voting(Multiclass::OneVsOne).winners(values.view());
        assert_eq!(one_vs_one, [0, 1, 2]);
        let values = array![[0.5, 0.5, -1.0], [-3.0, -2.0, -2.0]];
        let one_vs_rest = voting(Multiclass::OneVsRest).winners(values.view());
        assert_eq!(one_vs_rest, [0, 1]);
    }

    #[test]
    fn votes_taken_problem_by_problem_elect_whom_rows_of_values_elect() {
        let value = |i: usize| (i as f64 * 1.7).sin().max(-0.2);
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            let problems = multiclass.problems(5);
            let values = Array2::from_shape_fn((70, problems.len()), |(i, j)| value(11 * i + j));
            let mut counter = VoteCounter::new(5, 70, multiclass);
            for (&problem, column) in problems.iter().zip(values.columns()) {
                counter.take(problem, &column.mapv(|v| v + 0.3).to_vec(), 0.3);
            }
            let voting = Voting {
                n_classes: 5,
                multiclass,
            };
            let expected = voting.winners(values.view());
            assert_eq!(counter.winners(), expected, "{multiclass:?}");
        }
    }
}
