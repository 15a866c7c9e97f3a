//! A row of somebody's array that a press is written into.

/// Where the frame of a press goes, metres: one number a taxel, of either kind.
///
/// An array of many frames is seldom in the processor's caches, and to fill a row with zeros takes a third of a fast press. So it is
/// filled bit by bit while the spheres press, when the memory has nothing else to do.
#[derive(Debug)]
pub enum Row<'a> {
    /// Rounded to single precision.
    Single(&'a mut [f32]),
    /// As they are.
    Double(&'a mut [f64]),
}

impl Row<'_> {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Single(row) => row.len(),
            Self::Double(row) => row.len(),
        }
    }

    /// The same row, once more.
    pub(super) fn again(&mut self) -> Row<'_> {
        match self {
            Self::Single(row) => Row::Single(row),
            Self::Double(row) => Row::Double(row),
        }
    }

    /// Writes deflections from a taxel on.
    pub(super) fn write(&mut self, first: usize, deflections: &[f64]) {
        let taxels = first..first + deflections.len();
        match self {
            Self::Double(row) => row[taxels].copy_from_slice(deflections),
            Self::Single(row) => {
                for (single, double) in row[taxels].iter_mut().zip(deflections) {
                    *single = *double as f32;
                }
            }
        }
    }
}

/// What of a row is still to be filled with zeros.
pub(super) struct Zeroing<'a> {
    left: Row<'a>,
    /// How much of it at a time.
    step: usize,
}

impl<'a> Zeroing<'a> {
    /// All of a row.
    pub fn of(row: Row<'a>) -> Self {
        Self { left: row, step: 0 }
    }

    /// Nothing.
    pub fn nothing() -> Self {
        Self::of(Row::Double(&mut []))
    }

    /// From now on so many steps fill the row.
    pub fn in_steps(&mut self, n_steps: usize) {
        let step = self.left.len().div_ceil(n_steps.max(1));
        self.step = step.next_multiple_of(LINE);
    }

    /// Fills a bit more.
    #[inline(always)]
    pub fn step(&mut self) {
        if self.step > 0 {
            match &mut self.left {
                Row::Single(left) => fill_first(left, self.step),
                Row::Double(left) => fill_first(left, self.step),
            }
        }
    }

    /// Fills what is left.
    pub fn finish(mut self) {
        self.step = self.left.len();
        self.step();
    }
}

/// Numbers of whole lines of a cache: of 64 bytes, or two of them.
const LINE: usize = 16;

#[inline(always)]
fn fill_first<T: Copy + Default>(left: &mut &mut [T], n: usize) {
    let n = n.min(left.len());
    let (first, later) = std::mem::take(left).split_at_mut(n);
    first.fill(T::default());
    *left = later;
}
