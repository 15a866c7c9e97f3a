//! Selection of the rows of two classes that are nearest to the margin.

use crate::linalg::scalar::Scalar;

/// Number of inner products processed in parallel.
const LANES: usize = 32;

/// Labels of rows in the problem of a pair of classes: 1 for the first class, −1 for the second class.
pub(crate) const SIGNS: [f64; 2] = [1.0, -1.0];

/// Row numbers within the first and the second class of a pair.
pub(crate) type Sides = [Vec<usize>; 2];

/// Row of a pair of classes, given by its class (0 or 1) and its number within the class.
pub(crate) type RowOfPair = (usize, usize);

/// Row of a pair of classes, ordered by a distance and then by its position. Distance and position are packed into one number, because ranked rows are compared
/// more often than read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct RankedRow(u128);

impl RankedRow {
    /// Creates a ranked row with the given distance.
    pub fn new(beyond: f64, (side, row): RowOfPair) -> Self {
        // The bits have the order of the numbers: the bits of negative numbers are inverted, and positive numbers follow.
        let bits = beyond.to_bits();
        let turned = match bits >> 63 {
            0 => bits | 1 << 63,
            _ => !bits,
        };
        Self(u128::from(turned) << 64 | (side as u128) << 63 | row as u128)
    }

    /// Returns the class (0 or 1) of a row and its number within the class.
    pub fn place(self) -> RowOfPair {
        let place = self.0 as u64;
        ((place >> 63) as usize, (place & (u64::MAX >> 1)) as usize)
    }
}

/// Reusable list of rows that are ordered by a distance, shared by all pairs of classes.
pub(crate) type Ranked = Vec<RankedRow>;

/// Returns the n rows of each class that are nearest to the other class, given the inner products of all rows with the hyperplane normal.
pub(crate) fn nearest<T: Scalar>(products: [&[T]; 2], n: usize, ranked: &mut Ranked) -> Sides {
    [0, 1].map(|side| {
        let products = products[side].iter().enumerate();
        ranked.clear();
        ranked.extend(
            products
                .map(|(row, product)| RankedRow::new(SIGNS[side] * product.wide(), (side, row))),
        );
        let nearest = smallest(ranked, n).iter();
        nearest.map(|row| row.place().1).collect()
    })
}

/// Returns the n rows with the smallest distances, in any order.
pub(crate) fn smallest(rows: &mut [RankedRow], n: usize) -> &[RankedRow] {
    if n < rows.len() {
        rows.select_nth_unstable(n);
        return &rows[..n];
    }
    rows
}

/// Writes the positions of all products that are below `bound` after multiplication by `sign` into `places`. Whole chunks are tested first, because most chunks
/// contain no such product.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn find_below<T: Scalar>(products: &[T], sign: T, bound: T, places: &mut Vec<usize>) {
    places.clear();
    for start in (0..products.len()).step_by(LANES) {
        let piece = &products[start..products.len().min(start + LANES)];
        let mut is_any = false;
        for &product in piece {
            is_any |= sign * product < bound;
        }
        if is_any {
            for (at, &product) in piece.iter().enumerate() {
                if sign * product < bound {
                    places.push(start + at);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_ordered_by_what_they_are_beyond_then_by_their_place() {
        let beyond = [-f64::INFINITY, -2.0, -1e-300, -0.0, 0.0, 1e-300, 0.5, 7.0];
        let places = [(0, 0), (0, 5), (1, 0), (1, u32::MAX as usize)];
        let all = beyond.map(|beyond| places.map(|place| (beyond, place)));
        let all = all.as_flattened();
        let ranked: Vec<RankedRow> = all.iter().map(|&(by, at)| RankedRow::new(by, at)).collect();
        assert!(ranked.is_sorted());
        assert!(
            ranked
                .iter()
                .zip(all)
                .all(|(row, own)| row.place() == own.1)
        );
    }

    #[test]
    fn the_nearest_rows_are_those_of_a_sort() {
        let products: Vec<f64> = (0..50).map(|i| (f64::from(i) * 2.3).sin()).collect();
        let [mut near, mut other] = nearest([&products, &products], 7, &mut Ranked::new());
        let mut order: Vec<usize> = (0..50).collect();
        order.sort_by(|&a, &b| products[a].total_cmp(&products[b]));
        near.sort_unstable();
        other.sort_unstable();
        let [mut least, mut most] = [order[..7].to_vec(), order[43..].to_vec()];
        least.sort_unstable();
        most.sort_unstable();
        assert_eq!([near, other], [least, most]);
    }
}
