//! Deflections of a flat grid, and the rectangle that contains all deflections above zero.

use std::ops::Range;

/// Number of grid columns that are computed together: four f64 values in a vector of 256 bits. A larger value computes needless columns beside narrow
/// footprints of spheres; a smaller value needs more instructions.
pub(super) const BLOCK: usize = 4;

/// Number of grid columns that are computed together if a sphere's footprint is wider than three blocks: eight f64 values in a vector of 512 bits.
pub(super) const WIDE: usize = 8;

/// Deflections of a grid, row by row, with the rectangle of taxels that the last press reached. Outside this rectangle all deflections are zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct DeflectionGrid {
    /// Deflections, metres, shape (n_taxels,), padded so that the last row also consists of whole blocks.
    deflections: Vec<f64>,
    n_columns: usize,
    n_taxels: usize,
    rows: Range<usize>,
    columns: Range<usize>,
}

impl DeflectionGrid {
    /// Returns the deflections of all taxels of the grid, metres, row by row.
    pub fn deflections(&self) -> &[f64] {
        &self.deflections[..self.n_taxels]
    }

    /// Sets all deflections of a grid to zero. If the grid is unchanged, only the rectangle of taxels that the last press reached is written.
    pub fn clear(&mut self, n_columns: usize, n_rows: usize) {
        if (self.n_columns, self.n_taxels) == (n_columns, n_columns * n_rows) {
            self.each_row(|_, taxels| taxels.fill(0.0));
        } else {
            (self.n_columns, self.n_taxels) = (n_columns, n_columns * n_rows);
            self.deflections.clear();
            self.deflections.resize(self.n_taxels + BLOCK - 1, 0.0);
        }
        self.rows = n_rows..0;
        self.columns = n_columns..0;
    }

    /// Enlarges the rectangle of reached taxels so that it contains the given rows and columns.
    #[inline(always)]
    pub fn cover(&mut self, rows: &Range<usize>, columns: &Range<usize>) {
        self.rows = self.rows.start.min(rows.start)..self.rows.end.max(rows.end);
        self.columns = self.columns.start.min(columns.start)..self.columns.end.max(columns.end);
    }

    /// Returns the deflections of the taxels in the given row and columns, metres.
    #[inline(always)]
    pub fn row(&mut self, row: usize, columns: Range<usize>) -> &mut [f64] {
        let first = row * self.n_columns;
        &mut self.deflections[first + columns.start..first + columns.end]
    }

    /// Returns N blocks of deflections in a row, beginning at column `first`. Beyond the row's end a block contains taxels of the next row.
    #[inline(always)]
    pub fn blocks<const N: usize>(&mut self, row: usize, first: usize) -> &mut [[f64; BLOCK]; N] {
        let first = row * self.n_columns + first;
        let (blocks, _) = self.deflections[first..first + N * BLOCK].as_chunks_mut();
        blocks.try_into().expect("so many blocks are cut")
    }

    /// Returns a wide block of deflections in a row, beginning at column `first`; all columns must lie in the row.
    #[inline(always)]
    pub fn wide_block(&mut self, row: usize, first: usize) -> &mut [f64; WIDE] {
        let first = row * self.n_columns + first;
        let block = self.deflections[first..].first_chunk_mut();
        block.expect("a row is as long")
    }

    /// Calls `visit` for each row of the rectangle of taxels that the press reached. The arguments are the index of the row's first reached taxel and the
    /// deflections.
    #[inline(always)]
    pub fn each_row(&mut self, mut visit: impl FnMut(usize, &mut [f64])) {
        for row in self.rows.clone() {
            let first = row * self.n_columns + self.columns.start;
            visit(first, self.row(row, self.columns.clone()));
        }
    }
}
