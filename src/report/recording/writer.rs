//! The writer: frames in as they come, an `.npz` out at the end.

use super::header::{ForceKind, RecordedPatch, RecordingHeader, Stream};
use super::npy::{Element, NpyHeader};
use super::spool::Spool;
use crate::error::{Error, Result};
use crate::files::WholeFile;
use crate::geometry::Pose;
use glam::DVec3;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Forces on the taxels of a patch, newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Forces<'a> {
    /// Along the axes.
    Normal(&'a [f64]),
    /// In the patch frame.
    Vector(&'a [DVec3]),
}

/// What one patch felt at one instant, and where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchFrame<'a> {
    /// One a taxel, metres.
    pub deflection: &'a [f64],
    /// One a taxel, of the kind that the header says.
    pub force: Forces<'a>,
    /// World from patch.
    pub pose: Pose,
}

/// An `.npz` in the making. [`finish`](Self::finish) puts it in place; dropped before, it leaves nothing behind.
///
/// It holds about 8 MiB of rows in memory, whatever the number of frames (a frame, if that is larger), and as much disk as
/// the recording beside the target until it is finished, twice that while it finishes.
pub struct RecordingWriter {
    header: RecordingHeader,
    streams: Vec<Stream>,
    target: WholeFile,
    spool: Spool,
    last_time: f64,
}

impl RecordingWriter {
    /// Starts a recording that will stand at `path`.
    ///
    /// The error says what [`RecordingHeader::check`] does, or why nothing can be written there.
    pub fn create(path: &Path, header: RecordingHeader) -> Result<Self> {
        header.check()?;
        let streams = header.streams();
        let target = WholeFile::create(path)?;
        let spool = Spool::create(path, streams.iter().map(Stream::row_bytes).collect())?;
        Ok(Self {
            header,
            streams,
            target,
            spool,
            last_time: f64::NEG_INFINITY,
        })
    }

    /// Adds a frame: `time` in seconds, then each patch and each object (world from object) in the header's order.
    ///
    /// The error names a time that does not increase, or a number of patches, objects, deflections or forces that is not the
    /// header's; the frame is then not in the recording.
    pub fn push(&mut self, time: f64, patches: &[PatchFrame], objects: &[Pose]) -> Result<()> {
        self.check(time, patches, objects)?;
        self.last_time = time;
        let element = self.header.precision.element();
        let spool = &mut self.spool;
        put(spool.row(0), Element::Double, [time]);
        let mut column = 1;
        for patch in patches {
            put(spool.row(column), element, patch.deflection.iter().copied());
            match patch.force {
                Forces::Normal(force) => {
                    put(spool.row(column + 1), element, force.iter().copied());
                }
                Forces::Vector(force) => {
                    let numbers = force.iter().flat_map(|f| f.to_array());
                    put(spool.row(column + 1), element, numbers);
                }
            }
            put(spool.row(column + 2), Element::Double, seven(&patch.pose));
            column += 3;
        }
        for pose in objects {
            put(spool.row(column), Element::Double, seven(pose));
            column += 1;
        }
        spool.end_row()
    }

    fn check(&self, time: f64, patches: &[PatchFrame], objects: &[Pose]) -> Result<()> {
        if !(time.is_finite() && time > self.last_time) {
            let (frame, last) = (self.spool.n_rows(), self.last_time);
            return Err(Error::input(
                format!("recording, frame {frame}"),
                format!("{time} s after {last} s"),
                "finite times that increase",
            ));
        }
        let expected = (self.header.patches.len(), self.header.objects.len());
        if (patches.len(), objects.len()) != expected {
            return Err(Error::input(
                "recording",
                format!("{} patches and {} objects", patches.len(), objects.len()),
                format!("{} patches and {} objects", expected.0, expected.1),
            ));
        }
        let mut pairs = self.header.patches.iter().zip(patches);
        pairs.try_for_each(|(patch, frame)| check_frame(patch, frame))
    }

    /// Puts the recording together and in its place; returns how many frames it has.
    pub fn finish(mut self) -> Result<usize> {
        self.spool.end_block()?;
        let Self {
            header,
            streams,
            target,
            spool,
            ..
        } = &mut self;
        target.write(|file| assemble(header, streams, spool, file))?;
        let n_frames = self.spool.n_rows();
        self.target.commit()?;
        Ok(n_frames)
    }
}

fn check_frame(patch: &RecordedPatch, frame: &PatchFrame) -> Result<()> {
    let (kind, n_forces) = match frame.force {
        Forces::Normal(force) => (ForceKind::Normal, force.len()),
        Forces::Vector(force) => (ForceKind::Vector, force.len()),
    };
    let (n, n_deflections) = (patch.n_taxels(), frame.deflection.len());
    if (n_deflections, n_forces, kind) == (n, n, patch.force) {
        return Ok(());
    }
    Err(Error::input(
        format!("recording, patch {}", patch.name),
        format!("{n_deflections} deflections and {n_forces} forces ({kind:?})"),
        format!("{n} of each, forces {:?}", patch.force),
    ))
}

/// Position and quaternion as they are stored.
fn seven(pose: &Pose) -> [f64; 7] {
    let (t, q) = (pose.translation, pose.rotation);
    [t.x, t.y, t.z, q.x, q.y, q.z, q.w]
}

/// Fills a row.
fn put(row: &mut [u8], element: Element, values: impl IntoIterator<Item = f64>) {
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

fn assemble(
    header: &RecordingHeader,
    streams: &[Stream],
    spool: &mut Spool,
    file: &mut BufWriter<File>,
) -> io::Result<()> {
    let mut archive = ZipWriter::new(file);
    if let Err(error) = write_members(header, streams, spool, &mut archive) {
        // Dropped, it would try to finish the archive and say on standard error that it cannot.
        std::mem::forget(archive);
        return Err(error);
    }
    archive.finish()?.flush()
}

fn write_members(
    header: &RecordingHeader,
    streams: &[Stream],
    spool: &mut Spool,
    archive: &mut ZipWriter<&mut BufWriter<File>>,
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
    start(archive, "meta", &meta)?;
    archive.write_all(&code_points)?;
    for patch in &header.patches {
        for (name, vectors) in [("centers", &patch.centers), ("axes", &patch.axes)] {
            let array = NpyHeader {
                element: Element::Double,
                shape: vec![vectors.len(), 3],
            };
            start(archive, &format!("{}/{name}", patch.name), &array)?;
            let mut bytes = vec![0; 24 * vectors.len()];
            let numbers = vectors.iter().flat_map(|v| v.to_array());
            put(&mut bytes, Element::Double, numbers);
            archive.write_all(&bytes)?;
        }
    }
    for (column, stream) in streams.iter().enumerate() {
        let array = NpyHeader {
            element: stream.element,
            shape: stream.shape(spool.n_rows()),
        };
        start(archive, &stream.name, &array)?;
        spool.copy_column(column, archive)?;
    }
    archive.flush()
}

/// Starts a member; its time stamp is always the same, so that equal recordings are equal bytes.
fn start(
    archive: &mut ZipWriter<&mut BufWriter<File>>,
    name: &str,
    array: &NpyHeader,
) -> io::Result<()> {
    let header = array.bytes();
    let n_bytes = array.n_bytes().unwrap_or(usize::MAX);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .large_file(n_bytes as u64 + header.len() as u64 >= u64::from(u32::MAX));
    archive.start_file(format!("{name}.npy"), options)?;
    archive.write_all(&header)
}
