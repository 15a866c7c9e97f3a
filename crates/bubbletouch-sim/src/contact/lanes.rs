//! Lanes of vectors: selection of lanes, and extreme values. All functions are written so that loops over lanes become vector instructions.

/// Iterator over the indices of selected lanes, ascending. Implemented as a named type because the compiler does not use vector instructions in closures.
#[derive(Clone, Copy, Default)]
pub struct SelectedLanes {
    /// One bit for each selected lane that the iterator has not returned yet.
    pending: u64,
}

impl SelectedLanes {
    /// Creates the iterator over the lanes whose bits are set.
    #[inline(always)]
    pub fn of_bits(bits: impl Into<u64>) -> Self {
        Self {
            pending: bits.into(),
        }
    }

    /// Creates the iterator over the lanes of `values` (at most 32) that are below `limit`.
    #[inline(always)]
    pub fn below<const N: usize>(values: &[f64; N], limit: f64) -> Self {
        let mut bits = 0;
        for (k, &value) in values.iter().enumerate() {
            bits |= u32::from(value < limit) << k;
        }
        Self::of_bits(bits)
    }

    /// Returns whether no lane is selected.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.pending == 0
    }
}

impl Iterator for SelectedLanes {
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

/// Returns the smaller number; a single instruction, unlike `f64::min`.
#[inline(always)]
pub fn least<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// Returns the larger number; a single instruction, unlike `f64::max`.
#[inline(always)]
pub fn most<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// Returns the largest of eight values.
#[inline(always)]
pub fn largest<T: PartialOrd + Copy>(values: &[T; 8]) -> T {
    let mut largest = *values;
    for half in [4, 2, 1] {
        for k in 0..half {
            largest[k] = most(largest[k], largest[k + half]);
        }
    }
    largest[0]
}
