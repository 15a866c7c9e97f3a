//! Recorded touches of unequal length: their numbers of frames, and resampling to the number of frames of the study.

use crate::inputs::arrays::axis_order::FrameShape;
use crate::inputs::arrays::file_array::FileArray;
use crate::inputs::arrays::{TableContent, is_member};
use crate::signal::{resample, resampled_instant};
use crate::studies::prelude::*;
use ndarray::{Array2, s};
use std::path::Path;

impl RecordedSpec {
    /// Returns the number of frames of each touch: the numbers of the file, or the frames up to the last one with a reading.
    ///
    /// # Errors
    /// If the file cannot be read or has an invalid number, or a touch has no reading.
    pub(super) fn touch_lengths(
        &self,
        name: &str,
        shape: &FrameShape,
        readings: &Array2<f64>,
    ) -> Result<Vec<usize>> {
        let key = match name {
            "frames" => "lengths",
            _ => "lengths_test",
        };
        if let Some(path) = self.file_of(key) {
            let frames = self.file_of(name).unwrap_or(&self.frames);
            return lengths_of_file((path, key), shape, frames);
        }
        if shape.n_frames == 1 {
            return Ok(vec![1; shape.n_touches]);
        }
        let length = |touch: usize| {
            let is_there = |frame: &usize| {
                let row = readings.row(touch * shape.n_frames + frame);
                !row.iter().all(|reading| reading.is_nan())
            };
            let last = (0..shape.n_frames).rev().find(is_there);
            last.map(|last| last + 1).ok_or_else(|| {
                let path = self.file_of(name).unwrap_or(&self.frames);
                let place = format!("{}, touch {touch}", path.display());
                Error::input(
                    place,
                    "no reading (NaN in all frames)",
                    "at least one frame",
                )
            })
        };
        (0..shape.n_touches).map(length).collect()
    }

    /// Resamples each touch to the number of frames of the study, by linear interpolation. Returns the readings, and the time between the frames of each touch
    /// relative to the time between recorded frames.
    ///
    /// # Errors
    /// If the touches have unequal lengths and the study does not resample them.
    pub(super) fn resampled(
        &self,
        readings: Array2<f64>,
        (place, shape): (&str, &FrameShape),
        lengths: &[usize],
    ) -> Result<(Array2<f64>, Vec<f64>)> {
        let Some(n_frames) = self.resampled_frames else {
            let shortest = lengths.iter().copied().min().unwrap_or(0);
            if shortest < shape.n_frames {
                let longest = lengths.iter().copied().max().unwrap_or(0);
                let given = format!(
                    "touches of {shortest} to {longest} of {} frames",
                    shape.n_frames
                );
                let allowed = "touches with all frames, or recorded.resampled_frames, the number of frames to which each touch is resampled";
                return Err(Error::input(place, given, allowed));
            }
            return Ok((readings, vec![1.0; lengths.len()]));
        };
        let mut resampled = Array2::zeros((lengths.len() * n_frames, readings.ncols()));
        for (touch, &length) in lengths.iter().enumerate() {
            let first = touch * shape.n_frames;
            let recorded = readings.slice(s![first..first + length, ..]);
            let own = touch * n_frames..(touch + 1) * n_frames;
            resample(recorded, resampled.slice_mut(s![own, ..]));
        }
        // The time from the first to the second frame; a single frame has no step.
        let step = |&length: &usize| match n_frames {
            1 => 1.0,
            _ => resampled_instant(1, n_frames, length),
        };
        Ok((resampled, lengths.iter().map(step).collect()))
    }
}

/// Reads the number of frames of each touch from the array `name` of a file, shape (n_touches,).
///
/// # Errors
/// If the file cannot be read, has another number of values, or a value is no integer from 1 to the number of frames.
pub(crate) fn lengths_of_file(
    of: (&Path, &str),
    shape: &FrameShape,
    frames: &Path,
) -> Result<Vec<usize>> {
    let is_length =
        |length: f64| length.fract() == 0.0 && (1.0..=shape.n_frames as f64).contains(&length);
    let allowed = format!("an integer from 1 to {}", shape.n_frames);
    let each = (shape.n_touches, touch_of(frames));
    let lengths = numbers_of(of, each, is_length, &allowed)?.into_iter();
    Ok(lengths.map(|length| length as usize).collect())
}

/// Reads one allowed number for each of n touches or frames from the array `name` of a file, shape (n,). Text `each` names what has a number.
///
/// # Errors
/// If the file cannot be read, or contains texts, other numbers, or another number of them.
pub(crate) fn numbers_of(
    (path, name): (&Path, &str),
    (n, each): (usize, String),
    is_allowed: impl Fn(f64) -> bool,
    allowed: &str,
) -> Result<Vec<f64>> {
    let array = FileArray::read_content(path, name, TableContent::Rows(n))?;
    let place = array.place.clone();
    let numbers: Vec<f64> = array.into_numbers()?.into_iter().collect();
    one_each((path, name), (numbers.len(), n), each)?;
    match numbers.iter().position(|&number| !is_allowed(number)) {
        None => Ok(numbers),
        Some(number) => {
            let place = format!("{place}, position {number}");
            Err(Error::input(place, numbers[number], allowed))
        }
    }
}

/// Returns the words for a touch of a file of frames.
pub(crate) fn touch_of(frames: &Path) -> String {
    format!("touch of {}", frames.display())
}

/// Returns an error if the array `name` of a file does not contain exactly one value for each touch or frame, which `each` names.
pub(crate) fn one_each(
    (path, name): (&Path, &str),
    (n_given, n): (usize, usize),
    each: String,
) -> Result<()> {
    let place = match is_member(path, name) {
        true => format!("{}, array `{name}`", path.display()),
        false => path.display().to_string(),
    };
    let given = format!("{n_given} values");
    match n_given == n {
        true => Ok(()),
        false => Err(Error::input(place, given, format!("{n}, one a {each}"))),
    }
}
