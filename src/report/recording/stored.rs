//! A whole recording in memory.

use super::header::{RecordedPatch, RecordingHeader};
use super::reader::RecordingFile;
use crate::error::Result;
use crate::geometry::Pose;
use ndarray::{Array1, Array2, Array3};
use std::path::Path;

/// A recording as plain arrays.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredRecording {
    /// What it is of.
    pub header: RecordingHeader,
    /// n_frames, seconds.
    pub time: Array1<f64>,
    /// What each patch felt, in the header's order.
    pub patches: Vec<StoredPatch>,
    /// World from object, one a frame, in the header's order.
    pub objects: Vec<Vec<Pose>>,
}

/// What one patch felt.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredPatch {
    /// n_frames × n_taxels, metres.
    pub deflection: Array2<f64>,
    /// n_frames × n_taxels × 1 (along the axes) or × 3 (patch frame), newtons.
    pub force: Array3<f64>,
    /// World from patch, one a frame.
    pub pose: Vec<Pose>,
}

/// Reads a whole recording: 8 bytes of memory a number, twice what a file of f32 takes on disk.
///
/// Errors as those of [`RecordingFile::open`], or a member whose checksum is not that of its bytes.
pub fn read_recording(path: &Path) -> Result<StoredRecording> {
    let mut file = RecordingFile::open(path)?;
    let header = file.header().clone();
    let patches = header.patches.iter();
    let patches = patches
        .map(|patch| read_patch(&mut file, patch))
        .collect::<Result<_>>()?;
    let objects = header.objects.iter().map(|name| file.poses(name));
    let objects = objects.collect::<Result<_>>()?;
    Ok(StoredRecording {
        time: file.time().to_vec().into(),
        patches,
        objects,
        header,
    })
}

fn read_patch(file: &mut RecordingFile, patch: &RecordedPatch) -> Result<StoredPatch> {
    let (n_frames, n) = (file.time().len(), patch.n_taxels());
    let mut numbers = |member: &str| -> Result<Vec<f64>> {
        let mut numbers = Vec::new();
        file.each_row(&format!("{}/{member}", patch.name), |_, row| {
            numbers.extend_from_slice(row);
        })?;
        Ok(numbers)
    };
    let (deflection, force) = (numbers("deflection")?, numbers("force")?);
    let shape = (n_frames, n, patch.force.n_components());
    Ok(StoredPatch {
        deflection: Array2::from_shape_vec((n_frames, n), deflection)
            .expect("the file has checked its shape"),
        force: Array3::from_shape_vec(shape, force).expect("the file has checked its shape"),
        pose: file.poses(&patch.name)?,
    })
}
