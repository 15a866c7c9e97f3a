//! What is given, and touched frames without their zeros.

use super::faults::FoundFaults;
use super::robust::mean;
use super::saturation::plateau;
use super::untouched::Untouched;
use crate::error::{Error, Result};
use ndarray::{Array1, Array2, ArrayView1};

/// Frames of a grid of taxels, as shares of the full scale: 0 untouched, 1 at the full scale.
#[derive(Clone, Debug)]
pub struct RecordedSkin {
    /// Rows and columns of the grid.
    pub shape: (usize, usize),
    /// n × n_taxels, in the order of time.
    pub touched: Array2<f64>,
    /// When each was read, 0 at the beginning of the session and 1 at its end.
    pub touched_times: Array1<f64>,
    /// Frames of the skin while nothing touches it, likewise; none if there are none.
    pub untouched: Array2<f64>,
    /// When each of those was read.
    pub untouched_times: Array1<f64>,
    /// Newtons that press the skin as a whole in each touched frame.
    pub forces: Option<Array1<f64>>,
    /// Metres of deflection at the full scale.
    pub stroke: Option<f64>,
}

impl RecordedSkin {
    pub(super) fn check(&self) -> Result<()> {
        let (rows, columns) = self.shape;
        if rows * columns == 0 {
            return Err(Error::input("frames", "no taxels", "at least one"));
        }
        let lengths = [
            ("frames", self.touched.ncols(), rows * columns),
            ("untouched frames", self.untouched.ncols(), rows * columns),
            (
                "times of frames",
                self.touched_times.len(),
                self.touched.nrows(),
            ),
            (
                "times of untouched frames",
                self.untouched_times.len(),
                self.untouched.nrows(),
            ),
        ];
        let forces = self.forces.as_ref();
        let forces = forces.map(|forces| ("forces", forces.len(), self.touched.nrows()));
        for (what, given, wanted) in lengths.into_iter().chain(forces) {
            if given != wanted {
                return Err(Error::input(what, given, format!("{wanted} numbers")));
            }
        }
        let mut readings = self.touched.iter().chain(&self.untouched);
        match readings.find(|reading| !reading.is_finite()) {
            Some(reading) => Err(Error::input("frames", reading, "finite numbers")),
            None => Ok(()),
        }
    }

    pub(super) fn n_taxels(&self) -> usize {
        self.shape.0 * self.shape.1
    }

    /// Left, right, above and below, for a taxel that has all four.
    pub(super) fn neighbours(&self, taxel: usize) -> Option<[usize; 4]> {
        let (rows, columns) = self.shape;
        let (y, x) = (taxel / columns, taxel % columns);
        let is_inside = (1..rows.max(1) - 1).contains(&y) && (1..columns.max(1) - 1).contains(&x);
        is_inside.then(|| [taxel - 1, taxel + 1, taxel - columns, taxel + columns])
    }
}

/// Returns the reading from which on a taxel is saturated: the full scale, or a largest reading below it that many frames share.
pub(super) fn saturation(skin: &RecordedSkin, faults: &FoundFaults) -> f64 {
    let frames = || {
        skin.touched.outer_iter().map(|frame| {
            let readings = frame.into_iter().zip(&faults.is_sound);
            readings.map(|(&reading, &is_sound)| if is_sound { reading } else { f64::NAN })
        })
    };
    plateau(frames).map_or(1.0, |level| level.min(1.0))
}

/// Touched frames less what each taxel reads untouched, which is known from the runs of untouched frames before and after. NaN where it is not, and of
/// taxels at fault. What the converter clipped at the zero stays there. Saturated readings become 1, which all estimates leave out.
pub(super) fn touched(
    skin: &RecordedSkin,
    faults: &FoundFaults,
    (untouched, drift): (Option<&Untouched>, f64),
    saturation: f64,
) -> Array2<f64> {
    let mut touched = skin.touched.clone();
    for (mut frame, &time) in touched.outer_iter_mut().zip(&skin.touched_times) {
        for (taxel, reading) in frame.iter_mut().enumerate() {
            *reading = match untouched {
                _ if !faults.is_sound[taxel] => f64::NAN,
                _ if *reading >= saturation => 1.0,
                Some(untouched) if !(untouched.is_clipped && *reading == 0.0) => {
                    // Where nothing drifts, a zero that is never read is at the least reading.
                    let zero = untouched.zero(taxel, time);
                    let zero = zero.unwrap_or(if drift > 0.0 { f64::NAN } else { 0.0 });
                    *reading - zero
                }
                _ => *reading,
            };
        }
    }
    touched
}

impl RecordedSkin {
    /// A frame in which what is not known is the mean of what is known of its neighbours, or 0.
    pub(super) fn filled(&self, frame: ArrayView1<f64>) -> Vec<f64> {
        let filled = frame.iter().enumerate().map(|(taxel, &reading)| {
            if !reading.is_nan() {
                return reading;
            }
            let near = self.neighbours(taxel).into_iter().flatten();
            let near = mean(near.map(|near| frame[near]).filter(|near| !near.is_nan()));
            if near.is_nan() { 0.0 } else { near }
        });
        filled.collect()
    }
}
