//! Writing of NumPy's `.npy` files row by row, for arrays larger than memory. The header is followed by the elements; the last index changes fastest.
//!
//! Arrays in memory are written by ndarray-npy ([`write_npy`]), which cannot write a header alone. The module `arrays` reads array files.

use crate::error::Result;
use crate::files::{WholeFile, write_whole};
use ndarray::Array1;
use ndarray_npy::WriteNpyExt;
use std::io::{self, Read, Write};
use std::path::Path;

/// First bytes of a `.npy` file of version 1, which NumPy writes for arrays of numbers and texts. The length of the header follows.
const MAGIC: [u8; 8] = *b"\x93NUMPY\x01\x00";

/// Returns the text of a `.npy` header that describes an array, such as `{'descr': '<f4', 'fortran_order': False, 'shape': (500, 64), }`.
fn dictionary(descr: &str, shape: &[usize]) -> String {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let lengths = lengths.join(", ") + comma;
    format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({lengths}), }}")
}

/// Returns the header of a `.npy` file, given the element type in NumPy's notation (such as `<f4`) and the shape. Its length is a multiple of 64 bytes.
pub(crate) fn npy_header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let mut text = dictionary(descr, shape);
    let n_before = MAGIC.len() + 2;
    let n_bytes = (n_before + text.len() + 1).next_multiple_of(64);
    text += &" ".repeat(n_bytes - n_before - text.len() - 1);
    text += "\n";
    let length = (text.len() as u16).to_le_bytes();
    [&MAGIC[..], &length, text.as_bytes()].concat()
}

/// Reads a `.npy` header; returns its text and its length in bytes.
pub(crate) fn read_npy_header(reader: &mut impl Read) -> io::Result<(String, usize)> {
    let mut start = [0; MAGIC.len() + 2];
    reader.read_exact(&mut start)?;
    let Some([low, high]) = start.strip_prefix(&MAGIC) else {
        return Err(io::Error::other("no .npy header of version 1"));
    };
    let mut text = vec![0; usize::from(u16::from_le_bytes([*low, *high]))];
    reader.read_exact(&mut text)?;
    let n_bytes = start.len() + text.len();
    Ok((String::from_utf8_lossy(&text).trim().to_owned(), n_bytes))
}

/// Returns an error if a header has another element type or shape than expected; commas and spaces are ignored.
pub(crate) fn check_npy_header(text: &str, descr: &str, shape: &[usize]) -> io::Result<()> {
    let plain = |text: &str| {
        let letters = text.chars().filter(|letter| !letter.is_whitespace());
        let text: String = letters.collect();
        text.replace(",)", ")").replace(",}", "}")
    };
    let expected = dictionary(descr, shape);
    match plain(text) == plain(&expected) {
        true => Ok(()),
        false => Err(io::Error::other(format!("{text} instead of {expected}"))),
    }
}

/// Array file in `.npy` format that is written element by element; the file appears at its path when all elements are written.
pub(crate) struct NpyFile(WholeFile);

impl NpyFile {
    /// Creates an array file for elements of the type `descr` in NumPy's notation, such as `<f4`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(path: &Path, descr: &str, shape: &[usize]) -> Result<Self> {
        let mut file = WholeFile::create(path)?;
        file.write(|file| file.write_all(&npy_header(descr, shape)))?;
        Ok(Self(file))
    }

    /// Writes the next elements of the array, each with `N` bytes.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn push<const N: usize>(
        &mut self,
        elements: impl IntoIterator<Item = [u8; N]>,
    ) -> Result<()> {
        let bytes: Vec<u8> = elements.into_iter().flatten().collect();
        self.0.write(|file| file.write_all(&bytes))
    }

    /// Moves the complete array file to its path.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn commit(self) -> Result<()> {
        self.0.commit()
    }
}

/// Writes an array in memory as a `.npy` file.
///
/// # Errors
/// If the file cannot be written.
pub fn write_npy(path: &Path, array: &impl WriteNpyExt) -> Result<()> {
    write_whole(path, |file| array.write_npy(file).map_err(io::Error::other))
}

/// Writes class or row numbers as a `.npy` file of type int64.
///
/// # Errors
/// If the file cannot be written.
pub fn write_integers(path: &Path, numbers: impl IntoIterator<Item = usize>) -> Result<()> {
    let numbers = numbers.into_iter().map(|number| number as i64);
    write_npy(path, &Array1::from_iter(numbers))
}

/// Writes texts as a `.npy` file of NumPy's type U (Unicode texts).
///
/// # Errors
/// If the file cannot be written.
pub fn write_texts(path: &Path, texts: &[String]) -> Result<()> {
    let lengths = texts.iter().map(|text| text.chars().count());
    let n = lengths.max().unwrap_or(0).max(1);
    let mut file = NpyFile::create(path, &format!("<U{n}"), &[texts.len()])?;
    for text in texts {
        let letters = text.chars().chain(std::iter::repeat('\0')).take(n);
        file.push(letters.map(|letter| u32::from(letter).to_le_bytes()))?;
    }
    file.commit()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{ArrayD, IxDyn};
    use ndarray_npy::ReadNpyExt;

    #[test]
    fn ndarray_npy_reads_our_headers_and_we_read_its() {
        for shape in [vec![], vec![0], vec![7], vec![50, 4], vec![2, 3, 4]] {
            let array = ArrayD::from_elem(IxDyn(&shape), 0.5);
            let mut theirs = Vec::new();
            array.write_npy(&mut theirs).unwrap();
            let (text, n_bytes) = read_npy_header(&mut &theirs[..]).unwrap();
            check_npy_header(&text, "<f8", &shape).unwrap();
            assert!(check_npy_header(&text, "<f4", &shape).is_err());
            let header = npy_header("<f8", &shape);
            assert_eq!(header.len() % 64, 0);
            let ours = [&header, &theirs[n_bytes..]].concat();
            assert_eq!(ArrayD::<f64>::read_npy(&ours[..]).unwrap(), array);
        }
    }

    #[test]
    fn arrays_of_another_kind_are_refused() {
        for text in [
            "{'descr': '>f8', 'fortran_order': False, 'shape': (3, 2), }",
            "{'descr': '<f8', 'fortran_order': True, 'shape': (3, 2), }",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-3, 2), }",
            "{'descr': '<f8', 'fortran_order': False}",
            "",
        ] {
            assert!(check_npy_header(text, "<f8", &[3, 2]).is_err(), "{text}");
        }
        assert!(read_npy_header(&mut &b"\x93NUMPY\x02\x00\xff\xff\xff\xff"[..]).is_err());
        assert!(read_npy_header(&mut &b"\x93NUMPY\x01\x00\xff\xff"[..]).is_err());
        assert!(read_npy_header(&mut &b"\x93NUM"[..]).is_err());
    }
}
