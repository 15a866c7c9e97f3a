//! Recorded frames of a study, which replace simulated touches; the files are read once.
//!
//! A reading v corresponds to the deflection `stroke · (v − zero) / (full_scale − zero)`. Noise and sensor errors of a study are fractions of the full scale,
//! so they have the same effect as on a simulated skin. Readings of tangential forces are in newtons.

use crate::calibration::plateau;
use crate::contact::saturation_limit;
use crate::engine::progress::Progress;
use crate::error::{Error, Result};
use crate::inputs::arrays::axis_order::FrameShape;
use crate::inputs::arrays::file_array::{ElementKind, FileArray};
use crate::inputs::arrays::whole_numbers::{
    ClassLabels, KeyValue, group_keys, read_class_values, read_group_values,
};
use crate::inputs::memory::check_memory;
use crate::inputs::object_files::file_content;
use crate::learning::data::split::Side;
use crate::random::Seed;
use crate::report::pictures::snapshots::Snapshots;
use crate::signal::Quantity;
use crate::studies::recognition::frames::frame_store::Frames;
use crate::studies::recognition::frames::reading::{TouchToRead, touches_to_read};
use crate::studies::recognition::frames::samples::spread_samples;
use crate::studies::recognition::frames::touch_set::{Samples, TouchSet};
use crate::studies::recognition::plan::group::MeasurementGroup;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use crate::studies::recognition::spec::recorded::{PreviousTouch, RecordedSpec, ZeroSpec};
use ndarray::{Array1, Array2, ArrayView1, ArrayViewMut2, Axis, concatenate};
use rand::Rng;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// Fraction of missing (NaN) readings, 0 to 1, above which a taxel is masked. With a larger value, recordings with an intermittently failing taxel are
/// rejected; with a smaller value, a few missing readings mask a taxel.
const MASKED: f64 = 0.1;

/// Touches that a real skin recorded.
#[derive(Clone, Debug)]
pub struct RecordedFrames {
    /// Specification of the recording, from the table `[recorded]`.
    pub spec: RecordedSpec,
    /// Names of the classes, in the order of their labels.
    names: Vec<String>,
    /// Names from which the seeds of the random numbers of each class are derived.
    streams: Vec<String>,
    /// Number of touches of each class.
    counts: Vec<usize>,
    /// Recorded frames in two arrays: training touches (or all touches), and the separate test set.
    readings: [Array2<f64>; 2],
    /// Row index of each touch in the two arrays of frames; the touches are ordered by class.
    order: Vec<usize>,
    /// Whether each value of a frame belongs to a masked taxel.
    is_masked: Vec<bool>,
    /// Reading of each untouched taxel; 0 for a masked taxel.
    zeros: Vec<f64>,
    /// Reading of a taxel whose deflection equals its stroke.
    full_scale: f64,
    /// Reading above which a taxel of the recording counts as saturated.
    saturation: f64,
    /// Number F of frames per touch.
    n_frames: usize,
    /// Number of taxels of the skin; a frame may contain several values per taxel.
    n_taxels: usize,
    /// Group of each touch, in the order of the field `order`; `None` if the recording defines no groups.
    groups: Option<Array1<usize>>,
    /// Side (training or test) of each touch; `None` if the data do not define the split.
    sides: Option<Vec<Side>>,
    /// Press depth of each touch, metres; `None` if unknown.
    depths: Option<Vec<f64>>,
}

/// Frames that one file contains, and the shape of each frame.
struct FramesOfFile {
    shape: FrameShape,
    readings: Array2<f64>,
    kind: ElementKind,
    place: String,
    /// Path of the file that contains the tangential forces; `None` if the frames contain them.
    shear_place: Option<String>,
}

impl RecordedFrames {
    /// Reads the files of a recording. If `ceiling` is given, the frames must fit into this number of bytes.
    ///
    /// # Errors
    /// If a file cannot be read or does not fit the others, or a reading is infinite, or NaN although its taxel is not masked.
    pub fn read(spec: &RecordedSpec, ceiling: Option<u64>) -> Result<Self> {
        spec.check_files()?;
        let train = spec.read_frames("frames", ceiling)?;
        let test = match spec.has_test_set() {
            true => Some(spec.read_frames("frames_test", ceiling)?),
            false => None,
        };
        let files: Vec<&FramesOfFile> = [Some(&train), test.as_ref()]
            .into_iter()
            .flatten()
            .collect();
        if let Some(test) = &test {
            let axes = |shape: &FrameShape| [shape.n_frames, shape.rows, shape.columns];
            if axes(&test.shape) != axes(&train.shape) {
                let [given, allowed] = [&test.shape, &train.shape].map(|shape| {
                    let [n_frames, rows, columns] = axes(shape);
                    format!("touches of {n_frames} frames of {rows} × {columns} taxels")
                });
                let allowed = format!("{allowed}, as {} has", train.place);
                return Err(Error::input(&test.place, given, allowed));
            }
        }
        let n_train = train.shape.n_touches;
        let n_test = test.as_ref().map_or(0, |test| test.shape.n_touches);
        let labels = spec.class_labels([n_train, n_test])?;
        let (names, streams, counts) = spec.classes(&labels)?;
        let mut order: Vec<usize> = (0..n_train + n_test).collect();
        order.sort_by_key(|&touch| labels.labels[touch]);
        let groups = spec.group_keys([n_train, n_test])?;
        let groups = groups.map(|groups| order.iter().map(|&touch| groups[touch]).collect());
        let side = |&touch: &usize| match touch < n_train {
            true => Side::Train,
            false => Side::Test,
        };
        let sides = test
            .as_ref()
            .map(|_| order.iter().map(side).collect::<Vec<_>>());
        if let Some(sides) = &sides {
            spec.check_test_set(&names, &order, sides, &labels)?;
        }
        let depths = spec.read_depths(n_train + n_test)?;
        let depths = depths.map(|depths| order.iter().map(|&touch| depths[touch]).collect());
        let n_taxels = train.shape.rows * train.shape.columns;
        let is_masked = masked(&files, n_taxels)?;
        let zeros = spec.checked_zeros(&train.shape, &is_masked)?;
        let (full_scale, saturation) = spec.full_scale_of(&files, &zeros, depths.is_some())?;
        let n_frames = train.shape.n_frames;
        let none = Array2::zeros((0, train.readings.ncols()));
        Ok(Self {
            spec: spec.clone(),
            names,
            streams,
            counts,
            order,
            is_masked,
            zeros,
            full_scale,
            saturation,
            n_frames,
            n_taxels,
            groups,
            sides,
            depths,
            readings: [train.readings, test.map_or(none, |test| test.readings)],
        })
    }

    /// Returns the recorded readings of one frame of a touch.
    fn frame(&self, touch: usize, frame: usize) -> ArrayView1<'_, f64> {
        let row = self.order[touch] * self.n_frames + frame;
        let [train, test] = &self.readings;
        match row.checked_sub(train.nrows()) {
            None => train.row(row),
            Some(row) => test.row(row),
        }
    }

    /// Returns the values of one frame of a touch: deflections in metres, and tangential forces in newtons.
    fn values(&self, (touch, frame): (usize, usize), stroke: f64) -> Array1<f64> {
        let readings = self.frame(touch, frame);
        let values = readings.iter().zip(&self.is_masked).enumerate();
        let values = values.map(
            |(place, (&reading, &is_masked))| match place < self.n_taxels {
                _ if is_masked => 0.0,
                true => {
                    let zero = self.zeros[place];
                    (reading - zero) / (self.full_scale - zero) * stroke
                }
                false => reading,
            },
        );
        values.collect()
    }

    /// Returns two readings along the axis for each unmasked taxel: during the touch and without touch.
    fn pushes(&self, touch: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let frames = (0..self.n_frames).flat_map(move |frame| {
            let readings = self.frame(touch, frame).into_iter().zip(&self.is_masked);
            readings.zip(&self.zeros)
        });
        frames.filter_map(|((&reading, &is_masked), &zero)| (!is_masked).then_some((reading, zero)))
    }
}

impl RecordedSpec {
    /// Returns the SHA-256 hash of each file of the recording, by path.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn content(&self) -> Result<BTreeMap<String, String>> {
        let files = self.files().into_iter();
        let content = files.map(|path| Ok((path.display().to_string(), file_content(path)?)));
        content.collect()
    }

    fn read_frames(&self, name: &str, ceiling: Option<u64>) -> Result<FramesOfFile> {
        let path = self.file_of(name).unwrap_or(&self.frames);
        let shape = self.shape_of(name)?;
        let shear = self.shear_shape(name, &shape)?;
        let n = shape.n_touches;
        let of_shear = shear.as_ref().map_or(0, FrameShape::n_frame_values);
        let n_values = shape.n_frame_values() + of_shear;
        // The data are in memory twice as f64 if axes are permuted or files are joined.
        let bytes = 16.0 * (n * shape.n_frames) as f64 * n_values as f64;
        check_memory(bytes, ceiling, "frames")
            .map_err(|allowed| Error::input(path.display(), format!("{n} touches"), allowed))?;
        let array = FileArray::read(path, name)?;
        let (place, kind) = (array.place.clone(), array.kind);
        let mut readings = shape.arrange(array.into_numbers()?);
        let mut shear_place = None;
        if let (Some((path, name)), Some(shape)) = (self.shear_of(name), shear) {
            let array = FileArray::read(path, name)?;
            shear_place = Some(array.place.clone());
            let across = shape.arrange(array.into_numbers()?);
            readings = concatenate![Axis(1), readings, across];
        }
        Ok(FramesOfFile {
            readings,
            shape,
            kind,
            place,
            shear_place,
        })
    }

    /// Returns the class labels of all touches; the separate test set comes last.
    fn class_labels(&self, n: [usize; 2]) -> Result<ClassLabels> {
        let mut values = Vec::new();
        for (name, n) in ["labels", "labels_test"].into_iter().zip(n) {
            let Some(path) = self.file_of(name).filter(|_| n > 0) else {
                continue;
            };
            let own = read_class_values(path, name, n)?;
            one_each(path, (own.len(), n), &self.frames)?;
            let is_text = |value: &KeyValue| matches!(value, KeyValue::Text(_));
            if let (Some(first), Some(other)) = (own.first(), values.first())
                && is_text(first) != is_text(other)
            {
                let allowed = format!("texts or numbers, as {}", self.labels.display());
                let given = "numbers in one file and texts in the other";
                return Err(Error::input(path.display(), given, allowed));
            }
            values.extend(own);
        }
        let labels = ClassLabels::new(&values);
        let (Some(names), Some(KeyValue::Text(_))) = (&self.names, values.first()) else {
            return Ok(labels);
        };
        // Texts are numbered in the order of `names`.
        let known: Vec<KeyValue> = names.iter().cloned().map(KeyValue::Text).collect();
        let number = |value: &KeyValue| known.iter().position(|name| name == value);
        match values.iter().map(number).collect::<Option<Vec<_>>>() {
            Some(numbers) => Ok(ClassLabels {
                labels: numbers,
                classes: known,
            }),
            // Otherwise texts are numbered in the order of their first touches.
            None => Ok(labels),
        }
    }

    /// Returns the name, the random-stream name and the number of touches of each class.
    fn classes(&self, labels: &ClassLabels) -> Result<(Vec<String>, Vec<String>, Vec<usize>)> {
        let n_classes = labels.classes.len();
        let mut counts = vec![0; n_classes];
        for &label in &labels.labels {
            counts[label] += 1;
        }
        let file = self.file_of("labels").unwrap_or(&self.labels);
        if let Some(label) = counts.iter().position(|&count| count == 0) {
            let given = format!("no touch of class {}", name_of(&labels.classes[label]));
            return Err(Error::input(file.display(), given, "touches of each class"));
        }
        let (names, streams): (Vec<String>, Vec<String>) = match &self.names {
            None => {
                let classes = labels.classes.iter().enumerate();
                let names = classes.map(|(number, class)| match class {
                    KeyValue::Integer(value) => {
                        (format!("class {value}"), format!("class {number}"))
                    }
                    KeyValue::Text(text) => (text.clone(), text.clone()),
                });
                names.unzip()
            }
            Some(names) if names.len() == n_classes => (names.clone(), names.clone()),
            Some(names) => {
                let given = format!("{} names", names.len());
                let allowed = format!("{n_classes}, one a class of {}", file.display());
                return Err(Error::input("key recorded.names", given, allowed));
            }
        };
        if let Some(name) = (1..names.len()).find(|&k| names[..k].contains(&names[k])) {
            let given = format!("{:?} twice", names[name]);
            return Err(Error::input("key recorded.names", given, "each name once"));
        }
        Ok((names, streams, counts))
    }

    /// Returns the group of every touch; the touches of the separate test set come last. Returns `None` if the recording defines no groups.
    fn group_keys(&self, [n_train, n_test]: [usize; 2]) -> Result<Option<Vec<usize>>> {
        let read = |name: &str, n: usize| -> Result<Option<Vec<KeyValue>>> {
            match self.file_of(name) {
                None => Ok(None),
                Some(path) => {
                    let groups = read_group_values(path, name, n)?;
                    one_each(path, (groups.len(), n), &self.frames)?;
                    Ok(Some(groups))
                }
            }
        };
        let (train, test) = (read("groups", n_train)?, read("groups_test", n_test)?);
        if n_test == 0 {
            return Ok(train.map(|groups| group_keys(&groups)));
        }
        match (train, test) {
            (None, None) => Ok(None),
            (Some(_), None) => {
                let allowed = "the groups of the test set beside groups, or neither of them";
                Err(Error::input(
                    "key recorded.groups_test",
                    "no such key",
                    allowed,
                ))
            }
            (None, Some(test)) => {
                // Each training touch is a group of its own.
                let keys = group_keys(&test);
                let first = keys.iter().max().map_or(0, |last| last + 1);
                Ok(Some((first..first + n_train).chain(keys).collect()))
            }
            (Some(train), Some(test)) => {
                let known: HashSet<&KeyValue> = train.iter().collect();
                if let Some(both) = test.iter().find(|group| known.contains(group)) {
                    let given = format!("group {} in both sets", name_of(both));
                    let allowed = "groups that either train or test";
                    return Err(Error::input("key recorded.groups_test", given, allowed));
                }
                Ok(Some(group_keys(&[train, test].concat())))
            }
        }
    }

    /// Returns an error if a class has no training touches or no test touches.
    fn check_test_set(
        &self,
        names: &[String],
        order: &[usize],
        sides: &[Side],
        labels: &ClassLabels,
    ) -> Result<()> {
        for (label, name) in names.iter().enumerate() {
            for (side, key) in [(Side::Train, "frames"), (Side::Test, "frames_test")] {
                let mut touches = order.iter().zip(sides);
                if !touches.any(|(&touch, own)| *own == side && labels.labels[touch] == label) {
                    let given = format!("no touch of {name}");
                    let allowed =
                        "touches of each class among those that train and in the test set";
                    return Err(Error::input(format!("key recorded.{key}"), given, allowed));
                }
            }
        }
        Ok(())
    }

    fn read_depths(&self, n: usize) -> Result<Option<Vec<f64>>> {
        let Some(path) = &self.depths else {
            return Ok(None);
        };
        let depths = FileArray::read(path, "depths")?.into_numbers()?;
        one_each(path, (depths.len(), n), &self.frames)?;
        match depths
            .iter()
            .position(|depth| !(depth.is_finite() && *depth > 0.0))
        {
            None => Ok(Some(depths.into_iter().collect())),
            Some(touch) => {
                let place = format!("{}, position {touch}", path.display());
                let given = depths.iter().nth(touch).copied().unwrap_or(f64::NAN);
                Err(Error::input(place, given, "a positive number of metres"))
            }
        }
    }

    /// Checks and returns the reading of each untouched taxel; the reading of a masked taxel is 0.
    fn checked_zeros(&self, shape: &FrameShape, is_masked: &[bool]) -> Result<Vec<f64>> {
        let mut zeros = self.zeros(shape)?;
        for (taxel, zero) in zeros.iter_mut().enumerate() {
            if is_masked[taxel] {
                *zero = 0.0;
            } else if !zero.is_finite()
                && let ZeroSpec::Each(path) = &self.zero
            {
                let place = format!("{}, taxel {taxel}", path.display());
                let allowed = "a finite number (only a taxel that is masked may be without one)";
                return Err(Error::input(place, *zero, allowed));
            }
        }
        Ok(zeros)
    }

    /// Returns two readings: the reading of a taxel at full scale, and the reading above which a taxel counts as saturated. A taxel counts as saturated above
    /// the given full scale, or above a smaller largest reading that many frames share. If the depths are known, a shared largest reading is ignored, because
    /// equal depths may cause it.
    fn full_scale_of(
        &self,
        files: &[&FramesOfFile],
        zeros: &[f64],
        are_depths_known: bool,
    ) -> Result<(f64, f64)> {
        let frames = || files.iter().flat_map(|file| file.readings.outer_iter());
        let pushes = || frames().map(|frame| frame.into_iter().take(zeros.len()).copied());
        let largest = pushes().flatten().filter(|reading| !reading.is_nan());
        let largest = largest.fold(f64::NEG_INFINITY, f64::max);
        let full_scale = self.full_scale.unwrap_or(largest);
        let highest = zeros.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if highest >= full_scale {
            return Err(match &self.zero {
                ZeroSpec::One(zero) => {
                    let given = format!("no reading above recorded.zero, {zero}");
                    Error::input(self.frames.display(), given, "touches")
                }
                ZeroSpec::Each(path) => {
                    let taxel = zeros.iter().position(|&zero| zero == highest);
                    let place = format!("{}, taxel {}", path.display(), taxel.unwrap_or(0));
                    let allowed = match self.full_scale {
                        Some(full_scale) => format!("below recorded.full_scale, {full_scale}"),
                        None => format!(
                            "below the largest reading, {largest}, which stands for the full scale"
                        ),
                    };
                    Error::input(place, highest, allowed)
                }
            });
        }
        let spacing = match files[0].kind {
            ElementKind::Float(spacing) => spacing,
            _ => 0.0,
        };
        let given = self.full_scale.map(|full| full - spacing * full.abs());
        let shared = match are_depths_known {
            true => None,
            false => plateau(pushes).filter(|&level| level > highest),
        };
        let saturation = given
            .unwrap_or(f64::INFINITY)
            .min(shared.unwrap_or(f64::INFINITY));
        Ok((full_scale, saturation))
    }
}

/// Returns an error if a file does not contain exactly one value per touch.
fn one_each(path: &Path, (n_given, n): (usize, usize), frames: &Path) -> Result<()> {
    let given = format!("{n_given} numbers");
    let allowed = format!("{n}, one a touch of {}", frames.display());
    match n_given == n {
        true => Ok(()),
        false => Err(Error::input(path.display(), given, allowed)),
    }
}

fn name_of(value: &KeyValue) -> String {
    match value {
        KeyValue::Integer(number) => number.to_string(),
        KeyValue::Text(text) => text.clone(),
    }
}

/// Returns whether each value of a frame belongs to a masked taxel, which has too many NaN readings.
fn masked(files: &[&FramesOfFile], n_taxels: usize) -> Result<Vec<bool>> {
    let n_values = files[0].readings.ncols();
    let n_frames: usize = files.iter().map(|file| file.readings.nrows()).sum();
    let mut n_missing = vec![0_usize; n_values];
    for file in files {
        for frame in file.readings.outer_iter() {
            for (n, reading) in n_missing.iter_mut().zip(frame) {
                *n += usize::from(reading.is_nan());
            }
        }
    }
    let of_taxel = |place: usize| n_missing.iter().skip(place % n_taxels).step_by(n_taxels);
    let most = |place: usize| of_taxel(place).copied().max().unwrap_or(0);
    let is_masked = (0..n_values).map(|place| most(place) as f64 >= MASKED * n_frames as f64);
    let is_masked: Vec<bool> = (0..n_values)
        .zip(is_masked)
        .map(|(place, is_masked)| is_masked && most(place) > 0)
        .collect();
    for file in files {
        for ((row, place), &reading) in file.readings.indexed_iter() {
            if reading.is_finite() || is_masked[place] {
                continue;
            }
            let taxel = place % n_taxels;
            let own = file.shear_place.as_ref().filter(|_| place >= n_taxels);
            let own = own.unwrap_or(&file.place);
            let at = format!("{own}, frame {row}, taxel {taxel}");
            let allowed = match reading.is_nan() {
                true => format!(
                    "a finite number (a taxel that is NaN in at least {:.0} % of the frames is masked; this one is in {} of {n_frames})",
                    100.0 * MASKED,
                    most(place)
                ),
                false => "a finite number".to_owned(),
            };
            return Err(Error::input(at, reading, allowed));
        }
    }
    match is_masked.iter().all(|&is_masked| is_masked) {
        true => Err(Error::input(
            &files[0].place,
            "no taxel with readings",
            "numbers",
        )),
        false => Ok(is_masked),
    }
}

impl TouchSet for RecordedFrames {
    fn classes(&self) -> Vec<(&str, usize)> {
        let names = self.names.iter().map(String::as_str);
        names.zip(self.counts.iter().copied()).collect()
    }

    fn own_groups(&self) -> Option<Array1<usize>> {
        self.groups.clone()
    }

    fn given_sides(&self) -> Option<&[Side]> {
        self.sides.as_deref()
    }

    fn n_masked(&self) -> (usize, usize) {
        let of_taxels = &self.is_masked[..self.n_taxels];
        (of_taxels.iter().filter(|&&is| is).count(), self.n_taxels)
    }

    fn simulate(&self, (array, n_frames): (&TaxelArray, usize), progress: &dyn Progress) -> Frames {
        let stroke = array.taxel().stroke;
        let mut frames = Frames::new((array.n_values(), n_frames));
        let touches: Vec<usize> = (0..self.order.len()).collect();
        let copy = |&touch: &usize, _: &mut (), mut rows: ArrayViewMut2<f32>| {
            for (frame, row) in rows.outer_iter_mut().enumerate() {
                let values = self.values((touch, frame), stroke);
                for (to, from) in row.into_iter().zip(values) {
                    *to = from as f32;
                }
            }
            let mut pushes = self.pushes(touch);
            let is_missed = !self.pushes(touch).any(|(reading, zero)| reading > zero);
            (
                is_missed,
                pushes.any(|(reading, _)| reading >= self.saturation),
            )
        };
        frames.make(&touches, || (), copy, progress);
        frames
    }

    /// Returns the timing and the preceding touch of each touch. Touches are read at the study's speed or frame rate. Each touch follows a randomly drawn touch
    /// or no touch, depending on the study's keys.
    fn to_read(&self, speed: f64, n_frames: usize, seed: &Seed) -> Vec<TouchToRead> {
        let streams = self.streams.iter().map(String::as_str);
        let mut touches = touches_to_read(streams.zip(self.counts.iter().copied()), seed);
        let n_touches = touches.len();
        for (number, touch) in touches.iter_mut().enumerate() {
            let depth = self.depths.as_ref().map(|depths| depths[number]);
            let depth = depth.filter(|_| speed > 0.0);
            let at_speed = depth.map(|depth| depth / (n_frames as f64 * speed));
            touch.interval = self.spec.frame_interval_s.or(at_speed);
            if self.spec.previous_touch == PreviousTouch::Random {
                let mut rng = touch.seed.named("before").rng();
                touch.before = Some(rng.gen_range(0..n_touches));
            }
        }
        touches
    }

    fn n_deeper_than(&self, stroke: f64) -> usize {
        let limit = saturation_limit(stroke);
        let depths = self.depths.iter().flatten();
        depths.filter(|&&depth| depth > limit).count()
    }

    /// Returns sample touches for pictures: for each class, the last frame of its first touch.
    fn samples(&self, plan: &Plan, _groups: &[MeasurementGroup]) -> Result<Samples> {
        let array = &plan.arrays[0];
        let (configurations, stroke) = (array.picture_cells(), array.taxel().stroke);
        let mut first = 0;
        let frames = self.classes().into_iter().map(|(name, count)| {
            let values = self.values((first, self.n_frames - 1), stroke);
            first += count;
            let frame = configurations.mapv(|taxel| taxel.map_or(0.0, |taxel| values[taxel]));
            (name.replace('_', " "), frame)
        });
        let frames: Vec<(String, Array2<f64>)> = frames.collect();
        let set = |frames| Snapshots {
            frames,
            pitch_mm: array.picture_pitch_mm(),
            quantity: Quantity::Deflection,
            caption: format!("One recorded touch each on {}", array.describe_taxels()),
        };
        let chosen = spread_samples(plan, &self.class_names())?;
        let shown = chosen.into_iter().map(|label| frames[label].clone());
        Ok(Samples {
            shown: set(shown.collect()),
            each: Some(set(frames)),
        })
    }

    fn settings(&self) -> Vec<(String, String)> {
        let row = |name: &str, value: String| (name.to_owned(), value);
        let names = self.class_names();
        let mut rows = vec![
            row(
                "Recorded classes",
                format!("{}: {}", names.len(), names.join(", ")),
            ),
            row("Frames a touch", self.n_frames.to_string()),
            row("Recorded in", self.spec.frames.display().to_string()),
        ];
        let masked = self.is_masked[..self.n_taxels].iter().enumerate();
        let masked = masked
            .filter(|&(_, &is)| is)
            .map(|(taxel, _)| taxel.to_string());
        let masked: Vec<String> = masked.collect();
        if !masked.is_empty() {
            let taxels = format!(
                "{} of {}: {}",
                masked.len(),
                self.n_taxels,
                masked.join(", ")
            );
            rows.push(row("Masked taxels, from 0", taxels));
        }
        rows
    }
}
