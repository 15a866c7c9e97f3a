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

    /// Writes a deflection for each taxel.
    pub(super) fn write(&mut self, deflections: &[f64]) {
        match self {
            Self::Double(row) => row.copy_from_slice(deflections),
            Self::Single(row) => {
                assert_eq!(row.len(), deflections.len(), "one number a taxel");
                for (single, double) in row.iter_mut().zip(deflections) {
                    *single = *double as f32;
                }
            }
        }
    }
}

/// A row that is filled with zeros while the spheres press, and then takes what they have pressed.
pub(super) struct Filling<'a> {
    pub row: Row<'a>,
    n_filled: usize,
    /// How much of it at a time.
    step: usize,
}

impl<'a> Filling<'a> {
    /// Of a row that holds anything.
    pub fn of(row: Row<'a>) -> Self {
        Self {
            row,
            n_filled: 0,
            step: 0,
        }
    }

    /// Of a row of zeros.
    pub fn of_zeros(row: Row<'a>) -> Self {
        Self {
            n_filled: row.len(),
            row,
            step: 0,
        }
    }

    /// Of no row.
    pub fn nothing() -> Self {
        Self::of(Row::Double(&mut []))
    }

    /// From now on so many steps fill the row.
    pub fn in_steps(&mut self, n_steps: usize) {
        let step = (self.row.len() - self.n_filled).div_ceil(n_steps.max(1));
        self.step = step.next_multiple_of(LINE);
    }

    /// Fills a bit more.
    #[inline(always)]
    pub fn step(&mut self) {
        if self.step > 0 {
            self.fill(self.step);
        }
    }

    /// Fills what is left.
    pub fn finish(&mut self) {
        self.fill(self.row.len());
    }

    #[inline(always)]
    fn fill(&mut self, n: usize) {
        let end = self.row.len().min(self.n_filled + n);
        let bit = self.n_filled..end;
        match &mut self.row {
            Row::Single(row) => row[bit].fill(0.0),
            Row::Double(row) => row[bit].fill(0.0),
        }
        self.n_filled = end;
    }
}

/// Numbers of whole lines of a cache: of 64 bytes, or two of them.
const LINE: usize = 16;
