//! From the decision values of binary problems to one class.

use ndarray::{Array1, ArrayView2};

use crate::recognition::svm::Multiclass;

/// Which class the decision values speak for: for one-vs-one those of all pairs (0, 1), (0, 2), …, (1, 2), … of the
/// classes' positions, the first positive; for one-vs-rest one a class.
#[derive(Clone, Debug)]
pub(crate) struct Voting {
    classes: Vec<usize>,
    multiclass: Multiclass,
}

impl Voting {
    /// Between these classes, ascending.
    pub fn new(classes: &[usize], multiclass: Multiclass) -> Self {
        Self {
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
        let values = values.as_standard_layout();
        let mut votes = Vec::new();
        values
            .rows()
            .into_iter()
            .map(|row| self.label(row.as_slice().unwrap_or_default(), &mut votes))
            .collect()
    }

    /// The label that a row of decision values speaks for; `votes` is scratch.
    pub fn label(&self, values: &[f64], votes: &mut Vec<u32>) -> usize {
        let winner = match self.multiclass {
            Multiclass::OneVsRest => first_maximum(values),
            _ => {
                votes.clear();
                votes.resize(self.classes.len(), 0);
                count(values, votes);
                first_maximum(votes)
            }
        };
        self.classes[winner]
    }
}

/// Votes per class, as LIBSVM counts them: a value above 0 is for the positive class, any other for the negative. The
/// problems are all pairs of classes in order, so those of a class with all later ones lie side by side.
fn count(values: &[f64], votes: &mut [u32]) {
    let mut rest = values;
    for class in 0..votes.len() {
        let (own, later) = votes[class..].split_at_mut(1);
        let (values, after) = rest.split_at(later.len());
        rest = after;
        for (vote, &value) in later.iter_mut().zip(values) {
            let is_own = u32::from(value > 0.0);
            own[0] += is_own;
            *vote += 1 - is_own;
        }
    }
}

/// The position of the largest value; the first of equals.
pub(crate) fn first_maximum<V: PartialOrd>(values: &[V]) -> usize {
    let mut best = 0;
    for (i, value) in values.iter().enumerate() {
        if *value > values[best] {
            best = i;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn ties_go_to_the_lowest_class() {
        let voting = Voting::new(&[2, 5, 9], Multiclass::OneVsOne);
        // A cycle: one vote each.
        let values = array![[1.0, -1.0, 1.0], [-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]];
        assert_eq!(voting.labels(values.view()), array![2, 5, 9]);
        let voting = Voting::new(&[2, 5, 9], Multiclass::OneVsRest);
        let values = array![[0.5, 0.5, -1.0], [-3.0, -2.0, -2.0]];
        assert_eq!(voting.labels(values.view()), array![2, 5]);
    }
}
