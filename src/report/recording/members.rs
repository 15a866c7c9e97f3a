//! The members of a recording: their places, what does not change with time, and numbers as bytes.

use super::archive::Archive;
use super::header::RecordingHeader;
use super::npy::{Element, NpyHeader};
use std::fs::File;
use std::io::{self, BufWriter};

/// The number of the first member that has one row a frame.
pub(super) fn first_stream(header: &RecordingHeader) -> usize {
    1 + 2 * header.patches.len()
}

/// Gives all members of a recording their places, and writes what does not change with time.
pub(super) fn begin(
    header: &RecordingHeader,
    n_frames: usize,
    archive: &mut Archive,
    file: &mut BufWriter<File>,
) -> io::Result<()> {
    let code_points: Vec<u8> = header
        .meta()
        .chars()
        .flat_map(|c| u32::from(c).to_le_bytes())
        .collect();
    let meta = NpyHeader {
        element: Element::Text(code_points.len() / 4),
        shape: vec![],
    };
    let member = start(archive, file, "meta", &meta)?;
    archive.append(file, member, &code_points)?;
    for patch in &header.patches {
        for (name, vectors) in [("centers", &patch.centers), ("axes", &patch.axes)] {
            let array = NpyHeader {
                element: Element::Double,
                shape: vec![vectors.len(), 3],
            };
            let member = start(archive, file, &format!("{}/{name}", patch.name), &array)?;
            let mut bytes = vec![0; 24 * vectors.len()];
            let numbers = vectors.iter().flat_map(|v| v.to_array());
            put(&mut bytes, Element::Double, numbers);
            archive.append(file, member, &bytes)?;
        }
    }
    for stream in header.streams() {
        let array = NpyHeader {
            element: stream.element,
            shape: stream.shape(n_frames),
        };
        start(archive, file, &stream.name, &array)?;
    }
    Ok(())
}

/// Starts a member with the header of its array.
fn start(
    archive: &mut Archive,
    file: &mut BufWriter<File>,
    name: &str,
    array: &NpyHeader,
) -> io::Result<usize> {
    let head = array.bytes();
    let n_bytes = array
        .n_bytes()
        .ok_or_else(|| io::Error::other(format!("more bytes in {name} than can be counted")))?;
    let size = head.len() as u64 + n_bytes as u64;
    let member = archive.add(&format!("{name}.npy"), size);
    archive.append(file, member, &head)?;
    Ok(member)
}

/// Fills a row.
pub(super) fn put(row: &mut [u8], element: Element, values: impl IntoIterator<Item = f64>) {
    if element == Element::Single {
        let places = row.as_chunks_mut().0.iter_mut();
        places
            .zip(values)
            .for_each(|(to, value)| *to = (value as f32).to_le_bytes());
    } else {
        let places = row.as_chunks_mut().0.iter_mut();
        places
            .zip(values)
            .for_each(|(to, value)| *to = value.to_le_bytes());
    }
}
