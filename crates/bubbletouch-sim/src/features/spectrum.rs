//! Magnitude of the two-dimensional Fourier transform of an image, at low frequencies.
//!
//! F(u, v) = Σ δ(x, y) exp(−2πi (u x / nx + v y / ny)). The image is real, so F(−u, −v) is the conjugate of F(u, v), and columns u ≥ 0 suffice.

use super::image::Image;
use super::rings::roots;
use crate::world::ImageShape;
use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};
use std::fmt;
use std::sync::Arc;

/// Fourier transform of an image that computes the magnitudes for column frequencies 0 to `n_columns` − 1 and all row frequencies.
pub(super) struct Spectrum {
    nx: usize,
    ny: usize,
    n_columns: usize,
    along_x: Arc<dyn RealToComplex<f64>>,
    along_y: Arc<dyn Fft<f64>>,
}

/// Scratch memory for the Fourier transforms.
#[derive(Clone, Debug, Default)]
pub struct FourierWorkspace {
    line: Vec<f64>,
    of_line: Vec<Complex<f64>>,
    columns: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
    /// Magnitudes of the spectrum; the value for the column frequency u and the row frequency v is at index u · ny + v.
    pub(super) magnitudes: Vec<f64>,
}

impl Spectrum {
    /// Prepares the transform of ny × nx images for column frequencies 0 to `last`, limited to the existing columns.
    pub(super) fn new(ImageShape { ny, nx }: ImageShape, last: usize) -> Self {
        Self {
            nx,
            ny,
            n_columns: (last + 1).min(nx / 2 + 1),
            along_x: RealFftPlanner::new().plan_fft_forward(nx),
            along_y: FftPlanner::new().plan_fft_forward(ny),
        }
    }

    /// Returns the number of column frequencies, counted from 0.
    pub(super) fn n_columns(&self) -> usize {
        self.n_columns
    }

    /// Transforms the rows of an image that contain touched taxels, then the columns.
    pub(super) fn transform(&self, image: &Image, workspace: &mut FourierWorkspace) {
        assert_eq!((image.nx, image.ny), (self.nx, self.ny));
        let FourierWorkspace {
            line,
            of_line,
            columns,
            scratch,
            magnitudes,
        } = workspace;
        let zero = Complex::default();
        columns.clear();
        columns.resize(self.n_columns * self.ny, zero);
        of_line.resize(self.nx / 2 + 1, zero);
        let of_rows = self.along_x.get_scratch_len();
        scratch.resize(of_rows.max(self.along_y.get_inplace_scratch_len()), zero);
        for row in image.touched.y.chunk_by(|a, b| a == b) {
            let y = row[0] as usize;
            line.clear();
            line.extend_from_slice(&image.values[y * self.nx..(y + 1) * self.nx]);
            let along_x = &self.along_x;
            let done = along_x.process_with_scratch(line, of_line, &mut scratch[..of_rows]);
            done.expect("lines of nx values");
            for (column, value) in of_line[..self.n_columns].iter().enumerate() {
                columns[column * self.ny + y] = *value;
            }
        }
        self.along_y.process_with_scratch(columns, scratch);
        magnitudes.clear();
        magnitudes.extend(columns.iter().map(|value| value.norm_sqr()));
        roots(magnitudes);
    }
}

impl fmt::Debug for Spectrum {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { nx, ny, .. } = self;
        write!(f, "Spectrum of {ny} × {nx}, {} columns", self.n_columns)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::Cut;
    use super::*;
    use std::f64::consts::TAU;

    /// Returns the magnitude of the spectrum at the frequencies (u, v) by its definition; u may be negative.
    pub(crate) fn by_definition(image: &Image, u: isize, v: isize) -> f64 {
        let of = |n: usize, k: isize, i: f64| k as f64 * i / n as f64;
        let super::super::image::Touched { x, y, value } = &image.touched;
        let terms = x.iter().zip(y).zip(value).map(|((&x, &y), &value)| {
            let angle = -TAU * (of(image.nx, u, x) + of(image.ny, v, y));
            Complex::from_polar(value, angle)
        });
        terms.sum::<Complex<f64>>().norm()
    }

    #[test]
    fn magnitudes_are_those_of_the_definition_on_any_array() {
        for shape in
            [(8, 8), (5, 12), (12, 5), (1, 7), (7, 1)].map(|(ny, nx)| ImageShape { ny, nx })
        {
            let ImageShape { ny, nx } = shape;
            let frame: Vec<f64> = (0..ny * nx).map(|i| (i * i % 7) as f64).collect();
            let mut image = Image::default();
            image.read(&frame, nx, Cut::default());
            let spectrum = Spectrum::new(shape, nx / 3 + 1);
            let mut workspace = FourierWorkspace::default();
            spectrum.transform(&image, &mut workspace);
            assert_eq!(workspace.magnitudes.len(), spectrum.n_columns() * ny);
            for u in 0..spectrum.n_columns() {
                for v in 0..ny {
                    let expected = by_definition(&image, u as isize, v as isize);
                    let found = workspace.magnitudes[u * ny + v];
                    assert!((found - expected).abs() < 1e-11 * (1.0 + image.sum));
                }
            }
        }
    }
}
