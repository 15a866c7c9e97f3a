//! Which pixels each cell of a map colours: computed once, painted for every frame.
//!
//! A drawing of four thousand cells takes the chart library a tenth of a second; this, a millisecond.

use crate::report::colours::Rgb;
use crate::report::picture::Picture;
use std::ops::Range;

/// The cells of a map.
///
/// Invariant: cell i has the pixels `starts[i]..starts[i + 1]`, all within a picture of the given width.
pub(super) struct Painter {
    width: usize,
    height: usize,
    starts: Vec<usize>,
    /// The pixel's number, and how much of it the cell covers, of 255.
    pixels: Vec<(u32, u8)>,
}

impl Painter {
    /// No cells yet, for pictures of this size.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            starts: vec![0],
            pixels: Vec::new(),
        }
    }

    /// The next cell is a rectangle of whole pixels.
    pub fn add_rectangle(&mut self, columns: Range<usize>, rows: Range<usize>) {
        for y in rows.start..rows.end.min(self.height) {
            for x in columns.start..columns.end.min(self.width) {
                self.pixels.push(((y * self.width + x) as u32, 255));
            }
        }
        self.starts.push(self.pixels.len());
    }

    /// The next cell is a disc: its middle and radius in pixels from the top left corner.
    pub fn add_disc(&mut self, [x, y]: [f64; 2], radius: f64) {
        let range = |middle: f64, n: usize| {
            let clamp = |place: f64| place.clamp(0.0, n as f64) as usize;
            clamp((middle - radius - 1.0).floor())..clamp((middle + radius + 1.0).ceil())
        };
        for row in range(y, self.height) {
            for column in range(x, self.width) {
                let distance = (column as f64 + 0.5 - x).hypot(row as f64 + 0.5 - y);
                // As if the rim were straight within a pixel.
                let cover = (radius - distance + 0.5).clamp(0.0, 1.0);
                if cover > 0.0 {
                    let pixel = (row * self.width + column) as u32;
                    self.pixels.push((pixel, (255.0 * cover).round() as u8));
                }
            }
        }
        self.starts.push(self.pixels.len());
    }

    /// Colours all cells of a picture of the right size, one colour a cell.
    pub fn paint(&self, picture: &mut Picture, colours: &[Rgb]) {
        for (cell, colour) in colours.iter().enumerate() {
            for &(pixel, cover) in &self.pixels[self.starts[cell]..self.starts[cell + 1]] {
                let at = 3 * pixel as usize;
                for (value, &colour) in picture.rgb[at..at + 3].iter_mut().zip(colour) {
                    let (cover, below, above) =
                        (u32::from(cover), u32::from(*value), u32::from(colour));
                    *value = ((cover * above + (255 - cover) * below + 127) / 255) as u8;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_has_its_area_and_cells_keep_to_their_pixels() {
        let (width, height) = (80, 60);
        let mut painter = Painter::new(width, height);
        painter.add_disc([40.3, 30.8], 12.25);
        painter.add_rectangle(2..5, 3..7);
        painter.add_disc([79.0, 59.0], 5.0);
        let mut picture = Picture {
            width,
            height,
            rgb: vec![0; 3 * width * height],
        };
        painter.paint(&mut picture, &[[255, 0, 0], [0, 255, 0], [0, 0, 255]]);
        let sum = |channel: usize| -> f64 {
            let values = picture.rgb.chunks(3).map(|pixel| f64::from(pixel[channel]));
            values.sum::<f64>() / 255.0
        };
        let disc = std::f64::consts::PI * 12.25 * 12.25;
        assert!((sum(0) / disc - 1.0).abs() < 0.01, "{} of {disc}", sum(0));
        assert_eq!(sum(1), 12.0);
        assert_eq!(picture.rgb[3 * (6 * width + 4) + 1], 255);
        assert_eq!(picture.rgb[3 * (7 * width + 4) + 1], 0);
    }
}
