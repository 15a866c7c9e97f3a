//! Values of the taxels of a flat grid, and the rectangle that a press reaches.

use std::ops::{Index, IndexMut, Range};

/// Number of grid columns that are computed together: four f64 values in a vector of 256 bits. A larger value computes needless columns beside narrow
/// footprints of spheres; a smaller value needs more instructions.
pub(super) const BLOCK: usize = 4;

/// Number of grid columns that are computed together if a sphere's footprint is wider than three blocks: eight f64 values in a vector of 512 bits.
pub(super) const WIDE: usize = 8;

/// Values of the taxels of a grid, row by row: deflections, or heights of stops. Outside of the rectangle of taxels that a press reaches, all have one value.
#[derive(Clone, Debug, Default)]
pub(crate) struct GridValues {
    /// Values, metres, shape (n_taxels,), padded so that the last row also consists of whole blocks.
    values: Vec<f64>,
    n_columns: usize,
    n_taxels: usize,
    rows: Range<usize>,
    columns: Range<usize>,
}

impl GridValues {
    /// Returns the values of all taxels of the grid, metres, row by row.
    pub fn all(&self) -> &[f64] {
        &self.values[..self.n_taxels]
    }

    /// Sets all values of a grid to `value`, which must not change between calls. Only the rectangle of reached taxels is written.
    pub fn clear(&mut self, n_columns: usize, n_rows: usize, value: f64) {
        self.each_row(|_, values| values.fill(value));
        (self.n_columns, self.n_taxels) = (n_columns, n_columns * n_rows);
        self.values.resize(self.n_taxels + BLOCK - 1, value);
        (self.rows, self.columns) = (NOTHING, NOTHING);
    }

    /// Enlarges the rectangle of reached taxels so that it contains the given rows and columns.
    #[inline(always)]
    pub fn cover(&mut self, rows: &Range<usize>, columns: &Range<usize>) {
        self.rows = joined(&self.rows, rows);
        self.columns = joined(&self.columns, columns);
    }

    /// Returns the rows and the columns of the rectangle of reached taxels.
    pub fn rectangle(&self) -> (Range<usize>, Range<usize>) {
        (self.rows.clone(), self.columns.clone())
    }

    /// Returns the index of a taxel.
    #[inline(always)]
    pub fn number(&self, row: usize, column: usize) -> usize {
        row * self.n_columns + column
    }

    /// Returns the values of the taxels in the given row and columns, metres.
    #[inline(always)]
    pub fn row(&mut self, row: usize, columns: Range<usize>) -> &mut [f64] {
        let first = self.number(row, 0);
        &mut self.values[first + columns.start..first + columns.end]
    }

    /// Returns N blocks of values in a row, beginning at column `first`. Beyond the row's end a block contains taxels of the next row.
    #[inline(always)]
    pub fn blocks<const N: usize>(&mut self, row: usize, first: usize) -> &mut [[f64; BLOCK]; N] {
        let first = self.number(row, first);
        let (blocks, _) = self.values[first..first + N * BLOCK].as_chunks_mut();
        blocks.try_into().expect("so many blocks are cut")
    }

    /// Returns a wide block of values in a row, beginning at column `first`; all columns must lie in the row.
    #[inline(always)]
    pub fn wide_block(&mut self, row: usize, first: usize) -> &mut [f64; WIDE] {
        let first = self.number(row, first);
        let block = self.values[first..].first_chunk_mut();
        block.expect("a row is as long")
    }

    /// Calls `visit` for each row of the rectangle of taxels that the press reached. The arguments are the index of the row's first reached taxel and the
    /// values.
    #[inline(always)]
    pub fn each_row(&mut self, mut visit: impl FnMut(usize, &mut [f64])) {
        for row in self.rows.clone() {
            let first = self.number(row, self.columns.start);
            visit(first, self.row(row, self.columns.clone()));
        }
    }
}

impl Index<usize> for GridValues {
    type Output = f64;

    #[inline(always)]
    fn index(&self, taxel: usize) -> &f64 {
        &self.values[taxel]
    }
}

impl IndexMut<usize> for GridValues {
    #[inline(always)]
    fn index_mut(&mut self, taxel: usize) -> &mut f64 {
        &mut self.values[taxel]
    }
}

/// Range without a line.
pub(super) const NOTHING: Range<usize> = Range {
    start: usize::MAX,
    end: 0,
};

/// Returns the smallest range that contains two others.
#[inline(always)]
pub(super) fn joined(one: &Range<usize>, other: &Range<usize>) -> Range<usize> {
    one.start.min(other.start)..one.end.max(other.end)
}
