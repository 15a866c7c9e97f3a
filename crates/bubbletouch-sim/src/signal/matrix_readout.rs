//! Matrix readout: resistive taxels at the crossings of rows and columns are read through shared lines.
//!
//! The conductance of a taxel is proportional to its value, g = x/X with the full scale X. A fully pressed taxel has conductance 1. The electronics apply 1 V
//! to one row, hold all other lines at 0 V, and measure the current of one column. Each line (wire and switch) has a resistance ε, relative to a fully pressed
//! taxel's resistance. The readings of taxels on one line therefore depend on each other \[DA\]. With t = 1/ε the voltages v of all lines obey A v = t eᵢ,
//!
//! A = ⎡ diag(t + Σⱼ gᵢⱼ)       −G        ⎤  and what is read is  xᵢⱼ ← X t² (A⁻¹)ᵢⱼ,
//!     ⎣       −Gᵀ        diag(t + Σᵢ gᵢⱼ) ⎦
//!
//! exactly, for all rows i and columns j. There are two visible effects. A taxel reads too little if its lines carry large currents. If three corners of a
//! rectangle are pressed, the fourth corner also has a reading (a ghost). With ε = 0 the readings are exact. A value below zero (due to earlier noise) has
//! zero conductance and is kept.
//!
//! \[DA\] D'Alessio, *Measurement errors in the scanning of piezoresistive sensors arrays*, Sensors and Actuators A 72, 1999.

use super::sensor_error::{Effect, ErrorAbout, Strength};
use crate::error::Error;
use crate::linalg::RowCholesky;

/// Readout of a grid through its row and column lines, for one line resistance, one grid and one full scale.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MatrixReadout {
    nx: usize,
    ny: usize,
    /// Resistance of a line, relative to the resistance of a fully pressed taxel.
    resistance: f64,
    /// Full scale of the frames, in the unit of the frames.
    full_scale: f64,
}

impl Effect for MatrixReadout {
    fn scratch_len(&self) -> usize {
        self.nx * (self.nx + 2)
    }

    fn apply_to_frame(&self, frame: &mut [f64], scratch: &mut [f64]) {
        assert_eq!(frame.len(), self.nx * self.ny, "one value for each taxel");
        if self.resistance == 0.0 {
            return;
        }
        let line = 1.0 / self.resistance;
        let conductance = |&value: &f64| value.max(0.0) / self.full_scale;
        let (schur, rest) = scratch.split_at_mut(self.nx * self.nx);
        let (currents, row) = rest.split_at_mut(self.nx);
        let row = &mut row[..self.nx];
        // Schur complement of A after elimination of the rows: diag(t + Σᵢ gᵢⱼ) − Gᵀ diag(t + Σⱼ gᵢⱼ)⁻¹ G.
        schur.fill(0.0);
        currents.fill(0.0);
        for values in frame.chunks_exact(self.nx) {
            let total: f64 = values.iter().map(conductance).sum();
            if total == 0.0 {
                continue;
            }
            for (a, value) in values.iter().enumerate() {
                let share = conductance(value) / (line + total);
                currents[a] += conductance(value);
                if share > 0.0 {
                    let below = schur[a * self.nx..].iter_mut().zip(&values[..=a]);
                    below.for_each(|(entry, other)| *entry -= share * conductance(other));
                }
            }
        }
        for (a, current) in currents.iter().enumerate() {
            schur[a * self.nx + a] += line + current;
        }
        let schur = RowCholesky::new(schur, self.nx);
        for values in frame.chunks_exact_mut(self.nx) {
            let total: f64 = values.iter().map(conductance).sum();
            if total == 0.0 {
                continue;
            }
            for (entry, value) in row.iter_mut().zip(values.iter()) {
                *entry = conductance(value) / (line + total);
            }
            schur.solve(row);
            for (value, voltage) in values.iter_mut().zip(row.iter()) {
                *value = value.min(0.0) + self.full_scale * line * line * voltage;
            }
        }
    }
}

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    needs_places: true,
    ..ErrorAbout::new(
        "matrix_readout",
        &[Strength::share(
            "line_resistance",
            "line resistance",
            "zero or a positive part of the resistance of a fully pressed taxel",
        )],
        |&[resistance, _], skin| {
            let Some(grid) = skin.patch.layout().as_grid() else {
                let allowed = "a grid: a matrix has rows and columns";
                return Err(Error::input(
                    "matrix readout",
                    "a skin that is no grid",
                    allowed,
                ));
            };
            if skin.least < 0.0 {
                let allowed = "forces along the axes: a resistance has no sign";
                return Err(Error::input("matrix readout", "shear", allowed));
            }
            Ok(Box::new(MatrixReadout {
                nx: grid.nx,
                ny: grid.ny,
                resistance,
                full_scale: skin.full_scale,
            }))
        },
    )
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    const FULL_SCALE: f64 = 5e-3;

    fn read(frame: &[f64], (nx, ny): (usize, usize), resistance: f64) -> Vec<f64> {
        let readout = MatrixReadout {
            nx,
            ny,
            resistance,
            full_scale: FULL_SCALE,
        };
        let mut out = frame.to_vec();
        readout.apply_to_frame(&mut out, &mut vec![f64::NAN; nx * (nx + 2) + 5]);
        out
    }

    /// Returns a frame with pressed and unpressed taxels.
    fn pressed(n: usize, case: u64) -> Vec<f64> {
        let mut rng = Seed::new(3).numbered(case).rng();
        let value = |_| FULL_SCALE * rng.gen_range(-1.0..1.0_f64).max(0.0);
        (0..n).map(value).collect()
    }

    /// Returns the currents of the columns while one row is driven, for each row. The function solves Kirchhoff's law at every line by elimination.
    fn network(frame: &[f64], (nx, ny): (usize, usize), resistance: f64) -> Vec<f64> {
        let line = 1.0 / resistance;
        let mut out = Vec::new();
        for driven in 0..ny {
            let n = nx + ny;
            let mut a = vec![vec![0.0; n + 1]; n];
            for (k, equation) in a.iter_mut().enumerate() {
                equation[k] = line;
            }
            a[driven][n] = line;
            for (taxel, value) in frame.iter().enumerate() {
                let (i, j) = (taxel / nx, ny + taxel % nx);
                let g = value / FULL_SCALE;
                for (one, other) in [(i, j), (j, i)] {
                    a[one][one] += g;
                    a[one][other] -= g;
                }
            }
            for k in 0..n {
                let pivot = a[k].clone();
                for (row, equation) in a.iter_mut().enumerate() {
                    let part = equation[k] / pivot[k];
                    if row != k {
                        let pairs = equation.iter_mut().zip(&pivot);
                        pairs.for_each(|(entry, p)| *entry -= part * p);
                    }
                }
            }
            let voltage = |column: usize| a[ny + column][n] / a[ny + column][ny + column];
            out.extend((0..nx).map(|column| FULL_SCALE * line * voltage(column)));
        }
        out
    }

    #[test]
    fn it_is_the_current_of_the_network_of_lines_and_taxels() {
        for (case, &(nx, ny)) in [(1, 1), (1, 6), (5, 1), (7, 4), (6, 9)].iter().enumerate() {
            let frame = pressed(nx * ny, case as u64);
            for resistance in [1e-6, 0.01, 0.3, 20.0] {
                let expected = network(&frame, (nx, ny), resistance);
                for (out, expected) in read(&frame, (nx, ny), resistance).iter().zip(&expected) {
                    let error = (out - expected).abs();
                    assert!(
                        error < 1e-12 * FULL_SCALE,
                        "{nx} × {ny}, {resistance}: {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn lines_without_resistance_read_each_taxel_as_it_is() {
        let frame = pressed(20, 1);
        assert_eq!(read(&frame, (5, 4), 0.0), frame);
        // A single taxel is in series with its two lines.
        let one = read(&[FULL_SCALE], (1, 1), 0.25)[0];
        assert!((one - FULL_SCALE / 1.5).abs() < 1e-17);
        // Negative values do not conduct.
        assert_eq!(read(&[-1e-3, 0.0], (2, 1), 0.25), [-1e-3, 0.0]);
    }

    #[test]
    fn three_corners_of_a_rectangle_show_the_fourth_and_two_show_no_other() {
        let mut frame = vec![0.0; 20]; // 5 × 4
        (frame[6], frame[16]) = (FULL_SCALE, FULL_SCALE); // column 1 of rows 1 and 3
        let out = read(&frame, (5, 4), 0.1);
        assert!(
            out.iter()
                .zip(&frame)
                .all(|(out, felt)| (*out > 0.0) == (*felt > 0.0))
        );
        frame[18] = FULL_SCALE; // column 3 of row 3
        let out = read(&frame, (5, 4), 0.1);
        let ghost = out[8] / FULL_SCALE; // column 3 of row 1
        assert!((0.005..0.1).contains(&ghost), "{ghost}");
        // The shared line of two taxels carries more current, so both read less.
        assert!(out[16] < out[6] && out[18] > out[16]);
    }
}
