//! Export of the touches of a study as NumPy arrays and CSV files, written block by block.
//!
//! | file | content |
//! |---|---|
//! | `frames.npy` | n × ny × nx (1 × n_taxels of layouts without rows), f32, metres of deflection, without noise; or as a configuration reads them; n × F × ny × nx for touches of F frames |
//! | `shear.npy` | with `skin.sensed = "shear"` n × 2 × ny × nx (n × F × 2 × ny × nx), f32: the forces across the axis of each taxel, along x and y of its frame, newtons |
//! | `labels.npy` | n, i64: the object's number |
//! | `poses.npy` | n × 7, f64: the pose of the object in the patch frame at the time of reading: x, y, z in metres, unit quaternion w, x, y, z |
//! | `depths.npy` | n, f64: metres past first contact |
//! | `taxels.npy` | n_taxels × 6, f64, for layouts other than the grid: rest centres (metres) and axes in the patch frame |
//! | `touches.csv` | one row per touch: object, resting pose, offset, yaw, tilts, depth, taxels touched and saturated |
//! | `recorded.toml` | `[recorded]` and `[skin]` of an equivalent study that trains on these files; not for frames as a configuration reads them |
//! | `objects.csv` | one row per object: number, name, spheres (0 for a mesh), touches |
//!
//! Deflections are the direct result of the press: without noise, smoothing or any sensor error of `[signal]`. Frames as a configuration reads them
//! ([`ReadFrames`]) include all of these steps. These frames are in metres or, with the step `force`, in newtons; only `frames.npy` differs. With `skin.sensed
//! = "shear"` a configuration reads three forces: `frames.npy` then has 3 × ny × nx newtons per frame, and there is no `shear.npy`.

use crate::files::{CsvFile, write_bytes};
use crate::inputs::npy::{NpyFile, write_integers, write_npy};
use crate::studies::prelude::*;
use crate::studies::recognition::exports::find;
use crate::studies::recognition::frames::{ArrayPress, ArrayWorkspace, HumanTouches, TouchSet};
use crate::studies::recognition::plan::{Sensed, as_written};
use crate::studies::recognition::spec::{HumanTouchSpec, PreviousTouch};
use crate::studies::recognition::sweep::{StudyPart, TrainingRows};
use crate::studies::recognition::touches::touch_stream;
use crate::world::{ArrayLayout, RestPose, TouchSource};
use ndarray::Array2;
use rayon::prelude::*;
use std::path::Path;

/// Number of frames that are simulated and kept in memory before they are written to a file.
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

/// Touch to write to files: its frames, pose and depth.
struct Reading<'a> {
    row: TouchRow<'a>,
    /// Values of the F frames of the touch, one frame after the other.
    frames: Vec<f32>,
    /// Pose of the object in the patch frame: translation x, y, z in metres, and unit quaternion w, x, y, z.
    pose: [f64; 7],
    /// Distance that the patch travels past first contact, metres.
    depth: f64,
}

/// Deepest frame of every touch in one trial, after the signal chain of a configuration and before compression.
pub struct ReadFrames {
    /// Frame values, shape (n_touches · F, n_taxels), with F frames per touch; the last frame of a touch is the deepest.
    values: Array2<f64>,
    n_frames: usize,
    /// Whether the values are forces in newtons; otherwise they are deflections in metres.
    pub is_force: bool,
}

impl ReadFrames {
    /// Simulates all touches and applies a configuration's signal chain. The resulting frames of all touches are kept in memory.
    ///
    /// # Errors
    /// If the study does not have the configuration or the trial, or a signal step is invalid.
    pub fn of_cell(
        part: &StudyPart,
        (configuration, trial): (usize, usize),
        progress: &dyn Progress,
    ) -> Result<Self> {
        let (group, _) = find(&part.sweep, configuration)?;
        part.sweep.trial(&part.plan, trial)?;
        // Measurements with the identity matrix are the frames themselves.
        let identity = MeasurementGroup {
            ensemble: Ensemble::Identity,
            selection: None,
            ..group.clone()
        };
        let n_values = part.plan.array.n_values();
        let of = (&identity, TrainingRows::default(), n_values);
        let read = part.measured(of, trial, ("read", progress))?;
        Ok(Self {
            values: read.values,
            n_frames: group.frames,
            is_force: *part.plan.array.sensed() != Sensed::Deflection
                || part.plan.spec.signal.steps.contains(&StepSpec::Force),
        })
    }

    fn frame(&self, touch: usize) -> Vec<f32> {
        let deepest = self.values.row((touch + 1) * self.n_frames - 1);
        deepest.iter().map(|&value| value as f32).collect()
    }
}

/// Names of all touch files that the folder of an array may contain.
pub const TOUCH_FILES: [&str; 9] = [
    FRAMES,
    SHEAR,
    "labels.npy",
    "poses.npy",
    "depths.npy",
    "taxels.npy",
    "touches.csv",
    "objects.csv",
    "recorded.toml",
];
const FRAMES: &str = "frames.npy";
const SHEAR: &str = "shear.npy";

/// Returns the quantity and the unit of each channel in each frame file, as JSON.
pub fn touch_units(
    array: &TaxelArray,
    is_force: Option<bool>,
) -> Vec<(&'static str, serde_json::Value)> {
    let first = match is_force {
        Some(true) => ("force", "N"),
        _ => ("deflection", "m"),
    };
    let across = [("shear force along x", "N"), ("shear force along y", "N")];
    let across = &across[..array.sensed().n_channels() - 1];
    let facts = |channels: &[(&str, &str)]| {
        let (quantities, units): (Vec<&str>, Vec<&str>) = channels.iter().copied().unzip();
        serde_json::json!({"quantity": quantities, "unit": units})
    };
    match (across, is_force) {
        ([], _) => vec![(FRAMES, facts(&[first]))],
        (_, None) => vec![(FRAMES, facts(&[first])), (SHEAR, facts(across))],
        (_, Some(_)) => vec![(FRAMES, facts(&[&[first], across].concat()))],
    }
}

/// Open frame files: one file for each quantity, or a single file for frames after the signal chain.
struct FrameFiles {
    frames: NpyFile,
    shear: Option<NpyFile>,
    /// Number of values that a frame has.
    n_values: usize,
    /// Number of values of a frame that are written to the array `frames`; the remaining values are written to `shear`.
    n_first: usize,
}

impl FrameFiles {
    fn create(
        folder: &Path,
        (array, n_frames): (&TaxelArray, usize),
        n_touches: usize,
        is_read: bool,
    ) -> Result<Self> {
        let file = |name: &str, n_channels| {
            let (_, shape) = frames_shape(array, n_frames, n_channels);
            let shape = [&[n_touches][..], &shape].concat();
            NpyFile::create(&folder.join(name), "<f4", &shape)
        };
        let n_channels = array.sensed().n_channels();
        let n_first = if is_read { n_channels } else { 1 };
        let shear = (n_first < n_channels).then(|| file(SHEAR, n_channels - n_first));
        Ok(Self {
            frames: file(FRAMES, n_first)?,
            shear: shear.transpose()?,
            n_values: array.n_values(),
            n_first: n_first * array.n_taxels(),
        })
    }

    /// Appends frames to the files; each channel is written to its file.
    fn push(&mut self, frames: &[f32]) -> Result<()> {
        for frame in frames.chunks(self.n_values) {
            let (first, across) = frame.split_at(self.n_first);
            self.frames
                .push(first.iter().map(|value| value.to_le_bytes()))?;
            if let Some(shear) = &mut self.shear {
                shear.push(across.iter().map(|value| value.to_le_bytes()))?;
            }
        }
        Ok(())
    }

    fn commit(self) -> Result<()> {
        let mut files = [Some(self.frames), self.shear].into_iter().flatten();
        files.try_for_each(NpyFile::commit)
    }
}

/// Simulates all touches of an array with F frames each, writes them into an existing folder, and returns their number. If `read` is given, its frames are
/// written in place of the deflections.
///
/// # Errors
/// If the touches cannot be simulated or a file cannot be written.
pub fn write_touches(
    folder: &Path,
    objects: &[Object],
    plan: &Plan,
    (array, n_frames): (&TaxelArray, usize),
    read: Option<&ReadFrames>,
    progress: &dyn Progress,
) -> Result<usize> {
    let (placement, seed) = (&plan.placement, &Seed::new(plan.spec.seed));
    let n_frames = if read.is_some() { 1 } else { n_frames };
    let rests = objects.par_iter();
    let rests: Vec<_> = rests.map(|o| placement.rest.poses(&o.model)).collect();
    let sources = objects.iter().zip(&rests);
    let sources =
        sources.map(|(o, rests)| TouchSource::new(placement, rests, &touch_stream(seed, o)));
    let sources = sources.collect::<Result<Vec<_>>>()?;
    let n_touches = sources.iter().map(TouchSource::n_touches).sum();
    progress.stage(&format!("touch {}", array.describe()), n_touches as u64);
    let mut frames = FrameFiles::create(folder, (array, n_frames), n_touches, read.is_some())?;
    let file = |name: &str, descr, shape: &[usize]| {
        let shape = [&[n_touches], shape].concat();
        NpyFile::create(&folder.join(name), descr, &shape)
    };
    let mut labels = file("labels.npy", "<i8", &[])?;
    let mut poses = file("poses.npy", "<f8", &[7])?;
    let mut depths = file("depths.npy", "<f8", &[])?;
    let mut n_before = 0;
    let mut table = CsvFile::create(&folder.join("touches.csv"))?;
    let mut rows = Vec::new();
    for (label, ((object, rests), source)) in objects.iter().zip(&rests).zip(&sources).enumerate() {
        rows.push(ObjectRow {
            label,
            object: &object.name,
            n_spheres: object.model.n_spheres(),
            n_touches: source.n_touches(),
        });
        let press = array.press(&object.model);
        for first in (0..source.n_touches()).step_by(BLOCK) {
            let block = first..source.n_touches().min(first + BLOCK);
            let read_one = |workspace: &mut ArrayWorkspace, number| {
                let named = (n_before + number, label, object.name.as_str());
                let touch = (&source.touch(number), n_frames);
                pressed((&press, rests), named, touch, workspace)
            };
            let readings = block.clone().into_par_iter();
            let readings = readings.map_init(ArrayWorkspace::default, read_one);
            let readings: Vec<_> = readings.collect();
            for reading in readings {
                labels.push([(label as i64).to_le_bytes()])?;
                poses.push(reading.pose.map(f64::to_le_bytes))?;
                depths.push([reading.depth.to_le_bytes()])?;
                let of_touch = read.map_or(reading.frames, |read| read.frame(reading.row.touch));
                frames.push(&of_touch)?;
                table.row(reading.row)?;
            }
            progress.advance(block.len() as u64);
        }
        n_before += source.n_touches();
    }
    frames.commit()?;
    for file in [labels, poses, depths] {
        file.commit()?;
    }
    write_taxels(folder, array)?;
    table.commit()?;
    write_objects(folder, rows)?;
    if read.is_none() {
        let recorded = RecordedSpec {
            depths: Some("depths.npy".into()),
            speed_mm_per_s: plan.spec.touches.speed_mm_per_s,
            ..recorded(
                array,
                n_frames,
                objects.iter().map(|object| object.name.clone()),
            )
        };
        write_recorded(folder, recorded, (&plan.spec.skin, array))?;
    }
    Ok(n_touches)
}

/// Simulates all human touches on an array, and writes their frames and labels into an existing folder. The frames have the shape (n, F, ny, nx), with F frames
/// per touch. Returns the number of touches.
///
/// # Errors
/// If a touch is longer than a recording, or a file cannot be written.
pub fn write_human_touches(
    folder: &Path,
    human: &HumanTouchSpec,
    plan: &Plan,
    array: &TaxelArray,
    progress: &dyn Progress,
) -> Result<usize> {
    let touches = HumanTouches::draw(human, &Seed::new(plan.spec.seed))?;
    let labels = touches.labels();
    let n_frames = human.n_frames();
    progress.stage(&format!("touch {}", array.describe()), labels.len() as u64);
    let made = touches.simulate((array, n_frames), progress);
    let mut frames = FrameFiles::create(folder, (array, n_frames), labels.len(), false)?;
    let mut row = vec![0.0; array.n_values()];
    for number in 0..labels.len() * n_frames {
        made.read(number, &mut row);
        let row: Vec<f32> = row.iter().map(|&value| value as f32).collect();
        frames.push(&row)?;
    }
    frames.commit()?;
    write_integers(&folder.join("labels.npy"), labels.to_vec())?;
    let classes = touches.classes().into_iter().enumerate();
    let rows = classes.map(|(label, (object, n_touches))| ObjectRow {
        label,
        object,
        n_spheres: 0,
        n_touches,
    });
    write_objects(folder, rows)?;
    let names = touches.class_names().into_iter().map(str::to_owned);
    let recorded = RecordedSpec {
        frame_interval_s: Some(human.interval()),
        previous_touch: PreviousTouch::None,
        ..recorded(array, n_frames, names)
    };
    write_recorded(folder, recorded, (&plan.spec.skin, array))?;
    Ok(labels.len())
}

/// Writes the table of the objects.
fn write_objects<'a>(folder: &Path, rows: impl IntoIterator<Item = ObjectRow<'a>>) -> Result<()> {
    let mut table = CsvFile::create(&folder.join("objects.csv"))?;
    rows.into_iter().try_for_each(|row| table.row(row))?;
    table.commit()
}

/// Returns the letters of the axes of a frame file, and the lengths of the axes for a single touch.
fn frames_shape(array: &TaxelArray, n_frames: usize, n_channels: usize) -> (String, Vec<usize>) {
    let ImageShape { ny, nx } = array.shape();
    let axes = [("t", n_frames), ("c", n_channels), ("y", ny), ("x", nx)];
    let is_written = |(letter, length): &(&str, usize)| "yx".contains(letter) || *length > 1;
    let (letters, shape): (Vec<&str>, Vec<usize>) = axes.into_iter().filter(is_written).unzip();
    (format!("n {}", letters.join(" ")), shape)
}

/// Returns the table `[recorded]` of a study that reads the exported frames of an array; paths are relative to the folder.
fn recorded(
    array: &TaxelArray,
    n_frames: usize,
    names: impl Iterator<Item = String>,
) -> RecordedSpec {
    RecordedSpec {
        frames: FRAMES.into(),
        shear: (array.sensed().n_channels() > 1).then(|| SHEAR.into()),
        labels: "labels.npy".into(),
        order: Some(frames_shape(array, n_frames, 1).0),
        names: Some(names.collect()),
        full_scale: Some(array.taxel().stroke),
        ..RecordedSpec::default()
    }
}

/// Writes `recorded.toml`, which contains the tables of a study of the exported files.
fn write_recorded(
    folder: &Path,
    recorded: RecordedSpec,
    (skin, array): (&SkinSpec, &TaxelArray),
) -> Result<()> {
    #[derive(Serialize)]
    struct Tables {
        recorded: RecordedSpec,
        skin: SkinSpec,
    }
    let is_grid = array.layout() == Some(ArrayLayout::Grid);
    let units = match recorded.shear {
        Some(_) => {
            "# frames.npy has deflections in metres, shear.npy the forces along x and y of each taxel in newtons."
        }
        None => "# frames.npy has deflections in metres.",
    };
    let tables = Tables {
        recorded,
        skin: SkinSpec {
            pitch_mm: millimetres(array.pitch()),
            size_mm: None,
            taxels: (!is_grid).then_some(array.grid().nx),
            ..skin.clone()
        },
    };
    let tables = toml::to_string(&tables).expect("every key has a TOML form");
    let text = format!(
        "# In place of [objects], [touches], [human_touch] and [skin] of the study that made these touches; --objects is this folder.\n{units}\n\n{tables}"
    );
    write_bytes(&folder.join("recorded.toml"), text.as_bytes())
}

/// Writes the positions and axes of the taxels, if the layout is not a grid.
fn write_taxels(folder: &Path, array: &TaxelArray) -> Result<()> {
    if array.layout() == Some(ArrayLayout::Grid) {
        return Ok(());
    }
    let layout = array.patch().layout();
    let taxels = layout.centers().iter().zip(layout.axes());
    let numbers = taxels.flat_map(|(center, axis)| [center.to_array(), axis.to_array()].concat());
    let numbers = Array2::from_shape_vec((layout.n_taxels(), 6), numbers.collect());
    let numbers = numbers.expect("six numbers a taxel");
    write_npy(&folder.join("taxels.npy"), &numbers)
}

/// Simulates one touch of an object. The touch is given by its number, its label and the name of the object.
fn pressed<'a>(
    (press, rests): (&ArrayPress, &[RestPose]),
    (number, label, object): (usize, usize, &'a str),
    (touch, n_frames): (&Touch, usize),
    workspace: &mut ArrayWorkspace,
) -> Reading<'a> {
    let pose = touch.patch_from_object(&rests[touch.rest]);
    let mut frames = Array2::zeros((n_frames, press.n_values()));
    let contact = press.write_frames(pose, touch.depth, frames.view_mut(), workspace);
    let pose = press.end(pose, contact);
    Reading {
        row: TouchRow {
            touch: number,
            label,
            object,
            rest: touch.rest,
            offset_x_mm: as_written(1e3 * touch.offset[0]),
            offset_y_mm: as_written(1e3 * touch.offset[1]),
            yaw_deg: as_written(touch.yaw.to_degrees()),
            tilt_x_deg: as_written(touch.tilt[0].to_degrees()),
            tilt_y_deg: as_written(touch.tilt[1].to_degrees()),
            depth_mm: as_written(1e3 * touch.depth),
            n_touched: contact.map_or(0, |c| c.n_touched),
            n_saturated: contact.map_or(0, |c| c.n_saturated),
        },
        frames: frames.into_iter().collect(),
        pose: pose.to_array(),
        depth: touch.depth,
    }
}
