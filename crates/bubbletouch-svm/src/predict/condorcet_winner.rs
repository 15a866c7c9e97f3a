//! Condorcet winner: the class that wins all its pairs. The search does not evaluate every pair of classes.
//!
//! One-vs-one predicts the class with the most votes. If one of n classes wins all its n − 1 pairs, it has the most votes, because every other class has lost a
//! pair. A knock-out finds the only possible winner of n − 1 pairs. The winner of the knock-out must then win its remaining pairs. At most 2 (n − 1) of n (n −
//! 1) / 2 pairs are therefore evaluated. On touches of 43 objects, 99 rows of 100 have a Condorcet winner.
//!
//! A pair is decided only if its value differs from ρ by more than the rounding error. The result then does not depend on the order of summation.

use multiversion::multiversion;
use ndarray::{Array1, ArrayView1, ArrayView2};

use crate::gram::centered_rows::CenteredRows;
use crate::linalg::scalar::Scalar;
use crate::predict::class_weights::ClassWeights;

/// Number of partial sums that are computed in parallel and independently of each other. For contiguous products, `WIDE` is used: one vector register.
const LANES: usize = 4;
const WIDE: usize = 16;

/// Decision functions of all pairs of classes, each with only its own support vectors. Most support vectors of two classes have the coefficient 0 in the
/// problem of the two classes.
#[derive(Clone, Debug)]
pub(crate) struct Pairs<T> {
    n_classes: usize,
    /// Support vectors and coefficients of all decision functions, one pair of classes after another.
    terms: Vec<(u32, T)>,
    /// End index of each pair's terms in `terms`, and the offset ρ of the pair's decision function. The order of the pairs is (0, 1), (0, 2), …, (1, 2), ….
    ends: Vec<(usize, f64)>,
}

impl<T: Scalar> Pairs<T> {
    /// Creates the one-vs-one decision functions from the coefficients of each class and the offset ρ of each pair.
    pub fn new(weights: &[ClassWeights<T>], rho: &Array1<f64>) -> Self {
        let mut terms = Vec::new();
        let mut ends = Vec::with_capacity(rho.len());
        for (first, left) in weights.iter().enumerate() {
            for (second, right) in weights.iter().enumerate().skip(first + 1) {
                // A class's problems are ordered by the other class; the class itself is skipped.
                for (class, problem) in [(left, second - 1), (right, first)] {
                    let coefficients = class.coefficients.row(problem);
                    let all = class.vectors.clone().zip(coefficients);
                    let support = all.filter(|(_, weight)| **weight != T::zero());
                    terms.extend(support.map(|(vector, &weight)| (vector as u32, weight)));
                }
                ends.push((terms.len(), rho[ends.len()]));
            }
        }
        Self {
            n_classes: weights.len(),
            terms,
            ends,
        }
    }

    /// Returns the class that wins against every other class (Condorcet winner) for each row of kernel values (n × n_vectors). Returns `None` for a row if no
    /// class wins all its pairs, or if rounding could change the result of a pair.
    pub fn condorcet_winners(&self, kernel_values: ArrayView2<T>) -> Vec<Option<usize>> {
        let rows = kernel_values.rows().into_iter();
        let rows = rows.map(|row| row.to_slice().expect("they lie row by row"));
        rows.map(|kernel_values| {
            condorcet_winner(&ByKernel {
                pairs: self,
                kernel_values,
            })
        })
        .collect()
    }

    /// Returns the terms (support vector, coefficient) and the offset ρ of the decision function of a pair of classes.
    #[inline(always)]
    fn pair(&self, pair: usize) -> (&[(u32, T)], f64) {
        let start = if pair == 0 { 0 } else { self.ends[pair - 1].0 };
        let (end, rho) = self.ends[pair];
        (&self.terms[start..end], rho)
    }
}

/// Returns, for each feature row (n × m), the class that wins against every other class; inputs are the normals and offsets ρ of all pairs.
pub(crate) fn condorcet_winners_by_hyperplanes<'a, T: Scalar>(
    n_classes: usize,
    (normals, rho): (ArrayView2<'a, T>, ArrayView1<'a, f64>),
    rows: &'a CenteredRows<T>,
) -> Vec<Option<usize>> {
    let normals = normals.to_slice().expect("normals are stored one by one");
    let of_row = |row| {
        condorcet_winner(&Hyperplanes {
            n_classes,
            normals,
            rho,
            row: rows.row(row).0,
        })
    };
    (0..rows.len()).map(of_row).collect()
}

/// Interface to the decision functions of all pairs of classes for one feature row.
trait PairwiseDecisions<T> {
    fn n_classes(&self) -> usize;

    /// Returns the weighted sum of a pair's decision function, the sum of its absolute terms, the number of terms, and the offset ρ.
    fn value(&self, pair: usize) -> (T, T, usize, f64);
}

/// Decision functions of one row that are evaluated from its kernel values.
struct ByKernel<'a, T> {
    pairs: &'a Pairs<T>,
    kernel_values: &'a [T],
}

impl<T: Scalar> PairwiseDecisions<T> for ByKernel<'_, T> {
    #[inline(always)]
    fn n_classes(&self) -> usize {
        self.pairs.n_classes
    }

    #[inline(always)]
    fn value(&self, pair: usize) -> (T, T, usize, f64) {
        let (terms, rho) = self.pairs.pair(pair);
        let (sum, size) = sum_and_size(terms, self.kernel_values);
        (sum, size, terms.len(), rho)
    }
}

/// Decision functions of one row that are evaluated from the hyperplane normals.
struct Hyperplanes<'a, T> {
    n_classes: usize,
    normals: &'a [T],
    rho: ArrayView1<'a, f64>,
    row: &'a [T],
}

impl<T: Scalar> PairwiseDecisions<T> for Hyperplanes<'_, T> {
    #[inline(always)]
    fn n_classes(&self) -> usize {
        self.n_classes
    }

    #[inline(always)]
    fn value(&self, pair: usize) -> (T, T, usize, f64) {
        let normal = &self.normals[pair * self.row.len()..][..self.row.len()];
        let (sum, size) = product_and_size(normal, self.row);
        (sum, size, self.row.len(), self.rho[pair])
    }
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn condorcet_winner<T: Scalar, P: PairwiseDecisions<T>>(pairs: &P) -> Option<usize> {
    let mut champion = 0;
    for other in 1..pairs.n_classes() {
        if !wins(pairs, (champion, other))? {
            champion = other;
        }
    }
    // The pairs with all later classes are already won.
    for other in 0..champion {
        if wins(pairs, (other, champion))? {
            return None;
        }
    }
    Some(champion)
}

/// Returns whether class `first` wins against class `second` (first < second); `None` if rounding errors could change the result.
#[inline(always)]
fn wins<T: Scalar>(
    pairs: &impl PairwiseDecisions<T>,
    (first, second): (usize, usize),
) -> Option<bool> {
    let pair = first * (2 * pairs.n_classes() - first - 1) / 2 + second - first - 1;
    let (sum, size, n_terms, rho) = pairs.value(pair);
    let value = sum.wide() - rho;
    // The error of adding n products one by one is at most n u Σ|products|, where u is half of epsilon. Two orders of summation differ by at most twice this
    // value. The 8 accounts for adding lanes and classes.
    let error = (n_terms + 8) as f64 * T::epsilon().wide() * size.wide();
    if value > error {
        Some(true)
    } else if value < -error {
        Some(false)
    } else {
        None
    }
}

/// Returns the inner product of a hyperplane normal and a row, and the sum of the absolute values of all terms.
#[inline(always)]
fn product_and_size<T: Scalar>(normal: &[T], row: &[T]) -> (T, T) {
    let (mut sums, mut sizes) = ([T::zero(); WIDE], [T::zero(); WIDE]);
    let (weights, last_weights) = normal.as_chunks::<WIDE>();
    let (values, last_values) = row.as_chunks::<WIDE>();
    for at in 0..values.len() {
        for lane in 0..WIDE {
            let product = weights[at][lane] * values[at][lane];
            sums[lane] += product;
            sizes[lane] += product.abs();
        }
    }
    let (mut sum, mut size) = (T::zero(), T::zero());
    for at in 0..last_values.len() {
        let product = last_weights[at] * last_values[at];
        sum += product;
        size += product.abs();
    }
    for lane in 0..WIDE {
        sum += sums[lane];
        size += sizes[lane];
    }
    (sum, size)
}

/// Returns two sums over the terms (coefficient times kernel value): of the values, and of their absolute values.
#[inline(always)]
fn sum_and_size<T: Scalar>(terms: &[(u32, T)], kernel_values: &[T]) -> (T, T) {
    let (mut sum, mut size) = ([T::zero(); LANES], [T::zero(); LANES]);
    let (chunks, last) = terms.as_chunks::<LANES>();
    for terms in chunks {
        for (lane, &(vector, weight)) in terms.iter().enumerate() {
            let product = weight * kernel_values[vector as usize];
            sum[lane] += product;
            size[lane] += product.abs();
        }
    }
    for (lane, &(vector, weight)) in last.iter().enumerate() {
        let product = weight * kernel_values[vector as usize];
        sum[lane] += product;
        size[lane] += product.abs();
    }
    (
        sum[0] + sum[1] + (sum[2] + sum[3]),
        size[0] + size[1] + (size[2] + size[3]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multiclass::Multiclass;
    use crate::predict::voting::Voting;
    use ndarray::Array2;

    const N_CLASSES: usize = 6;
    const N_VECTORS: usize = 5;

    /// Returns irregular test coefficients; two of three are zero.
    fn weights() -> Vec<ClassWeights<f64>> {
        let pairs = Multiclass::OneVsOne.problems(N_CLASSES);
        let of_class = |class: usize| {
            let own = |i: &usize| pairs[*i].0 == class || pairs[*i].1 == Some(class);
            ClassWeights {
                vectors: class * N_VECTORS..(class + 1) * N_VECTORS,
                problems: (0..pairs.len()).filter(own).collect(),
                coefficients: Array2::from_shape_fn((N_CLASSES - 1, N_VECTORS), |(i, j)| {
                    let at = 31 * class + 7 * i + j;
                    if at.is_multiple_of(3) {
                        (at as f64 * 2.3).sin()
                    } else {
                        0.0
                    }
                }),
            }
        };
        (0..N_CLASSES).map(of_class).collect()
    }

    /// Returns the decision values of a row, computed from the coefficients class by class.
    fn values(weights: &[ClassWeights<f64>], rho: &Array1<f64>, row: &[f64]) -> Array1<f64> {
        let mut values = -rho.clone();
        for class in weights {
            for (&problem, own) in class.problems.iter().zip(class.coefficients.rows()) {
                let products = class
                    .vectors
                    .clone()
                    .zip(own)
                    .map(|(at, own)| row[at] * own);
                values[problem] += products.sum::<f64>();
            }
        }
        values
    }

    #[test]
    fn a_class_is_unbeaten_exactly_if_it_has_all_votes_and_voting_elects_it() {
        let weights = weights();
        let rho =
            Array1::from_shape_fn(N_CLASSES * (N_CLASSES - 1) / 2, |i| (i as f64).cos() * 0.1);
        let rows = Array2::from_shape_fn((400, N_CLASSES * N_VECTORS), |(i, j)| {
            (i as f64 * 0.7 + j as f64 * (1.0 + i as f64 * 0.01)).sin() + 0.3
        });
        let winners = Pairs::new(&weights, &rho).condorcet_winners(rows.view());
        let voting = Voting {
            n_classes: N_CLASSES,
            multiclass: Multiclass::OneVsOne,
        };
        for (row, winner) in rows.rows().into_iter().zip(&winners) {
            let values = values(&weights, &rho, &row.to_vec());
            let elected = voting.winners(values.view().insert_axis(ndarray::Axis(0)))[0];
            let pairs = Multiclass::OneVsOne.problems(N_CLASSES);
            let lost = pairs.iter().zip(&values).any(|(&(first, second), &value)| {
                (value <= 0.0 && first == elected) || (value > 0.0 && second == Some(elected))
            });
            assert_eq!(*winner, (!lost).then_some(elected));
        }
        assert!(winners.iter().any(|winner| winner.is_none()));
        for class in 0..N_CLASSES {
            assert!(winners.contains(&Some(class)), "{class} is never elected");
        }
    }

    #[test]
    fn what_rounding_might_decide_is_left_open() {
        let weights = weights();
        let row = vec![1.0; N_CLASSES * N_VECTORS];
        let tied = values(&weights, &Array1::zeros(15), &row);
        let rows = Array2::ones((1, N_CLASSES * N_VECTORS));
        for (offset, is_open) in [(0.0, true), (1e-15, true), (-1e-15, true), (1e-9, false)] {
            // The offset makes the first class win each pair.
            let winners = Pairs::new(&weights, &(&tied - offset)).condorcet_winners(rows.view());
            assert_eq!(winners, [if is_open { None } else { Some(0) }], "{offset}");
        }
        let winners = Pairs::new(&weights, &tied).condorcet_winners((&rows * f64::NAN).view());
        assert_eq!(winners, [None]);
    }
}
