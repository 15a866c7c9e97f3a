//! From the decision values of binary problems to one class.

use ndarray::{Array1, ArrayView2};

use crate::recognition::svm::Multiclass;

/// Which class each decision value speaks for.
#[derive(Clone, Debug)]
pub(crate) struct Voting {
    classes: Vec<usize>,
    multiclass: Multiclass,
    /// For every problem, the positions in `classes` of its positive and its negative class.
    sides: Vec<(usize, Option<usize>)>,
}

impl Voting {
    /// For problems between these classes (ascending): the class whose rows are positive, and the other (`None`: all).
    pub fn new(
        classes: &[usize],
        multiclass: Multiclass,
        problems: impl Iterator<Item = (usize, Option<usize>)>,
    ) -> Self {
        let position = |class: usize| classes.partition_point(|&other| other < class);
        Self {
            sides: problems
                .map(|(positive, negative)| (position(positive), negative.map(position)))
                .collect(),
            classes: classes.to_vec(),
            multiclass,
        }
    }

    /// The classes, ascending.
    pub fn classes(&self) -> &[usize] {
        &self.classes
    }

    /// The label that each row of decision values (n_rows × n_problems) speaks for.
    pub fn labels(&self, values: ArrayView2<f64>) -> Array1<usize> {
        let mut votes = vec![0_u32; self.classes.len()];
        values
            .rows()
            .into_iter()
            .map(|values| {
                let winner = match self.multiclass {
                    Multiclass::OneVsRest => first_maximum(values.iter()),
                    _ => {
                        self.count(values.iter(), &mut votes);
                        first_maximum(votes.iter())
                    }
                };
                self.classes[winner]
            })
            .collect()
    }

    /// Votes per class, as LIBSVM counts them: a value above 0 is for the positive class, any other for the negative.
    fn count<'a>(&self, values: impl Iterator<Item = &'a f64>, votes: &mut [u32]) {
        votes.fill(0);
        for (&value, &(positive, negative)) in values.zip(&self.sides) {
            let negative = negative.unwrap_or(positive);
            votes[if value > 0.0 { positive } else { negative }] += 1;
        }
    }
}

/// The position of the largest value; the first of equals.
fn first_maximum<'a, V: PartialOrd + 'a>(values: impl Iterator<Item = &'a V>) -> usize {
    let mut best: Option<(usize, &V)> = None;
    for (i, value) in values.enumerate() {
        if best.is_none_or(|(_, largest)| value > largest) {
            best = Some((i, value));
        }
    }
    best.map_or(0, |(i, _)| i)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn ties_go_to_the_lowest_class() {
        let pairs = [(2, Some(5)), (2, Some(9)), (5, Some(9))];
        let voting = Voting::new(&[2, 5, 9], Multiclass::OneVsOne, pairs.into_iter());
        // A cycle: one vote each.
        let values = array![[1.0, -1.0, 1.0], [-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]];
        assert_eq!(voting.labels(values.view()), array![2, 5, 9]);
        let rest = [(2, None), (5, None), (9, None)];
        let voting = Voting::new(&[2, 5, 9], Multiclass::OneVsRest, rest.into_iter());
        let values = array![[0.5, 0.5, -1.0], [-3.0, -2.0, -2.0]];
        assert_eq!(voting.labels(values.view()), array![2, 5]);
    }
}
