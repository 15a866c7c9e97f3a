//! Separable Gaussian smoothing of a physical width.
//!
//! The kernel is G(t) ∝ exp(−½ (t p / w)²) for whole taxel steps |t| ≤ ⌊4 w/p + ½⌋, normalised to sum 1. The frame is convolved along y and then along x.
//! The width w (σ) and the pitch p are in metres, so w covers an equal area of skin at every pitch. Beyond its edge, the frame is mirrored with the edge
//! taxel included (d c b a | a b c d | d c b a). Truncation and mirroring equal the defaults of `scipy.ndimage.gaussian_filter`.

use super::sensor_error::Effect;
use crate::error::{Error, Result};
use crate::world::Grid;
use multiversion::multiversion;

/// Radius at which the Gaussian kernel is cut off, in multiples of its standard deviation.
const TRUNCATE: f64 = 4.0;
/// Largest width of the Gaussian kernel, in taxel pitches. The limit is far above the size of any array and bounds the time to sum the kernel (about 50 ms).
const MAX_WIDTH_PITCHES: f64 = 1e6;

/// Gaussian smoothing with one width, for one grid.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Smoothing {
    nx: usize,
    ny: usize,
    /// Kernel weights at distances of 0, 1, … taxels along x, including the weights of mirrored taxels; at most nx + 1 weights.
    taps_x: Vec<f64>,
    /// Kernel weights at distances of 0, 1, … taxels along y, including the weights of mirrored taxels; at most ny + 1 weights.
    taps_y: Vec<f64>,
}

impl Smoothing {
    /// Prepares Gaussian smoothing for a grid. `width` is the standard deviation of the kernel, metres, zero or positive. Width 0 has no effect.
    ///
    /// # Errors
    /// If the width is negative, not finite or above a million pitches.
    pub(crate) fn new(width: f64, grid: &Grid) -> Result<Self> {
        grid.check()?;
        let width_pitches = width / grid.pitch;
        if !(width >= 0.0 && width_pitches <= MAX_WIDTH_PITCHES) {
            return Err(Error::input(
                "smoothing width",
                format!("{width} m on a pitch of {} m", grid.pitch),
                "from zero to a million pitches",
            ));
        }
        Ok(Self {
            nx: grid.nx,
            ny: grid.ny,
            taps_x: folded_taps(width_pitches, grid.nx),
            taps_y: folded_taps(width_pitches, grid.ny),
        })
    }
}

impl Effect for Smoothing {
    /// Returns the length of one frame and one mirrored line.
    fn scratch_len(&self) -> usize {
        self.nx * self.ny + self.nx + 2 * (self.taps_x.len() - 1)
    }

    fn apply_to_frame(&self, frame: &mut [f64], scratch: &mut [f64]) {
        assert_eq!(frame.len(), self.nx * self.ny, "one value for each taxel");
        if self.taps_x.len() == 1 && self.taps_y.len() == 1 {
            return;
        }
        let (columns_done, line) = scratch.split_at_mut(frame.len());
        smooth_columns(frame, columns_done, self.nx, &self.taps_y);
        let line = &mut line[..self.nx + 2 * (self.taps_x.len() - 1)];
        for (row_in, row_out) in columns_done
            .chunks_exact(self.nx)
            .zip(frame.chunks_exact_mut(self.nx))
        {
            smooth_row(row_in, row_out, line, &self.taps_x);
        }
    }
}

/// Smooths a frame along y. Each output row is a weighted sum of input rows. Rows at equal distances are added first, so that a flipped frame gives the
/// flipped result bit by bit.
fn smooth_columns(frame: &[f64], out: &mut [f64], nx: usize, taps: &[f64]) {
    let ny = frame.len() / nx;
    let row = |y: isize| {
        let y = mirrored(y, ny);
        &frame[y * nx..(y + 1) * nx]
    };
    for (y, out) in out.chunks_exact_mut(nx).enumerate() {
        let y = y as isize;
        start(out, row(y), taps[0]);
        for (distance, tap) in taps.iter().enumerate().skip(1) {
            let (above, below) = (row(y - distance as isize), row(y + distance as isize));
            add_pair(out, (above, below), *tap);
        }
    }
}

fn smooth_row(row: &[f64], out: &mut [f64], line: &mut [f64], taps: &[f64]) {
    let reach = taps.len() - 1;
    let nx = row.len();
    line[reach..reach + nx].copy_from_slice(row);
    for distance in 1..=reach {
        line[reach - distance] = row[mirrored(-(distance as isize), nx)];
        line[reach + nx - 1 + distance] = row[mirrored((nx - 1 + distance) as isize, nx)];
    }
    start(out, row, taps[0]);
    for (distance, tap) in taps.iter().enumerate().skip(1) {
        let left = &line[reach - distance..][..nx];
        let right = &line[reach + distance..][..nx];
        add_pair(out, (left, right), *tap);
    }
}

fn start(out: &mut [f64], values: &[f64], tap: f64) {
    for (out, value) in out.iter_mut().zip(values) {
        *out = tap * value;
    }
}

/// Adds `tap` times the sum of the rows `a` and `b` to `out`; both rows have the same distance from the output row.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
fn add_pair(out: &mut [f64], (a, b): (&[f64], &[f64]), tap: f64) {
    let n = out.len();
    let (a, b) = (&a[..n], &b[..n]);
    for at in 0..n {
        out[at] += tap * (a[at] + b[at]);
    }
}

/// Returns the index of the taxel at an integer `position`, in a line of `n` taxels that is continued endlessly by mirroring.
fn mirrored(position: isize, n: usize) -> usize {
    let wrapped = position.rem_euclid(2 * n as isize) as usize;
    wrapped.min(2 * n - 1 - wrapped)
}

/// Returns the kernel weights at distances of 0, 1, … taxels, at most n + 1 weights. The mirrored line repeats every 2n taxels, so the weight at distance t
/// is added to the weight at t mod 2n.
fn folded_taps(width_pitches: f64, n: usize) -> Vec<f64> {
    let reach = (TRUNCATE * width_pitches + 0.5) as usize;
    let weight = |t: usize| (-0.5 * (t as f64 / width_pitches).powi(2)).exp();
    let mut taps = vec![0.0; reach.min(n) + 1];
    taps[0] = 1.0;
    let mut sum = 1.0;
    for t in 1..=reach {
        let weight = weight(t);
        sum += 2.0 * weight;
        let wrapped = t % (2 * n);
        let distance = wrapped.min(2 * n - wrapped);
        // At distance 0 both taps of the pair read one taxel; every other distance keeps its pair.
        taps[distance] += if distance == 0 { 2.0 * weight } else { weight };
    }
    for tap in &mut taps {
        *tap /= sum;
    }
    taps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smoothed(frame: &[f64], nx: usize, ny: usize, width_pitches: f64) -> Vec<f64> {
        let grid = Grid {
            nx,
            ny,
            pitch: 2e-3,
        };
        let smoothing = Smoothing::new(width_pitches * grid.pitch, &grid).unwrap();
        let mut out = frame.to_vec();
        smoothing.apply_to_frame(&mut out, &mut vec![f64::NAN; smoothing.scratch_len()]);
        out
    }

    #[test]
    fn width_zero_changes_nothing() {
        let frame: Vec<f64> = (0..12).map(|i| (i as f64).sin()).collect();
        assert_eq!(smoothed(&frame, 4, 3, 0.0), frame);
        // A kernel radius below half a step has no effect: 4 σ + ½ < 1.
        assert_eq!(smoothed(&frame, 4, 3, 0.1), frame);
    }

    #[test]
    fn a_constant_frame_stays_and_any_frame_keeps_its_mean() {
        for (nx, ny) in [(1, 1), (1, 7), (5, 1), (8, 6)] {
            for width in [0.3, 1.0, 2.5, 40.0, 1e4] {
                let flat = smoothed(&vec![0.25; nx * ny], nx, ny, width);
                assert!(flat.iter().all(|v| (v - 0.25).abs() < 1e-14));
                let frame: Vec<f64> = (0..nx * ny).map(|i| (3.7 * i as f64).sin()).collect();
                let kept = smoothed(&frame, nx, ny, width).iter().sum::<f64>();
                assert!((kept - frame.iter().sum::<f64>()).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_flipped_frame_gives_the_flipped_result_bit_by_bit() {
        let frame: Vec<f64> = (0..35).map(|i| (1.3 * i as f64).sin()).collect();
        let flipped: Vec<f64> = frame.iter().rev().copied().collect();
        for width in [0.7, 2.0, 9.0] {
            let mut back = smoothed(&flipped, 7, 5, width);
            back.reverse();
            assert_eq!(back, smoothed(&frame, 7, 5, width));
        }
    }

    #[test]
    fn negative_undefined_and_boundless_widths_are_refused() {
        let grid = Grid {
            nx: 2,
            ny: 2,
            pitch: 1e-3,
        };
        for width in [-1e-3, f64::NAN, f64::INFINITY, 2e3] {
            let error = Smoothing::new(width, &grid).unwrap_err();
            assert!(error.to_string().starts_with("smoothing width"));
        }
    }
}
