//! Any frame of a patch of any shape as a picture: cells of a grid, or dots where the taxels are.

use super::dots::Dots;
use super::header::RecordedPatch;
use super::pixels::Painter;
use super::unrolled::unroll;
use crate::error::{Error, Result};
use crate::report::colours::{GRID, INK, MUTED, Rgb};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::report::heat_map::{ColourScale, block_sentence, grid_sentence, largest_of_blocks};
pub use crate::report::picture::Picture;
use crate::report::picture_axes::{Side, draw_colour_bar, draw_map_axis};
use crate::report::text_width::text_width;
use crate::signal::Quantity;
use crate::world::Grid;
use ndarray::ArrayView2;

/// Pixels of a drawing along a map's longer side.
pub(super) const SIDE: f64 = 400.0;
/// Cells of a grid that are shown each way, at most; longer grids are shown by the largest value of blocks.
const MOST_CELLS: usize = 400;
/// Where maps begin.
pub(super) const LEFT: f64 = 70.0;
pub(super) const TOP: f64 = 76.0;
/// The line that changes from frame to frame: its top and height, and its width at least.
const NOTE: (f64, f64, f64) = (48.0, 18.0, 320.0);
/// A raster has two picture elements a pixel of its drawing.
const FINE: f64 = 2.0;
/// What is the same in all pictures of a patch: paper, axes or scale bar, colour bar, and where the taxels are.
pub struct SkinPicture {
    background: Picture,
    painter: Painter,
    quantity: Quantity,
    scale: ColourScale,
    n_taxels: usize,
    /// The grid, and how many taxels a cell is wide and high.
    grid: Option<(Grid, usize)>,
}

impl SkinPicture {
    /// Prepares the pictures of a patch, all on one scale.
    ///
    /// A grid is drawn as a heat map with axes in millimetres. Of another skin each taxel is a dot: a flat one is seen from
    /// above, a cylinder unrolled, a part of a sphere flattened about its middle; another is seen from the side to which its
    /// axes point, and from behind. The picture says which, and has a scale bar.
    pub fn new(patch: &RecordedPatch, quantity: Quantity, scale: ColourScale) -> Result<Self> {
        match patch.grid {
            Some(grid) => Self::of_grid(patch, grid, quantity, scale),
            None => Self::of_dots(patch, quantity, scale),
        }
    }

    /// The picture of a frame, one value a taxel (metres or newtons); `note` is a line above it, such as the time.
    ///
    /// The error names a number of values that is not that of the taxels, or a value that is not finite.
    pub fn frame(&self, values: &[f64], note: &str) -> Result<Picture> {
        if values.len() != self.n_taxels {
            return Err(Error::input(
                "frame",
                format!("{} values", values.len()),
                format!("{}, one a taxel", self.n_taxels),
            ));
        }
        if let Some(taxel) = values.iter().position(|value| !value.is_finite()) {
            return Err(Error::input(
                format!("frame, taxel {taxel}"),
                values[taxel],
                "a finite number",
            ));
        }
        let mut picture = self.background.clone();
        self.painter.paint(&mut picture, &self.colours(values));
        write_note(&mut picture, note)?;
        Ok(picture)
    }

    fn colours(&self, values: &[f64]) -> Vec<Rgb> {
        let colour = |value: &f64| self.scale.colour(*value, self.quantity);
        match self.grid {
            Some((grid, block)) if block > 1 => {
                let frame = ArrayView2::from_shape((grid.ny, grid.nx), values)
                    .expect("a grid has as many taxels as the patch");
                let shown = largest_of_blocks(&frame.to_owned(), (block, block));
                shown.iter().map(colour).collect()
            }
            _ => values.iter().map(colour).collect(),
        }
    }

    fn of_grid(
        patch: &RecordedPatch,
        grid: Grid,
        quantity: Quantity,
        scale: ColourScale,
    ) -> Result<Self> {
        let block = grid.nx.max(grid.ny).div_ceil(MOST_CELLS);
        let (rows, columns) = (grid.ny.div_ceil(block), grid.nx.div_ceil(block));
        // Whole pixels a cell: no seams between neighbours.
        let side = (SIDE / rows.max(columns) as f64).floor().max(1.0);
        let area = Area {
            x: LEFT,
            y: TOP,
            width: side * columns as f64,
            height: side * rows as f64,
        };
        let pitch_mm = grid.pitch * 1e3;
        let below = grid_sentence((grid.nx, grid.ny), pitch_mm) + &block_sentence(block);
        let mut drawing = paper(patch, &below, area, quantity, scale);
        // Cells at the far edges may stand for less than a block.
        for (side, n) in [(Side::Below, columns), (Side::Left, rows)] {
            draw_map_axis(&mut drawing, area, side, (n * block) as f64 * pitch_mm);
        }
        drawing.frame(area, Stroke::new(INK, 1.0));
        let background = drawing.picture()?;
        let mut painter = Painter::new(background.width, background.height);
        let fine = |place: f64| (FINE * place) as usize;
        for row in 0..rows {
            let top = area.y + (rows - 1 - row) as f64 * side;
            for column in 0..columns {
                let left = area.x + column as f64 * side;
                painter.add_rectangle(fine(left)..fine(left + side), fine(top)..fine(top + side));
            }
        }
        Ok(Self {
            background,
            painter,
            quantity,
            scale,
            n_taxels: patch.n_taxels(),
            grid: Some((grid, block)),
        })
    }

    fn of_dots(patch: &RecordedPatch, quantity: Quantity, scale: ColourScale) -> Result<Self> {
        let unrolled = unroll(&patch.centers, &patch.axes);
        let dots = Dots::new(&unrolled);
        let below = match patch.n_taxels() {
            1 => format!("1 taxel, {}", unrolled.sentence),
            n => format!("{n} taxels, {}", unrolled.sentence),
        };
        let mut drawing = paper(patch, &below, dots.area, quantity, scale);
        for (view, panel) in unrolled.views.iter().zip(&dots.panels) {
            drawing.area(*panel, GRID);
            let name = (panel.x + panel.width / 2.0, panel.y + panel.height + 16.0);
            drawing.text(name, view.name, TextStyle::new(12).align(Align::Middle));
        }
        let has_names = unrolled.views.len() > 1;
        dots.draw_scale_bar(&mut drawing, if has_names { 40.0 } else { 26.0 });
        let background = drawing.picture()?;
        let mut painter = Painter::new(background.width, background.height);
        for place in dots.places(&unrolled, patch.n_taxels()) {
            let [x, y] = (FINE * place).to_array();
            painter.add_disc([x, y], FINE * dots.radius);
        }
        Ok(Self {
            background,
            painter,
            quantity,
            scale,
            n_taxels: patch.n_taxels(),
            grid: None,
        })
    }
}

/// Title, a line below it, and the colour bar.
fn paper(
    patch: &RecordedPatch,
    below: &str,
    area: Area,
    quantity: Quantity,
    scale: ColourScale,
) -> Drawing {
    let bar = Area {
        x: area.x + area.width + 18.0,
        width: 16.0,
        height: area.height.max(120.0),
        ..area
    };
    let text_right = LEFT + text_width(below, 11.0).max(text_width(&patch.name, 15.0)) + 16.0;
    let width = (bar.x + 92.0).max(text_right).max(LEFT + NOTE.2);
    let mut drawing = Drawing::new(width, area.y + bar.height + 54.0);
    drawing.bold_text((LEFT, 22.0), &patch.name, TextStyle::new(13).colour(INK));
    drawing.text((LEFT, 40.0), below, TextStyle::new(11).colour(MUTED));
    draw_colour_bar(&mut drawing, scale, quantity, bar);
    drawing
}

fn write_note(picture: &mut Picture, note: &str) -> Result<()> {
    if note.is_empty() {
        return Ok(());
    }
    let mut drawing = Drawing::new(NOTE.2, NOTE.1);
    drawing.text((0.0, 13.0), note, TextStyle::new(12));
    let corner = [LEFT, NOTE.0].map(|place| (FINE * place) as usize);
    picture.paste(&drawing.picture()?, corner);
    Ok(())
}
