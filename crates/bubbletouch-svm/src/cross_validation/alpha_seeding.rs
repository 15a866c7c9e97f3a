//! Alpha seeding: the solution of a cross-validation fold is the starting point of the next fold.
//!
//! Two of k folds differ in only 2/k of their rows. The multipliers of removed rows are moved to the most similar added rows [DeCoste, Wagstaff 2000; Wen et
//! al. 2017]. The constraint `Σβ = 0` and the bounds remain satisfied.

use std::ops::Range;

use crate::gram::matrix::Gram;
use crate::linalg::scalar::Scalar;

/// Transfer of a solution from one cross-validation fold to the next, given the rows that differ (alpha seeding).
pub(crate) struct AlphaSeeding {
    /// Rows that are removed from and added to the training set, ascending, for each of the two classes.
    sides: [(Vec<usize>, Vec<usize>); 2],
}

impl AlphaSeeding {
    /// Creates the transfer from one fold to the next; each slice contains the limits of the coefficients in one fold, 0 for held-out rows.
    pub fn new((before, limits): (&[f64], &[f64]), positive: &Range<usize>) -> Self {
        let mut sides = [(); 2].map(|()| (Vec::new(), Vec::new()));
        for (at, (before, limit)) in before.iter().zip(limits).enumerate() {
            let (lost, gained) = &mut sides[usize::from(positive.contains(&at))];
            match (*before != 0.0, *limit != 0.0) {
                (true, false) => lost.push(at),
                (false, true) => gained.push(at),
                _ => (),
            }
        }
        Self { sides }
    }

    /// Returns the coefficients β after the values of removed rows were transferred to the most similar added rows. Returns `None` if a removed row has no
    /// added row left. The similarity of two rows is their kernel value.
    pub fn transfer<T: Scalar>(&self, beta: &[f64], gram: &mut Gram<T>) -> Option<Vec<f64>> {
        let mut moved = beta.to_vec();
        for (lost, gained) in &self.sides {
            let mut gained = gained.clone();
            for &lost in lost.iter().filter(|&&at| beta[at] != 0.0) {
                let similar = gram.row(lost);
                let mut nearest = (T::neg_infinity(), None);
                for (number, &at) in gained.iter().enumerate() {
                    if similar[at] > nearest.0 {
                        nearest = (similar[at], Some(number));
                    }
                }
                moved[gained.swap_remove(nearest.1?)] = beta[lost];
                moved[lost] = 0.0;
            }
        }
        Some(moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    /// Positions of the rows on a line; the first four rows are positive, and their similarity falls with the distance.
    const AT: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 0.4, 1.4, 2.4, 3.4];

    fn seed(beta: &[f64], was: &[usize], is: &[usize]) -> Option<Vec<f64>> {
        let kernel = Array2::from_shape_fn((8, 8), |(i, j)| -(AT[i] - AT[j]).abs());
        let labels = |fold: &[usize]| {
            let sign = |at: usize| if at < 4 { 1.0 } else { -1.0 };
            let label = |at: usize| if fold.contains(&at) { sign(at) } else { 0.0 };
            (0..8).map(label).collect::<Vec<f64>>()
        };
        let seeding = AlphaSeeding::new((&labels(was), &labels(is)), &(0..4));
        seeding.transfer(beta, &mut Gram::whole(kernel.view()))
    }

    #[test]
    fn multipliers_of_lost_rows_go_to_the_most_similar_gained_rows_of_their_class() {
        let beta = [0.5, 0.0, 0.0, 1.0, -0.7, 0.0, -0.8, 0.0];
        // Rows 3 and 4 are removed; rows 1, 2, 5 and 7 are added.
        let found = seed(&beta, &[0, 3, 4, 6], &[0, 1, 2, 5, 6, 7]);
        assert_eq!(found.unwrap(), [0.5, 0.0, 1.0, 0.0, 0.0, -0.7, -0.8, 0.0]);
    }

    #[test]
    fn rows_without_multipliers_are_lost_for_nothing() {
        let beta = [0.5, 0.0, 0.0, 0.0, -0.5, 0.0, 0.0, 0.0];
        let found = seed(&beta, &[0, 1, 4, 5], &[0, 4]);
        assert_eq!(found.unwrap(), beta);
    }

    #[test]
    fn a_multiplier_that_finds_no_row_of_its_class_makes_no_start() {
        let beta = [0.5, 0.0, 0.0, 0.0, -0.5, 0.0, 0.0, 0.0];
        assert_eq!(seed(&beta, &[0, 1, 4, 5], &[1, 4, 5, 6]), None);
    }
}
