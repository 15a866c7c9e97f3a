//! The header of NumPy's `.npy` format: what the elements are, and the shape (NEP 1; versions 1 to 3 are read, 1 is written).

use std::io::{self, Read};

/// What an array holds, in the machine-independent order: least significant byte first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Element {
    /// `<f4`.
    Single,
    /// `<f8`.
    Double,
    /// `<U…`: so many code points of four bytes.
    Text(usize),
}

impl Element {
    pub fn n_bytes(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
            Self::Text(n) => 4 * n,
        }
    }

    fn descr(self) -> String {
        match self {
            Self::Single => "<f4".to_owned(),
            Self::Double => "<f8".to_owned(),
            Self::Text(n) => format!("<U{n}"),
        }
    }

    fn of_descr(descr: &str) -> Option<Self> {
        match descr {
            "<f4" => Some(Self::Single),
            "<f8" => Some(Self::Double),
            _ => Some(Self::Text(descr.strip_prefix("<U")?.parse().ok()?)),
        }
    }
}

/// What stands before an array's bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NpyHeader {
    pub element: Element,
    /// Rows first: the last index runs fastest.
    pub shape: Vec<usize>,
}

/// A header is shorter than that, whatever its length field says.
const LONGEST: usize = 1 << 16;

impl NpyHeader {
    /// Bytes of the array behind the header; `None` beyond what this machine can count.
    pub fn n_bytes(&self) -> Option<usize> {
        let mut lengths = self.shape.iter();
        lengths.try_fold(self.element.n_bytes(), |product, &n| product.checked_mul(n))
    }

    /// The error says what it is, and what it should be.
    pub fn check(&self, element: Element, shape: &[usize]) -> Result<(), (String, String)> {
        let said = |element: Element, shape: &[usize]| format!("{element:?} of shape {shape:?}");
        match (self.element, &self.shape[..]) == (element, shape) {
            true => Ok(()),
            false => Err((said(self.element, &self.shape), said(element, shape))),
        }
    }

    /// The header as it stands in the file, a multiple of 64 bytes long.
    pub fn bytes(&self) -> Vec<u8> {
        let shape = match &self.shape[..] {
            [one] => format!("({one},)"),
            many => {
                let lengths: Vec<String> = many.iter().map(usize::to_string).collect();
                format!("({})", lengths.join(", "))
            }
        };
        let mut dictionary = format!(
            "{{'descr': '{}', 'fortran_order': False, 'shape': {shape}, }}",
            self.element.descr()
        );
        let unpadded = 10 + dictionary.len() + 1;
        dictionary += &" ".repeat(unpadded.next_multiple_of(64) - unpadded);
        dictionary.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((dictionary.len() as u16).to_le_bytes());
        bytes.extend(dictionary.as_bytes());
        bytes
    }

    /// Reads a header and says how long it was; the error says what is not understood.
    pub fn read(reader: &mut impl Read) -> io::Result<(Self, usize)> {
        let mut start = [0; 8];
        reader.read_exact(&mut start)?;
        if start[..6] != *b"\x93NUMPY" || !(1..=3).contains(&start[6]) {
            return Err(io::Error::other("no .npy header of version 1 to 3"));
        }
        let mut length = [0; 4];
        let n_length = if start[6] == 1 { 2 } else { 4 };
        reader.read_exact(&mut length[..n_length])?;
        let length = u32::from_le_bytes(length) as usize;
        if length > LONGEST {
            return Err(io::Error::other(format!("a .npy header of {length} bytes")));
        }
        let mut dictionary = vec![0; length];
        reader.read_exact(&mut dictionary)?;
        let dictionary = String::from_utf8_lossy(&dictionary);
        let header = Self::parse(&dictionary).ok_or_else(|| {
            io::Error::other(format!("an array of another kind: {}", dictionary.trim()))
        })?;
        Ok((header, 8 + n_length + length))
    }

    /// `{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }`, keys in any order.
    fn parse(dictionary: &str) -> Option<Self> {
        let after = |key: &str| {
            let (_, rest) = dictionary.split_once(&format!("'{key}':"))?;
            Some(rest.trim_start())
        };
        let descr = after("descr")?.strip_prefix('\'')?.split('\'').next()?;
        if !after("fortran_order")?.starts_with("False") {
            return None;
        }
        let (shape, _) = after("shape")?.strip_prefix('(')?.split_once(')')?;
        let lengths = shape.split(',').map(str::trim).filter(|n| !n.is_empty());
        Some(Self {
            element: Element::of_descr(descr)?,
            shape: lengths.map(|n| n.parse().ok()).collect::<Option<_>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_reads_back_whatever_the_shape() {
        for shape in [vec![], vec![0], vec![7], vec![50_000, 4096], vec![2, 3, 4]] {
            for element in [Element::Single, Element::Double, Element::Text(300)] {
                let shape = shape.clone();
                let header = NpyHeader { element, shape };
                let bytes = header.bytes();
                assert_eq!(bytes.len() % 64, 0);
                let read = NpyHeader::read(&mut &bytes[..]).unwrap();
                assert_eq!(read, (header, bytes.len()));
            }
        }
    }

    #[test]
    fn arrays_that_are_not_ours_are_refused() {
        for dictionary in [
            "{'descr': '>f8', 'fortran_order': False, 'shape': (3,), }",
            "{'descr': '<f8', 'fortran_order': True, 'shape': (3, 2), }",
            "{'descr': '|O', 'fortran_order': False, 'shape': (3,), }",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-3,), }",
            "{'descr': '<f8', 'fortran_order': False}",
            "",
        ] {
            assert_eq!(NpyHeader::parse(dictionary), None, "{dictionary}");
        }
        assert!(NpyHeader::read(&mut &b"\x93NUMPY\x02\x00\xff\xff\xff\xff"[..]).is_err());
        assert!(NpyHeader::read(&mut &b"\x93NUM"[..]).is_err());
    }
}
