//! The writer: frames in as they come, an `.npz` out at the end.

use super::archive::Archive;
use super::block::Block;
use super::header::{ForceKind, RecordedPatch, RecordingHeader, Stream};
use super::members::{begin, first_stream, put};
use super::npy::Element;
use crate::error::{Error, Result};
use crate::files::WholeFile;
use crate::geometry::Pose;
use glam::DVec3;
use std::io::{self, Write};
use std::path::Path;

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
/// It holds about 2 MiB of rows in memory, whatever the number of frames (a frame, if that is larger), and writes each byte once, to
/// its place: so the number of frames is to be known when it begins.
pub struct RecordingWriter {
    header: RecordingHeader,
    target: WholeFile,
    block: Block,
    archive: Archive,
    n_frames: usize,
    /// A block was written in part: what is behind it is not known.
    is_broken: bool,
    last_time: f64,
}

impl RecordingWriter {
    /// Starts a recording of `n_frames` frames that will stand at `path`.
    ///
    /// # Errors
    /// What [`RecordingHeader::check`] says, or why nothing can be written there.
    pub fn create(path: &Path, header: RecordingHeader, n_frames: usize) -> Result<Self> {
        header.check()?;
        let mut target = WholeFile::create(path)?;
        let mut archive = Archive::default();
        target.write(|file| begin(&header, n_frames, &mut archive, file))?;
        let streams = header.streams();
        Ok(Self {
            block: Block::new(streams.iter().map(Stream::row_bytes).collect()),
            header,
            target,
            archive,
            n_frames,
            is_broken: false,
            last_time: f64::NEG_INFINITY,
        })
    }

    /// Adds a frame: `time` in seconds, then each patch and each object (world from object) in the header's order.
    ///
    /// The error names a time that does not increase, or a number of patches, objects, deflections or forces that is not the
    /// header's, or a frame beyond those that it was started for; the frame is then not in the recording.
    pub fn push(&mut self, time: f64, patches: &[PatchFrame], objects: &[Pose]) -> Result<()> {
        self.check(time, patches, objects)?;
        self.last_time = time;
        let element = Element::Single;
        let block = &mut self.block;
        put(block.row(0), Element::Double, [time]);
        let mut column = 1;
        for patch in patches {
            put(block.row(column), element, patch.deflection.iter().copied());
            match patch.force {
                Forces::Normal(force) => {
                    put(block.row(column + 1), element, force.iter().copied());
                }
                Forces::Vector(force) => {
                    let numbers = force.iter().flat_map(|f| f.to_array());
                    put(block.row(column + 1), element, numbers);
                }
            }
            put(block.row(column + 2), Element::Double, seven(&patch.pose));
            column += 3;
        }
        for pose in objects {
            put(block.row(column), Element::Double, seven(pose));
            column += 1;
        }
        if block.end_row() {
            return self.end_block();
        }
        Ok(())
    }

    fn check(&self, time: f64, patches: &[PatchFrame], objects: &[Pose]) -> Result<()> {
        if !(time.is_finite() && time > self.last_time) {
            let (frame, last) = (self.block.n_rows(), self.last_time);
            return Err(Error::input(
                format!("recording, frame {frame}"),
                format!("{time} s after {last} s"),
                "finite times that increase",
            ));
        }
        if self.block.n_rows() == self.n_frames {
            return Err(self.other_count(self.n_frames + 1));
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

    fn other_count(&self, given: usize) -> Error {
        Error::input("recording", format!("{given} frames"), self.n_frames)
    }

    /// Writes what waits in memory. After an error, always an error.
    fn end_block(&mut self) -> Result<()> {
        let was_broken = std::mem::replace(&mut self.is_broken, true);
        let first = first_stream(&self.header);
        let (block, archive) = (&self.block, &mut self.archive);
        self.target.write(|file| {
            if was_broken {
                let lost = "rows were lost when writing failed before";
                return Err(io::Error::other(lost));
            }
            let mut columns = block.columns().iter().enumerate();
            columns.try_for_each(|(column, rows)| archive.append(file, first + column, rows))
        })?;
        self.block.clear();
        self.is_broken = false;
        Ok(())
    }

    /// Puts the recording in its place; returns how many frames it has.
    ///
    /// # Errors
    /// Why it cannot be written, or a number of frames that is not the one that it was started for.
    pub fn finish(mut self) -> Result<usize> {
        let n_frames = self.block.n_rows();
        if n_frames != self.n_frames {
            return Err(self.other_count(n_frames));
        }
        self.end_block()?;
        let archive = &self.archive;
        self.target.write(|file| {
            archive.finish(file)?;
            file.flush()
        })?;
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
