//! Lanes of vector instructions, and rows that are padded to a multiple of the number of lanes.

/// Number of values computed in parallel: two vector registers with eight f32 each, or four with four f64 each.
pub(crate) const LANES: usize = 16;

/// Returns n rounded up to a multiple of [`LANES`].
pub(crate) fn padded(n: usize) -> usize {
    n.next_multiple_of(LANES)
}
