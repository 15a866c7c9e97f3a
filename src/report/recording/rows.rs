//! Rows of a member as numbers.

use super::header::Stream;
use super::npy::{Element, NpyHeader};
use std::fs::File;
use std::io::{self, BufReader, Read};
use zip::ZipArchive;

/// Bytes of rows that are read at once.
const BLOCK: usize = 1 << 20;

/// Numbers from their bytes, in place of what was there.
pub(super) fn decode(bytes: &[u8], element: Element, values: &mut Vec<f64>) {
    values.clear();
    if element == Element::Single {
        let numbers = bytes.as_chunks().0.iter();
        values.extend(numbers.map(|&b| f64::from(f32::from_le_bytes(b))));
    } else {
        let numbers = bytes.as_chunks().0.iter();
        values.extend(numbers.map(|&b| f64::from_le_bytes(b)));
    }
}

/// Visits all rows of a member, some at a time; the zip's checksum is compared at the end.
pub(super) fn read_rows(
    archive: &mut ZipArchive<BufReader<File>>,
    stream: &Stream,
    n_frames: usize,
    visit: &mut impl FnMut(usize, &[f64]),
) -> io::Result<()> {
    let mut entry = archive.by_name(&format!("{}.npy", stream.name))?;
    NpyHeader::read(&mut entry)?;
    let n_row: usize = stream.row.iter().product();
    let rows_per_block = (BLOCK / stream.row_bytes().max(1)).max(1);
    let (mut bytes, mut values) = (Vec::new(), Vec::new());
    for first in (0..n_frames).step_by(rows_per_block) {
        let n = rows_per_block.min(n_frames - first);
        bytes.resize(n * stream.row_bytes(), 0);
        entry.read_exact(&mut bytes)?;
        decode(&bytes, stream.element, &mut values);
        for (row, values) in values.chunks(n_row.max(1)).enumerate() {
            visit(first + row, values);
        }
    }
    // The checksum is compared at the end of the member.
    match entry.read(&mut [0])? {
        0 => Ok(()),
        _ => Err(io::Error::other("more bytes than rows")),
    }
}
