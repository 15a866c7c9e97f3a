//! Any frame of a patch of any shape as a picture: cells of a grid, or dots where the taxels are.

use super::cells::{Cells, LEFT};
use super::header::RecordedPatch;
use super::pixels::paint;
use crate::error::{Error, Result};
use crate::report::pictures::colours::{INK, MUTED, Rgb};
use crate::report::pictures::drawing::{Area, Drawing, TextStyle};
use crate::report::pictures::heat_map::{ColourScale, largest_of_blocks};
pub use crate::report::pictures::picture::Picture;
use crate::report::pictures::picture_axes::draw_colour_bar;
use crate::report::text_width::text_width;
use crate::world::Grid;
use ndarray::ArrayView2;

/// The line that changes from frame to frame: its top and height, and its width at least.
const NOTE: (f64, f64, f64) = (48.0, 18.0, 320.0);
/// A raster has two picture elements a pixel of its drawing.
const FINE: f64 = 2.0;

/// What is the same in all pictures of a patch: paper, axes or scale bar, colour bar, and where the taxels are.
pub struct SkinPicture {
    background: Picture,
    cells: Cells,
    scale: ColourScale,
    n_taxels: usize,
    grid: Option<Grid>,
}

impl SkinPicture {
    /// Prepares the pictures of a patch, all on one scale.
    ///
    /// A grid is drawn as a heat map with axes in millimetres. Of another skin each taxel is a dot: a flat one is seen from
    /// above, a cylinder unrolled, a part of a sphere flattened about its middle; another is seen from the side to which its
    /// axes point, and from behind. The picture says which, and has a scale bar.
    ///
    /// # Errors
    /// Taxels that cannot be laid out.
    pub fn new(patch: &RecordedPatch, scale: ColourScale) -> Result<Self> {
        let cells = Cells::of(patch);
        let mut drawing = paper(&patch.name, &cells, scale);
        cells.draw_frame(&mut drawing, patch.grid.is_some());
        Ok(Self {
            background: drawing.picture()?,
            cells,
            scale,
            n_taxels: patch.n_taxels(),
            grid: patch.grid,
        })
    }

    /// Columns and rows of pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.background.width, self.background.height)
    }

    /// The picture of a frame, one value a taxel (metres or newtons); `note` is a line above it, such as the time.
    ///
    /// # Errors
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
        paint(&mut picture, &self.cells, FINE, &self.colours(values));
        write_note(&mut picture, note)?;
        Ok(picture)
    }

    fn colours(&self, values: &[f64]) -> Vec<Rgb> {
        let colour = |value: &f64| self.scale.colour(*value);
        match self.grid {
            Some(grid) if self.cells.block > 1 => {
                let frame = ArrayView2::from_shape((grid.ny, grid.nx), values)
                    .expect("a grid has as many taxels as the patch");
                let block = (self.cells.block, self.cells.block);
                let shown = largest_of_blocks(&frame.to_owned(), block);
                shown.iter().map(colour).collect()
            }
            _ => values.iter().map(colour).collect(),
        }
    }
}

/// Title, a line below it, and the colour bar.
fn paper(name: &str, cells: &Cells, scale: ColourScale) -> Drawing {
    let (area, below) = (cells.area, &cells.sentence);
    let corner = (area.x + area.width + 18.0, area.y);
    let bar = Area::new(corner, (16.0, area.height.max(120.0)));
    let text_right = LEFT + text_width(below, 11.0).max(text_width(name, 15.0)) + 16.0;
    let width = (bar.x + 92.0).max(text_right).max(LEFT + NOTE.2);
    let mut drawing = Drawing::new(width, area.y + bar.height + 54.0);
    drawing.bold_text((LEFT, 22.0), name, TextStyle::new(13).colour(INK));
    drawing.text((LEFT, 40.0), below, TextStyle::new(11).colour(MUTED));
    draw_colour_bar(&mut drawing, scale, bar);
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
