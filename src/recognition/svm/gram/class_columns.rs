//! Kernel values of a row with all others, class by class, so that those of a class are whole registers.

use std::ops::Range;

use crate::recognition::svm::Multiclass;
use crate::recognition::svm::linalg::scalar::Scalar;

/// Values added up side by side: two vector registers of sixteen f32.
const LANES: usize = 32;

/// Where the rows of each class are, and where their values are when each class has whole registers.
pub(crate) struct ClassColumns {
    ranges: Vec<Range<usize>>,
    starts: Vec<usize>,
}

impl ClassColumns {
    /// Of classes that follow each other.
    pub fn new(ranges: &[Range<usize>]) -> Self {
        let mut starts = vec![0];
        for range in ranges {
            starts.push(starts[starts.len() - 1] + range.len().next_multiple_of(LANES));
        }
        Self {
            ranges: ranges.to_vec(),
            starts,
        }
    }

    /// The rows of each class.
    pub fn ranges(&self) -> &[Range<usize>] {
        &self.ranges
    }

    /// Values that one solution of each problem takes.
    pub fn n_values(&self, multiclass: Multiclass) -> usize {
        let n_classes = self.ranges.len();
        let n_problems_a_class = match multiclass {
            Multiclass::OneVsOne => n_classes - 1,
            _ => n_classes,
        };
        n_problems_a_class * self.starts[n_classes]
    }

    /// The values of a class among all.
    #[inline(always)]
    pub fn of_class<'v, T>(&self, class: usize, values: &'v [T]) -> &'v [T] {
        &values[self.starts[class]..self.starts[class + 1]]
    }

    /// Values of all rows, with zeros between classes.
    pub fn spread<T: Scalar>(&self, values: &[T], to: &mut Vec<T>) {
        to.clear();
        for (range, &end) in self.ranges.iter().zip(&self.starts[1..]) {
            to.extend_from_slice(&values[range.clone()]);
            to.resize(end, T::zero());
        }
    }

    /// Appends values of the rows of some classes, one class after the other, with zeros between.
    pub fn spread_some<T: Scalar>(&self, classes: &[usize], values: &[f64], to: &mut Vec<T>) {
        let mut values = values;
        for &class in classes {
            let (own, later) = values.split_at(self.ranges[class].len());
            let end = to.len() + self.starts[class + 1] - self.starts[class];
            to.extend(own.iter().map(|&value| T::of(value)));
            to.resize(end, T::zero());
            values = later;
        }
    }
}

/// Sums of products of whole registers, lane by lane.
pub(crate) struct Products<T>([T; LANES]);

impl<T: Scalar> Products<T> {
    #[inline(always)]
    pub fn new() -> Self {
        Self([T::zero(); LANES])
    }

    /// Adds `Σ a b`.
    #[inline(always)]
    pub fn add(&mut self, a: &[T], b: &[T]) {
        let (a, b) = (a.as_chunks::<LANES>().0, b.as_chunks::<LANES>().0);
        let n = a.len().min(b.len());
        for at in 0..n {
            for lane in 0..LANES {
                self.0[lane] += a[at][lane] * b[at][lane];
            }
        }
    }

    /// The sum of all lanes, halves onto halves.
    #[inline(always)]
    pub fn sum(mut self) -> T {
        let mut width = LANES / 2;
        while width > 0 {
            for lane in 0..width {
                self.0[lane] += self.0[lane + width];
            }
            width /= 2;
        }
        self.0[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_spread_values_are_those_of_the_rows() {
        let columns = ClassColumns::new(&[0..40, 40..41, 41..105]);
        let values: Vec<f64> = (0..105).map(|i| (i as f64 * 1.7).sin()).collect();
        let weights: Vec<f64> = (0..105).map(|i| (i as f64 * 0.9).cos()).collect();
        let mut spread = Vec::new();
        columns.spread(&values, &mut spread);
        for classes in [&[0, 2][..], &[1], &[0, 1, 2]] {
            let rows = classes
                .iter()
                .flat_map(|&class| columns.ranges()[class].clone());
            let rows: Vec<usize> = rows.collect();
            let own: Vec<f64> = rows.iter().map(|&row| weights[row]).collect();
            let mut some: Vec<f64> = Vec::new();
            columns.spread_some(classes, &own, &mut some);
            let mut rest = &some[..];
            let mut found = Products::new();
            for &class in classes {
                let values = columns.of_class(class, &spread);
                found.add(values, &rest[..values.len()]);
                rest = &rest[values.len()..];
            }
            assert!(rest.is_empty());
            let expected: f64 = rows.iter().map(|&row| weights[row] * values[row]).sum();
            let found = found.sum();
            assert!((found - expected).abs() < 1e-12, "{classes:?}");
        }
    }
}
