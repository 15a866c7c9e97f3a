//! Recorded frames of a skin.

use super::robust::mean;
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
