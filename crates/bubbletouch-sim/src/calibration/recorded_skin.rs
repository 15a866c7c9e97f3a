//! Recorded frames of a skin, from which its signal parameters are estimated.

use super::robust::mean;
use crate::error::{Error, Result};
use ndarray::{Array1, Array2, ArrayView1};

/// Recorded frames of a grid of taxels, as fractions of the full scale: 0 is an untouched taxel, 1 is the full scale.
#[derive(Clone, Debug)]
pub struct RecordedSkin {
    /// Numbers of rows and columns of the grid.
    pub shape: (usize, usize),
    /// Frames with contact, shape (n_frames, n_taxels), in the order of time.
    pub touched: Array2<f64>,
    /// Time of each frame with contact, from 0 at the beginning of the recording session to 1 at its end.
    pub touched_times: Array1<f64>,
    /// Frames without contact, shape (n_frames, n_taxels), in the order of time; may be empty.
    pub untouched: Array2<f64>,
    /// Time of each frame without contact, from 0 at the beginning of the recording session to 1 at its end.
    pub untouched_times: Array1<f64>,
    /// Total normal force on the skin in each frame with contact, newtons; `None` if not recorded.
    pub forces: Option<Array1<f64>>,
    /// Deflection at the full scale, metres; `None` if unknown.
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

    /// Returns the indices of the four taxels to the left and right of a taxel and in the rows before and after it. Returns `None` for a taxel at the border.
    pub(super) fn neighbours(&self, taxel: usize) -> Option<[usize; 4]> {
        let (rows, columns) = self.shape;
        let (y, x) = (taxel / columns, taxel % columns);
        let is_inside = (1..rows.max(1) - 1).contains(&y) && (1..columns.max(1) - 1).contains(&x);
        is_inside.then(|| [taxel - 1, taxel + 1, taxel - columns, taxel + columns])
    }
}

impl RecordedSkin {
    /// Returns a frame in which unknown values are replaced by the mean of the known values of their neighbours, or by 0 without known neighbours.
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
