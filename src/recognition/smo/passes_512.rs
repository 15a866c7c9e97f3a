//! The solver's passes over f32 variables, sixteen at a time. They find what [the plain ones](super::passes) find, to the bit.

use std::arch::x86_64::{
    _CMP_EQ_OQ, _mm512_add_ps, _mm512_cmp_ps_mask, _mm512_div_ps, _mm512_max_ps, _mm512_mul_ps,
    _mm512_reduce_max_ps, _mm512_set1_ps, _mm512_setzero_ps, _mm512_sub_ps,
};

use super::passes::{Down, LANES};
use crate::recognition::vector_registers::{load, store};

/// See [`step_along`](super::passes::step_along).
#[target_feature(enable = "avx512f")]
pub(crate) fn step_along(
    f: &mut [f32],
    (row_i, row_j): (&[f32], &[f32]),
    step: f32,
    up: &[f32],
) -> Option<usize> {
    let f = f.as_chunks_mut::<LANES>().0;
    let n = f.len();
    let (row_i, row_j) = (&lanes(row_i)[..n], &lanes(row_j)[..n]);
    let up = &lanes(up)[..n];
    let step = _mm512_set1_ps(step);
    let mut highest = _mm512_set1_ps(f32::NEG_INFINITY);
    for at in 0..n {
        let difference = _mm512_sub_ps(load(&row_i[at]), load(&row_j[at]));
        let value = _mm512_sub_ps(load(&f[at]), _mm512_mul_ps(step, difference));
        f[at] = store(value);
        highest = _mm512_max_ps(_mm512_add_ps(value, load(&up[at])), highest);
    }
    let highest = _mm512_reduce_max_ps(highest);
    if highest == f32::NEG_INFINITY {
        return None;
    }
    let wanted = _mm512_set1_ps(highest);
    for at in 0..n {
        let value = _mm512_add_ps(load(&f[at]), load(&up[at]));
        let is_here = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(value, wanted);
        if is_here != 0 {
            return Some(at * LANES + is_here.trailing_zeros() as usize);
        }
    }
    Some(0)
}

/// See [`select_down`](super::passes::select_down).
#[target_feature(enable = "avx512f")]
pub(crate) fn select_down(
    (f, low): (&[f32], &[f32]),
    (row, diagonal): (&[f32], &[f32]),
    (highest, own): (f32, f32),
    smallest_curvature: f32,
    gains: &mut [f32],
) -> Down<f32> {
    let gains = gains.as_chunks_mut::<LANES>().0;
    let n = gains.len();
    let (f, low) = (&lanes(f)[..n], &lanes(low)[..n]);
    let (row, diagonal) = (&lanes(row)[..n], &lanes(diagonal)[..n]);
    let (highest, own) = (_mm512_set1_ps(highest), _mm512_set1_ps(own));
    let smallest = _mm512_set1_ps(smallest_curvature);
    let two = _mm512_set1_ps(2.0);
    let (mut best, mut violation) = (_mm512_setzero_ps(), _mm512_setzero_ps());
    for at in 0..n {
        let difference = _mm512_add_ps(_mm512_sub_ps(highest, load(&f[at])), load(&low[at]));
        let difference = _mm512_max_ps(difference, _mm512_setzero_ps());
        let sum = _mm512_add_ps(own, load(&diagonal[at]));
        let curvature = _mm512_sub_ps(sum, _mm512_mul_ps(two, load(&row[at])));
        let curvature = _mm512_max_ps(curvature, smallest);
        let gain = _mm512_div_ps(_mm512_mul_ps(difference, difference), curvature);
        gains[at] = store(gain);
        best = _mm512_max_ps(gain, best);
        violation = _mm512_max_ps(difference, violation);
    }
    let best = _mm512_reduce_max_ps(best);
    Down {
        j: first_equal(gains, best).filter(|_| best > 0.0),
        violation: _mm512_reduce_max_ps(violation),
    }
}

/// Where the first value is that equals another.
#[inline]
#[target_feature(enable = "avx512f")]
fn first_equal(values: &[[f32; LANES]], wanted: f32) -> Option<usize> {
    let wanted = _mm512_set1_ps(wanted);
    for (at, values) in values.iter().enumerate() {
        let is_here = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(load(values), wanted);
        if is_here != 0 {
            return Some(at * LANES + is_here.trailing_zeros() as usize);
        }
    }
    None
}

#[inline(always)]
fn lanes(values: &[f32]) -> &[[f32; LANES]] {
    values.as_chunks::<LANES>().0
}
