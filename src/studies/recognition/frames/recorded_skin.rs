//! Recorded frames of a skin, with the additional data that calibration needs.

use crate::calibration::RecordedSkin;
use crate::inputs::arrays::OneForEach;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::RecordedArray;
use bubbletouch_sim::statistics::quantile::quantile;
use ndarray::{Array1, Array2, Axis};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Selection of the recorded frames in which nothing touches the skin.
#[derive(Clone, Debug, PartialEq)]
pub enum UntouchedFrames {
    /// The recording does not specify frames in which nothing touches the skin.
    None,
    /// Separate file of frames in which nothing touches the skin, in order of time. The untouched frames are recorded at even intervals over the ranges `times`,
    /// which are fractions of the session of the main file, 0 to 1.
    File {
        /// Path of the file.
        path: PathBuf,
        /// Ranges of times at which the frames were recorded.
        times: Vec<Range<f64>>,
    },
    /// Ranges of the numbers of untouched frames in the main file.
    Among(Vec<Range<usize>>),
}

/// Paths of the files that a skin recorded, and the conversion of their readings to deflections.
#[derive(Clone, Debug)]
pub struct RecordedSkinFiles {
    /// Frames in temporal order, shape (n, rows, columns) or (n, F, rows, columns).
    pub frames: PathBuf,
    /// Order of the array axes of the frames, one letter per axis, as in the key `order` of `[recorded]`; `None` for the default order.
    pub order: Option<String>,
    /// Columns of a table that are readings, as in the key `columns` of `[recorded]`; `None` for all columns.
    pub columns: Option<String>,
    /// Numbers of rows and columns of the skin, if the axis `c` of the frames lists its taxels row by row.
    pub grid: Option<[usize; 2]>,
    /// Selection of the recorded frames in which nothing touches the skin.
    pub untouched: UntouchedFrames,
    /// File with the total force on the skin in each frame, newtons, shape (n,).
    pub forces: Option<PathBuf>,
    /// Reading of a taxel that is not touched. If `None`, the median of the untouched frames if their readings have one sign, otherwise 0.
    pub zero: Option<f64>,
    /// Reading of a taxel at full scale, not equal to `zero`; if `None`, the largest of all readings.
    pub full_scale: Option<f64>,
    /// Deflection of a taxel at full scale, mm; `None` if unknown.
    pub stroke_mm: Option<f64>,
}

impl RecordedSkinFiles {
    /// Reads the recorded files of the skin. Also returns the reading of a taxel that is not touched.
    ///
    /// # Errors
    /// If a file cannot be read or does not fit the others, a range exceeds the frames, the times of untouched frames are no ranges within 0 to 1,
    /// or the full scale equals the zero.
    pub fn read(&self) -> Result<(RecordedSkin, f64)> {
        let (recorded, sides) = self.frames_of(&self.frames, None)?;
        let (frames, n) = (&recorded.readings, recorded.readings.nrows());
        let times = Array1::linspace(0.0, 1.0, n);
        let forces = self.forces.as_ref().map(|path| {
            let of_frames = OneForEach::new(path, "forces", n, "frame");
            of_frames.numbers(f64::is_finite, "finite numbers")
        });
        let forces = forces.transpose()?;
        let all: Vec<usize> = (0..n).collect();
        let (untouched, untouched_times, touched) = match &self.untouched {
            UntouchedFrames::None => (Array2::zeros((0, frames.ncols())), Array1::zeros(0), all),
            UntouchedFrames::File { path, times } => {
                let (untouched, other) = self.frames_of(path, Some(&recorded))?;
                if other != sides {
                    let [given, wanted] = [other, sides].map(|[n, m]| format!("{n} × {m}"));
                    let given = format!("frames of {given} taxels");
                    let allowed = format!("{wanted}, as {}", self.frames.display());
                    return Err(Error::input(path.display(), given, allowed));
                }
                let times = times_in(times, untouched.readings.nrows())?;
                (untouched.readings, times, all)
            }
            UntouchedFrames::Among(ranges) => {
                if let Some(range) = ranges.iter().find(|r| r.is_empty() || r.end > n) {
                    let given = format!("{}..{}", range.start, range.end);
                    let allowed = format!("FROM..TO with FROM below TO, at most {n}");
                    return Err(Error::input("untouched frames", given, allowed));
                }
                let is_untouched = |frame: &usize| ranges.iter().any(|r| r.contains(frame));
                let (among, touched): (Vec<_>, Vec<_>) = all.into_iter().partition(is_untouched);
                let untouched = frames.select(Axis(0), &among);
                (untouched, times.select(Axis(0), &among), touched)
            }
        };
        let all = || frames.iter().chain(&untouched);
        let largest = all().fold(f64::NEG_INFINITY, |largest, &reading| largest.max(reading));
        let full_scale = self.full_scale.unwrap_or(largest);
        let zero = self.zero.unwrap_or_else(|| usual_zero(&untouched));
        if full_scale.is_nan() || full_scale == zero {
            let allowed = format!("a number other than the zero, {zero}");
            return Err(Error::input("full scale", full_scale, allowed));
        }
        let share = |reading: f64| (reading - zero) / (full_scale - zero);
        let skin = RecordedSkin {
            shape: sides.into(),
            touched: frames.select(Axis(0), &touched).mapv(share),
            touched_times: times.select(Axis(0), &touched),
            untouched: untouched.mapv(share),
            untouched_times,
            forces: forces.map(|forces| touched.iter().map(|&frame| forces[frame]).collect()),
            stroke: self.stroke_mm.map(|stroke| stroke * 1e-3),
        };
        Ok((skin, zero))
    }

    /// Reads frames of a grid of taxels; also returns its numbers of rows and columns. The columns of a table must have the names of the frames `first`.
    fn frames_of(
        &self,
        path: &Path,
        first: Option<&RecordedArray>,
    ) -> Result<(RecordedArray, [usize; 2])> {
        let spec = RecordedSpec::of_frames(path, [&self.order, &self.columns], self.grid);
        let array = spec.read_frames("frames", first, None)?;
        let shape = &array.shape;
        if let Some(sides) = shape.grid() {
            return Ok((array, sides));
        }
        let given = match shape.sides {
            Some(_) => format!("{} values a taxel", shape.n_taxels / shape.n_places),
            None => format!("{} taxels without rows and columns", shape.n_taxels),
        };
        let allowed = "frames of a grid of taxels with one value each (--grid ROWS,COLUMNS or --order names them)";
        Err(Error::input(path.display(), given, allowed))
    }
}

/// Fraction of untouched readings that may have another sign than the zero offset of the skin. A skin whose zero is 0 reads as many values on both sides of 0,
/// or 0 itself.
const OTHER_SIGN: f64 = 0.05;

/// Returns the median of untouched readings if nearly all of them have one sign, otherwise 0.
fn usual_zero(untouched: &Array2<f64>) -> f64 {
    let most = OTHER_SIGN * untouched.len() as f64;
    let n_with =
        |sign: fn(&f64) -> bool| untouched.iter().filter(|reading| sign(reading)).count() as f64;
    match n_with(|reading| *reading <= 0.0) < most || n_with(|reading| *reading >= 0.0) < most {
        true => quantile(&mut untouched.iter().copied().collect::<Vec<_>>(), 0.5),
        false => 0.0,
    }
}

/// Returns the times of n frames at even intervals over ranges of times, one range after the other.
fn times_in(ranges: &[Range<f64>], n: usize) -> Result<Array1<f64>> {
    let mut last = 0.0;
    for range in ranges {
        if !(last <= range.start && range.start <= range.end && range.end <= 1.0) {
            let given = format!("{}..{}", range.start, range.end);
            let allowed =
                "FROM..TO with 0 ≤ FROM ≤ TO ≤ 1, fractions of the session in order of time";
            return Err(Error::input("times of untouched frames", given, allowed));
        }
        last = range.end;
    }
    let total: f64 = ranges.iter().map(|range| range.end - range.start).sum();
    let time = |frame: usize| {
        let mut rest = total * frame as f64 / (n.max(2) - 1) as f64;
        for range in ranges {
            let length = range.end - range.start;
            if rest <= length {
                return range.start + rest;
            }
            rest -= length;
        }
        last
    };
    Ok((0..n).map(time).collect())
}
