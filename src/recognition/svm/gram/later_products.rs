//! Products of some rows with those of all later classes.
//!
//! [`ClassProducts`] has them as columns, scattered over the rows of these classes. Rows that are in doubt with one kernel are
//! mostly so with the next; products depend on no kernel, so those of a row are brought together once.

use std::ops::Range;

use crate::recognition::svm::gram::class_products::ClassProducts;
use crate::recognition::svm::linalg::scalar::Scalar;
use crate::recognition::svm::linalg::transposed::write_some_columns;

/// Products of rows with those of all later classes, kept from when they are first asked for.
pub(crate) struct LaterProducts<'a, T> {
    products: &'a ClassProducts<T>,
    /// Of rows that were gathered at once, row by row.
    values: Vec<Vec<T>>,
    /// Which of these a row's are in, and where.
    places: Vec<Option<(usize, Range<usize>)>>,
}

impl<'a, T: Scalar> LaterProducts<'a, T> {
    /// None yet.
    pub fn new(products: &'a ClassProducts<T>) -> Self {
        let n_rows = products.ranges().last().map_or(0, |range| range.end);
        Self {
            products,
            values: Vec::new(),
            places: vec![None; n_rows],
        }
    }

    /// Gathers those of rows of a class, of which some may be here already.
    pub fn gather(&mut self, class: usize, rows: impl Iterator<Item = usize>) {
        let ranges = self.products.ranges();
        let own = &ranges[class];
        let n_later = self.places.len() - own.end;
        let mut columns = Vec::new();
        for row in rows {
            if self.places[row].is_none() {
                let start = columns.len() * n_later;
                self.places[row] = Some((self.values.len(), start..start + n_later));
                columns.push(row - own.start);
            }
        }
        if columns.is_empty() {
            return;
        }
        let later = (class + 1..ranges.len())
            .flat_map(|class| ranges[class].clone().map(move |row| (class, row)));
        let later = later.map(|(class, row)| &self.products.of_row(class, row)[own.clone()]);
        let later: Vec<&[T]> = later.collect();
        let mut values = vec![T::zero(); columns.len() * n_later];
        write_some_columns(&later, &columns, &mut values, n_later);
        self.values.push(values);
    }

    /// Those of a row that was gathered.
    pub fn of_row(&self, row: usize) -> &[T] {
        let (number, place) = self.places[row].as_ref().expect("the row was gathered");
        &self.values[*number][place.clone()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::svm::gram::points::Points;
    use ndarray::{Array1, Array2};

    #[test]
    fn a_row_has_its_products_with_all_later_classes_however_often_it_is_gathered() {
        let rows = Array2::from_shape_fn((60, 4), |(i, j)| ((i * 4 + j) as f64 * 1.7).sin());
        let points = Points::<f64>::new(rows.view(), Array1::zeros(4).view());
        let ranges = [0..9, 9..10, 10..41, 41..60];
        let products = ClassProducts::new(points.all(), &ranges);
        let expected = rows.dot(&rows.t());
        let mut later = LaterProducts::new(&products);
        for (class, range) in ranges.iter().enumerate() {
            for step in [3, 2, 3] {
                let some = || range.clone().step_by(step);
                later.gather(class, some());
                for row in some() {
                    let found = later.of_row(row);
                    assert_eq!(found.len(), 60 - range.end);
                    for (number, found) in found.iter().enumerate() {
                        let difference = found - expected[[row, range.end + number]];
                        assert!(difference.abs() < 1e-14, "{row} {number}");
                    }
                }
            }
        }
    }
}
