//! NumPy's `.npy` format, versions 1 to 3: a header with the element type, the order and the lengths, followed by the elements.

use crate::error::{Error, Result};
use crate::inputs::arrays::element_type::ElementType;
use crate::inputs::arrays::file_array::{Elements, FileArray};
use ndarray::{ArrayD, IxDyn, ShapeBuilder};
use std::io::Read;

/// Maximum size of the header of a `.npy` file, bytes. A longer header indicates a damaged file; NumPy rejects headers above 10,000 bytes by default.
const MAX_HEADER: usize = 1 << 20;
/// Number of array elements that are decoded together, so that they fit into the processor's cache.
const BLOCK: usize = 1 << 13;

/// Header of a `.npy` file.
pub struct Header {
    /// Type of the elements of the array.
    pub elements: ElementType,
    /// Whether the first index changes fastest (Fortran order).
    is_fortran: bool,
    /// Lengths of the array's axes.
    pub shape: Vec<usize>,
    /// Number of bytes in the file before the first element.
    n_bytes: u64,
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
    let text = String::from_utf8_lossy(&text).into_owned();
    let value = |key: &str| {
        let (_, rest) = text.split_once(&format!("'{key}'"))?;
        rest.trim_start().strip_prefix(':').map(str::trim_start)
    };
    let descr = value("descr").ok_or_else(damaged)?;
    let is_fortran = value("fortran_order").ok_or_else(damaged)?;
    let shape = value("shape").and_then(|rest| {
        let (lengths, _) = rest.strip_prefix('(')?.split_once(')')?;
        let lengths = lengths.split(',').map(str::trim);
        let lengths = lengths.filter(|length| !length.is_empty());
        lengths
            .map(|length| length.trim_end_matches('L').parse().ok())
            .collect::<Option<Vec<usize>>>()
    });
    Ok(Header {
        elements: ElementType::parse(place, descr)?,
        is_fortran: is_fortran.starts_with("True"),
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
    let mut lengths = header.shape.iter();
    let n = lengths.try_fold(1_usize, |n, &length| n.checked_mul(length));
    let wanted = n.and_then(|n| n.checked_mul(size));
    let there = length.saturating_sub(header.n_bytes);
    let (Some(n), true) = (n, wanted.is_some_and(|wanted| wanted as u64 == there)) else {
        let given = format!(
            "{} elements of {size} bytes in {there} bytes",
            header
                .shape
                .iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(" × ")
        );
        return Err(Error::input(place, given, "a whole .npy file"));
    };
    let mut elements = header.elements.empty(n);
    let mut bytes = vec![0; BLOCK.min(n) * size];
    let mut n_left = n;
    while n_left > 0 && size > 0 {
        let block = &mut bytes[..BLOCK.min(n_left) * size];
        let cut = |_| Error::input(place, "a file that ends too early", "a whole .npy file");
        reader.read_exact(block).map_err(cut)?;
        header.elements.decode(block, &mut elements);
        n_left -= block.len() / size;
    }
    // At the end of a member, the archive reader compares the checksum.
    let at_end = reader.read(&mut [0]);
    at_end
        .map_err(|error| Error::input(place, format!("damaged: {error}"), "a whole .npy file"))?;
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
