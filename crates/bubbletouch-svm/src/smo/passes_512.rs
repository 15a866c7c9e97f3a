//! Passes of the solver over f32 variables, with vectors of sixteen values. The results equal the results of the generic passes, bit by bit.

use std::arch::x86_64::{
    __m512, __m512i, _CMP_EQ_OQ, _CMP_GT_OQ, _mm512_add_epi32, _mm512_add_ps, _mm512_cmp_ps_mask,
    _mm512_cvtsi512_si32, _mm512_mask_blend_epi32, _mm512_mask_reduce_min_epi32,
    _mm512_maskz_compress_epi32, _mm512_max_ps, _mm512_mul_ps, _mm512_reduce_max_ps,
    _mm512_set1_epi32, _mm512_set1_ps, _mm512_setr_epi32, _mm512_setzero_ps, _mm512_sub_ps,
};

use super::iterations::{Search, Stop, run_with};
use super::passes::Down;
use super::variables::Variables;
use crate::gram::matrix::Gram;
use crate::linalg::lanes::LANES;
use crate::linalg::vector_registers::{load, store};

/// Runs the pairwise steps of the solver with explicit vector instructions. The passes are closures, because function calls would take as long as a few of
/// their steps.
#[target_feature(enable = "avx512f")]
pub(crate) fn run(
    gram: &mut Gram<f32>,
    variables: &mut Variables<f32>,
    search: &mut Search,
    first_look: u64,
) -> Stop {
    // Equals the generic `select_down`.
    let select_down =
        |(f, low): (&[f32], &[f32]), inverses: &[f32], highest: f32, _: &mut [f32]| {
            let f = lanes(f);
            let n = f.len();
            let (low, inverses) = (&lanes(low)[..n], &lanes(inverses)[..n]);
            let highest = _mm512_set1_ps(highest);
            let mut best = Largest::at_least(0.0);
            let mut violation = _mm512_setzero_ps();
            for at in 0..n {
                let difference = _mm512_sub_ps(highest, load(&f[at]));
                let difference = _mm512_add_ps(difference, load(&low[at]));
                let difference = _mm512_max_ps(difference, _mm512_setzero_ps());
                let square = _mm512_mul_ps(difference, difference);
                best = best.or(_mm512_mul_ps(square, load(&inverses[at])));
                violation = _mm512_max_ps(difference, violation);
            }
            let (best, at) = best.of_all();
            Down {
                j: (best > 0.0).then_some(at),
                violation: _mm512_reduce_max_ps(violation),
            }
        };
    // Equals the generic `step_along`.
    let step_along = |f: &mut [f32], (row_i, row_j): (&[f32], &[f32]), step: f32, up: &[f32]| {
        let f = f.as_chunks_mut::<LANES>().0;
        let n = f.len();
        let (row_i, row_j) = (&lanes(row_i)[..n], &lanes(row_j)[..n]);
        let up = &lanes(up)[..n];
        let step = _mm512_set1_ps(step);
        let mut highest = Largest::at_least(f32::NEG_INFINITY);
        for at in 0..n {
            let difference = _mm512_sub_ps(load(&row_i[at]), load(&row_j[at]));
            let value = _mm512_sub_ps(load(&f[at]), _mm512_mul_ps(step, difference));
            f[at] = store(value);
            highest = highest.or(_mm512_add_ps(value, load(&up[at])));
        }
        let (highest, at) = highest.of_all();
        (highest > f32::NEG_INFINITY).then_some(at)
    };
    run_with(
        (gram, (select_down, step_along)),
        variables,
        search,
        first_look,
    )
}

/// Search for the largest value in vector registers: for each lane, the largest value found so far and its first position.
struct Largest {
    values: __m512,
    places: __m512i,
    /// Indices of the 16 values that are compared in the next step.
    next: __m512i,
}

impl Largest {
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn at_least(value: f32) -> Self {
        let first = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        Self {
            values: _mm512_set1_ps(value),
            places: first,
            next: first,
        }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    fn or(self, values: __m512) -> Self {
        let is_larger = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(values, self.values);
        Self {
            values: _mm512_max_ps(values, self.values),
            places: _mm512_mask_blend_epi32(is_larger, self.places, self.next),
            next: _mm512_add_epi32(self.next, _mm512_set1_epi32(LANES as i32)),
        }
    }

    /// Returns the largest value over all lanes, and its first position.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn of_all(self) -> (f32, usize) {
        let largest = _mm512_reduce_max_ps(self.values);
        let is_here = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.values, _mm512_set1_ps(largest));
        let place = if is_here.is_power_of_two() {
            _mm512_cvtsi512_si32(_mm512_maskz_compress_epi32(is_here, self.places))
        } else {
            _mm512_mask_reduce_min_epi32(is_here, self.places)
        };
        (largest, place as usize)
    }
}

#[inline(always)]
fn lanes(values: &[f32]) -> &[[f32; LANES]] {
    values.as_chunks::<LANES>().0
}
