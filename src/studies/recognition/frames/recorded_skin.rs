//! Recorded frames of a skin and what is known of them, for calibration.

use crate::calibration::RecordedSkin;
use crate::error::{Error, Result};
use crate::inputs::arrays::file_array::{ElementKind, FileArray};
use crate::studies::recognition::spec::recorded::RecordedSpec;
use ndarray::{Array1, Array2, Axis};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Which frames nothing touches.
#[derive(Clone, Debug, PartialEq)]
pub enum UntouchedFrames {
    /// Nobody knows of any.
    None,
    /// Those of a file of their own, read evenly over the same session, in order.
    File(PathBuf),
    /// Some of the frames, by their numbers in the file.
    Among(Vec<Range<usize>>),
}

/// Files of a skin's frames, and what its readings are.
#[derive(Clone, Debug)]
pub struct RecordedSkinFiles {
    /// n × rows × columns, or n × F × rows × columns, in the order of time.
    pub frames: PathBuf,
    /// A letter for each axis of the frames, as in `[recorded]`.
    pub order: Option<String>,
    /// Rows and columns of the axis `c`.
    pub grid: Option<[usize; 2]>,
    /// Those of the untouched skin.
    pub untouched: UntouchedFrames,
    /// n: newtons that press the skin as a whole in each frame.
    pub forces: Option<PathBuf>,
    /// The reading of a taxel that nothing touches.
    pub zero: f64,
    /// The reading at the full scale; the largest of all when left out.
    pub full_scale: Option<f64>,
    /// Millimetres of deflection at the full scale.
    pub stroke_mm: Option<f64>,
}

impl RecordedSkinFiles {
    /// Reads them.
    ///
    /// # Errors
    /// A file that cannot be read or does not fit the others; ranges that are not among the frames; a full scale that is not above the zero.
    pub fn read(&self) -> Result<RecordedSkin> {
        let (frames, shape) = self.frames_of(&self.frames)?;
        let n = frames.nrows();
        let times = Array1::linspace(0.0, 1.0, n);
        let forces = self
            .forces
            .as_ref()
            .map(|path| numbers_of(path, n))
            .transpose()?;
        let all: Vec<usize> = (0..n).collect();
        let (untouched, untouched_times, touched) = match &self.untouched {
            UntouchedFrames::None => (Array2::zeros((0, frames.ncols())), Array1::zeros(0), all),
            UntouchedFrames::File(path) => {
                let (untouched, other) = self.frames_of(path)?;
                if other != shape {
                    let given = format!("frames of {} × {} taxels", other.0, other.1);
                    let allowed =
                        format!("{} × {}, as {}", shape.0, shape.1, self.frames.display());
                    return Err(Error::input(path.display(), given, allowed));
                }
                let times = Array1::linspace(0.0, 1.0, untouched.nrows());
                (untouched, times, all)
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
        if full_scale.is_nan() || full_scale <= self.zero {
            let allowed = format!("a number above the zero, {}", self.zero);
            return Err(Error::input("full scale", full_scale, allowed));
        }
        let share = |reading: f64| (reading - self.zero) / (full_scale - self.zero);
        Ok(RecordedSkin {
            shape,
            touched: frames.select(Axis(0), &touched).mapv(share),
            touched_times: times.select(Axis(0), &touched),
            untouched: untouched.mapv(share),
            untouched_times,
            forces: forces.map(|forces| forces.select(Axis(0), &touched)),
            stroke: self.stroke_mm.map(|stroke| stroke * 1e-3),
        })
    }
}

impl RecordedSkinFiles {
    /// Frames one a row, and rows and columns of each.
    fn frames_of(&self, path: &Path) -> Result<(Array2<f64>, (usize, usize))> {
        let spec = RecordedSpec::of_frames(path, self.order.as_deref(), self.grid);
        let shape = spec.shape_of("frames")?;
        if !shape.has_grid {
            let given = format!("{} taxels without rows and columns", shape.columns);
            let allowed = "frames of a grid of taxels (--grid ROWS,COLUMNS or --order names them)";
            return Err(Error::input(path.display(), given, allowed));
        }
        let readings = FileArray::read(path, "frames")?.into_numbers()?;
        Ok((shape.arrange(readings), (shape.rows, shape.columns)))
    }
}

/// One number a frame.
fn numbers_of(path: &Path, n: usize) -> Result<Array1<f64>> {
    let array = FileArray::read(path, "forces")?;
    if array.kind == ElementKind::Text {
        return Err(Error::input(path.display(), "texts", "finite numbers"));
    }
    let numbers = array.into_numbers()?;
    if numbers.len() != n {
        let given = format!("{} numbers", numbers.len());
        return Err(Error::input(
            path.display(),
            given,
            format!("{n}, one for each frame"),
        ));
    }
    match numbers.iter().find(|number| !number.is_finite()) {
        Some(number) => Err(Error::input(path.display(), number, "finite numbers")),
        None => Ok(numbers.into_iter().collect()),
    }
}
