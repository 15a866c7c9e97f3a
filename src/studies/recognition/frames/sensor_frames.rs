//! Frames of one sensor of a recording: its files, masked taxels, zeros and full scale.

use crate::calibration::plateau;
use crate::inputs::arrays::axis_order::FrameShape;
use crate::inputs::arrays::file_array::{ElementKind, FileArray};
use crate::inputs::memory::check_memory;
use crate::studies::prelude::*;
use crate::studies::recognition::spec::ZeroSpec;
use ndarray::{Array2, Axis, concatenate};

/// Fraction of missing (NaN) readings, 0 to 1, above which a taxel is masked. With a larger value, recordings with an intermittently failing taxel are
/// rejected; with a smaller value, a few missing readings mask a taxel.
const MASKED: f64 = 0.1;

/// Minimum number of frames from which a taxel with one reading counts as one without a sensor. With fewer frames, an untouched taxel may read one number by
/// chance.
const MIN_CONSTANT: usize = 20;

/// Largest distance of readings from their zero, in multiples of their change. Frames are kept in single precision, with a relative error of 6e-8. With a larger
/// value, changes are rounded by more than 0.6 %; with a smaller value, exact recordings with an offset are refused.
const MAX_OFFSET: f64 = 1e5;

/// Frames that one file contains, and the shape of each frame.
struct FramesOfFile {
    shape: FrameShape,
    readings: Array2<f64>,
    kind: ElementKind,
    place: String,
    /// Names of the columns of a table; `None` for other files.
    columns: Option<Vec<String>>,
    /// Path of the file that contains the tangential forces; `None` if the frames contain them.
    shear_place: Option<String>,
    /// Time between the frames of each touch relative to the time between recorded frames; 1 without resampling.
    steps: Vec<f64>,
}

/// Frames that one sensor recorded: training touches (or all touches), and the separate test set.
pub struct SensorFrames {
    /// Name of the sensor.
    pub name: String,
    spec: RecordedSpec,
    train: FramesOfFile,
    test: Option<FramesOfFile>,
}

/// Zeros and full scale of one sensor.
pub struct SensorScale {
    /// Whether each value of a frame belongs to a masked taxel.
    pub is_masked: Vec<bool>,
    /// Reading of each untouched taxel; 0 for a masked taxel.
    pub zeros: Vec<f64>,
    /// Reading of a taxel whose deflection equals its stroke.
    pub full_scale: f64,
    /// Reading from which on a taxel counts as saturated.
    pub saturation: f64,
}

impl SensorFrames {
    /// Reads the frames of a sensor. If `ceiling` is given, the frames must fit into this number of bytes.
    ///
    /// # Errors
    /// If a file cannot be read, or the test set has other axes than the training touches.
    pub fn read(name: String, spec: RecordedSpec, ceiling: Option<u64>) -> Result<Self> {
        let train = spec.read_frames("frames", None, ceiling)?;
        let test = match spec.file_of("frames_test") {
            Some(_) => Some(spec.read_frames("frames_test", Some(&train), ceiling)?),
            None => None,
        };
        if let Some(test) = &test {
            let axes = |shape: &FrameShape| {
                let sides = shape.sides.unwrap_or([1, shape.n_places]);
                (
                    shape.n_frames,
                    sides,
                    shape.rows * shape.columns / shape.n_places,
                )
            };
            if axes(&test.shape) != axes(&train.shape) {
                let [given, allowed] = [&test.shape, &train.shape].map(|shape| {
                    let (n_frames, [rows, columns], n_values) = axes(shape);
                    let values = match n_values {
                        1 => String::new(),
                        n => format!(" of {n} values"),
                    };
                    format!("touches of {n_frames} frames of {rows} × {columns} taxels{values}")
                });
                let allowed = format!("{allowed}, as {} has", train.place);
                return Err(Error::input(&test.place, given, allowed));
            }
        }
        Ok(Self {
            name,
            spec,
            train,
            test,
        })
    }

    /// Returns the numbers of touches: training touches (or all touches), and touches of the test set.
    pub fn n_touches(&self) -> [usize; 2] {
        let n_test = self.test.as_ref().map_or(0, |test| test.shape.n_touches);
        [self.train.shape.n_touches, n_test]
    }

    /// Returns the memory of the readings, bytes.
    pub fn n_bytes(&self) -> u64 {
        let sizes = self.files().into_iter().map(|file| file.readings.len());
        8 * sizes.sum::<usize>() as u64
    }

    /// Returns the number of frames of each touch.
    pub fn n_frames(&self) -> usize {
        self.train.shape.n_frames
    }

    /// Returns the time between the frames of each touch relative to the time between recorded frames; the test set comes last.
    pub fn steps(&self) -> Vec<f64> {
        let files = self.files().into_iter();
        files.flat_map(|file| file.steps.iter().copied()).collect()
    }

    /// Determines masked taxels, zeros and the full scale of the sensor.
    ///
    /// # Errors
    /// If a reading is not finite although its taxel is not masked, or the zeros do not fit the readings.
    pub fn scale(&self, are_depths_known: bool) -> Result<SensorScale> {
        let (files, shape) = (self.files(), &self.train.shape);
        let mut is_masked = masked(&files, shape.rows * shape.columns)?;
        let zeros = self.spec.zeros(shape, self.train.columns.as_deref())?;
        mask_placeholders(&files, &zeros, &mut is_masked);
        let zeros = self.spec.checked_zeros(zeros, &is_masked)?;
        check_precision(&files, &zeros, &is_masked)?;
        let scale = (&files[..], &zeros[..], &is_masked[..]);
        let scale = self.spec.full_scale_of(scale, are_depths_known)?;
        let (full_scale, saturation) = scale;
        Ok(SensorScale {
            is_masked,
            zeros,
            full_scale,
            saturation,
        })
    }

    fn files(&self) -> Vec<&FramesOfFile> {
        let files = [Some(&self.train), self.test.as_ref()];
        files.into_iter().flatten().collect()
    }
}

/// Checks that all sensors recorded the same number of touches, each with the same number of frames.
///
/// # Errors
/// If a sensor differs from the first one.
pub fn check_alike(sensors: &[SensorFrames]) -> Result<()> {
    for sensor in sensors {
        for (own, first) in sensor.files().into_iter().zip(sensors[0].files()) {
            if own.shape.n_touches != first.shape.n_touches {
                let given = format!("{} touches", own.shape.n_touches);
                let allowed = format!("{}, as {} has", first.shape.n_touches, first.place);
                return Err(Error::input(&own.place, given, allowed));
            }
            if own.shape.n_frames != first.shape.n_frames {
                let given = format!("touches of {} frames", own.shape.n_frames);
                let allowed = format!(
                    "{}, as {} has, or recorded.resampled_frames",
                    first.shape.n_frames, first.place
                );
                return Err(Error::input(&own.place, given, allowed));
            }
        }
    }
    Ok(())
}

/// Joins the readings of all sensors to frames, sensor after sensor: training touches (or all touches), and the separate test set.
pub fn joined_readings(sensors: Vec<SensorFrames>) -> [Array2<f64>; 2] {
    let files = sensors.into_iter().map(|sensor| {
        let test = sensor.test.map(|test| test.readings);
        let none = Array2::zeros((0, sensor.train.readings.ncols()));
        (sensor.train.readings, test.unwrap_or(none))
    });
    let (train, test): (Vec<_>, Vec<_>) = files.unzip();
    [train, test].map(|mut parts| match parts.len() {
        1 => parts.swap_remove(0),
        _ => {
            let parts: Vec<_> = parts.iter().map(Array2::view).collect();
            concatenate(Axis(1), &parts).expect("the sensors have the same touches")
        }
    })
}

impl RecordedSpec {
    /// Reads the array `frames`, or the array `frames_test` beside the frames `first`.
    fn read_frames(
        &self,
        name: &'static str,
        first: Option<&FramesOfFile>,
        ceiling: Option<u64>,
    ) -> Result<FramesOfFile> {
        let path = self.file_of(name).unwrap_or(&self.frames);
        let mut shape = self.shape_of(name)?;
        let shear = self.shear_shape(name, &shape)?;
        let n = shape.n_touches;
        let of_shear = shear.as_ref().map_or(0, FrameShape::n_frame_values);
        let n_values = shape.n_frame_values() + of_shear;
        // The data are in memory twice as f64 if axes are permuted or files are joined.
        let bytes = 16.0 * (n * shape.n_frames) as f64 * n_values as f64;
        check_memory(bytes, ceiling, "frames")
            .map_err(|allowed| Error::input(path.display(), format!("{n} touches"), allowed))?;
        let array = self.read_array(name)?;
        if let Some(first) = first {
            array.check_columns_of(first.columns.as_deref(), &first.place)?;
        }
        let (place, kind, columns) = (array.place.clone(), array.kind, array.columns.clone());
        let mut readings = shape.arrange(array.into_numbers()?);
        let mut shear_place = None;
        if let (Some((path, name)), Some(shape)) = (self.shear_of(name), shear) {
            let array = FileArray::read(path, name)?;
            shear_place = Some(array.place.clone());
            let across = shape.arrange(array.into_numbers()?);
            readings = concatenate![Axis(1), readings, across];
        }
        let lengths = self.touch_lengths(name, &shape, &readings)?;
        let (readings, steps) = self.resampled(readings, (&place, &shape), &lengths)?;
        shape.n_frames = self.resampled_frames.unwrap_or(shape.n_frames);
        Ok(FramesOfFile {
            readings,
            shape,
            kind,
            place,
            columns,
            shear_place,
            steps,
        })
    }

    /// Checks and returns the reading of each untouched taxel; the reading of a masked taxel is 0.
    fn checked_zeros(&self, mut zeros: Vec<f64>, is_masked: &[bool]) -> Result<Vec<f64>> {
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

    /// Returns two readings: the reading of a taxel at full scale, and the reading from which on a taxel counts as saturated. A taxel counts as saturated from
    /// the given full scale on, or from a smaller largest reading that many frames share. If the depths are known, a shared largest reading is ignored, because
    /// equal depths may cause it. If the full scale is below the zeros, readings fall under pressure, and the smallest reading counts as the largest one.
    fn full_scale_of(
        &self,
        (files, zeros, is_masked): (&[&FramesOfFile], &[f64], &[bool]),
        are_depths_known: bool,
    ) -> Result<(f64, f64)> {
        let present = || (0..zeros.len()).filter(|&taxel| !is_masked[taxel]);
        let highest = present()
            .map(|taxel| zeros[taxel])
            .fold(f64::NEG_INFINITY, f64::max);
        let lowest = present()
            .map(|taxel| zeros[taxel])
            .fold(f64::INFINITY, f64::min);
        let sign = match self.full_scale {
            Some(full_scale) if full_scale < lowest => -1.0,
            _ => 1.0,
        };
        let frames = || files.iter().flat_map(|file| file.readings.outer_iter());
        let pushes = || {
            frames().map(|frame| {
                let taxels = frame.into_iter().zip(is_masked).take(zeros.len());
                taxels.map(
                    move |(&reading, &is_masked)| if is_masked { f64::NAN } else { sign * reading },
                )
            })
        };
        let largest = pushes().flatten().filter(|reading| !reading.is_nan());
        let largest = largest.fold(f64::NEG_INFINITY, f64::max);
        let full_scale = self.full_scale.unwrap_or(largest);
        if sign * (full_scale - if sign > 0.0 { highest } else { lowest }) <= 0.0 {
            return Err(match &self.zero {
                ZeroSpec::One(zero) => {
                    let given = format!("no reading above recorded.zero, {zero}");
                    let allowed =
                        "touches (readings that fall under pressure need recorded.full_scale)";
                    Error::input(self.frames.display(), given, allowed)
                }
                ZeroSpec::Each(path) => {
                    let taxel = present().find(|&taxel| zeros[taxel] == highest);
                    let place = format!("{}, taxel {}", path.display(), taxel.unwrap_or(0));
                    let allowed = match self.full_scale {
                        Some(full_scale) => format!(
                            "below recorded.full_scale, {full_scale} (or all zeros above it, if readings fall under pressure)"
                        ),
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
        let given = self
            .full_scale
            .map(|full| sign * full - spacing * full.abs());
        let shared = match are_depths_known {
            true => None,
            false => {
                plateau(pushes).filter(|&level| level > if sign > 0.0 { highest } else { -lowest })
            }
        };
        let saturation = given
            .unwrap_or(f64::INFINITY)
            .min(shared.unwrap_or(f64::INFINITY));
        Ok((full_scale, sign * saturation))
    }
}

/// Checks that the readings minus their zeros keep their changes in single precision.
///
/// # Errors
/// If the changes of most taxels are too small beside their distance from the zero.
fn check_precision(files: &[&FramesOfFile], zeros: &[f64], is_masked: &[bool]) -> Result<()> {
    let (mut n_rounded, mut n_changing, mut example) = (0, 0, None);
    for taxel in (0..zeros.len()).filter(|&taxel| !is_masked[taxel]) {
        let readings = files.iter().flat_map(|file| file.readings.column(taxel));
        let range = readings.fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(low, high), &reading| (low.min(reading), high.max(reading)),
        );
        let change = range.1 - range.0;
        let away = (range.0 - zeros[taxel])
            .abs()
            .min((range.1 - zeros[taxel]).abs());
        n_changing += usize::from(change > 0.0);
        if change > 0.0 && away > MAX_OFFSET * change {
            n_rounded += 1;
            example.get_or_insert(range);
        }
    }
    match example.filter(|_| 2 * n_rounded > n_changing) {
        Some((low, high)) => Err(Error::input(
            &files[0].place,
            format!(
                "readings from {low} to {high}, far from recorded.zero: single precision would round their changes off"
            ),
            "recorded.zero = the reading of an untouched taxel",
        )),
        None => Ok(()),
    }
}

/// Masks taxels that read one number other than their zero in all frames, such as −1 at places of a rectangle without a sensor, if another taxel changes.
fn mask_placeholders(files: &[&FramesOfFile], zeros: &[f64], is_masked: &mut [bool]) {
    let n_frames: usize = files.iter().map(|file| file.readings.nrows()).sum();
    if n_frames < MIN_CONSTANT {
        return;
    }
    let frames = || files.iter().flat_map(|file| file.readings.outer_iter());
    let first: Vec<f64> = frames().next().into_iter().flatten().copied().collect();
    let mut is_constant = vec![true; first.len()];
    for frame in frames() {
        for (is_constant, (reading, first)) in is_constant.iter_mut().zip(frame.iter().zip(&first))
        {
            *is_constant &= reading == first;
        }
    }
    if (0..first.len()).all(|place| is_masked[place] || is_constant[place]) {
        return;
    }
    let n_taxels = zeros.len();
    for taxel in (0..n_taxels).filter(|&taxel| first[taxel] != zeros[taxel]) {
        let values = (taxel..first.len()).step_by(n_taxels);
        if values.clone().all(|place| is_constant[place]) {
            values.for_each(|place| is_masked[place] = true);
        }
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
