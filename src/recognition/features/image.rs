//! A frame as an image: what all features of images start from.

use ndarray::ArrayView2;

/// What of a frame is no part of its image. Both are in the frame's unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cut {
    /// ℓ, zero or positive: a value δ below it counts as 0. So does one that is negative, as noise and estimates may be, or not a number.
    pub level: f64,
    /// d, positive: an image keeps what is so far behind its foremost point, max(0, δ − δ_max + d). A rigid object that goes in deeper adds the
    /// same to all taxels that it touches, as far as their strokes go: pressed to d or deeper it has the same image, exactly.
    pub foremost: Option<f64>,
}

/// An ny × nx frame of pressures without what is cut off, with its sum, centroid and largest value.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// ny · nx values, row after row, zero or positive.
    pub values: Vec<f64>,
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
    /// Column, row and value of each that is above zero, in reading order.
    pub touched: Vec<(usize, usize, f64)>,
    /// Σ δ.
    pub sum: f64,
    /// Σ δ (x, y) / Σ δ, in columns and rows; the middle of an image of nothing.
    pub centroid: (f64, f64),
    /// The largest δ.
    pub largest: f64,
}

impl Image {
    /// Reads a frame (ny · nx values) of so many columns.
    ///
    /// # Panics
    /// A frame that is not of whole rows.
    pub fn read(&mut self, frame: &[f64], nx: usize, cut: Cut) {
        assert!(nx > 0 && frame.len().is_multiple_of(nx), "whole rows");
        (self.nx, self.ny) = (nx, frame.len() / nx);
        self.values.clear();
        self.touched.clear();
        (self.sum, self.largest) = (0.0, 0.0);
        let least = cut.level.max(f64::MIN_POSITIVE);
        let largest = frame
            .iter()
            .fold(0.0, |largest: f64, &value| largest.max(value));
        let off = cut
            .foremost
            .map_or(0.0, |foremost| (largest - foremost).max(0.0));
        let (mut along_x, mut along_y) = (0.0, 0.0);
        for (y, row) in frame.chunks_exact(nx).enumerate() {
            for (x, &value) in row.iter().enumerate() {
                let is_felt = value >= least && value > off;
                let value = value - off;
                self.values.push(if is_felt { value } else { 0.0 });
                if is_felt {
                    self.touched.push((x, y, value));
                    self.sum += value;
                    along_x += x as f64 * value;
                    along_y += y as f64 * value;
                    self.largest = self.largest.max(value);
                }
            }
        }
        let middle = |n: usize| 0.5 * (n as f64 - 1.0);
        self.centroid = match self.sum > 0.0 {
            true => (along_x / self.sum, along_y / self.sum),
            false => (middle(self.nx), middle(self.ny)),
        };
    }

    /// As rows and columns.
    pub fn view(&self) -> ArrayView2<'_, f64> {
        let view = ArrayView2::from_shape((self.ny, self.nx), &self.values);
        view.expect("ny · nx values")
    }

    /// The value between taxels, by bilinear interpolation; 0 outside.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let (left, below) = (x.floor(), y.floor());
        let (along, up) = (x - left, y - below);
        let (column, row) = (left as isize, below as isize);
        let inside = |at: isize, n: usize| at >= 0 && (at as usize) < n;
        let (nx, ny) = (self.nx, self.ny);
        if inside(column, nx - 1) && inside(row, ny - 1) {
            let first = row as usize * nx + column as usize;
            let (low, high) = (&self.values[first..], &self.values[first + nx..]);
            let low = (1.0 - along) * low[0] + along * low[1];
            let high = (1.0 - along) * high[0] + along * high[1];
            return (1.0 - up) * low + up * high;
        }
        let value = |column: isize, row: isize| match inside(column, nx) && inside(row, ny) {
            true => self.values[row as usize * nx + column as usize],
            false => 0.0,
        };
        let low = (1.0 - along) * value(column, row) + along * value(column + 1, row);
        let high = (1.0 - along) * value(column, row + 1) + along * value(column + 1, row + 1);
        (1.0 - up) * low + up * high
    }
}
