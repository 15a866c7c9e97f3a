//! Combination of the decision values of all binary problems into one predicted class.

use ndarray::{Array1, Array2, ArrayView1, ArrayView2};
use serde::{Deserialize, Serialize};

use crate::linalg::scalar::Scalar;
use crate::multiclass::Multiclass;

/// Rule that converts decision values into a class. One-vs-one has one value per pair of class positions (0, 1), (0, 2), …, (1, 2), …; the first class of a
/// pair is positive. One-vs-rest has one value per class.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Voting {
    /// Number of classes.
    pub n_classes: usize,
    /// Multi-class strategy.
    pub multiclass: Multiclass,
}

impl Voting {
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

    /// Returns the number of the predicted class for each row of decision values, shape n_rows × n_problems.
    pub fn winners(&self, values: ArrayView2<f64>) -> Vec<usize> {
        let by_problem = values.t().as_standard_layout().into_owned();
        let offsets = Array1::zeros(by_problem.nrows());
        self.elect(&by_problem, offsets.view(), |_| true)
    }

    /// Returns the number of the predicted class for each row, from the weighted sums (n_problems × n_rows) and offsets ρ of the binary problems. Problems
    /// with an excluded class are ignored. A sum above ρ is a vote for the positive class, any other sum for the negative class, as in LIBSVM.
    pub fn elect<T: Scalar>(
        &self,
        sums: &Array2<T>,
        rho: ArrayView1<f64>,
        takes_part: impl Fn(usize) -> bool,
    ) -> Vec<usize> {
        let n_rows = sums.ncols();
        let (mut best, mut winners) = (vec![f64::NEG_INFINITY; n_rows], vec![0; n_rows]);
        let mut votes = Array2::<u16>::zeros((self.n_classes, n_rows));
        let problems = self.multiclass.problems(self.n_classes).into_iter();
        for (((positive, negative), sums), &rho) in problems.zip(sums.rows()).zip(rho) {
            if !takes_part(positive) || !negative.is_none_or(&takes_part) {
                continue;
            }
            let sums = sums.to_slice().expect("sums are stored problem by problem");
            let Some(negative) = negative else {
                for ((best, winner), &sum) in best.iter_mut().zip(&mut winners).zip(sums) {
                    let value = sum.wide() - rho;
                    if value > *best {
                        (*best, *winner) = (value, positive);
                    }
                }
                continue;
            };
            for (vote, &sum) in votes.row_mut(positive).iter_mut().zip(sums) {
                *vote += u16::from(sum.wide() > rho);
            }
            for (vote, &sum) in votes.row_mut(negative).iter_mut().zip(sums) {
                *vote += u16::from(sum.wide() <= rho);
            }
        }
        if self.multiclass == Multiclass::OneVsOne {
            let columns = votes.columns().into_iter();
            winners = columns.map(first_maximum).collect();
        }
        winners
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
}
