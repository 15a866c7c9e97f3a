//! A picture of pixels, the type on it, and the PNG file that holds it.

use super::canvas::BACKGROUND;
use super::shaded_view::ShadedView;
use crate::error::{Error, Result};
use kuva::render::render::{Primitive, Scene, TextAnchor};
use std::ops::Range;
use std::path::Path;

/// An opaque picture, rows from the top, 3 bytes a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels.
    pub width: usize,
    /// Pixels.
    pub height: usize,
    /// Red, green, blue; length 3 × width × height.
    pub rgb: Vec<u8>,
}

/// A line of text in the middle of a place.
pub(crate) struct Label {
    pub text: String,
    /// Pixels from the left.
    pub x: f64,
    /// The baseline, pixels from the top.
    pub y: f64,
    /// Font size, pixels.
    pub size: u32,
}

impl Picture {
    /// The picture as a PNG file's bytes.
    pub fn png(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let write = |bytes: &mut Vec<u8>| -> std::result::Result<(), png::EncodingError> {
            let mut encoder = png::Encoder::new(bytes, self.width as u32, self.height as u32);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_depth(png::BitDepth::Eight);
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&self.rgb)?;
            writer.finish()
        };
        match write(&mut bytes) {
            Ok(()) => Ok(bytes),
            Err(error) => Err(Error::io(
                Path::new("picture"),
                "encode",
                std::io::Error::other(error),
            )),
        }
    }

    /// Paper of a size in pixels, each side 64 to 20,000.
    pub(crate) fn blank(width: usize, height: usize) -> Result<Self> {
        // The largest side that a table of 100 × 100 tiles of 200 pixels needs.
        let sides = 64..=20_000;
        if !(sides.contains(&width) && sides.contains(&height)) {
            return Err(Error::input(
                "picture size",
                format!("{width} × {height} pixels"),
                "64 to 20000 pixels each way",
            ));
        }
        let rgb = [BACKGROUND; 3].repeat(width * height);
        Ok(Self { width, height, rgb })
    }

    /// Sets all labels at once, in the chart library's own type.
    pub(crate) fn write_labels(&mut self, labels: &[Label]) -> Result<()> {
        let mut scene = Scene::new(self.width as f64, self.height as f64);
        for label in labels {
            scene.add(Primitive::Text {
                x: label.x,
                y: label.y,
                content: label.text.clone(),
                size: label.size,
                anchor: TextAnchor::Middle,
                rotate: None,
                bold: false,
                color: None,
            });
        }
        let failed = |e: String| {
            Error::io(
                Path::new("picture"),
                "set type in",
                std::io::Error::other(e),
            )
        };
        let backend = kuva::RasterBackend::new().with_scale(1.0);
        let page = backend.render_scene(&scene).map_err(failed)?;
        let mut reader = png::Decoder::new(std::io::Cursor::new(page))
            .read_info()
            .map_err(|e| failed(e.to_string()))?;
        let mut ink = vec![0; reader.output_buffer_size().unwrap_or(0)];
        let info = reader
            .next_frame(&mut ink)
            .map_err(|e| failed(e.to_string()))?;
        let samples = info.color_type.samples();
        for (pixel, ink) in self.rgb.chunks_mut(3).zip(ink.chunks(samples)) {
            for value in pixel {
                *value = (u16::from(*value) * u16::from(ink[0]) / 255) as u8;
            }
        }
        Ok(())
    }

    /// Fills the pixels of an area that are on the paper.
    pub(crate) fn fill(&mut self, columns: Range<usize>, rows: Range<usize>, rgb: [u8; 3]) {
        for y in rows.start..rows.end.min(self.height) {
            for x in columns.start..columns.end.min(self.width) {
                let at = 3 * (y * self.width + x);
                self.rgb[at..at + 3].copy_from_slice(&rgb);
            }
        }
    }

    /// Copies a view to the area whose top left corner is given.
    pub(crate) fn place(&mut self, view: &ShadedView, [left, top]: [usize; 2], size: [usize; 2]) {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let at = 3 * ((top + y) * self.width + left + x);
                self.rgb[at..at + 3].copy_from_slice(&view.rgb(x, y));
            }
        }
    }

    /// Draws a bar of a round length of about a fifth of `width` pixels about a place, and returns its label.
    pub(crate) fn draw_scale(
        &mut self,
        pixels_per_metre: f64,
        width: f64,
        [x, y]: [f64; 2],
        size: u32,
    ) -> Label {
        let millimetres = bar_length(0.22 * width / pixels_per_metre * 1e3);
        let length = millimetres * 1e-3 * pixels_per_metre;
        let [first, last] = [x - 0.5 * length, x + 0.5 * length].map(|x| x.round() as usize);
        self.fill(first..last, y as usize..y as usize + 2, [60; 3]);
        let text = format!("{millimetres} mm");
        let y = y - 5.0;
        Label { text, x, y, size }
    }
}

/// The longest of 1, 2, 5, 10, … that fits.
pub(crate) fn bar_length(largest: f64) -> f64 {
    let power = 10f64.powf(largest.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps.into_iter().find(|&s| s <= largest).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_the_longest_round_number_that_fits() {
        let lengths = [1.0, 1.99, 2.5, 7.0, 12.0, 49.0, 0.03].map(bar_length);
        let expected = [1.0, 1.0, 2.0, 5.0, 10.0, 20.0, 0.02];
        for (length, expected) in lengths.into_iter().zip(expected) {
            assert!((length - expected).abs() < 1e-12, "{length}");
        }
    }
}
