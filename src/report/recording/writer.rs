//! Writer of recordings: receives frames one by one and writes an `.npz` file.

use super::header::{Element, Member, RecordingHeader};
use crate::error::{Error, Result};
use crate::files::WholeFile;
use crate::inputs::content_hash::bytes_of_numbers;
use crate::inputs::npy::npy_header;
use crate::scene::Frame;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::mem::ManuallyDrop;
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Maximum size of the recorded rows that are kept in memory, bytes. With a smaller value, there are more and shorter reads and writes; with a larger value,
/// the rows exceed the processor's cache.
const BLOCK: usize = 2 << 20;

/// Writer of a recording as an `.npz` file. The method `finish` completes the file. If the writer is dropped before, no file remains.
///
/// The writer keeps about 2 MiB of rows in memory (or one frame, if it is larger), for any number of frames. Because a member of a zip file is contiguous,
/// earlier rows are stored in an unnamed temporary file beside the target. While the recording is completed, the disk contains the data twice.
///
/// Invariant: `blocks` starts with `n_blocks` blocks. Each block contains the rows of all members, one member after the other.
pub struct RecordingWriter {
    header: RecordingHeader,
    target: WholeFile,
    members: Vec<Member>,
    /// Rows of each array of the recording that were added after its last complete block.
    rows: Vec<Vec<u8>>,
    rows_per_block: usize,
    blocks: File,
    n_blocks: usize,
    n_frames: usize,
    last_time: f64,
}

impl RecordingWriter {
    /// Creates a recording at `path`, to which frames are appended.
    ///
    /// # Errors
    /// If the header is invalid, or the file cannot be created.
    pub fn create(path: &Path, header: RecordingHeader) -> Result<Self> {
        header.check()?;
        let target = WholeFile::create(path)?;
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let blocks = tempfile::tempfile_in(folder);
        let members = header.members();
        Ok(Self {
            target,
            rows: vec![Vec::new(); members.len()],
            rows_per_block: (BLOCK / frame_bytes(&members)).max(1),
            members,
            header,
            blocks: blocks.map_err(|e| Error::io(folder, "write frames to", e))?,
            n_blocks: 0,
            n_frames: 0,
            last_time: f64::NEG_INFINITY,
        })
    }

    /// Appends a frame to the recording; its patches and objects must have the order given in the header.
    ///
    /// # Errors
    /// If the time does not increase, the patches, objects or taxels differ from the header, or a write fails. The frame is then not part of the
    /// recording.
    pub fn push(&mut self, frame: &Frame) -> Result<()> {
        let place = || format!("recording, frame {}", self.n_frames);
        let (time, last) = (frame.time, self.last_time);
        if !(time.is_finite() && time > last) {
            let given = format!("{time} s after {last} s");
            return Err(Error::input(place(), given, "finite times that increase"));
        }
        let numbers = numbers(frame);
        let given: Vec<usize> = numbers.iter().map(Vec::len).collect();
        let expected: Vec<usize> = self.members.iter().map(Member::n_numbers).collect();
        if given != expected {
            let [given, allowed] = [given, expected].map(|n| format!("rows of {n:?} numbers"));
            return Err(Error::input(place(), given, allowed));
        }
        if self.n_frames == (self.n_blocks + 1) * self.rows_per_block {
            let written = self.write_block();
            written.map_err(|e| Error::io("recording", "write frames of", e))?;
        }
        for ((member, rows), numbers) in self.members.iter().zip(&mut self.rows).zip(numbers) {
            for number in numbers {
                match member.element {
                    Element::Single => rows.extend_from_slice(&(number as f32).to_le_bytes()),
                    Element::Double => rows.extend_from_slice(&number.to_le_bytes()),
                }
            }
        }
        self.last_time = time;
        self.n_frames += 1;
        Ok(())
    }

    fn write_block(&mut self) -> io::Result<()> {
        let start = self.n_blocks * self.rows_per_block * frame_bytes(&self.members);
        self.blocks.seek(SeekFrom::Start(start as u64))?;
        for rows in &self.rows {
            self.blocks.write_all(rows)?;
        }
        self.rows.iter_mut().for_each(Vec::clear);
        self.n_blocks += 1;
        Ok(())
    }

    /// Completes the recording and returns its number of frames.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self) -> Result<usize> {
        let (rows_per_block, n_frames) = (self.rows_per_block as u64, self.n_frames);
        let block_bytes = rows_per_block * frame_bytes(&self.members) as u64;
        let (blocks, mut place) = (&mut self.blocks, 0);
        self.target.write(|file| {
            // If a write fails, the zip writer is not dropped: its destructor would write again and print the error.
            let mut zip = ManuallyDrop::new(ZipWriter::new(file));
            for (name, bytes) in constant_members(&self.header) {
                start(&mut zip, &name)?;
                zip.write_all(&bytes)?;
            }
            for (member, rows) in self.members.iter().zip(&self.rows) {
                let header = npy_header(&member.descr(), &member.shape(n_frames));
                start(&mut zip, &member.name)?;
                zip.write_all(&header)?;
                let n_bytes = member.row_bytes() as u64 * rows_per_block;
                for block in 0..self.n_blocks as u64 {
                    blocks.seek(SeekFrom::Start(block * block_bytes + place))?;
                    io::copy(&mut blocks.take(n_bytes), &mut *zip)?;
                }
                zip.write_all(rows)?;
                place += n_bytes;
            }
            let zip = ManuallyDrop::into_inner(zip);
            zip.finish().map(drop).map_err(io::Error::from)
        })?;
        self.target.commit()?;
        Ok(self.n_frames)
    }
}

/// Returns the size of one frame of all arrays of a recording, bytes.
fn frame_bytes(members: &[Member]) -> usize {
    members.iter().map(Member::row_bytes).sum()
}

/// Starts an archive member, which may exceed 4 GiB. All members have the same modification time, so that equal recordings give equal bytes.
fn start(zip: &mut ZipWriter<&mut BufWriter<File>>, name: &str) -> io::Result<()> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .large_file(true);
    Ok(zip.start_file(format!("{name}.npy"), options)?)
}

/// Returns the archive members that are constant over time: `meta`, and the centres and axes of the taxels.
fn constant_members(header: &RecordingHeader) -> Vec<(String, Vec<u8>)> {
    let meta = header.meta();
    let code_points = meta.chars().flat_map(|c| u32::from(c).to_le_bytes());
    let mut bytes = npy_header(&format!("<U{}", meta.chars().count()), &[]);
    bytes.extend(code_points);
    let mut members = vec![("meta".to_owned(), bytes)];
    for patch in &header.patches {
        for (name, vectors) in [("centers", &patch.centers), ("axes", &patch.axes)] {
            let mut bytes = npy_header("<f8", &[vectors.len(), 3]);
            bytes.extend(bytes_of_numbers(vectors.iter().flat_map(|v| v.to_array())));
            members.push((format!("{}/{name}", patch.name), bytes));
        }
    }
    members
}

/// Returns the numbers of one frame for each array of the recording.
fn numbers(frame: &Frame) -> Vec<Vec<f64>> {
    let mut numbers = vec![vec![frame.time]];
    for patch in &frame.patches {
        numbers.push(patch.deflection.clone());
        numbers.push(match &patch.friction {
            Some(_) => patch.force3.iter().flat_map(|f| f.to_array()).collect(),
            None => patch.force.clone(),
        });
        numbers.extend(patch.signal.clone());
        numbers.push(patch.pose.to_array().to_vec());
    }
    numbers.extend(
        frame
            .objects
            .iter()
            .map(|object| object.pose.to_array().to_vec()),
    );
    numbers
}
