//! Rows that wait on the disk until it is known how many there are.
//!
//! A member of a zip has a place only if the sizes of those before it are known. Until then blocks of rows wait in one file beside
//! the target. One file, rather than one an array, since a robot may have more patches than a process may have open files;
//! large blocks, since an array with short rows would else be read back a row at a time.

use super::block::Block;
use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The file of waiting rows; gone when this is dropped.
#[derive(Debug)]
pub(super) struct Spool {
    path: PathBuf,
    file: File,
}

impl Spool {
    /// An empty spool beside `target`.
    pub fn create(target: &Path) -> Result<Self> {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.rows.partial", std::process::id()));
        let path = target.with_file_name(name);
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(true);
        let file = options
            .open(&path)
            .map_err(|e| Error::io(target, "write", e))?;
        Ok(Self { path, file })
    }

    /// Takes what is in a block.
    pub fn put(&mut self, block: &Block) -> io::Result<()> {
        let mut columns = block.columns().iter();
        columns.try_for_each(|column| self.file.write_all(column))
    }

    /// Visits all rows of one array, some at a time, after the last block has been put; in the block's memory.
    pub fn each_part(
        &mut self,
        block: &mut Block,
        column: usize,
        mut visit: impl FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let row = block.row_bytes()[column];
        let before: usize = block.row_bytes()[..column].iter().sum();
        let all: usize = block.row_bytes().iter().sum();
        let (n_rows, rows_per_block) = (block.n_rows(), block.rows_per_block());
        let part = block.column(column);
        for first in (0..n_rows).step_by(rows_per_block) {
            let n = rows_per_block.min(n_rows - first);
            let start = first as u64 * all as u64 + (n * before) as u64;
            self.file.seek(SeekFrom::Start(start))?;
            part.resize(n * row, 0);
            self.file.read_exact(part)?;
            visit(part)?;
        }
        part.clear();
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
        // Two thirds of a megabyte a row: two rows a block.
        let row_bytes = vec![5, 700_000, 0, 8];
        for n_rows in [0, 1, 11, 12, 25] {
            let mut spool = Spool::create(&target).unwrap();
            let mut block = Block::new(row_bytes.clone());
            let value =
                |column: usize, row: usize, byte: usize| (31 * column + 7 * row + byte) as u8;
            for row in 0..n_rows {
                for column in 0..4 {
                    let bytes = block.row(column).iter_mut().enumerate();
                    bytes.for_each(|(byte, to)| *to = value(column, row, byte));
                }
                if block.end_row() {
                    spool.put(&block).unwrap();
                    block.clear();
                }
            }
            spool.put(&block).unwrap();
            block.clear();
            for (column, &n) in row_bytes.iter().enumerate() {
                let mut read = Vec::new();
                let collected = spool.each_part(&mut block, column, |part| {
                    read.extend_from_slice(part);
                    Ok(())
                });
                collected.unwrap();
                let expected: Vec<u8> = (0..n_rows)
                    .flat_map(|row| (0..n).map(move |byte| value(column, row, byte)))
                    .collect();
                assert!(read == expected, "column {column} of {n_rows} rows");
            }
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
