//! Rows of many arrays on their way to the disk, in bounded memory.
//!
//! A zip cannot grow two members at once, so the arrays wait in one file beside the target until their length is known.
//! It holds blocks of some megabytes; within a block each array's rows lie together. One file, rather than one an array,
//! since a robot may have more patches than a process may have open files; large blocks, since an array with short rows
//! would else be read back a row at a time.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Bytes of a block. Smaller: more and shorter reads at the end; larger: more memory.
const BLOCK: usize = 8 << 20;

/// The file of waiting rows; gone when this is dropped.
///
/// Invariant: each column holds the rows since the last whole block, `row_bytes` each.
pub(super) struct Spool {
    path: PathBuf,
    /// Who it is for: what errors name.
    target: PathBuf,
    file: File,
    /// Bytes of one row of each array.
    row_bytes: Vec<usize>,
    columns: Vec<Vec<u8>>,
    rows_per_block: usize,
    n_rows: usize,
    /// A block was written in part: where the next one would start is not known.
    is_broken: bool,
}

impl Spool {
    /// An empty spool beside `target`.
    pub fn create(target: &Path, row_bytes: Vec<usize>) -> Result<Self> {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.rows.partial", std::process::id()));
        let path = target.with_file_name(name);
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(true);
        let file = options
            .open(&path)
            .map_err(|e| Error::io(target, "write", e))?;
        let rows_per_block = (BLOCK / row_bytes.iter().sum::<usize>().max(1)).max(1);
        Ok(Self {
            path,
            target: target.to_owned(),
            file,
            columns: row_bytes
                .iter()
                .map(|n| Vec::with_capacity(n * rows_per_block))
                .collect(),
            row_bytes,
            rows_per_block,
            n_rows: 0,
            is_broken: false,
        })
    }

    /// Rows that are complete.
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

    /// All arrays have got their row.
    pub fn end_row(&mut self) -> Result<()> {
        self.n_rows += 1;
        if self.n_rows.is_multiple_of(self.rows_per_block) {
            return self.end_block();
        }
        Ok(())
    }

    /// Writes what waits in memory; only the last block may be shorter than the others. After an error, always an error.
    pub fn end_block(&mut self) -> Result<()> {
        if std::mem::replace(&mut self.is_broken, true) {
            let lost = io::Error::other("rows were lost when writing failed before");
            return Err(Error::io(&self.target, "write", lost));
        }
        for column in &mut self.columns {
            self.file
                .write_all(column)
                .map_err(|e| Error::io(&self.target, "write", e))?;
            column.clear();
        }
        self.is_broken = false;
        Ok(())
    }

    /// Copies all rows of one array, after the last block has been ended.
    pub fn copy_column(&mut self, column: usize, to: &mut impl Write) -> io::Result<()> {
        let row = self.row_bytes[column];
        let before: usize = self.row_bytes[..column].iter().sum();
        let all: usize = self.row_bytes.iter().sum();
        let buffer = &mut self.columns[column];
        for first in (0..self.n_rows).step_by(self.rows_per_block) {
            let n = self.rows_per_block.min(self.n_rows - first);
            let start = first as u64 * all as u64 + (n * before) as u64;
            self.file.seek(SeekFrom::Start(start))?;
            buffer.resize(n * row, 0);
            self.file.read_exact(buffer)?;
            to.write_all(buffer)?;
        }
        buffer.clear();
        Ok(())
    }
}

impl Drop for Spool {
    fn drop(&mut self) {
        // It is ours alone; that it cannot be removed changes nothing in what is reported.
        let _ = fs::remove_file(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_come_back_whole_over_many_blocks_and_a_short_last_one() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("target");
        // Two thirds of a megabyte a row: twelve rows a block.
        let row_bytes = vec![5, 700_000, 0, 8];
        for n_rows in [0, 1, 11, 12, 25] {
            let mut spool = Spool::create(&target, row_bytes.clone()).unwrap();
            let value =
                |column: usize, row: usize, byte: usize| (31 * column + 7 * row + byte) as u8;
            for row in 0..n_rows {
                for column in 0..4 {
                    let bytes = spool.row(column).iter_mut().enumerate();
                    bytes.for_each(|(byte, to)| *to = value(column, row, byte));
                }
                spool.end_row().unwrap();
            }
            spool.end_block().unwrap();
            for (column, &n) in row_bytes.iter().enumerate() {
                let mut read = Vec::new();
                spool.copy_column(column, &mut read).unwrap();
                let expected: Vec<u8> = (0..n_rows)
                    .flat_map(|row| (0..n).map(move |byte| value(column, row, byte)))
                    .collect();
                assert!(read == expected, "column {column} of {n_rows} rows");
            }
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
