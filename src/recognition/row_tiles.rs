//! Products of a few f32 rows with a few others where they lie, each row read once for all of a tile's products.
//!
//! Written with the processor's vector instructions: the compiler makes them of plain loops over a tile's sums, too, but not
//! in every build, and a build where it does not is ten times slower.

use crate::recognition::row_products::Rows;

/// Products of some rows with others, by number, row by row into `products`; `false`, and nothing written, where the
/// processor has not got the instructions.
#[cfg(target_arch = "x86_64")]
#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
pub(crate) fn products_in_place(
    all: Rows<f32>,
    rows: &[usize],
    others: &[usize],
    products: &mut [f32],
) -> bool {
    multiversion::target::match_target! {
        "x86_64+avx2+fma" => {
            avx2::products(all, rows, others, products);
            true
        }
        _ => {
            let _ = (all, rows, others, products);
            false
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn products_in_place(_: Rows<f32>, _: &[usize], _: &[usize], _: &mut [f32]) -> bool {
    false
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{
        __m256, _mm_add_ps, _mm_add_ss, _mm_cvtss_f32, _mm_movehl_ps, _mm_shuffle_ps,
        _mm256_castps256_ps128, _mm256_extractf128_ps, _mm256_fmadd_ps, _mm256_setr_ps,
        _mm256_setzero_ps,
    };

    use crate::recognition::row_products::Rows;

    /// Values in a vector register.
    const LANES: usize = 8;
    /// Rows multiplied with [`M`] others at once: their sums and what is read of the rows fill 16 vector registers.
    const N: usize = 4;
    /// See [`N`].
    const M: usize = 3;

    #[target_feature(enable = "avx2,fma")]
    pub fn products(all: Rows<f32>, rows: &[usize], others: &[usize], products: &mut [f32]) {
        // What the last few lack is made up by their last row.
        let row = |of: &[usize], at: usize| all.row(of[at.min(of.len() - 1)]);
        for i in (0..rows.len()).step_by(N) {
            let left = [i, i + 1, i + 2, i + 3].map(|at| row(rows, at));
            for j in (0..others.len()).step_by(M) {
                let right = [j, j + 1, j + 2].map(|at| row(others, at));
                let tile = tile(left, right);
                for (at, tile) in tile.iter().enumerate().take(rows.len() - i) {
                    let to = &mut products[(i + at) * others.len()..][..others.len()];
                    to[j..]
                        .iter_mut()
                        .zip(tile)
                        .for_each(|(to, &product)| *to = product);
                }
            }
        }
    }

    /// All products of a few rows with a few others. Each lane keeps its own sums; they meet at the end.
    ///
    /// Loops, not closures: a function of the standard library that calls a closure has not got its vector instructions.
    #[target_feature(enable = "avx2,fma")]
    fn tile(left: [&[f32]; N], right: [&[f32]; M]) -> [[f32; M]; N] {
        let n = left[0].len();
        let mut left_lanes: [&[[f32; LANES]]; N] = [&[]; N];
        let mut right_lanes: [&[[f32; LANES]]; M] = [&[]; M];
        for i in 0..N {
            left_lanes[i] = left[i][..n].as_chunks().0;
        }
        for j in 0..M {
            right_lanes[j] = right[j][..n].as_chunks().0;
        }
        let n_lanes = n / LANES;
        let mut sums = [[_mm256_setzero_ps(); M]; N];
        for at in 0..n_lanes {
            let mut own = [_mm256_setzero_ps(); M];
            for j in 0..M {
                own[j] = load(&right_lanes[j][at]);
            }
            for i in 0..N {
                let other = load(&left_lanes[i][at]);
                for j in 0..M {
                    sums[i][j] = _mm256_fmadd_ps(other, own[j], sums[i][j]);
                }
            }
        }
        let mut products = [[0.0; M]; N];
        for i in 0..N {
            for j in 0..M {
                products[i][j] = sum(sums[i][j]);
                for at in n_lanes * LANES..n {
                    products[i][j] += left[i][at] * right[j][at];
                }
            }
        }
        products
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn load(lanes: &[f32; LANES]) -> __m256 {
        let [a, b, c, d, e, f, g, h] = *lanes;
        _mm256_setr_ps(a, b, c, d, e, f, g, h)
    }

    /// The sum of all lanes, halves onto halves.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn sum(lanes: __m256) -> f32 {
        let four = _mm_add_ps(
            _mm256_castps256_ps128(lanes),
            _mm256_extractf128_ps(lanes, 1),
        );
        let two = _mm_add_ps(four, _mm_movehl_ps(four, four));
        _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps(two, two, 1)))
    }
}
