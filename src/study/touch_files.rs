//! A study's touches as files, for people who train elsewhere: NumPy arrays and CSV, streamed.
//!
//! | file | holds |
//! |---|---|
//! | `frames.npy` | n × ny × nx (1 × n_taxels of layouts without rows), f32, metres of deflection, without noise; or as a cell reads them; with `skin.sensed = "shear"` n × 3 × ny × nx, the second and third in newtons |
//! | `labels.npy` | n, i64: the object's number |
//! | `poses.npy` | n × 7, f64: the object in the patch frame when it is read: x, y, z in metres, quaternion x, y, z, w |
//! | `depths.npy` | n, f64: metres past first contact |
//! | `taxels.npy` | n_taxels × 6, f64, of layouts that are no grid: rest centres (metres) and axes in the patch frame |
//! | `touches.csv` | one row a touch: object, resting pose, offset, yaw, tilts, depth, taxels touched and saturated |
//! | `objects.csv` | one row an object: number, name, spheres (0 of a mesh), touches |
//!
//! Deflections are what the press gives: no noise, no smoothing, none of the sensor errors of `[signal]`. Frames as a cell reads them
//! ([`ReadFrames`]) have all of these, in metres or, with the step `force`, in newtons; only `frames.npy` differs.

use super::array_press::{ArrayPress, ArrayWorkspace};
use super::feature_files::find;
use super::npy::NpyFile;
use super::progress::Progress;
use super::simulation::touch_stream;
use super::sweep::{Group, StudyPart};
use super::taxel_array::TaxelArray;
use crate::error::Result;
use crate::files::CsvFile;
use crate::objects::Object;
use crate::random::Seed;
use crate::sensing::Ensemble;
use crate::world::{ArrayLayout, Placement, RestPose, Touch, TouchSource};
use ndarray::Array2;
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// Frames simulated before they are written: all of them that are held in memory at once.
const BLOCK: usize = 256;

#[derive(Serialize)]
struct TouchRow<'a> {
    touch: usize,
    label: usize,
    object: &'a str,
    rest: usize,
    offset_x_mm: f64,
    offset_y_mm: f64,
    yaw_deg: f64,
    tilt_x_deg: f64,
    tilt_y_deg: f64,
    depth_mm: f64,
    n_touched: usize,
    n_saturated: usize,
}

#[derive(Serialize)]
struct ObjectRow<'a> {
    label: usize,
    object: &'a str,
    n_spheres: usize,
    n_touches: usize,
}

/// One touch as it goes into the files.
struct Reading<'a> {
    row: TouchRow<'a>,
    frame: Vec<f32>,
    /// Translation and quaternion.
    pose: [f64; 7],
    /// Metres past first contact.
    depth: f64,
}

/// The deepest frame of every touch as a cell reads it in one trial: what its measurements are made of.
pub struct ReadFrames {
    /// The cell's array, by its number in the plan.
    pub array: usize,
    /// n_touches · F rows of n_taxels; the deepest frame of a touch is the last of its F.
    values: Array2<f64>,
    n_frames: usize,
}

impl ReadFrames {
    /// Simulates and reads all touches; held in memory at once.
    ///
    /// # Errors
    /// A cell or a trial that the study does not have; what a signal step refuses.
    pub fn of_cell(
        part: &StudyPart,
        (cell, trial): (usize, usize),
        progress: &dyn Progress,
    ) -> Result<Self> {
        let (group, cell) = find(&part.sweep, cell)?;
        part.sweep.split(&part.plan, cell, trial)?;
        // What the identity measures are the frames themselves.
        let identity = Group {
            ensemble: Ensemble::Identity,
            ..group.clone()
        };
        let of = (&identity, part.plan.arrays[group.array].n_values());
        let read = part.measured(of, trial, ("read", progress))?;
        Ok(Self {
            array: group.array,
            values: read.values,
            n_frames: group.frames,
        })
    }

    fn frame(&self, touch: usize) -> Vec<f32> {
        let deepest = self.values.row((touch + 1) * self.n_frames - 1);
        deepest.iter().map(|&value| value as f32).collect()
    }
}

/// Simulates all touches of an array, drawn a block at a time, and writes them into a folder that exists, with frames as they were `read`
/// if these are given; returns how many.
///
/// # Errors
/// What [`TouchSource::new`] refuses; a file that cannot be written.
pub fn write_touches(
    folder: &Path,
    objects: &[Object],
    (placement, seed): (&Placement, &Seed),
    array: &TaxelArray,
    read: Option<&ReadFrames>,
    progress: &dyn Progress,
) -> Result<usize> {
    let rests = objects.par_iter();
    let rests: Vec<_> = rests.map(|o| placement.rest.of(&o.model)).collect();
    let sources = objects.iter().zip(&rests);
    let sources =
        sources.map(|(o, rests)| TouchSource::new(placement, rests, &touch_stream(seed, o)));
    let sources = sources.collect::<Result<Vec<_>>>()?;
    let n_touches = sources.iter().map(TouchSource::n_touches).sum();
    progress.stage(&format!("touch {}", array.describe()), n_touches as u64);
    let file = |name: &str, descr, shape: &[usize]| {
        let shape = [&[n_touches], shape].concat();
        NpyFile::create(&folder.join(name), descr, &shape)
    };
    let (ny, nx) = array.shape();
    let n_channels = array.sensed().n_channels();
    let shape = [n_channels, ny, nx];
    let shape = if n_channels > 1 {
        &shape[..]
    } else {
        &shape[1..]
    };
    let mut frames = file("frames.npy", "<f4", shape)?;
    let mut labels = file("labels.npy", "<i8", &[])?;
    let mut poses = file("poses.npy", "<f8", &[7])?;
    let mut depths = file("depths.npy", "<f8", &[])?;
    let mut n_before = 0;
    let mut table = CsvFile::create(&folder.join("touches.csv"))?;
    let mut rows = CsvFile::create(&folder.join("objects.csv"))?;
    for (label, ((object, rests), source)) in objects.iter().zip(&rests).zip(&sources).enumerate() {
        rows.row(ObjectRow {
            label,
            object: &object.name,
            n_spheres: object.model.n_spheres(),
            n_touches: source.n_touches(),
        })?;
        let press = array.press(&object.model);
        for first in (0..source.n_touches()).step_by(BLOCK) {
            let block = first..source.n_touches().min(first + BLOCK);
            let read_one = |workspace: &mut ArrayWorkspace, number| {
                let named = (n_before + number, label, object.name.as_str());
                pressed((&press, rests), named, &source.touch(number), workspace)
            };
            let readings = block.clone().into_par_iter();
            let readings = readings.map_init(ArrayWorkspace::default, read_one);
            let readings: Vec<_> = readings.collect();
            for reading in readings {
                labels.push([(label as i64).to_le_bytes()])?;
                poses.push(reading.pose.map(f64::to_le_bytes))?;
                depths.push([reading.depth.to_le_bytes()])?;
                let frame = read.map_or(reading.frame, |read| read.frame(reading.row.touch));
                frames.push(frame.into_iter().map(f32::to_le_bytes))?;
                table.row(reading.row)?;
            }
            progress.advance(block.len() as u64);
        }
        n_before += source.n_touches();
    }
    for file in [frames, labels, poses, depths] {
        file.commit()?;
    }
    write_taxels(folder, array)?;
    table.commit()?;
    rows.commit()?;
    Ok(n_touches)
}

/// Where the taxels of a layout are that is no grid, and their axes.
fn write_taxels(folder: &Path, array: &TaxelArray) -> Result<()> {
    if array.layout() == ArrayLayout::Grid {
        return Ok(());
    }
    let layout = array.patch().layout();
    let (centers, axes) = (layout.centers(), layout.axes());
    let mut file = NpyFile::create(&folder.join("taxels.npy"), "<f8", &[centers.len(), 6])?;
    for (center, axis) in centers.iter().zip(axes) {
        let numbers = center.to_array().into_iter().chain(axis.to_array());
        file.push(numbers.map(f64::to_le_bytes))?;
    }
    file.commit()
}

/// Presses a touch, of which the number, the label and the name of its object are known.
fn pressed<'a>(
    (press, rests): (&ArrayPress, &[RestPose]),
    (number, label, object): (usize, usize, &'a str),
    touch: &Touch,
    workspace: &mut ArrayWorkspace,
) -> Reading<'a> {
    let pose = touch.patch_from_object(&rests[touch.rest]);
    let contact = press.touch(pose, (touch.depth, 1.0), workspace);
    let pose = press.end(pose, contact);
    let (t, q) = (pose.translation, pose.rotation);
    Reading {
        row: TouchRow {
            touch: number,
            label,
            object,
            rest: touch.rest,
            offset_x_mm: 1e3 * touch.offset[0],
            offset_y_mm: 1e3 * touch.offset[1],
            yaw_deg: touch.yaw.to_degrees(),
            tilt_x_deg: touch.tilt[0].to_degrees(),
            tilt_y_deg: touch.tilt[1].to_degrees(),
            depth_mm: 1e3 * touch.depth,
            n_touched: contact.map_or(0, |c| c.n_touched),
            n_saturated: contact.map_or(0, |c| c.n_saturated),
        },
        frame: press.values(workspace).map(|value| value as f32).collect(),
        pose: [t.x, t.y, t.z, q.x, q.y, q.z, q.w],
        depth: touch.depth,
    }
}
