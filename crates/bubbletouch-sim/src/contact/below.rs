//! Which of a few values are below a limit.

/// Which of a few values are below a limit, ascending. (An iterator whose parts are put in place at once: closures would be compiled
/// without vector instructions.)
#[derive(Clone, Copy, Default)]
pub struct Below {
    /// A bit each.
    left: u32,
}

impl Below {
    /// Those of `values`, at most 32, that are below a limit.
    #[inline(always)]
    pub fn of<const N: usize>(values: &[f64; N], limit: f64) -> Self {
        let mut left = 0;
        for (k, &value) in values.iter().enumerate() {
            left |= u32::from(value < limit) << k;
        }
        Self { left }
    }

    /// Whether none are.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.left == 0
    }
}

impl Iterator for Below {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.left == 0 {
            return None;
        }
        let first = self.left.trailing_zeros() as usize;
        self.left &= self.left - 1;
        Some(first)
    }
}
