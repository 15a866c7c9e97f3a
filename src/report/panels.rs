//! Panels of a chart side by side and row by row, below its heading.

use super::legend::{LEFT, RIGHT};
use crate::report::drawing::Area;

/// Pixels between panels.
const GAP: f64 = 26.0;

/// Where the panels of a chart stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Panels {
    /// How many.
    n: usize,
    columns: usize,
    /// Pixels across and down of one.
    size: (f64, f64),
    /// Pixels above each, for its title.
    above: f64,
    /// Pixels below each, for its labels.
    pub below: f64,
}

impl Panels {
    /// Panels in so many columns; the more columns, the smaller the panels.
    pub(super) fn new(n: usize, columns: usize, above: f64, below: f64) -> Self {
        let size = match columns {
            1 => (660.0, 340.0),
            2 => (385.0, 300.0),
            _ => (272.0, 240.0),
        };
        Self {
            n,
            columns,
            size,
            above,
            below,
        }
    }

    /// Pixels across of the chart.
    pub(super) fn width(&self) -> f64 {
        LEFT + self.columns as f64 * self.size.0 + (self.columns - 1) as f64 * GAP + RIGHT
    }

    /// Where a chart ends, pixels down, whose heading ends at `top`.
    pub(super) fn bottom(&self, top: f64) -> f64 {
        top + self.n.div_ceil(self.columns) as f64 * self.pitch() + 26.0
    }

    /// The frame of a panel by its number.
    pub(super) fn frame(&self, panel: usize, top: f64) -> Area {
        let (row, column) = (panel / self.columns, panel % self.columns);
        Area {
            x: LEFT + column as f64 * (self.size.0 + GAP),
            y: top + row as f64 * self.pitch() + self.above,
            width: self.size.0,
            height: self.size.1,
        }
    }

    /// Whether a panel stands at the left edge.
    pub(super) fn is_first_in_row(&self, panel: usize) -> bool {
        panel.is_multiple_of(self.columns)
    }

    /// Whether no panel stands below a panel.
    pub(super) fn is_last_in_column(&self, panel: usize) -> bool {
        panel + self.columns >= self.n
    }

    fn pitch(&self) -> f64 {
        self.above + self.size.1 + self.below
    }
}
