//! A frame as a heat map with axes in millimetres and a colour bar, part of a drawing.

use crate::error::{Error, Result};
use crate::report::chart::even_ticks;
use crate::report::colours::{INK, Rgb, heat};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::signal::Quantity;
use crate::table::short_number;
use ndarray::{Array2, ArrayView2};

/// How many taxels a grid has and how far apart they are: `64 × 64 taxels, pitch 3.5 mm`.
pub(crate) fn grid_sentence((nx, ny): (usize, usize), pitch_mm: f64) -> String {
    format!("{nx} × {ny} taxels, pitch {} mm", short_number(pitch_mm))
}

/// What is said of cells that stand for `block` × `block` taxels, behind another sentence; nothing of those that do not.
pub(crate) fn block_sentence(block: usize) -> String {
    match block {
        1 => String::new(),
        _ => format!("; each cell is the largest of {block} × {block}"),
    }
}

/// The lowest and the highest shown value that colours stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourScale {
    /// Darkest colour: 0, or the lowest value if that is below.
    pub low: f64,
    /// Lightest colour.
    pub high: f64,
}

impl ColourScale {
    /// The scale that covers all frames, in shown units. Frames of zeros get 0 … 1.
    pub fn over<'a>(frames: impl IntoIterator<Item = &'a Array2<f64>>, quantity: Quantity) -> Self {
        Self::over_values(frames.into_iter().flatten(), quantity)
    }

    /// The scale that covers values as they are stored, in shown units.
    pub fn over_values<'a>(values: impl IntoIterator<Item = &'a f64>, quantity: Quantity) -> Self {
        let mut scale = Self {
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

    /// Place of a shown value on the scale, 0 … 1.
    pub fn place(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }
}

/// The error says what is wrong with a frame that nobody can draw: no taxels, or a value that is not a number.
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

/// A smaller frame of the largest values of blocks `block` taxels wide and high (fewer at the far edges).
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

/// Draws a frame into an area, row 0 (the lowest y) at the bottom; neighbours of one colour become one rectangle.
pub fn draw_map(
    drawing: &mut Drawing,
    frame: &Array2<f64>,
    quantity: Quantity,
    scale: ColourScale,
    area: Area,
) {
    let (ny, nx) = frame.dim();
    let (width, height) = (area.width / nx as f64, area.height / ny as f64);
    for (row, values) in frame.outer_iter().enumerate() {
        let colours: Vec<[u8; 3]> = values
            .iter()
            .map(|value| heat(scale.place(value * quantity.factor())))
            .collect();
        let mut start = 0;
        while start < nx {
            let run = colours[start..]
                .iter()
                .take_while(|&&c| c == colours[start])
                .count();
            let piece = Area {
                x: area.x + start as f64 * width,
                y: area.y + (ny - 1 - row) as f64 * height,
                width: run as f64 * width,
                height,
            };
            drawing.area(piece, colours[start]);
            start += run;
        }
    }
    drawing.frame(area, Stroke::new(INK, 1.0));
}

/// Ticks and title in millimetres below a map of an array centred on its origin.
pub fn draw_x_axis(drawing: &mut Drawing, area: Area, width_mm: f64) {
    let style = TextStyle::new(12).align(Align::Middle);
    let bottom = area.y + area.height;
    for tick in even_ticks(-0.5 * width_mm, 0.5 * width_mm) {
        let x = area.x + area.width * (tick / width_mm + 0.5);
        drawing.line((x, bottom), (x, bottom + 5.0), Stroke::new(INK, 1.0));
        drawing.text((x, bottom + 18.0), &short_number(tick), style);
    }
    let below = (area.x + area.width / 2.0, bottom + 36.0);
    drawing.text(below, "x (mm)", style);
}

/// Ticks and title in millimetres to the left of a map of an array centred on its origin.
pub fn draw_y_axis(drawing: &mut Drawing, area: Area, height_mm: f64) {
    let style = TextStyle::new(12);
    for tick in even_ticks(-0.5 * height_mm, 0.5 * height_mm) {
        let y = area.y + area.height * (0.5 - tick / height_mm);
        drawing.line((area.x - 5.0, y), (area.x, y), Stroke::new(INK, 1.0));
        let at = (area.x - 8.0, y + 4.5);
        drawing.text(at, &short_number(tick), style.align(Align::End));
    }
    let beside = (area.x - 44.0, area.y + area.height / 2.0);
    drawing.text(beside, "y (mm)", style.align(Align::Middle).angle(-90.0));
}

/// Colours from 0 (below) to 1 (above) in so many steps, framed.
pub(super) fn draw_colours(
    drawing: &mut Drawing,
    area: Area,
    n_steps: usize,
    colour: fn(f64) -> Rgb,
) {
    let height = area.height / n_steps as f64;
    for step in 0..n_steps {
        let piece = Area {
            y: area.y + area.height - (step + 1) as f64 * height,
            // A little overlap, so that no gap shines through between two steps.
            height: height + if step == 0 { 0.0 } else { 0.5 },
            ..area
        };
        drawing.area(piece, colour((step as f64 + 0.5) / n_steps as f64));
    }
    drawing.frame(area, Stroke::new(INK, 1.0));
}

/// A colour bar to the right of what it explains, `area` wide and high.
pub fn draw_colour_bar(drawing: &mut Drawing, scale: ColourScale, title: &str, area: Area) {
    draw_colours(drawing, area, 64, heat);
    let right = area.x + area.width;
    for value in even_ticks(scale.low, scale.high) {
        let y = area.y + area.height * (1.0 - scale.place(value));
        drawing.line((right, y), (right + 4.0, y), Stroke::new(INK, 1.0));
        drawing.text(
            (right + 8.0, y + 4.5),
            &short_number(value),
            TextStyle::new(12),
        );
    }
    let beside = (right + 52.0, area.y + area.height / 2.0);
    let style = TextStyle::new(12).align(Align::Middle).angle(-90.0);
    drawing.text(beside, title, style);
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
