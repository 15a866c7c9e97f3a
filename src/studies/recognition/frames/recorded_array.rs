//! Frames of one file of a recording, as studies, `calibrate` and `audit` read them, and the resampling of touches of unequal length.

use crate::inputs::arrays::{ElementKind, FileArray, FrameShape, OneForEach};
use crate::inputs::memory::check_memory;
use crate::signal::{resample, resampled_instant};
use crate::studies::prelude::*;
use ndarray::{Array2, Axis, concatenate, s};
use std::path::Path;

/// Frames that one file contains.
pub struct RecordedArray {
    /// Name of the file, for error messages.
    pub place: String,
    /// Axes of the frames.
    pub shape: FrameShape,
    /// Readings, shape (n_touches · n_frames, n_values). Tangential forces follow the readings along the axes of the taxels.
    pub readings: Array2<f64>,
    /// Kind of the numbers in the file.
    pub kind: ElementKind,
    /// Names of the columns of a table; `None` for other files.
    pub columns: Option<Vec<String>>,
    /// Name of the file that contains the tangential forces; `None` if the frames contain them.
    pub shear_place: Option<String>,
    /// Number of frames of each touch, from the file `lengths`; `None` without this file.
    pub lengths: Option<Vec<usize>>,
}

impl RecordedSpec {
    /// Reads the array `frames`, or the array `frames_test`, whose columns must have the names of the frames `first`. If `ceiling` is given, the frames must fit
    /// into this number of bytes.
    ///
    /// # Errors
    /// If a file cannot be read or does not fit the frames.
    pub fn read_frames(
        &self,
        name: &str,
        first: Option<&RecordedArray>,
        ceiling: Option<u64>,
    ) -> Result<RecordedArray> {
        let path = self.frames_file(name);
        let shape = self.shape_of(name)?;
        let shear = self.shear_shape(name, &shape)?;
        let n = shape.n_touches;
        let of_shear = shear.as_ref().map_or(0, FrameShape::n_frame_values);
        let n_values = shape.n_frame_values() + of_shear;
        // The data are in memory twice as f64 if axes are permuted or files are joined.
        let bytes = 16.0 * (n * shape.n_frames) as f64 * n_values as f64;
        check_memory(bytes, ceiling, "frames")
            .map_err(|allowed| Error::input(path.display(), format!("{n} touches"), allowed))?;
        let array = self.with_frames(name, FileArray::read_content)?;
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
        Ok(RecordedArray {
            lengths: self.lengths_of(name, &shape)?,
            place,
            shape,
            readings,
            kind,
            columns,
            shear_place,
        })
    }

    /// Reads the number of frames of each touch of the array `frames` or `frames_test`; `None` if the recording has no such file.
    fn lengths_of(&self, name: &str, shape: &FrameShape) -> Result<Option<Vec<usize>>> {
        let key = name.replace("frames", "lengths");
        let Some(path) = self.file_of(&key) else {
            return Ok(None);
        };
        let each = touch_of(self.frames_file(name));
        let of_touches = OneForEach::new(path, &key, shape.n_touches, each);
        let is_length =
            |length: f64| length.fract() == 0.0 && (1.0..=shape.n_frames as f64).contains(&length);
        let allowed = format!("an integer from 1 to {}", shape.n_frames);
        let lengths = of_touches.numbers(is_length, &allowed)?.into_iter();
        Ok(Some(lengths.map(|length| length as usize).collect()))
    }
}

impl RecordedArray {
    /// Sets the readings of frames after the end of a touch to a value.
    pub fn fill_padding(&mut self, reading: f64) {
        let n_frames = self.shape.n_frames;
        for (touch, &length) in self.lengths.iter().flatten().enumerate() {
            let padding = touch * n_frames + length..(touch + 1) * n_frames;
            self.readings.slice_mut(s![padding, ..]).fill(reading);
        }
    }

    /// Resamples each touch to `n_frames` frames, by linear interpolation; without this number, all touches must have all frames. Returns the frames, and the
    /// time between the frames of each touch relative to the time between recorded frames.
    ///
    /// # Errors
    /// If a touch has no reading, or the touches have unequal lengths and are not resampled.
    pub fn resampled(mut self, n_frames: Option<usize>) -> Result<(Self, Vec<f64>)> {
        let lengths = match self.lengths.take() {
            Some(lengths) => lengths,
            None => self.lengths_with_readings()?,
        };
        let n_recorded = self.shape.n_frames;
        let Some(n_frames) = n_frames else {
            let shortest = lengths.iter().copied().min().unwrap_or(0);
            if shortest < n_recorded {
                let longest = lengths.iter().copied().max().unwrap_or(0);
                let given = format!("touches of {shortest} to {longest} of {n_recorded} frames");
                let allowed = "touches with all frames, or recorded.resampled_frames, the number of frames to which each touch is resampled";
                return Err(Error::input(self.place, given, allowed));
            }
            return Ok((self, vec![1.0; lengths.len()]));
        };
        let mut resampled = Array2::zeros((lengths.len() * n_frames, self.readings.ncols()));
        for (touch, &length) in lengths.iter().enumerate() {
            let first = touch * n_recorded;
            let recorded = self.readings.slice(s![first..first + length, ..]);
            let own = touch * n_frames..(touch + 1) * n_frames;
            resample(recorded, resampled.slice_mut(s![own, ..]));
        }
        (self.readings, self.shape.n_frames) = (resampled, n_frames);
        // The time from the first to the second frame; a single frame has no step.
        let step = |&length: &usize| match n_frames {
            1 => 1.0,
            _ => resampled_instant(1, n_frames, length),
        };
        Ok((self, lengths.iter().map(step).collect()))
    }

    /// Returns the number of frames of each touch up to the last one with a reading. A single frame always counts.
    fn lengths_with_readings(&self) -> Result<Vec<usize>> {
        let n_frames = self.shape.n_frames;
        if n_frames == 1 {
            return Ok(vec![1; self.shape.n_touches]);
        }
        let length = |touch: usize| {
            let is_there = |length: &usize| {
                let row = self.readings.row(touch * n_frames + length - 1);
                !row.iter().all(|reading| reading.is_nan())
            };
            (1..=n_frames).rev().find(is_there).ok_or_else(|| {
                let place = format!("{}, touch {touch}", self.place);
                let given = "no reading (NaN in all frames)";
                Error::input(place, given, "at least one frame")
            })
        };
        (0..self.shape.n_touches).map(length).collect()
    }
}

/// Returns the words for a touch of a file of frames.
pub(crate) fn touch_of(frames: &Path) -> String {
    format!("touch of {}", frames.display())
}
