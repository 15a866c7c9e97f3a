//! Element types of NumPy files, and decoding of the elements.

use crate::encoding::utf8_or_latin1;
use crate::error::{Error, Result};
use crate::inputs::arrays::file_array::{ElementKind, Elements};

const ALLOWED: &str = "numbers (float16 to float64, int8 to int64, uint8 to uint64, bool) or texts";

/// Type of the elements in a NumPy file.
#[derive(Clone, Copy, Debug)]
pub struct ElementType {
    /// Kind of the elements: number, truth value or text.
    pub kind: ElementKind,
    /// Size of an element, bytes.
    pub size: usize,
    /// Letter that NumPy uses for the type, such as `f` for floating-point numbers.
    letter: char,
    is_big_endian: bool,
}

impl ElementType {
    /// Parses the element type at the start of a `.npy` header, such as `'<f8', 'fortran_order': …`.
    ///
    /// # Errors
    /// If the elements are neither numbers nor texts; the error contains their type.
    pub fn parse(place: &str, descr: &str) -> Result<Self> {
        let refuse = |given: &str| Err(Error::input(place, given, ALLOWED));
        let quoted = descr
            .strip_prefix('\'')
            .and_then(|rest| rest.split_once('\''));
        let Some((code, _)) = quoted else {
            return refuse("records of several fields");
        };
        let order = code.chars().next().unwrap_or(' ');
        let rest = code.trim_start_matches(['<', '>', '=', '|']);
        let mut letters = rest.chars();
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
            is_big_endian: order == '>',
        })
    }

    /// Returns an empty list for elements of this type, with capacity for `n` elements.
    pub fn empty(&self, n: usize) -> Elements {
        match self.kind {
            ElementKind::Text => Elements::Texts(Vec::with_capacity(n)),
            _ => Elements::Numbers(Vec::with_capacity(n)),
        }
    }

    /// Decodes all elements that the bytes contain and appends them to `elements`.
    pub fn decode(&self, bytes: &[u8], elements: &mut Elements) {
        /// Decodes little-endian numbers of `N` bytes each and appends them to a list.
        fn numbers<const N: usize>(
            (bytes, is_big_endian): (&[u8], bool),
            numbers: &mut Vec<f64>,
            number: impl Fn([u8; N]) -> f64,
        ) {
            numbers.extend(bytes.as_chunks::<N>().0.iter().map(|chunk| {
                let mut chunk = *chunk;
                if is_big_endian {
                    chunk.reverse();
                }
                number(chunk)
            }));
        }
        let from = (bytes, self.is_big_endian);
        match elements {
            Elements::Texts(texts) => {
                texts.extend(bytes.chunks_exact(self.size).map(|chunk| self.text(chunk)));
            }
            Elements::Numbers(to) => match (self.letter, self.size) {
                ('f', 2) => numbers(from, to, |b| half(u16::from_le_bytes(b))),
                ('f', 4) => numbers(from, to, |b| f64::from(f32::from_le_bytes(b))),
                ('f', _) => numbers(from, to, f64::from_le_bytes),
                ('i', 1) => numbers(from, to, |b| f64::from(i8::from_le_bytes(b))),
                ('i', 2) => numbers(from, to, |b| f64::from(i16::from_le_bytes(b))),
                ('i', 4) => numbers(from, to, |b| f64::from(i32::from_le_bytes(b))),
                ('i', _) => numbers(from, to, |b| i64::from_le_bytes(b) as f64),
                ('u', 2) => numbers(from, to, |b| f64::from(u16::from_le_bytes(b))),
                ('u', 4) => numbers(from, to, |b| f64::from(u32::from_le_bytes(b))),
                ('u', 8) => numbers(from, to, |b| u64::from_le_bytes(b) as f64),
                ('u', _) => numbers(from, to, |[b]| f64::from(b)),
                _ => numbers(from, to, |[b]| f64::from(u8::from(b != 0))),
            },
        }
    }

    /// Decodes a text and removes its zero padding.
    fn text(&self, bytes: &[u8]) -> String {
        if self.letter != 'U' {
            return utf8_or_latin1(bytes).trim_end_matches('\0').to_owned();
        }
        let letters = bytes.as_chunks::<4>().0.iter().map(|chunk| {
            let code = match self.is_big_endian {
                true => u32::from_be_bytes(*chunk),
                false => u32::from_le_bytes(*chunk),
            };
            char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
        });
        let text: String = letters.collect();
        text.trim_end_matches('\0').to_owned()
    }
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
    use crate::inputs::arrays::element_type::half;

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
