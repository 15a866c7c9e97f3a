//! A study's touches as files, for people who train elsewhere: NumPy arrays and CSV, streamed.
//!
//! | file | holds |
//! |---|---|
//! | `frames.npy` | n × ny × nx, f32, metres of deflection, without noise; or as a cell reads them |
//! | `labels.npy` | n, i64: the object's number |
//! | `poses.npy` | n × 7, f64: the object in the patch frame when it is read: x, y, z in metres, quaternion x, y, z, w |
//! | `depths.npy` | n, f64: metres past first contact |
//! | `touches.csv` | one row a touch: object, resting pose, offset, yaw, tilts, depth, taxels touched and saturated |
//! | `objects.csv` | one row an object: number, name, spheres (0 of a mesh), touches |
//!
//! Deflections are what the press gives: no noise, no smoothing, none of the sensor errors of `[signal]`. Frames as a cell reads them
//! ([`ReadFrames`]) have all of these, in metres or, with the step `force`, in newtons; only `frames.npy` differs.

use super::content_hash::bytes_of_numbers;
use super::feature_files::{find, measured};
use super::plan::Plan;
use super::progress::Progress;
use super::simulation::describe;
use super::simulation::touch_stream;
use super::sweep::{Group, Sweep};
use super::touch_set::TouchSet;
use crate::contact::{Workspace, press_to_depth};
use crate::error::Result;
use crate::files::{CsvFile, WholeFile};
use crate::objects::Object;
use crate::random::Seed;
use crate::sensing::Ensemble;
use crate::world::{Patch, Placement, RestPose, Scene, Touch, TouchSource};
use ndarray::Array2;
use ndarray_npy::{WritableElement, write_zeroed_npy};
use rayon::prelude::*;
use serde::Serialize;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

/// Touches simulated before they are written: all that is held in memory at once.
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
struct Reading {
    frame: Vec<f32>,
    /// Translation and quaternion.
    pose: [f64; 7],
    n_touched: usize,
    n_saturated: usize,
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
        plan: &Plan,
        sweep: &Sweep,
        touched: &dyn TouchSet,
        (cell, trial): (usize, usize),
        progress: &dyn Progress,
    ) -> Result<Self> {
        let (group, cell) = find(sweep, cell)?;
        let split = sweep.split(plan, cell, trial)?;
        // What the identity measures are the frames themselves.
        let identity = Group {
            ensemble: Ensemble::Identity,
            ..group.clone()
        };
        let n_taxels = plan.arrays[group.array].grid.n_taxels();
        let of = (touched, &identity, n_taxels);
        let read = measured(plan, of, (trial, &split), ("read", progress))?;
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

/// Simulates all touches of an array and writes them into a folder that exists, with frames as they were `read` if these are given;
/// returns how many.
///
/// # Errors
/// What [`TouchSource::new`] refuses; a file that cannot be written.
pub fn write_touches(
    folder: &Path,
    objects: &[Object],
    placement: &Placement,
    (seed, patch): (&Seed, &Patch),
    read: Option<&ReadFrames>,
    progress: &dyn Progress,
) -> Result<usize> {
    let rests: Vec<Vec<RestPose>> = objects
        .par_iter()
        .map(|object| placement.rest.of(&object.model))
        .collect();
    let sources = objects
        .iter()
        .zip(&rests)
        .map(|(object, rests)| TouchSource::new(placement, rests, &touch_stream(seed, object)))
        .collect::<Result<Vec<_>>>()?;
    let n_touches = sources.iter().map(TouchSource::n_touches).sum();
    progress.stage(&format!("touch {}", describe(patch)), n_touches as u64);
    let mut files = TouchFiles::create(folder, n_touches, patch)?;
    let mut table = CsvFile::create(&folder.join("objects.csv"))?;
    for (label, ((object, rests), source)) in objects.iter().zip(&rests).zip(&sources).enumerate() {
        table.row(ObjectRow {
            label,
            object: &object.name,
            n_spheres: object.model.n_spheres(),
            n_touches: source.n_touches(),
        })?;
        let scene = Scene::of_one(patch, &object.model);
        for first in (0..source.n_touches()).step_by(BLOCK) {
            let numbers = first..source.n_touches().min(first + BLOCK);
            let n_block = numbers.len() as u64;
            let mut block: Vec<(Touch, Reading)> = numbers
                .into_par_iter()
                .map_init(Workspace::new, |workspace, number| {
                    let touch = source.touch(number);
                    let reading = pressed(&scene, &rests[touch.rest], &touch, workspace);
                    (touch, reading)
                })
                .collect();
            for (touch, reading) in &mut block {
                if let Some(read) = read {
                    reading.frame = read.frame(files.n_written);
                }
                files.add(label, &object.name, touch, reading)?;
            }
            progress.advance(n_block);
        }
    }
    table.commit()?;
    files.commit()?;
    Ok(n_touches)
}

fn pressed(scene: &Scene, rest: &RestPose, touch: &Touch, workspace: &mut Workspace) -> Reading {
    let mut pose = touch.patch_from_object(rest);
    let contact = press_to_depth(scene, &[pose], touch.depth, workspace);
    pose.translation.z -= contact.map_or(0.0, |c| c.travel);
    let (t, q) = (pose.translation, pose.rotation);
    Reading {
        frame: workspace.deflections().iter().map(|&d| d as f32).collect(),
        pose: [t.x, t.y, t.z, q.x, q.y, q.z, q.w],
        n_touched: contact.map_or(0, |c| c.n_touched),
        n_saturated: contact.map_or(0, |c| c.n_saturated),
    }
}

/// The files with one entry a touch.
struct TouchFiles {
    /// Frames, labels, poses, depths.
    arrays: [WholeFile; 4],
    table: CsvFile,
    n_written: usize,
}

impl TouchFiles {
    fn create(folder: &Path, n: usize, patch: &Patch) -> Result<Self> {
        let shape = [n, patch.grid.ny, patch.grid.nx];
        Ok(Self {
            arrays: [
                start_npy::<f32>(&folder.join("frames.npy"), &shape)?,
                start_npy::<i64>(&folder.join("labels.npy"), &[n])?,
                start_npy::<f64>(&folder.join("poses.npy"), &[n, 7])?,
                start_npy::<f64>(&folder.join("depths.npy"), &[n])?,
            ],
            table: CsvFile::create(&folder.join("touches.csv"))?,
            n_written: 0,
        })
    }

    fn add(&mut self, label: usize, object: &str, touch: &Touch, reading: &Reading) -> Result<()> {
        let entries: [Vec<u8>; 4] = [
            reading.frame.iter().flat_map(|v| v.to_le_bytes()).collect(),
            (label as i64).to_le_bytes().to_vec(),
            bytes_of_numbers(reading.pose),
            bytes_of_numbers([touch.depth]),
        ];
        for (file, entry) in self.arrays.iter_mut().zip(entries) {
            file.write(|writer| writer.write_all(&entry))?;
        }
        self.table.row(TouchRow {
            touch: self.n_written,
            label,
            object,
            rest: touch.rest,
            offset_x_mm: 1e3 * touch.offset[0],
            offset_y_mm: 1e3 * touch.offset[1],
            yaw_deg: touch.yaw.to_degrees(),
            tilt_x_deg: touch.tilt[0].to_degrees(),
            tilt_y_deg: touch.tilt[1].to_degrees(),
            depth_mm: 1e3 * touch.depth,
            n_touched: reading.n_touched,
            n_saturated: reading.n_saturated,
        })?;
        self.n_written += 1;
        Ok(())
    }

    fn commit(self) -> Result<()> {
        self.arrays.into_iter().try_for_each(WholeFile::commit)?;
        self.table.commit()
    }
}

/// Starts an array file: its header now, its data (little-endian, row by row) as it comes.
fn start_npy<A: WritableElement>(path: &Path, shape: &[usize]) -> Result<WholeFile> {
    let mut file = WholeFile::create(path)?;
    file.write(|writer| {
        write_zeroed_npy::<A, _>(writer.get_ref(), shape).map_err(io::Error::other)?;
        let n_bytes = shape.iter().product::<usize>() * size_of::<A>();
        writer.seek(SeekFrom::End(-(n_bytes as i64))).map(|_| ())
    })?;
    Ok(file)
}
