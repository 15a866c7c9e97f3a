//! NumPy's `.npy` format, versions 1 to 3: a header with the element type, the order and the lengths, followed by the elements.

use crate::encoding::utf8_or_latin1;
use crate::error::{Error, Result};
use crate::inputs::arrays::{ElementKind, Elements, FileArray};
use ndarray::{ArrayD, IxDyn, ShapeBuilder};
use std::io::Read;

/// Maximum size of the header of a `.npy` file, bytes. A longer header indicates a damaged file; NumPy rejects headers above 10,000 bytes by default.
const MAX_HEADER: usize = 1 << 20;
/// Number of array elements that are decoded together, so that they fit into the processor's cache.
const BLOCK: usize = 1 << 13;

const ALLOWED: &str = "numbers (float16 to float64, int8 to int64, uint8 to uint64, bool) or texts";

/// Header of a `.npy` file.
pub struct Header {
    elements: ElementType,
    /// Whether the first index changes fastest (Fortran order).
    is_fortran: bool,
    /// Lengths of the array's axes.
    pub shape: Vec<usize>,
    /// Number of bytes in the file before the first element.
    pub n_bytes: u64,
}

impl Header {
    /// Checks that an array in C order has elements of the type `descr` in NumPy's notation, such as `<f4`, and a shape.
    ///
    /// # Errors
    /// If the type, the order or the shape differs.
    pub fn check(&self, place: &str, descr: &str, shape: &[usize]) -> Result<()> {
        let is_expected = ElementType::parse(place, &format!("'{descr}'"))? == self.elements;
        if is_expected && !self.is_fortran && self.shape == shape {
            return Ok(());
        }
        let given = format!("an array of shape {:?}", self.shape);
        let allowed = format!("shape {shape:?} of `{descr}`, row by row");
        Err(Error::input(place, given, allowed))
    }
}

/// Reads the header of a `.npy` file.
///
/// # Errors
/// If the header is damaged, or the elements are neither numbers nor texts.
pub fn read_header(place: &str, reader: &mut (impl Read + ?Sized)) -> Result<Header> {
    let damaged = || {
        let allowed = "a .npy file as NumPy writes it";
        Error::input(place, "a damaged header of a .npy file", allowed)
    };
    let mut start = [0; 8];
    reader.read_exact(&mut start).map_err(|_| damaged())?;
    if !start.starts_with(b"\x93NUMPY") {
        return Err(damaged());
    }
    let mut length = [0; 4];
    let n_length = if start[6] == 1 { 2 } else { 4 };
    let wide = &mut length[..n_length];
    reader.read_exact(wide).map_err(|_| damaged())?;
    let length = u32::from_le_bytes(length) as usize;
    if length > MAX_HEADER || !(1..=3).contains(&start[6]) {
        return Err(damaged());
    }
    let mut text = vec![0; length];
    reader.read_exact(&mut text).map_err(|_| damaged())?;
    let text = String::from_utf8_lossy(&text);
    let value = |key: &str| {
        let (_, rest) = text.split_once(&format!("'{key}'"))?;
        rest.trim_start().strip_prefix(':').map(str::trim_start)
    };
    let [descr, order, shape] = ["descr", "fortran_order", "shape"].map(value);
    let (Some(descr), Some(order)) = (descr, order) else {
        return Err(damaged());
    };
    let shape = shape.and_then(|rest| {
        let (lengths, _) = rest.strip_prefix('(')?.split_once(')')?;
        let lengths = lengths.split(',').map(str::trim);
        let lengths = lengths.filter(|length| !length.is_empty());
        lengths
            .map(|length| length.trim_end_matches('L').parse().ok())
            .collect::<Option<Vec<usize>>>()
    });
    Ok(Header {
        elements: ElementType::parse(place, descr)?,
        is_fortran: order.starts_with("True"),
        shape: shape.ok_or_else(damaged)?,
        n_bytes: (start.len() + n_length + length) as u64,
    })
}

/// Reads an array in `.npy` format that occupies `length` bytes.
///
/// # Errors
/// If the header is damaged, the elements are neither numbers nor texts, or their number differs from the header. If the checksum of an archive differs.
pub fn read(place: &str, reader: &mut dyn Read, length: u64) -> Result<FileArray> {
    let header = read_header(place, reader)?;
    let size = header.elements.size;
    let refuse = |given: String| Error::input(place, given, "a whole .npy file");
    let mut lengths = header.shape.iter();
    let n = lengths.try_fold(1_usize, |n, &length| n.checked_mul(length));
    let wanted = n.and_then(|n| n.checked_mul(size));
    let there = length.saturating_sub(header.n_bytes);
    let (Some(n), true) = (n, wanted.is_some_and(|wanted| wanted as u64 == there)) else {
        let lengths: Vec<String> = header.shape.iter().map(usize::to_string).collect();
        let lengths = lengths.join(" × ");
        return Err(refuse(format!(
            "{lengths} elements of {size} bytes in {there} bytes"
        )));
    };
    let mut elements = header.elements.empty(n);
    let mut bytes = vec![0; BLOCK.min(n) * size];
    let mut n_left = n;
    while n_left > 0 && size > 0 {
        let block = &mut bytes[..BLOCK.min(n_left) * size];
        let cut = |_| refuse("a file that ends too early".to_owned());
        reader.read_exact(block).map_err(cut)?;
        n_left -= block.len() / size;
        header.elements.decode(block, &mut elements);
    }
    // At the end of a member, the archive reader compares the checksum.
    let at_end = reader.read(&mut [0]);
    at_end.map_err(|error| refuse(format!("damaged: {error}")))?;
    if size == 0 {
        elements = Elements::Texts(vec![String::new(); n]);
    }
    if header.is_fortran && header.shape.len() > 1 {
        elements = match elements {
            Elements::Numbers(numbers) => Elements::Numbers(row_major(&header.shape, numbers)),
            Elements::Texts(texts) => Elements::Texts(row_major(&header.shape, texts)),
        };
    }
    Ok(FileArray {
        place: place.to_owned(),
        shape: header.shape,
        kind: header.elements.kind,
        elements,
        columns: None,
        refusal: None,
    })
}

/// Reorders the elements of an array from Fortran order (first index fastest) to C order (last index fastest).
fn row_major<T: Clone>(shape: &[usize], elements: Vec<T>) -> Vec<T> {
    let array = ArrayD::from_shape_vec(IxDyn(shape).f(), elements);
    let array = array.expect("one element for each place");
    array.iter().cloned().collect()
}

/// Type of the elements in a NumPy file.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ElementType {
    /// Kind of the elements: number, truth value or text.
    kind: ElementKind,
    /// Size of an element, bytes.
    size: usize,
    /// Letter that NumPy uses for the type, such as `f` for floating-point numbers.
    letter: char,
    is_big_endian: bool,
}

impl ElementType {
    /// Parses the element type at the start of a `.npy` header, such as `'<f8', 'fortran_order': …`.
    fn parse(place: &str, descr: &str) -> Result<Self> {
        let refuse = |given: &str| Err(Error::input(place, given, ALLOWED));
        let quoted = descr
            .strip_prefix('\'')
            .and_then(|rest| rest.split_once('\''));
        let Some((code, _)) = quoted else {
            return refuse("records of several fields");
        };
        let mut letters = code.trim_start_matches(['<', '>', '=', '|']).chars();
        let letter = letters.next().unwrap_or(' ');
        let digits: String = letters.take_while(char::is_ascii_digit).collect();
        let count: usize = digits.parse().unwrap_or(0);
        let (kind, size) = match (letter, count) {
            ('f', 2) => (ElementKind::Float(f64::from(f32::EPSILON) * 8192.0), 2),
            ('f', 4) => (ElementKind::Float(f64::from(f32::EPSILON)), 4),
            ('f', 8) => (ElementKind::Float(f64::EPSILON), 8),
            ('i' | 'u', 1 | 2 | 4 | 8) => (ElementKind::Integer, count),
            ('b' | '?', _) => (ElementKind::Truth, 1),
            ('S' | 'a', _) => (ElementKind::Text, count),
            ('U', _) => (ElementKind::Text, count.saturating_mul(4)),
            ('O', _) => {
                return refuse(
                    "Python objects, as NumPy stores rows of unlike lengths or mixed types",
                );
            }
            ('c', _) => return refuse("complex numbers"),
            ('f', _) => return refuse("floats of more than 64 bits"),
            ('M' | 'm', _) => return refuse("dates or times"),
            _ => return refuse("elements of another type"),
        };
        Ok(Self {
            kind,
            size,
            letter,
            is_big_endian: code.starts_with('>'),
        })
    }

    /// Returns an empty list for elements of this type, with capacity for `n` elements.
    fn empty(&self, n: usize) -> Elements {
        match self.kind {
            ElementKind::Text => Elements::Texts(Vec::with_capacity(n)),
            _ => Elements::Numbers(Vec::with_capacity(n)),
        }
    }

    /// Returns the number of bytes that the byte order arranges: those of a number or of a letter.
    fn word_size(&self) -> usize {
        match (self.kind, self.letter) {
            (ElementKind::Text, 'U') => 4,
            (ElementKind::Text, _) => 1,
            _ => self.size,
        }
    }

    /// Decodes all elements that the bytes contain and appends them to `elements`. The bytes are in little-endian order afterwards.
    fn decode(&self, bytes: &mut [u8], elements: &mut Elements) {
        if self.is_big_endian {
            let words = bytes.chunks_exact_mut(self.word_size());
            words.for_each(<[u8]>::reverse);
        }
        let chunks = bytes.chunks_exact(self.size);
        match elements {
            Elements::Texts(texts) => texts.extend(chunks.map(|chunk| self.text(chunk))),
            Elements::Numbers(numbers) => match (self.letter, self.size) {
                ('f', 8) => numbers.extend(words(bytes).map(f64::from_le_bytes)),
                ('f', 4) => {
                    numbers.extend(words(bytes).map(|word| f64::from(f32::from_le_bytes(word))))
                }
                _ => numbers.extend(chunks.map(|chunk| self.number(chunk))),
            },
        }
    }

    /// Decodes a number of any other type than float32 and float64.
    fn number(&self, bytes: &[u8]) -> f64 {
        let bits = bits(bytes);
        match (self.letter, self.size) {
            ('f', _) => half(bits as u16),
            ('i', size) => {
                let n_unused = 64 - 8 * size;
                ((bits << n_unused) as i64 >> n_unused) as f64
            }
            ('u', _) => bits as f64,
            _ => f64::from(u8::from(bits != 0)),
        }
    }

    /// Decodes a text and removes its zero padding.
    fn text(&self, bytes: &[u8]) -> String {
        let text = match self.letter {
            'U' => {
                let codes = bytes.chunks_exact(4).map(|chunk| bits(chunk) as u32);
                let letters = codes.map(char::from_u32);
                let letters = letters.map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER));
                letters.collect()
            }
            _ => utf8_or_latin1(bytes),
        };
        text.trim_end_matches('\0').to_owned()
    }
}

/// Returns the bits of a number or a letter of at most eight bytes.
fn bits(bytes: &[u8]) -> u64 {
    let mut bits = [0; 8];
    bits[..bytes.len()].copy_from_slice(bytes);
    u64::from_le_bytes(bits)
}

/// Returns the words of `N` bytes each.
fn words<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [u8; N]> {
    bytes.as_chunks().0.iter().copied()
}

/// Converts an IEEE 754 binary16 number, given by its bits, to f64.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    sign * match exponent {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    }
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn halves_are_the_numbers_of_the_standard() {
        for (bits, number) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0001, 2f64.powi(-24)),
            (0x0400, 2f64.powi(-14)),
            (0x3555, 0.333_251_953_125),
            (0xfc00, f64::NEG_INFINITY),
        ] {
            assert_eq!(half(bits), number, "{bits:x}");
        }
        assert!(half(0x7e00).is_nan());
    }
}
