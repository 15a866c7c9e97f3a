//! Iteration over the lanes of a vector whose values are below a limit.

/// Iterator over the indices of lanes whose values are below a limit, ascending. Implemented as a named type because the compiler does not use vector
/// instructions in closures.
#[derive(Clone, Copy, Default)]
pub struct LanesBelow {
    /// One bit per vector lane that the iterator has not returned yet.
    pending: u32,
}

impl LanesBelow {
    /// Creates the iterator over the lanes of `values` (at most 32) that are below `limit`.
    #[inline(always)]
    pub fn new<const N: usize>(values: &[f64; N], limit: f64) -> Self {
        let mut pending = 0;
        for (k, &value) in values.iter().enumerate() {
            pending |= u32::from(value < limit) << k;
        }
        Self { pending }
    }

    /// Returns whether no value is below the limit.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.pending == 0
    }
}

impl Iterator for LanesBelow {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.pending == 0 {
            return None;
        }
        let first = self.pending.trailing_zeros() as usize;
        self.pending &= self.pending - 1;
        Some(first)
    }
}
