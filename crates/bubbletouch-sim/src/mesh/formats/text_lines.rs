//! Numbered lines of text files in any encoding, with any line ends, without the byte order mark.

use crate::error::{Error, Result};
use crate::text::numbers::finite_number;
use std::io::BufRead;

/// Byte order mark of UTF-8.
pub(super) const BYTE_ORDER_MARK: [u8; 3] = [0xEF, 0xBB, 0xBF];

/// Returns all bytes of a file.
///
/// # Errors
/// If `source` cannot be read; the error contains `place`.
pub(super) fn all_bytes(place: &str, mut source: impl BufRead) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = source.read_to_end(&mut bytes);
    read.map_err(|error| Error::io(place, "read", error))?;
    Ok(bytes)
}

/// Calls `visit` with the line number (from 1) and the text of each non-empty line of a text file.
///
/// A backslash at the end of a line means that the line continues on the next line. Invalid UTF-8 (names and comments in other encodings) is replaced by
/// U+FFFD. Line ends are LF, CR LF or CR.
///
/// # Errors
/// If `source` cannot be read, or `visit` returns an error.
pub(super) fn each_line(
    place: &str,
    source: impl BufRead,
    mut visit: impl FnMut(usize, &str) -> Result<()>,
) -> Result<()> {
    let bytes = all_bytes(place, source)?;
    let text = bytes.strip_prefix(&BYTE_ORDER_MARK).unwrap_or(&bytes);
    let (mut number, mut first, mut line) = (0, 1, String::new());
    let mut is_after_return = false;
    for end in text.split_inclusive(|&byte| byte == b'\n' || byte == b'\r') {
        // The LF of a CR LF ends a line that has already ended.
        if end == b"\n" && is_after_return {
            is_after_return = false;
            continue;
        }
        is_after_return = end.ends_with(b"\r");
        number += 1;
        let content = String::from_utf8_lossy(end);
        let content = content.trim();
        match content.strip_suffix('\\') {
            Some(content) => {
                line.push_str(content);
                line.push(' ');
            }
            None => {
                line.push_str(content);
                visit(first, &line)?;
                line.clear();
                first = number + 1;
            }
        }
    }
    visit(first, &line)
}

/// Reads three finite coordinates from the first three words of a line; further words are ignored.
///
/// # Errors
/// If there are fewer words, or one is not a finite number; the error begins with `place`.
pub(super) fn coordinates<'a>(
    place: impl std::fmt::Display,
    mut words: impl Iterator<Item = &'a str>,
) -> Result<glam::DVec3> {
    let mut point = glam::DVec3::ZERO;
    for n_read in 0..3 {
        let Some(word) = words.next() else {
            let given = format!("{n_read} coordinates");
            return Err(Error::input(place, given, "x, y and z"));
        };
        let Some(number) = finite_number(word) else {
            let given = format!("coordinate `{word}`");
            return Err(Error::input(place, given, "a finite number"));
        };
        point[n_read] = number;
    }
    Ok(point)
}
