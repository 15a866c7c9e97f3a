//! Deflections of a flat grid, and the rectangle that contains those above zero.

use std::ops::Range;

/// Columns that are indented together: lanes of 256 bits, f64. More: columns beside narrow footprints are computed in vain; fewer: more instructions.
pub(super) const BLOCK: usize = 4;

/// Columns that are indented together in footprints wider than three blocks: lanes of 512 bits, f64.
pub(super) const WIDE: usize = 8;

/// Deflections of a grid, row by row, and the rectangle outside of which all are zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct DeflectionGrid {
    /// n_taxels, metres, and a block's more, so that the last row has all of its blocks too.
    deflections: Vec<f64>,
    n_columns: usize,
    n_taxels: usize,
    rows: Range<usize>,
    columns: Range<usize>,
}

impl DeflectionGrid {
    /// All deflections, metres.
    pub fn deflections(&self) -> &[f64] {
        &self.deflections[..self.n_taxels]
    }

    /// Leaves all taxels of a grid at rest. What was not covered is not looked at.
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

    /// Makes the rectangle hold some rows and columns.
    #[inline(always)]
    pub fn cover(&mut self, rows: &Range<usize>, columns: &Range<usize>) {
        self.rows = self.rows.start.min(rows.start)..self.rows.end.max(rows.end);
        self.columns = self.columns.start.min(columns.start)..self.columns.end.max(columns.end);
    }

    /// Some columns of a row.
    #[inline(always)]
    pub fn row(&mut self, row: usize, columns: Range<usize>) -> &mut [f64] {
        let first = row * self.n_columns;
        &mut self.deflections[first + columns.start..first + columns.end]
    }

    /// Blocks of columns of a row, from column `first`: behind its last come taxels of the next one.
    #[inline(always)]
    pub fn blocks<const N: usize>(&mut self, row: usize, first: usize) -> &mut [[f64; BLOCK]; N] {
        let first = row * self.n_columns + first;
        let (blocks, _) = self.deflections[first..first + N * BLOCK].as_chunks_mut();
        blocks.try_into().expect("so many blocks are cut")
    }

    /// A wide block of columns of a row, from column `first`, all of them in the row.
    #[inline(always)]
    pub fn wide_block(&mut self, row: usize, first: usize) -> &mut [f64; WIDE] {
        let first = row * self.n_columns + first;
        let block = self.deflections[first..].first_chunk_mut();
        block.expect("a row is as long")
    }

    /// Visits what is covered, row by row, each from which taxel on.
    #[inline(always)]
    pub fn each_row(&mut self, mut visit: impl FnMut(usize, &mut [f64])) {
        for row in self.rows.clone() {
            let first = row * self.n_columns + self.columns.start;
            visit(first, self.row(row, self.columns.clone()));
        }
    }
}
