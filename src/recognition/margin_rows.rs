//! Rows of two classes, and which of them are nearest to the margin.

use crate::recognition::scalar::Scalar;

/// Products looked at side by side.
const LANES: usize = 32;

/// y of a pair's first class and of its second.
pub(crate) const SIGNS: [f64; 2] = [1.0, -1.0];

/// Rows of a pair's first class and of its second, by their number within the class.
pub(crate) type Sides = [Vec<usize>; 2];

/// A row by its class, the first or the second, and its number within the class.
pub(crate) type RowOfPair = (usize, usize);

/// Rows of pairs by how far they are beyond something; in turn for all pairs, so that memory is asked for once.
pub(crate) type Ranked = Vec<(f64, RowOfPair)>;

/// The n rows of either class that are nearest to the other when `w·x` of all rows of both are these.
pub(crate) fn nearest<T: Scalar>(products: [&[T]; 2], n: usize, ranked: &mut Ranked) -> Sides {
    [0, 1].map(|side| {
        let products = products[side].iter().enumerate();
        ranked.clear();
        ranked.extend(products.map(|(row, product)| (SIGNS[side] * product.wide(), (side, row))));
        let nearest = smallest(ranked, n).iter();
        nearest.map(|&(_, (_, row))| row).collect()
    })
}

/// The n smallest values, in no order, and what they belong to; of equal values the first.
pub(crate) fn smallest<K: Ord + Copy>(values: &mut [(f64, K)], n: usize) -> &[(f64, K)] {
    if n >= values.len() {
        return values;
    }
    values.select_nth_unstable_by(n, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    &values[..n]
}

/// Makes `places` those of the products that, times a sign, are below a bound. A piece at a time: most have none.
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
