//! Output buffer of a press: a row of the caller's array that receives the deflections.

/// Destination of the deflections of a press: one value per taxel, metres, in single or double precision.
///
/// An array of many frames is rarely in the processor's caches, and filling a row with zeros takes a third of a fast press. The row is therefore filled in
/// small parts while the spheres are evaluated, when the memory is idle.
#[derive(Debug)]
pub enum Row<'a> {
    /// Deflections rounded to single precision.
    Single(&'a mut [f32]),
    /// Deflections in double precision.
    Double(&'a mut [f64]),
}

impl Row<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Single(row) => row.len(),
            Self::Double(row) => row.len(),
        }
    }

    /// Writes one deflection per taxel to the row.
    pub(crate) fn write(&mut self, deflections: &[f64]) {
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

/// Output row that is filled with zeros while the spheres are evaluated, and then receives the deflections.
pub(crate) struct OutputBuffer<'a> {
    pub row: Row<'a>,
    n_filled: usize,
    /// Number of values that one call of `step` fills with zeros.
    step: usize,
}

impl<'a> OutputBuffer<'a> {
    /// Creates the output buffer for a row with arbitrary contents.
    pub fn new(row: Row<'a>) -> Self {
        Self {
            row,
            n_filled: 0,
            step: 0,
        }
    }

    /// Creates the output buffer for a row that already contains zeros.
    pub fn from_zeros(row: Row<'a>) -> Self {
        Self {
            n_filled: row.len(),
            row,
            step: 0,
        }
    }

    /// Creates an output buffer without a row, for presses without output.
    pub fn none() -> Self {
        Self::new(Row::Double(&mut []))
    }

    /// Divides the filling with zeros into `n_steps` calls of `step`.
    pub fn in_steps(&mut self, n_steps: usize) {
        let step = (self.row.len() - self.n_filled).div_ceil(n_steps.max(1));
        self.step = step.next_multiple_of(LINE);
    }

    /// Fills the next part of the row with zeros.
    #[inline(always)]
    pub fn step(&mut self) {
        if self.step > 0 {
            self.fill(self.step);
        }
    }

    /// Fills the rest of the row with zeros.
    pub fn finish(&mut self) {
        self.fill(self.row.len());
    }

    #[inline(always)]
    fn fill(&mut self, n: usize) {
        let end = self.row.len().min(self.n_filled + n);
        let step = self.n_filled..end;
        match &mut self.row {
            Row::Single(row) => row[step].fill(0.0),
            Row::Double(row) => row[step].fill(0.0),
        }
        self.n_filled = end;
    }
}

/// Number of values whose filling is not divided further: one or two cache lines of 64 bytes.
const LINE: usize = 16;
