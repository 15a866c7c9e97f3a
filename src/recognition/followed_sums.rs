//! Weighted sums of rows that follow the solutions of a problem from one C to the next.
//!
//! Most multipliers of a small C are at their bounds, and stay there at the next: their part of the sums grows with C. Only
//! rows whose coefficients do not grow with C are added.

use std::ops::Range;

use ndarray::Array2;

use crate::recognition::scalar::Scalar;

/// The sums of each class's rows (n_classes × columns).
pub(crate) fn class_sums<'a, T: Scalar>(
    classes: impl ExactSizeIterator<Item = &'a Range<usize>>,
    rows: &Array2<T>,
) -> Array2<T> {
    let mut sums = Array2::zeros((classes.len(), rows.ncols()));
    for (range, mut sums) in classes.zip(sums.rows_mut()) {
        let to = sums.as_slice_mut().expect("a new array is contiguous");
        add_rows(
            to,
            range.clone().map(|at| (row(rows, at), T::one())).collect(),
        );
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
    /// Of all multipliers at C = 1.
    pub fn of_bounds(
        of_classes: &Array2<T>,
        (positive, negative): (usize, Option<usize>),
        is_positive: &[bool],
    ) -> Self {
        let sign = |is_positive: bool| if is_positive { 1.0 } else { -1.0 };
        let mut values = vec![T::zero(); of_classes.ncols()];
        let takes_part = |class: &usize| {
            *class == positive || negative.is_none_or(|negative| *class == negative)
        };
        let classes = (0..of_classes.nrows()).filter(takes_part);
        let weigh = |class: usize| (row(of_classes, class), T::of(sign(class == positive)));
        add_rows(&mut values, classes.map(weigh).collect());
        Self {
            values,
            beta: is_positive.iter().map(|&own| sign(own)).collect(),
            c: 1.0,
        }
    }

    /// The sums, one a column.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Goes on to the coefficients of another C, and adds up what differs from the last ones in proportion to C: those at
    /// their bounds do not. Or starts again, if that is less.
    pub fn follow(&mut self, rows: &Array2<T>, places: &[usize], (beta, c): (&[f64], f64)) {
        let ratio = c / self.c;
        let rest = |(&beta, &last): (&f64, &f64)| {
            let stays = beta.abs() == c && last.abs() == self.c;
            if stays { 0.0 } else { beta - ratio * last }
        };
        let rest: Vec<f64> = beta.iter().zip(&self.beta).map(rest).collect();
        let n = |beta: &[f64]| beta.iter().filter(|beta| **beta != 0.0).count();
        let (start, change) = if n(&rest) < n(beta) {
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
        let weigh = |(&at, &beta): (&usize, &f64)| (row(rows, at), T::of(beta));
        add_rows(&mut self.values, change.map(weigh).collect());
        self.beta.copy_from_slice(beta);
        self.c = c;
    }
}

fn row<T>(rows: &Array2<T>, at: usize) -> &[T] {
    let row = rows.row(at).to_slice();
    row.expect("rows were gathered one by one")
}

/// Adds rows times their weights.
fn add_rows<T: Scalar>(sums: &mut [T], mut rows: Vec<(&[T], T)>) {
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
        let of_classes = class_sums([0..4, 4..6, 6..9].iter(), &rows);
        let pair: Vec<usize> = (0..4).chain(6..9).collect();
        for (problem, places) in [((0, Some(2)), pair), ((1, None), (0..9).collect())] {
            let own = |at: &usize| {
                if problem.0 == 0 {
                    *at < 4
                } else {
                    (4..6).contains(at)
                }
            };
            let is_positive: Vec<bool> = places.iter().map(own).collect();
            let mut sums = Sums::of_bounds(&of_classes, problem, &is_positive);
            // All at C, all but one, two free, then free alone, and back.
            for (c, free, is_bound) in [
                (0.5_f64, 9, true),
                (2.0, 3, true),
                (8.0, 2, true),
                (9.0, 2, false),
                (1.0, 4, true),
            ] {
                let beta = |(number, &own): (usize, &bool)| {
                    let bound = if is_bound { c } else { 0.0 };
                    let size = if number % free == 1 {
                        0.3 * c.sqrt()
                    } else {
                        bound
                    };
                    if own { size } else { -size }
                };
                let beta: Vec<f64> = is_positive.iter().enumerate().map(beta).collect();
                sums.follow(&rows, &places, (&beta, c));
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
