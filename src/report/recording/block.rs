//! Rows of many arrays in memory, until there are enough to be written.

/// Bytes of a block. Smaller: more and shorter reads and writes; larger: the processor has forgotten it when it is written, which then
/// takes half as long again.
const BLOCK: usize = 2 << 20;

/// A few megabytes of rows, those of each array together.
///
/// Invariant: each column holds the rows since the last whole block, `row_bytes` each.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Bytes of one row of each array.
    row_bytes: Vec<usize>,
    columns: Vec<Vec<u8>>,
    rows_per_block: usize,
    n_rows: usize,
}

impl Block {
    /// No rows yet.
    pub fn new(row_bytes: Vec<usize>) -> Self {
        let rows_per_block = (BLOCK / row_bytes.iter().sum::<usize>().max(1)).max(1);
        let columns = row_bytes.iter();
        Self {
            columns: columns
                .map(|n| Vec::with_capacity(n * rows_per_block))
                .collect(),
            row_bytes,
            rows_per_block,
            n_rows: 0,
        }
    }

    /// Rows that are complete, those of earlier blocks with them.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// Room for the next row of an array: to be filled before [`end_row`](Self::end_row).
    pub fn row(&mut self, column: usize) -> &mut [u8] {
        let (n, bytes) = (self.row_bytes[column], &mut self.columns[column]);
        let start = bytes.len();
        bytes.resize(start + n, 0);
        &mut bytes[start..]
    }

    /// All arrays have got their row; whether the block is whole now.
    pub fn end_row(&mut self) -> bool {
        self.n_rows += 1;
        self.n_rows.is_multiple_of(self.rows_per_block)
    }

    /// The rows of each array.
    pub fn columns(&self) -> &[Vec<u8>] {
        &self.columns
    }

    /// Begins the next block.
    pub fn clear(&mut self) {
        self.columns.iter_mut().for_each(Vec::clear);
    }
}
