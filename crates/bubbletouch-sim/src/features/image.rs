//! Images of frames, from which all image features are computed.

use multiversion::multiversion;
use ndarray::ArrayView2;

/// Parts of a frame that are omitted from its image. The limits `level` and `foremost` are in the unit of the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cut {
    /// Threshold of the frame's values, zero or positive. Smaller values become 0, as do negative values (from noise or estimates) and NaN.
    pub level: f64,
    /// Depth window d, positive: each value δ of the frame becomes max(0, δ − δ_max + d), where δ_max is the largest value. If a rigid object moves deeper, δ
    /// increases equally on all touched taxels below their stroke. The images of all presses of depth d or more are therefore exactly equal.
    pub foremost: Option<f64>,
}

/// Pressure image of an ny × nx frame after parts have been omitted, with its sum, centroid and largest value.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Values of the image, zero or positive, shape (ny, nx), row after row.
    pub values: Vec<f64>,
    /// Number of columns of the image.
    pub nx: usize,
    /// Number of rows of the image.
    pub ny: usize,
    /// Positions and values of the taxels with values above zero, row by row.
    pub touched: Touched,
    /// Sum of all values of the image.
    pub sum: f64,
    /// Centroid of the image, weighted by the values, in columns and rows; the middle of the image if no taxel is touched.
    pub centroid: (f64, f64),
    /// Largest value of the image.
    pub largest: f64,
}

/// Positions and values of touched taxels, in three lists of equal length for vectorised sums.
#[derive(Clone, Debug, Default)]
pub struct Touched {
    /// Columns of the taxels.
    pub x: Vec<f64>,
    /// Rows of the taxels.
    pub y: Vec<f64>,
    /// Values of the touched taxels.
    pub value: Vec<f64>,
}

impl Image {
    /// Converts a frame (ny · nx values) with `nx` columns to an image.
    ///
    /// # Panics
    /// If the frame does not consist of whole rows.
    pub fn read(&mut self, frame: &[f64], nx: usize, cut: Cut) {
        assert!(nx > 0 && frame.len().is_multiple_of(nx), "whole rows");
        (self.nx, self.ny) = (nx, frame.len() / nx);
        read(self, frame, cut);
    }

    /// Returns the image as an array, shape (ny, nx).
    pub fn view(&self) -> ArrayView2<'_, f64> {
        let view = ArrayView2::from_shape((self.ny, self.nx), &self.values);
        view.expect("ny · nx values")
    }

    /// Replaces `out` by the interpolated image values at the positions `places` (columns and rows) plus an offset.
    pub fn write_at(&self, places: &[(f64, f64)], offset: (f64, f64), out: &mut Vec<f64>) {
        out.resize(places.len(), 0.0);
        write_at(self, places, offset, out);
    }

    /// Returns the image value at a position between taxels, by bilinear interpolation; 0 outside the array.
    #[inline(always)]
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

/// Writes the image of a frame into `image`, whose shape is already set.
#[multiversion(targets("x86_64+avx2"))]
fn read(image: &mut Image, frame: &[f64], cut: Cut) {
    let Touched { x, y, value } = &mut image.touched;
    x.clear();
    y.clear();
    value.clear();
    image.values.clear();
    image.values.resize(frame.len(), 0.0);
    let least = cut.level.max(f64::MIN_POSITIVE);
    let off = match cut.foremost {
        Some(foremost) => (largest(frame) - foremost).max(0.0),
        None => 0.0,
    };
    let nx = image.nx;
    let (mut along_x, mut along_y) = (0.0, 0.0);
    (image.sum, image.largest) = (0.0, 0.0);
    for row in 0..image.ny {
        let from = &frame[row * nx..][..nx];
        if largest(from) < least {
            continue;
        }
        let to = &mut image.values[row * nx..][..nx];
        for column in 0..nx {
            let own = from[column];
            if own >= least && own > off {
                let own = own - off;
                to[column] = own;
                x.push(column as f64);
                y.push(row as f64);
                value.push(own);
                image.sum += own;
                along_x += column as f64 * own;
                along_y += row as f64 * own;
                image.largest = image.largest.max(own);
            }
        }
    }
    let middle = |n: usize| 0.5 * (n as f64 - 1.0);
    image.centroid = match image.sum > 0.0 {
        true => (along_x / image.sum, along_y / image.sum),
        false => (middle(nx), middle(image.ny)),
    };
}

/// Returns the largest of the values, at least 0; NaN is ignored.
#[inline(always)]
fn largest(values: &[f64]) -> f64 {
    let (lanes, last) = values.as_chunks::<8>();
    let mut most = [0.0; 8];
    for values in lanes {
        for lane in 0..8 {
            most[lane] = if values[lane] > most[lane] {
                values[lane]
            } else {
                most[lane]
            };
        }
    }
    let mut largest = 0.0;
    for value in last {
        largest = if *value > largest { *value } else { largest };
    }
    for value in most {
        largest = if value > largest { value } else { largest };
    }
    largest
}

#[multiversion(targets("x86_64+avx2"))]
fn write_at(image: &Image, places: &[(f64, f64)], (x, y): (f64, f64), out: &mut [f64]) {
    for at in 0..places.len() {
        out[at] = image.at(x + places[at].0, y + places[at].1);
    }
}
