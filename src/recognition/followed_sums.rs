//! Weighted sums of rows that follow the solutions of a problem from one C to the next.
//!
//! Most multipliers of a small C are at their bounds, and stay there at the next: their part of the sums grows with C. Only
//! rows whose coefficients do not grow with C are added.

use std::ops::Range;

use ndarray::{Array2, ArrayView2};

use crate::recognition::scalar::Scalar;

/// The sums of each class's rows that are trained on (n_classes × columns).
pub(crate) fn class_sums<T: Scalar>(
    classes: &[Range<usize>],
    is_training: &[bool],
    rows: ArrayView2<T>,
) -> Array2<T> {
    let mut sums = Array2::zeros((classes.len(), rows.ncols()));
    for (range, mut sums) in classes.iter().zip(sums.rows_mut()) {
        let own = range.clone().filter(|&at| is_training[at]);
        let to = sums.as_slice_mut().expect("a new array is contiguous");
        add_rows(to, own.map(|at| (row(&rows, at), T::one())).collect());
    }
    sums
}

/// `Σ β_i row_i` over the rows of a problem, and the coefficients that it belongs to.
pub(crate) struct Sums<T> {
    values: Vec<T>,
    beta: Vec<f64>,
    c: f64,
}

impl<T: Scalar> Sums<T> {
    /// Of all multipliers at C = 1, in the first `n` columns: β of the problem's rows is then 1 or −1, or 0 where a row is not
    /// trained on.
    pub fn of_bounds(
        of_classes: &Array2<T>,
        (positive, negative): (usize, Option<usize>),
        beta: Vec<f64>,
        n: usize,
    ) -> Self {
        let sign = |is_positive: bool| if is_positive { T::one() } else { -T::one() };
        let mut values = vec![T::zero(); n];
        let takes_part = |class: &usize| {
            *class == positive || negative.is_none_or(|negative| *class == negative)
        };
        let classes = (0..of_classes.nrows()).filter(takes_part);
        let of_classes = of_classes.view();
        let weigh = |class: usize| (row(&of_classes, class), sign(class == positive));
        add_rows(&mut values, classes.map(weigh).collect());
        Self {
            values,
            beta,
            c: 1.0,
        }
    }

    /// The sums, one a column.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Leaves out all columns from this one on.
    pub fn truncate(&mut self, n_columns: usize) {
        self.values.truncate(n_columns);
    }

    /// Goes on to the coefficients of another C, and adds up what differs from the last ones in proportion to C: those at
    /// their bounds do not. Starts again unless that is less than half the work: sums that are followed round more than once.
    pub fn follow(&mut self, rows: ArrayView2<T>, places: &[usize], (beta, c): (&[f64], f64)) {
        let ratio = c / self.c;
        let rest = |(&beta, &last): (&f64, &f64)| {
            let stays = beta.abs() == c && last.abs() == self.c;
            if stays { 0.0 } else { beta - ratio * last }
        };
        let rest: Vec<f64> = beta.iter().zip(&self.beta).map(rest).collect();
        let n = |beta: &[f64]| beta.iter().filter(|beta| **beta != 0.0).count();
        let (start, change) = if 2 * n(&rest) < n(beta) {
            (T::of(ratio), &rest[..])
        } else {
            (T::zero(), beta)
        };
        if start == T::zero() {
            self.values.fill(start);
        } else {
            self.values.iter_mut().for_each(|sum| *sum *= start);
        }
        let change = places.iter().zip(change).filter(|(_, beta)| **beta != 0.0);
        let width = rows.ncols();
        let rows = rows.to_slice().expect("rows lie one by one");
        let row = |at: usize| &rows[at * width..][..width];
        let weigh = |(&at, &beta): (&usize, &f64)| (row(at), T::of(beta));
        add_rows(&mut self.values, change.map(weigh).collect());
        self.beta.copy_from_slice(beta);
        self.c = c;
    }
}

fn row<'a, T>(rows: &ArrayView2<'a, T>, at: usize) -> &'a [T] {
    let width = rows.ncols();
    let rows = rows.to_slice().expect("rows lie one by one");
    &rows[at * width..][..width]
}

/// Adds rows times their weights; rows may be longer than the sums.
pub(crate) fn add_rows<T: Scalar>(sums: &mut [T], mut rows: Vec<(&[T], T)>) {
    let Some(&(first, _)) = rows.first() else {
        return;
    };
    // Rows that weigh nothing fill up the last four.
    rows.resize(rows.len().next_multiple_of(4), (first, T::zero()));
    for four in rows.as_chunks::<4>().0 {
        add_four(sums, four);
    }
}

/// Four rows at once: the sums are read and written a quarter as often.
#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
fn add_four<T: Scalar>(sums: &mut [T], rows: &[(&[T], T); 4]) {
    let n = sums.len();
    let [(a, p), (b, q), (c, r), (d, s)] = *rows;
    let (a, b, c, d) = (&a[..n], &b[..n], &c[..n], &d[..n]);
    for at in 0..n {
        sums[at] += (p * a[at] + q * b[at]) + (r * c[at] + s * d[at]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn followed_sums_are_those_of_all_rows() {
        let rows = Array2::from_shape_fn((9, 21), |(i, j)| ((i * 5 + j * 3) as f64 * 1.7).sin());
        // One row of each of two classes is not trained on.
        let is_training: Vec<bool> = (0..9).map(|at| at != 2 && at != 6).collect();
        let of_classes = class_sums(&[0..4, 4..6, 6..9], &is_training, rows.view());
        let pair: Vec<usize> = (0..4).chain(6..9).collect();
        for (problem, places) in [((0, Some(2)), pair), ((1, None), (0..9).collect())] {
            let sign = |&at: &usize| match at {
                at if !is_training[at] => 0.0,
                0..4 if problem.0 == 0 => 1.0,
                4..6 if problem.0 == 1 => 1.0,
                _ => -1.0,
            };
            let signs: Vec<f64> = places.iter().map(sign).collect();
            let mut sums = Sums::of_bounds(&of_classes, problem, signs.clone(), 21);
            // All at C, all but one, two free, then free alone, and back; on fewer and fewer columns.
            for (number, (c, free, is_bound)) in [
                (0.5_f64, 9, true),
                (2.0, 3, true),
                (8.0, 2, true),
                (9.0, 2, false),
                (1.0, 4, true),
            ]
            .into_iter()
            .enumerate()
            {
                let beta = |(number, sign): (usize, &f64)| match number % free == 1 {
                    true => 0.3 * c.sqrt() * sign,
                    false if is_bound => c * sign,
                    false => 0.0,
                };
                let beta: Vec<f64> = signs.iter().enumerate().map(beta).collect();
                sums.truncate(21 - number);
                sums.follow(rows.view(), &places, (&beta, c));
                assert_eq!(sums.values().len(), 21 - number);
                for (column, sum) in sums.values().iter().enumerate() {
                    let each = places
                        .iter()
                        .zip(&beta)
                        .map(|(&at, beta)| beta * rows[[at, column]]);
                    let expected: f64 = each.sum();
                    assert!(
                        (sum - expected).abs() < 1e-12,
                        "{problem:?} {c} {sum} {expected}"
                    );
                }
            }
        }
    }
}
