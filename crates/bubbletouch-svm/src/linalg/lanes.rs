//! Lanes of vector instructions, and rows padded to a multiple of their number.

/// Number of values computed in parallel: two vector registers of eight f32, or four of four f64.
pub(crate) const LANES: usize = 16;

/// Returns n rounded up to a multiple of [`LANES`].
pub(crate) fn padded(n: usize) -> usize {
    n.next_multiple_of(LANES)
}
