//! Lines of a grid patch: positions of its rows and columns, and search for the lines near a coordinate.

use crate::world::Grid;
use std::ops::Range;

/// Bound of rounding errors in positions on the grid, as a fraction of the pitch. The bound is far above 1e-16 of the largest grid and far below any measurable
/// distance.
const ROUNDING: f64 = 1e-9;

/// Positions of the columns and rows of a grid.
#[derive(Clone, Debug, Default)]
pub struct GridLines {
    /// Positions of the columns along x.
    pub x: Lines,
    /// Positions of the rows along y.
    pub y: Lines,
    grid: Option<Grid>,
}

/// Equidistant parallel lines, in ascending order.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    /// Positions of the lines, metres.
    pub positions: Vec<f64>,
    /// Number of lines per metre, the reciprocal of their distance.
    density: f64,
}

impl GridLines {
    /// Sets the lines to the columns and rows of a grid; returns at once if the grid is unchanged.
    pub fn lay(&mut self, grid: &Grid) {
        if self.grid.as_ref() == Some(grid) {
            return;
        }
        self.grid = Some(*grid);
        self.x
            .lay((0..grid.nx).map(|column| grid.x(column)), grid.pitch);
        self.y.lay((0..grid.ny).map(|row| grid.y(row)), grid.pitch);
    }
}

impl Lines {
    /// Creates lines at the given positions, metres, ascending and equidistant.
    pub fn at(positions: &[f64]) -> Self {
        let steps = positions.len().saturating_sub(1).max(1) as f64;
        let length =
            positions.last().copied().unwrap_or(0.0) - positions.first().copied().unwrap_or(0.0);
        Self {
            positions: positions.to_vec(),
            // The density of a single line is arbitrary.
            density: if length > 0.0 { steps / length } else { 1.0 },
        }
    }

    fn lay(&mut self, positions: impl Iterator<Item = f64>, pitch: f64) {
        self.positions.clear();
        self.positions.extend(positions);
        self.density = 1.0 / pitch;
    }

    /// Returns the number of lines per metre.
    pub(super) fn density(&self) -> f64 {
        self.density
    }

    /// Returns the position of the line that is nearest to a coordinate, metres.
    #[inline(always)]
    pub fn nearest(&self, coordinate: f64) -> f64 {
        let index = (coordinate - self.positions[0]) * self.density + 0.5;
        // The cast truncates, and saturates for coordinates beside the grid.
        self.positions[(index as u32 as usize).min(self.positions.len() - 1)]
    }

    /// Returns the indices of the lines within `half_width` of a coordinate, metres. The range includes lines that are farther away only by rounding.
    ///
    /// Casts to integers truncate, and saturate for coordinates beside the grid. Casts replace floor and ceil, which are function calls on the oldest
    /// supported processors. A cast to 32 bits needs fewer instructions than a cast to 64 bits.
    #[inline(always)]
    pub fn within(&self, coordinate: f64, half_width: f64) -> Range<usize> {
        let index = (coordinate - self.positions[0]) * self.density;
        let spread = half_width * self.density + ROUNDING;
        let start = (index - spread + 1.0) as u32 as usize;
        let end = ((index + spread) as u32 as usize + 1).min(self.positions.len());
        start.min(end)..end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines() -> GridLines {
        let mut lines = GridLines::default();
        lines.lay(&Grid {
            nx: 7,
            ny: 4,
            pitch: 2e-3,
        });
        lines
    }

    #[test]
    fn every_line_within_is_in_the_range_and_none_beyond_rounding() {
        let lines = lines();
        for step in -3000..3000 {
            let coordinate = f64::from(step) * 1e-5;
            for half_width in [0.0, 1e-9, 1e-3, 2e-3, 3.3e-3, 1.0] {
                let range = lines.x.within(coordinate, half_width);
                for (index, position) in lines.x.positions.iter().enumerate() {
                    let distance = (position - coordinate).abs();
                    if distance <= half_width {
                        assert!(range.contains(&index), "{coordinate} {half_width} {index}");
                    }
                    let left_of_grid = coordinate + half_width < lines.x.positions[0];
                    if distance > half_width + 1e-11 && !left_of_grid {
                        assert!(!range.contains(&index), "{coordinate} {half_width} {index}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_nearest_line_is_the_nearest() {
        let lines = lines();
        for step in -3000..3000 {
            let coordinate = f64::from(step) * 1e-5;
            let nearest = lines.y.nearest(coordinate);
            for position in &lines.y.positions {
                assert!((nearest - coordinate).abs() <= (position - coordinate).abs() + 1e-15);
            }
        }
    }

    #[test]
    fn another_grid_is_laid_anew() {
        let mut lines = lines();
        lines.lay(&Grid {
            nx: 2,
            ny: 2,
            pitch: 1.0,
        });
        assert_eq!(lines.x.positions, [-0.5, 0.5]);
    }
}
