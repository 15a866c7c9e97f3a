//! Picture of several frames side by side with a common colour scale, as in Figure 4 of \[BT\].

use crate::error::{Error, Result};
use crate::report::pictures::{
    Align, Area, ColourScale, Drawing, INK, MUTED, Picture, Side, Stroke, TextStyle, check_frame,
    draw_colour_bar, draw_map_axis, largest_of_blocks,
};
use crate::report::recording::cells::{Cells, whole_pixels};
use crate::report::text_width::shorten;
use crate::signal::Quantity;
use crate::world::Grid;
use ndarray::Array2;

/// Maximum number of cells along each side of a frame's picture. In a larger frame, each cell shows the largest value of a block of taxels.
const MAX_CELLS: usize = 128;
/// Maximum number of frames in a picture; a picture of more frames does not fit on a page.
const MAX_FRAMES: usize = 120;

/// Frames of several touches, which are drawn with a common colour scale.
#[derive(Clone, Debug)]
pub struct Snapshots {
    /// Name and values of each frame (ny × nx, rows ascending in y), metres or newtons.
    pub frames: Vec<(String, Array2<f64>)>,
    /// Distance between neighbouring taxels, millimetres.
    pub pitch_mm: f64,
    /// Physical quantity of the values in the frames, which determines their unit.
    pub quantity: Quantity,
    /// Caption of the picture: the objects, the touches and the noise.
    pub caption: String,
}

/// Draws the first 120 named frames, four per row, or eight if there are more than eight, with a common colour bar and the caption below. The picture has two
/// image pixels per drawing pixel.
///
/// # Errors
/// If there are no frames, or [`check_frame`] rejects one.
pub fn snapshots(set: &Snapshots) -> Result<Picture> {
    let Snapshots {
        frames, pitch_mm, ..
    } = set;
    let frames = &frames[..frames.len().min(MAX_FRAMES)];
    let (n_columns, room) = if frames.len() > 8 {
        (8, 80.0)
    } else {
        (4, 192.0)
    };
    let sides = frames
        .iter()
        .map(|(_, frame)| frame.nrows().max(frame.ncols()));
    let Some(largest) = sides.max() else {
        return Err(Error::input("snapshots", "no frames", "at least one"));
    };
    let scale = ColourScale::over(frames.iter().flat_map(|(_, frame)| frame), set.quantity);
    let block = largest.div_ceil(MAX_CELLS);
    let n_cells = largest.div_ceil(block);
    let side = whole_pixels(room, n_cells);
    let rows = frames.iter().map(|(_, frame)| frame.nrows());
    let n_rows = rows.max().unwrap_or(0).div_ceil(block);
    let (box_side, box_height) = (side * n_cells as f64, side * n_rows as f64);
    let (left, top) = (66.0, 34.0);
    let (column_width, row_height) = (box_side + 22.0, box_height + 74.0);
    let right = left + frames.len().min(n_columns) as f64 * column_width;
    let height = frames.len().div_ceil(n_columns) as f64 * row_height + 24.0;
    let mut drawing = Drawing::new(right + 84.0, height);
    let mut maps = Vec::new();
    for (index, (name, frame)) in frames.iter().enumerate() {
        check_frame(frame)?;
        let (ny, nx) = frame.dim();
        let grid = Grid {
            nx,
            ny,
            pitch: pitch_mm * 1e-3,
        };
        let x = left + (index % n_columns) as f64 * column_width;
        let y = top + (index / n_columns) as f64 * row_height;
        let cells = Cells::of_grid(&grid, block, side, (x, y));
        let area = cells.area;
        let (middle, above) = area.at(0.5, 1.0);
        let title = shorten(name, 15.0, box_side);
        let style = TextStyle::new(13).align(Align::Middle);
        drawing.bold_text((middle, above - 10.0), &title, style);
        drawing.frame(area, Stroke::new(INK, 2.0));
        // In a picture of many frames, the first frame alone has axes.
        let has_axes = n_columns == 4 || index == 0;
        if has_axes {
            draw_map_axis(&mut drawing, area, Side::Below, nx as f64 * pitch_mm);
        }
        if has_axes && index % n_columns == 0 {
            draw_map_axis(&mut drawing, area, Side::Left, ny as f64 * pitch_mm);
        }
        maps.push((cells, largest_of_blocks(frame, (block, block))));
    }
    let bar = Area::new((right, top), (16.0, box_height));
    draw_colour_bar(&mut drawing, scale, bar);
    let style = TextStyle::new(12).colour(MUTED);
    drawing.text((left, height - 10.0), &set.caption, style);
    let mut picture = drawing.picture()?;
    for (cells, shown) in &maps {
        let colours = shown.iter().map(|&value| scale.colour(value));
        cells.paint(&mut picture, 2.0, &colours.collect::<Vec<_>>());
    }
    Ok(picture)
}
