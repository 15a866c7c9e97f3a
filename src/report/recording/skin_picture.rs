//! Picture of one frame of a patch: cells of a grid, or discs at the taxels of another layout.

use super::cells::{Cells, LEFT};
use super::header::RecordedPatch;
use crate::error::{Error, Result};
pub use crate::report::pictures::picture::Picture;
use crate::report::pictures::{
    Area, ColourScale, Drawing, INK, MUTED, Rgb, TextStyle, draw_colour_bar, largest_of_blocks,
};
use crate::report::text_width::text_width;
use crate::world::Grid;
use ndarray::ArrayView2;

/// Top, height and minimum width of the text line above the map, pixels; each frame has its own text.
const NOTE: (f64, f64, f64) = (48.0, 18.0, 320.0);
/// Number of image pixels for each drawing pixel along each side.
const FINE: f64 = 2.0;

/// Parts that all pictures of a patch have in common: background, axes or scale bar, colour bar, and taxel positions.
pub struct SkinPicture {
    background: Picture,
    cells: Cells,
    scale: ColourScale,
    n_taxels: usize,
    grid: Option<Grid>,
}

impl SkinPicture {
    /// Prepares the drawing of several pictures of a patch with one common colour scale.
    ///
    /// A grid is drawn as a heat map with axes in millimetres. In any other layout, each taxel is drawn as a disc. The patch is
    /// seen from the side to which its axes point and, if some taxels face away, from behind. The picture states the view and has a scale bar.
    ///
    /// # Errors
    /// If the picture cannot be rendered.
    pub fn new(patch: &RecordedPatch, scale: ColourScale) -> Result<Self> {
        let cells = Cells::new(patch);
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

    /// Returns the width and height of the pictures, pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.background.width, self.background.height)
    }

    /// Returns the picture of one frame, given one value per taxel (metres or newtons). The line of text above the map is `note`, for example the time.
    ///
    /// # Errors
    /// If the number of values differs from the number of taxels, or a value is not finite.
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
        self.cells.paint(&mut picture, FINE, &self.colours(values));
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

/// Draws the background of the pictures: the title, the text line below the title, and the colour bar.
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
