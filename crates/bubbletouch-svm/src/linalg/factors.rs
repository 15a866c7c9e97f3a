//! Factors `L D Lᵀ` of a symmetric matrix, stored as rows of `D Lᵀ`: factorisation, solution of linear systems, and rank-one updates.
//!
//! Each row is stored in blocks of [`LANES`] values; entries up to and including the diagonal are 0. The inverse of D is stored separately, with 0 for unused
//! rows.

/// Number of values that are processed in parallel: four vector registers, so that additions do not wait for each other.
pub(crate) const LANES: usize = 32;
/// Number of unknowns of a triangular system that are solved as one block.
const BLOCK: usize = 8;
/// Minimum diagonal entry of a linearly independent row, as a multiple of the ridge (constant added to the diagonal). After elimination, the diagonal entry of
/// a linearly dependent row is about the ridge; the entry of a nearly dependent row is slightly larger.
const INDEPENDENT_FROM: f64 = 10.0;

/// Block of 32 consecutive values of a matrix row.
pub(crate) type Lanes = [f64; LANES];

/// Factorises a symmetric matrix plus `ridge` on its diagonal as `L D Lᵀ`, given the upper triangle. The rows become `D Lᵀ`; `inverse` becomes 1/D.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn eliminate(rows: &mut [Lanes], width: usize, inverse: &mut [f64], ridge: f64) {
    let n = inverse.len();
    let n_pieces = n.div_ceil(LANES);
    let mut factors = vec![0.0; n];
    for i in 0..n {
        let (piece, lane) = (i / LANES, i % LANES);
        for j in 0..i {
            factors[j] = rows[j * width + piece][lane] * inverse[j];
        }
        for at in piece..n_pieces {
            let mut own = rows[i * width + at];
            for j in 0..i {
                let above = &rows[j * width + at];
                for lane in 0..LANES {
                    own[lane] -= factors[j] * above[lane];
                }
            }
            rows[i * width + at] = own;
        }
        let pivot = rows[i * width + piece][lane];
        let is_independent = pivot > INDEPENDENT_FROM * ridge;
        inverse[i] = if is_independent {
            1.0 / (pivot + ridge)
        } else {
            0.0
        };
        rows[i * width + piece][..=lane].fill(0.0);
    }
}

/// Solves the triangular system `L v = side` in place for N right-hand sides, block by block in ascending order.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn substitute<const N: usize>(
    rows: &[Lanes],
    width: usize,
    inverse: &[f64],
    sides: &mut [[Lanes; N]],
) {
    let n = inverse.len();
    let mut factors = vec![[0.0; N]; n];
    for piece in 0..n.div_ceil(LANES) {
        let mut own = sides[piece];
        let start = piece * LANES;
        for (row, factors) in rows.chunks_exact(width).zip(&factors[..start]) {
            take_product(&mut own, factors, &row[piece]);
        }
        for at in start..n.min(start + LANES) {
            for side in 0..N {
                factors[at][side] = own[side][at - start] * inverse[at];
            }
            take_product(&mut own, &factors[at], &rows[at * width + piece]);
        }
        sides[piece] = own;
    }
}

/// Multiplies a block of a matrix row by one factor per right-hand side, and subtracts the products from the N right-hand sides.
#[inline(always)]
fn take_product<const N: usize>(own: &mut [Lanes; N], factors: &[f64; N], row: &Lanes) {
    for side in 0..N {
        for lane in 0..LANES {
            own[side][lane] -= factors[side] * row[lane];
        }
    }
}

/// Solves the triangular system `D Lᵀ x = side` in place, block by block from the last to the first.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn substitute_back(rows: &[Lanes], width: usize, inverse: &[f64], side: &mut [f64]) {
    let n_blocks = inverse.len().div_ceil(BLOCK);
    let (blocks, _) = side.as_chunks_mut::<BLOCK>();
    for block in (0..n_blocks).rev() {
        let (before, after) = blocks[..n_blocks].split_at_mut(block + 1);
        let own = &mut before[block];
        let start = block * BLOCK;
        let places = start..inverse.len().min(start + BLOCK);
        let row = |at: usize| rows[at * width..][..width].as_flattened();
        for at in places.clone() {
            let (row, _) = row(at)[start + BLOCK..].as_chunks::<BLOCK>();
            let mut sums = [0.0; BLOCK];
            for (row, known) in row.iter().zip(&*after) {
                for lane in 0..BLOCK {
                    sums[lane] += row[lane] * known[lane];
                }
            }
            own[at - start] -= sums.iter().sum::<f64>();
        }
        for at in places.rev() {
            let row = &row(at)[start..][..BLOCK];
            let mut value = own[at - start];
            for later in at - start + 1..BLOCK {
                value -= row[later] * own[later];
            }
            own[at - start] = value * inverse[at];
        }
    }
}

/// Adds the rank-one matrix `weight · own ownᵀ` to a factorised matrix. The first of the given rows has the position `first`; `own` is overwritten.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn add_product(
    rows: &mut [Lanes],
    own: &mut [Lanes],
    (first, mut weight): (usize, f64),
    inverse: &mut [f64],
) {
    let (n, width) = (inverse.len(), own.len());
    let n_pieces = n.div_ceil(LANES);
    let own = &mut own[..n_pieces];
    for i in first..n {
        let (piece, lane) = (i / LANES, i % LANES);
        let value = std::mem::take(&mut own[piece][lane]);
        if inverse[i] == 0.0 || value == 0.0 {
            continue;
        }
        let row = &mut rows[(i - first) * width..][..n_pieces];
        let (to_row, to_own) = (weight * value, value * inverse[i]);
        for at in piece..n_pieces {
            for lane in 0..LANES {
                let before = row[at][lane];
                row[at][lane] = before + to_row * own[at][lane];
                own[at][lane] -= to_own * before;
            }
        }
        let pivot = 1.0 / inverse[i];
        let changed = pivot + to_row * value;
        weight *= pivot / changed;
        inverse[i] = 1.0 / changed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 75;
    const WIDTH: usize = 3;
    const RIDGE: f64 = 1e-3;

    /// Returns an irregular diagonally dominant symmetric matrix, with the ridge added to the diagonal.
    fn matrix() -> Vec<[f64; N]> {
        let value = |i: usize, j: usize| (((i.min(j) * N + i.max(j)) as f64).sin() * 1e4).fract();
        let entry = |i: usize, j: usize| if i == j { 40.0 + RIDGE } else { value(i, j) };
        let row = |i: usize| std::array::from_fn(|j| entry(i, j));
        (0..N).map(row).collect()
    }

    fn factors() -> (Vec<Lanes>, Vec<f64>) {
        let mut rows = vec![[0.0; LANES]; N * WIDTH];
        for (i, values) in matrix().iter().enumerate() {
            let row = rows[i * WIDTH..][..WIDTH].as_flattened_mut();
            row[i..N].copy_from_slice(&values[i..]);
            row[i] -= RIDGE;
        }
        let mut inverse = vec![0.0; N];
        eliminate(&mut rows, WIDTH, &mut inverse, RIDGE);
        (rows, inverse)
    }

    fn side(number: usize) -> Vec<Lanes> {
        let mut side = vec![[0.0; LANES]; WIDTH];
        let values = side.as_flattened_mut()[..N].iter_mut().enumerate();
        values.for_each(|(i, value)| *value = ((i + 31 * number) as f64 * 0.7).cos());
        side
    }

    /// Asserts that the solution computed from the factors satisfies the linear equations of the matrix.
    fn assert_solves((rows, inverse): &(Vec<Lanes>, Vec<f64>), matrix: &[[f64; N]]) {
        let both = |(a, b): (Lanes, Lanes)| [a, b];
        let mut sides: Vec<[Lanes; 2]> = side(0).into_iter().zip(side(1)).map(both).collect();
        substitute(rows, WIDTH, inverse, &mut sides);
        for number in 0..2 {
            let mut x: Vec<Lanes> = sides.iter().map(|side| side[number]).collect();
            substitute_back(rows, WIDTH, inverse, x.as_flattened_mut());
            let expected = side(number);
            for (i, row) in matrix.iter().enumerate() {
                let products = row.iter().zip(x.as_flattened()).map(|(a, x)| a * x);
                let left = products.sum::<f64>() - expected.as_flattened()[i];
                assert!(left.abs() < 1e-12, "{i}: {left}");
            }
        }
    }

    #[test]
    fn what_is_solved_for_times_the_matrix_is_the_side() {
        assert_solves(&factors(), &matrix());
    }

    #[test]
    fn a_product_that_is_added_is_in_the_factors() {
        let (mut rows, mut inverse) = factors();
        let mut changed = matrix();
        // Only the positions from 40 on are non-zero.
        let mut own = side(2);
        own.as_flattened_mut()[..40].fill(0.0);
        for (i, row) in changed.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value += 2.5 * own.as_flattened()[i] * own.as_flattened()[j];
            }
        }
        add_product(&mut rows[40 * WIDTH..], &mut own, (40, 2.5), &mut inverse);
        assert_solves(&(rows, inverse), &changed);
    }

    #[test]
    fn a_row_that_depends_on_one_before_takes_no_part() {
        let mut rows = vec![[0.0; LANES]; 2];
        (rows[0][0], rows[0][1], rows[1][1]) = (2.0, 4.0, 8.0);
        let mut inverse = vec![0.0; 2];
        eliminate(&mut rows, 1, &mut inverse, 1e-6);
        assert_eq!(inverse[1], 0.0);
        assert!((inverse[0] - 0.5).abs() < 1e-6);
    }
}
