//! Frames side by side on one colour scale, as in Figure 4 of \[BT\].

use crate::error::{Error, Result};
use crate::report::colours::MUTED;
use crate::report::drawing::{Align, Area, Drawing, TextStyle};
use crate::report::heat_map::{
    ColourScale, check_frame, draw_colour_bar, draw_map, draw_x_axis, draw_y_axis,
    largest_of_blocks,
};
use crate::report::text_width::shorten;
use crate::signal::Quantity;
use ndarray::Array2;

const MOST_CELLS: usize = 128;

/// Draws named frames (ny × nx, row = y ascending), four a row, with a common colour bar.
///
/// `caption` stands below (what was pressed how, and the noise). Errors: no frames, or one that
/// [`check_frame`] rejects.
pub fn snapshots(
    frames: &[(String, Array2<f64>)],
    pitch_mm: f64,
    quantity: Quantity,
    caption: &str,
) -> Result<Drawing> {
    if frames.is_empty() {
        return Err(Error::input("snapshots", "no frames", "at least one"));
    }
    for (_, frame) in frames {
        check_frame(frame)?;
    }
    let scale = ColourScale::over(frames.iter().map(|(_, frame)| frame), quantity);
    let columns = frames.len().min(4);
    let rows = frames.len().div_ceil(4);
    let largest = frames
        .iter()
        .map(|(_, f)| f.nrows().max(f.ncols()))
        .max()
        .unwrap_or(1);
    let block = largest.div_ceil(MOST_CELLS);
    // Whole pixels a taxel: no seams between neighbours.
    let side = (192.0 / largest.div_ceil(block) as f64).floor().max(1.0);
    let box_side = side * largest.div_ceil(block) as f64;
    let (left, gap, top, row_height) = (66.0, 22.0, 34.0, box_side + 74.0);
    let maps_right = left + columns as f64 * (box_side + gap);
    let height = rows as f64 * row_height + 18.0 + 6.0;
    let mut drawing = Drawing::new(maps_right + 84.0, height);
    for (index, (name, frame)) in frames.iter().enumerate() {
        let (row, column) = (index / 4, index % 4);
        let shown = largest_of_blocks(frame, (block, block));
        let area = Area {
            x: left + column as f64 * (box_side + gap),
            y: top + row as f64 * row_height,
            width: side * shown.ncols() as f64,
            height: side * shown.nrows() as f64,
        };
        let title = shorten(name, 15.0, box_side);
        let above = (area.x + area.width / 2.0, area.y - 10.0);
        drawing.bold_text(above, &title, TextStyle::new(13).align(Align::Middle));
        draw_map(&mut drawing, &shown, quantity, scale, area);
        let (ny, nx) = frame.dim();
        draw_x_axis(&mut drawing, area, nx as f64 * pitch_mm);
        if column == 0 {
            draw_y_axis(&mut drawing, area, ny as f64 * pitch_mm);
        }
    }
    let bar = Area {
        x: maps_right,
        y: top,
        width: 16.0,
        height: box_side,
    };
    let title = format!("{} ({})", quantity.name(), quantity.unit());
    draw_colour_bar(&mut drawing, scale, &title, bar);
    drawing.text(
        (left, height - 10.0),
        caption,
        TextStyle::new(12).colour(MUTED),
    );
    Ok(drawing)
}
