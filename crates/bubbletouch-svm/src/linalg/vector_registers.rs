//! Conversion between arrays and vector registers of 16 f32 values, without raw pointers.

use std::arch::x86_64::{
    __m128, __m512, _mm_cvtss_f32, _mm_shuffle_ps, _mm512_extractf32x4_ps, _mm512_setr_ps,
};

/// Loads an array into a register; the compiler generates one instruction.
#[inline]
#[target_feature(enable = "avx512f")]
pub(crate) fn load(values: &[f32; 16]) -> __m512 {
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = *values;
    _mm512_setr_ps(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
}

/// Returns the 16 values of a vector register.
#[inline]
#[target_feature(enable = "avx512f")]
pub(crate) fn store(register: __m512) -> [f32; 16] {
    let [a, b, c, d] = four(_mm512_extractf32x4_ps(register, 0));
    let [e, f, g, h] = four(_mm512_extractf32x4_ps(register, 1));
    let [i, j, k, l] = four(_mm512_extractf32x4_ps(register, 2));
    let [m, n, o, p] = four(_mm512_extractf32x4_ps(register, 3));
    [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p]
}

#[inline]
#[target_feature(enable = "avx512f")]
fn four(part: __m128) -> [f32; 4] {
    [
        _mm_cvtss_f32(part),
        _mm_cvtss_f32(_mm_shuffle_ps(part, part, 1)),
        _mm_cvtss_f32(_mm_shuffle_ps(part, part, 2)),
        _mm_cvtss_f32(_mm_shuffle_ps(part, part, 3)),
    ]
}
