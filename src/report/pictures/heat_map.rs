//! Heat map of a frame: its colour scale, and the averaging of large frames over blocks of taxels.

use crate::error::{Error, Result};
use crate::report::pictures::{Rgb, heat};
use crate::signal::Quantity;
use crate::table::short_number;
use ndarray::{Array2, ArrayView2};

/// Returns the size and pitch of a grid of taxels as text, such as `64 × 64 taxels, pitch 3.5 mm`.
pub(crate) fn grid_sentence((nx, ny): (usize, usize), pitch_mm: f64) -> String {
    format!("{nx} × {ny} taxels, pitch {} mm", short_number(pitch_mm))
}

/// Returns a text that each cell shows `block` × `block` taxels; empty if each cell shows one taxel.
pub(crate) fn block_sentence(block: usize) -> String {
    match block {
        1 => String::new(),
        _ => format!("; each cell is the largest of {block} × {block}"),
    }
}

/// Colour scale of a heat map: the values of the darkest and lightest colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourScale {
    /// Physical quantity of the values, which determines their unit.
    pub quantity: Quantity,
    /// Value of the darkest colour, in displayed units: 0, or the lowest value if some values are negative.
    pub low: f64,
    /// Value of the lightest colour, in displayed units.
    pub high: f64,
}

impl ColourScale {
    /// Creates a colour scale that covers the given values, in metres or newtons. If all values are zero, the scale is 0 to 1.
    pub fn over<'a>(values: impl IntoIterator<Item = &'a f64>, quantity: Quantity) -> Self {
        let mut scale = Self {
            quantity,
            low: 0.0,
            high: 0.0,
        };
        for value in values {
            scale.low = scale.low.min(value * quantity.factor());
            scale.high = scale.high.max(value * quantity.factor());
        }
        if scale.high <= scale.low {
            scale.high = scale.low + 1.0;
        }
        scale
    }

    /// Returns the position of a value (metres or newtons) on the colour scale, 0 to 1.
    pub fn place(&self, value: f64) -> f64 {
        let shown = value * self.quantity.factor();
        ((shown - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Returns the colour of a value (metres or newtons).
    pub(crate) fn colour(&self, value: f64) -> Rgb {
        heat(self.place(value))
    }
}

/// Checks that a frame can be drawn as a heat map.
///
/// # Errors
/// If the frame has no taxels, or a value that is not finite.
pub fn check_frame(frame: &Array2<f64>) -> Result<()> {
    let (ny, nx) = frame.dim();
    if frame.is_empty() {
        return Err(Error::input(
            "frame",
            format!("{ny} rows × {nx} columns"),
            "at least one row and one column",
        ));
    }
    let broken = frame.indexed_iter().find(|(_, value)| !value.is_finite());
    match broken {
        Some(((row, column), value)) => Err(Error::input(
            format!("frame row {row}, column {column}"),
            value,
            "a finite number",
        )),
        None => Ok(()),
    }
}

/// Returns a smaller frame that contains the largest value of each block of taxels. The size of a block (rows, columns) is `block`; blocks at the upper and
/// right edge may be smaller.
pub fn largest_of_blocks(frame: &Array2<f64>, block: (usize, usize)) -> Array2<f64> {
    let (ny, nx) = frame.dim();
    let (down, across) = (block.0.max(1), block.1.max(1));
    Array2::from_shape_fn((ny.div_ceil(down), nx.div_ceil(across)), |(row, column)| {
        let rows = row * down..((row + 1) * down).min(ny);
        let columns = column * across..((column + 1) * across).min(nx);
        let part: ArrayView2<f64> = frame.slice(ndarray::s![rows, columns]);
        part.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn blocks_keep_the_peak() {
        let frame = Array2::from_shape_fn((7, 5), |(row, column)| (row * 5 + column) as f64);
        let small = largest_of_blocks(&frame, (3, 2));
        assert_eq!(
            small,
            array![[11.0, 13.0, 14.0], [26.0, 28.0, 29.0], [31.0, 33.0, 34.0]]
        );
    }

    #[test]
    fn a_frame_that_nobody_can_draw_is_an_error() {
        assert!(check_frame(&Array2::zeros((0, 3))).is_err());
        let said = check_frame(&array![[0.0, 1.0], [f64::NAN, 0.0]]).unwrap_err();
        assert_eq!(
            said.to_string(),
            "frame row 1, column 0: NaN; a finite number"
        );
        assert!(check_frame(&array![[0.0]]).is_ok());
    }
}
