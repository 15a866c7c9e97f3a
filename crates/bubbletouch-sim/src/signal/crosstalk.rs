//! Crosstalk: a fraction of each taxel's value leaks to its neighbours.
//!
//! The operator is xᵢ ← (1 − κ) xᵢ + κ/4 (x_left + x_right + x_above + x_below). A fraction κ of each value leaks, a quarter of it to each of the four
//! neighbours. At an edge the missing neighbour is replaced by the taxel itself. Rows and columns of this operator sum to 1. A uniform pressure is
//! therefore unchanged, and the sum over the array is conserved, as if a cover or a shared wire distributed the load.
//! Only four of the eight neighbours are coupled directly, because coupling decreases with distance; values reach a diagonal
//! neighbour through two steps.

use super::sensor_error::{Effect, ErrorAbout, Strength};
use crate::world::{Grid, Neighbours};

/// Crosstalk between neighbouring taxels of one grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crosstalk {
    nx: usize,
    ny: usize,
    leak: f64,
}

impl Crosstalk {
    /// Prepares crosstalk. `leak` is the fraction of a taxel's value that leaks to its neighbours, 0 to 1.
    pub(crate) fn new(leak: f64, grid: &Grid) -> Self {
        Self {
            nx: grid.nx,
            ny: grid.ny,
            leak,
        }
    }
}

impl Effect for Crosstalk {
    fn scratch_len(&self) -> usize {
        self.nx * self.ny
    }

    fn apply_to_frame(&self, frame: &mut [f64], scratch: &mut [f64]) {
        assert_eq!(frame.len(), self.nx * self.ny, "one value for each taxel");
        let felt = &mut scratch[..frame.len()];
        felt.copy_from_slice(frame);
        let row = |y: usize| &felt[y * self.nx..(y + 1) * self.nx];
        for (y, out) in frame.chunks_exact_mut(self.nx).enumerate() {
            let (above, here) = (row(y.saturating_sub(1)), row(y));
            let below = row((y + 1).min(self.ny - 1));
            for (x, out) in out.iter_mut().enumerate() {
                let (left, right) = (here[x.saturating_sub(1)], here[(x + 1).min(self.nx - 1)]);
                let neighbours = (left + right) + (above[x] + below[x]);
                *out = here[x] + self.leak * (0.25 * neighbours - here[x]);
            }
        }
    }
}

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    needs_places: true,
    ..ErrorAbout::new(
        "crosstalk",
        &[Strength::fraction("crosstalk", "crosstalk")],
        |&[leak, _], skin| {
            Ok(match skin.patch.whole_grid() {
                Some(grid) => Box::new(Crosstalk::new(leak, grid)),
                None => Box::new(SurfaceLeak {
                    leak,
                    neighbours: Neighbours::new(skin.patch),
                }),
            })
        },
    )
};

/// Crosstalk between neighbouring taxels on a skin that is not a grid.
#[derive(Debug)]
struct SurfaceLeak {
    leak: f64,
    neighbours: Neighbours,
}

impl Effect for SurfaceLeak {
    fn scratch_len(&self) -> usize {
        self.neighbours.n_taxels()
    }

    fn apply_to_frame(&self, frame: &mut [f64], scratch: &mut [f64]) {
        let share = self.leak / self.neighbours.most().max(1) as f64;
        let felt = &mut scratch[..frame.len()];
        felt.copy_from_slice(frame);
        for (taxel, out) in frame.iter_mut().enumerate() {
            let differences = self.neighbours.of_taxel(taxel);
            let differences = differences.map(|other| felt[other] - felt[taxel]);
            *out += share * differences.sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn leaked(frame: &[f64], (nx, ny): (usize, usize), leak: f64) -> Vec<f64> {
        let pitch = 2e-3;
        let crosstalk = Crosstalk::new(leak, &Grid { nx, ny, pitch });
        let mut out = frame.to_vec();
        crosstalk.apply_to_frame(&mut out, &mut vec![f64::NAN; nx * ny + 3]);
        out
    }

    #[test]
    fn one_pressed_taxel_keeps_its_share_and_gives_each_neighbour_a_quarter_of_the_leak() {
        let mut frame = [0.0; 20];
        frame[7] = 1.0; // row 1, column 2 of 4 × 5
        let out = leaked(&frame, (5, 4), 0.2);
        for (taxel, value) in out.iter().enumerate() {
            let expected = match taxel {
                7 => 0.8,
                2 | 6 | 8 | 12 => 0.05,
                _ => 0.0,
            };
            assert!((value - expected).abs() < 1e-16, "taxel {taxel}: {value}");
        }
    }

    #[test]
    fn an_even_frame_stays_bit_by_bit_and_any_frame_keeps_its_sum() {
        for (nx, ny) in [(1, 1), (1, 7), (5, 1), (8, 6)] {
            let frame: Vec<f64> = (0..nx * ny).map(|i| (3.7 * i as f64).sin()).collect();
            for leak in [0.0, 0.1, 0.8, 1.0] {
                let even = vec![0.3; nx * ny];
                assert_eq!(leaked(&even, (nx, ny), leak), even);
                let out = leaked(&frame, (nx, ny), leak);
                let kept = out.iter().sum::<f64>() - frame.iter().sum::<f64>();
                assert!(kept.abs() < 1e-13, "{kept}");
            }
        }
    }

    #[test]
    fn cosines_come_back_smaller_by_their_eigenvalue() {
        let (nx, ny) = (9, 6);
        for (a, b) in [(0, 0), (1, 0), (3, 2), (8, 5)] {
            let phase = |i: usize, k: usize, n: usize| PI * k as f64 * (i as f64 + 0.5) / n as f64;
            let mode = |i: usize| phase(i % nx, a, nx).cos() * phase(i / nx, b, ny).cos();
            let frame: Vec<f64> = (0..nx * ny).map(mode).collect();
            let slope = |k: usize, n: usize| (PI * k as f64 / n as f64).cos();
            let eigenvalue = 1.0 - 0.6 * (1.0 - 0.5 * (slope(a, nx) + slope(b, ny)));
            for (out, value) in leaked(&frame, (nx, ny), 0.6).iter().zip(&frame) {
                assert!((out - eigenvalue * value).abs() < 1e-15);
            }
        }
    }
}
