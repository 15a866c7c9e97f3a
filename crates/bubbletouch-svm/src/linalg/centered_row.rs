//! Row of features minus a centre.

use crate::linalg::scalar::Scalar;

/// Number of values processed in parallel.
const LANES: usize = 8;

/// Squared norm and projection of a row x after the centre c is subtracted.
pub(crate) struct CenteredRow {
    /// Squared norm `|x − c|²` of the row x minus the centre c.
    pub norm: f64,
    /// Projection `(x − c)·c` of the row x minus the centre c onto c. Far from the origin, the equivalent `x·c − c·c` would lose most digits.
    pub along_centre: f64,
}

/// Writes a row minus the centre into `to`; returns its squared norm and its projection onto the centre. The function works on slices, because the compiler
/// does not always vectorise ndarray views.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn center_row<T: Scalar>(to: &mut [T], row: &[f64], centre: &[f64]) -> CenteredRow {
    let (to, last_to) = to.as_chunks_mut::<LANES>();
    let (row, last_row) = row.as_chunks::<LANES>();
    let (centre, last_centre) = centre.as_chunks::<LANES>();
    let n = to.len();
    let (row, centre) = (&row[..n], &centre[..n]);
    // Each lane has its own sum; the lanes are added at the end.
    let (mut squares, mut products) = ([0.0; LANES], [0.0; LANES]);
    for at in 0..n {
        for lane in 0..LANES {
            let moved = row[at][lane] - centre[at][lane];
            to[at][lane] = T::from_f64(moved);
            squares[lane] += moved * moved;
            products[lane] += moved * centre[at][lane];
        }
    }
    let (mut norm, mut along_centre) = (0.0, 0.0);
    for lane in 0..LANES {
        norm += squares[lane];
        along_centre += products[lane];
    }
    for at in 0..last_to.len() {
        let moved = last_row[at] - last_centre[at];
        last_to[at] = T::from_f64(moved);
        norm += moved * moved;
        along_centre += moved * last_centre[at];
    }
    CenteredRow { norm, along_centre }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moved_row_and_what_is_told_of_it_are_those_of_a_plain_loop() {
        for n in [0, 1, 7, 8, 21] {
            let row: Vec<f64> = (0..n).map(|i| (f64::from(i) * 1.7).sin()).collect();
            let centre: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.3).cos()).collect();
            let mut to = vec![f64::NAN; row.len()];
            let told = center_row(&mut to, &row, &centre);
            let expected: Vec<f64> = row.iter().zip(&centre).map(|(x, c)| x - c).collect();
            assert_eq!(to, expected);
            let norm: f64 = expected.iter().map(|x| x * x).sum();
            let along: f64 = expected.iter().zip(&centre).map(|(x, c)| x * c).sum();
            assert!((told.norm - norm).abs() < 1e-13 && (told.along_centre - along).abs() < 1e-13);
        }
    }
}
