//! Writing of NumPy's `.npy` files row by row, for arrays larger than memory. The header is followed by the elements; the last index changes fastest.
//!
//! Arrays in memory are written by ndarray-npy ([`write_npy`]), which cannot write a header alone. The module `arrays` reads array files.

use crate::error::Result;
use crate::files::{WholeFile, write_whole};
use ndarray::Array1;
use ndarray_npy::WriteNpyExt;
use std::io::{self, Write};
use std::path::Path;

/// First bytes of a `.npy` file of version 1, which NumPy writes for arrays of numbers and texts. The length of the header follows.
const MAGIC: [u8; 8] = *b"\x93NUMPY\x01\x00";

/// Returns the header of a `.npy` file, given the element type in NumPy's notation (such as `<f4`) and the shape. Its length is a multiple of 64 bytes.
pub(crate) fn npy_header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let lengths = lengths.join(", ") + comma;
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({lengths}), }}");
    let n_before = MAGIC.len() + 2;
    let n_bytes = (n_before + text.len() + 1).next_multiple_of(64);
    let text = format!("{text:<width$}\n", width = n_bytes - n_before - 1);
    let length = (text.len() as u16).to_le_bytes();
    [&MAGIC[..], &length, text.as_bytes()].concat()
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
    use crate::inputs::arrays::npy_file::read_header;
    use ndarray::{ArrayD, IxDyn};
    use ndarray_npy::ReadNpyExt;

    fn is_read(mut bytes: &[u8], descr: &str, shape: &[usize]) -> bool {
        let header = read_header("array", &mut bytes);
        header.is_ok_and(|header| header.check("array", descr, shape).is_ok())
    }

    #[test]
    fn ndarray_npy_reads_our_headers_and_we_read_its() {
        for shape in [vec![], vec![0], vec![7], vec![50, 4], vec![2, 3, 4]] {
            let array = ArrayD::from_elem(IxDyn(&shape), 0.5);
            let mut theirs = Vec::new();
            array.write_npy(&mut theirs).unwrap();
            assert!(is_read(&theirs, "<f8", &shape));
            assert!(!is_read(&theirs, "<f4", &shape));
            let header = npy_header("<f8", &shape);
            assert_eq!(header.len() % 64, 0);
            let n_bytes = read_header("array", &mut &theirs[..]).unwrap().n_bytes;
            let ours = [&header, &theirs[n_bytes as usize..]].concat();
            assert_eq!(ArrayD::<f64>::read_npy(&ours[..]).unwrap(), array);
        }
    }

    #[test]
    fn arrays_of_another_kind_are_refused() {
        let with_text = |text: &str| {
            let length = (text.len() as u16).to_le_bytes();
            [&MAGIC[..], &length, text.as_bytes()].concat()
        };
        let usual = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }";
        assert!(is_read(&with_text(usual), "<f8", &[3, 2]));
        for text in [
            "{'descr': '>f8', 'fortran_order': False, 'shape': (3, 2), }",
            "{'descr': '<f8', 'fortran_order': True, 'shape': (3, 2), }",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-3, 2), }",
            "{'descr': '<f8', 'fortran_order': False}",
            "",
        ] {
            assert!(!is_read(&with_text(text), "<f8", &[3, 2]), "{text}");
        }
        assert!(read_header("array", &mut &b"\x93NUMPY\x02\x00\xff\xff\xff\xff"[..]).is_err());
        assert!(read_header("array", &mut &b"\x93NUMPY\x01\x00\xff\xff"[..]).is_err());
        assert!(read_header("array", &mut &b"\x93NUM"[..]).is_err());
    }
}
