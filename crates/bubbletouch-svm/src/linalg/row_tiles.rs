//! Inner products of a few f32 rows with a few other rows; each row is read once for all products of a tile.
//!
//! The code uses the processor's vector instructions explicitly. The compiler can generate them from plain loops, but not in every build; a build without them
//! is ten times slower.

/// Writes the inner products of rows with other rows of equal length into `products`, row by row. If the processor lacks the required vector instructions,
/// returns `false` and writes nothing.
#[cfg(target_arch = "x86_64")]
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn products_in_place(rows: &[&[f32]], others: &[&[f32]], products: &mut [f32]) -> bool {
    multiversion::target::match_target! {
        "x86_64+avx512f" => {
            avx512::products(rows, others, products);
            true
        }
        "x86_64+avx2+fma" => {
            avx2::products(rows, others, products);
            true
        }
        _ => {
            let _ = (rows, others, products);
            false
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn products_in_place(_: &[&[f32]], _: &[&[f32]], _: &mut [f32]) -> bool {
    false
}

/// Number of features that are processed together, so that the rows of a tile fit into the first-level cache.
#[cfg(target_arch = "x86_64")]
const DEPTH: usize = 1024;

/// Computes the inner products of every row in `rows` with every row in `others` by the function `tile`, N × M products at a time. An incomplete tile is filled
/// with copies of its last row. The code uses loops instead of iterators, because closures passed to the standard library are not always inlined.
#[cfg(target_arch = "x86_64")]
fn by_tiles<'r, const N: usize, const M: usize>(
    (rows, others): (&[&'r [f32]], &[&'r [f32]]),
    products: &mut [f32],
    tile: impl Fn([&'r [f32]; N], [&'r [f32]; M]) -> [[f32; M]; N],
) {
    let n_features = rows.first().map_or(0, |row| row.len());
    if n_features == 0 {
        products.fill(0.0);
    }
    for start in (0..n_features).step_by(DEPTH) {
        let end = n_features.min(start + DEPTH);
        for i in (0..rows.len()).step_by(N) {
            let mut left: [&[f32]; N] = [&[]; N];
            for at in 0..N {
                left[at] = &rows[(i + at).min(rows.len() - 1)][start..end];
            }
            for j in (0..others.len()).step_by(M) {
                let mut right: [&[f32]; M] = [&[]; M];
                for at in 0..M {
                    right[at] = &others[(j + at).min(others.len() - 1)][start..end];
                }
                let tile = tile(left, right);
                let width = M.min(others.len() - j);
                for at in 0..N.min(rows.len() - i) {
                    let to = &mut products[(i + at) * others.len() + j..][..width];
                    match to.first_chunk_mut::<M>() {
                        Some(to) if start == 0 => *to = tile[at],
                        _ => put(to, &tile[at], start == 0),
                    }
                }
            }
        }
    }
}

/// Writes the inner products of a tile to `to` for the first block of features; adds them for later blocks.
#[cfg(target_arch = "x86_64")]
fn put(to: &mut [f32], products: &[f32], is_first: bool) {
    for (to, product) in to.iter_mut().zip(products) {
        let before = if is_first { 0.0 } else { *to };
        *to = before + product;
    }
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use std::arch::x86_64::{
        __m512, _mm512_add_ps, _mm512_castpd_ps, _mm512_castps_pd, _mm512_fmadd_ps,
        _mm512_setzero_ps, _mm512_shuffle_f32x4, _mm512_unpackhi_pd, _mm512_unpackhi_ps,
        _mm512_unpacklo_pd, _mm512_unpacklo_ps,
    };

    use crate::linalg::vector_registers::{load, store};

    /// Number of f32 values in a vector register (AVX-512).
    const LANES: usize = 16;
    /// Number of rows of a tile, and number of other rows; one register combines the four sums of a row.
    const N: usize = 4;

    #[target_feature(enable = "avx512f")]
    pub fn products(rows: &[&[f32]], others: &[&[f32]], products: &mut [f32]) {
        match rows {
            [_] => super::by_tiles((rows, others), products, |left, right| [row(left, right)]),
            _ => super::by_tiles((rows, others), products, |left, right| tile(left, right)),
        }
    }

    /// Returns the inner products of one row with N other rows, bitwise equal to the results of [`tile`].
    #[target_feature(enable = "avx512f")]
    fn row([left]: [&[f32]; 1], right: [&[f32]; N]) -> [f32; N] {
        let n = left.len();
        let left_lanes: &[[f32; LANES]] = left.as_chunks().0;
        let mut right_lanes: [&[[f32; LANES]]; N] = [&[]; N];
        for j in 0..N {
            right_lanes[j] = right[j][..n].as_chunks().0;
        }
        let mut sums = [_mm512_setzero_ps(); N];
        for at in 0..left_lanes.len() {
            let mut own = sums;
            for j in 0..N {
                own[j] = load(&right_lanes[j][at]);
            }
            sums = add_products(sums, load(&left_lanes[at]), own);
        }
        let zero = _mm512_setzero_ps();
        let sums = store(add_parts(add_parts(add_lanes(sums), zero), zero));
        let mut products = [0.0; N];
        for j in 0..N {
            products[j] = sums[j];
            for at in left_lanes.len() * LANES..n {
                products[j] += left[at] * right[j][at];
            }
        }
        products
    }

    /// Returns the inner products of N rows with N other rows. Each lane of a vector register has its own sum; the lanes are added at the end.
    ///
    /// The sums of each row have separate variables, because the compiler would store an array of arrays in memory.
    #[target_feature(enable = "avx512f")]
    fn tile(left: [&[f32]; N], right: [&[f32]; N]) -> [[f32; N]; N] {
        let n = left[0].len();
        let mut left_lanes: [&[[f32; LANES]]; N] = [&[]; N];
        let mut right_lanes: [&[[f32; LANES]]; N] = [&[]; N];
        for i in 0..N {
            left_lanes[i] = left[i][..n].as_chunks().0;
            right_lanes[i] = right[i][..n].as_chunks().0;
        }
        let n_lanes = n / LANES;
        let zero = [_mm512_setzero_ps(); N];
        let (mut a, mut b, mut c, mut d) = (zero, zero, zero, zero);
        for at in 0..n_lanes {
            let mut own = zero;
            for j in 0..N {
                own[j] = load(&right_lanes[j][at]);
            }
            a = add_products(a, load(&left_lanes[0][at]), own);
            b = add_products(b, load(&left_lanes[1][at]), own);
            c = add_products(c, load(&left_lanes[2][at]), own);
            d = add_products(d, load(&left_lanes[3][at]), own);
        }
        let first = add_parts(add_lanes(a), add_lanes(b));
        let second = add_parts(add_lanes(c), add_lanes(d));
        let sums = store(add_parts(first, second));
        let mut products = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..N {
                products[i][j] = sums[i * N + j];
            }
        }
        if n_lanes * LANES < n {
            for i in 0..N {
                for j in 0..N {
                    for at in n_lanes * LANES..n {
                        products[i][j] += left[i][at] * right[j][at];
                    }
                }
            }
        }
        products
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn add_products(sums: [__m512; N], left: __m512, right: [__m512; N]) -> [__m512; N] {
        [
            _mm512_fmadd_ps(left, right[0], sums[0]),
            _mm512_fmadd_ps(left, right[1], sums[1]),
            _mm512_fmadd_ps(left, right[2], sums[2]),
            _mm512_fmadd_ps(left, right[3], sums[3]),
        ]
    }

    /// Adds the four neighbouring lanes of each group within each of four registers. Returns the sums in the order a₀ b₀ c₀ d₀ a₁ b₁ ….
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn add_lanes([a, b, c, d]: [__m512; N]) -> __m512 {
        let ab = _mm512_add_ps(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let cd = _mm512_add_ps(_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
        let (ab, cd) = (_mm512_castps_pd(ab), _mm512_castps_pd(cd));
        let low = _mm512_castpd_ps(_mm512_unpacklo_pd(ab, cd));
        let high = _mm512_castpd_ps(_mm512_unpackhi_pd(ab, cd));
        _mm512_add_ps(low, high)
    }

    /// Adds neighbouring quarters within each of two registers a and b: a₀ + a₁, a₂ + a₃, b₀ + b₁, b₂ + b₃.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn add_parts(a: __m512, b: __m512) -> __m512 {
        let even = _mm512_shuffle_f32x4(a, b, 0b10_00_10_00);
        let odd = _mm512_shuffle_f32x4(a, b, 0b11_01_11_01);
        _mm512_add_ps(even, odd)
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{
        __m256, _mm_add_ps, _mm_add_ss, _mm_cvtss_f32, _mm_movehl_ps, _mm_shuffle_ps,
        _mm256_castps256_ps128, _mm256_extractf128_ps, _mm256_fmadd_ps, _mm256_setr_ps,
        _mm256_setzero_ps,
    };

    /// Number of f32 values in a vector register (AVX2).
    const LANES: usize = 8;
    /// Number of rows of a tile, each multiplied with [`M`] other rows; the values fill 16 vector registers.
    const N: usize = 4;
    /// Number of rows of the second factor in a tile, chosen together with [`N`].
    const M: usize = 3;

    #[target_feature(enable = "avx2,fma")]
    pub fn products(rows: &[&[f32]], others: &[&[f32]], products: &mut [f32]) {
        match rows {
            [_] => super::by_tiles((rows, others), products, |left, right| {
                tile::<1>(left, right)
            }),
            _ => super::by_tiles((rows, others), products, |left, right| {
                tile::<N>(left, right)
            }),
        }
    }

    /// Returns the inner products of N rows with M other rows. Each lane of a vector register has its own sum; the lanes are added at the end.
    ///
    /// The code uses loops instead of closures, because closures called by the standard library are compiled without vector instructions.
    #[target_feature(enable = "avx2,fma")]
    fn tile<const N: usize>(left: [&[f32]; N], right: [&[f32]; M]) -> [[f32; M]; N] {
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

    /// Returns the sum of the eight lanes of a register, computed by repeated halving.
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
