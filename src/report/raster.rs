//! A scene as pixels.

use super::picture::Picture;
use crate::error::{Error, Result};
use kuva::render::render::{Primitive, Scene};

/// How much larger a scene is drawn than it is.
///
/// kuva draws turned text and slanted lines jagged, so it draws at twice the size of two picture elements a pixel, and each
/// element becomes the mean of four.
const SCALE: u32 = 4;

/// A scene that will be pixels on white, two picture elements a pixel.
pub(super) struct ToRaster(Scene);

impl ToRaster {
    /// A copy of a scene.
    pub fn new(scene: &Scene) -> Self {
        let mut large = Scene::new(scene.width, scene.height);
        let elements = scene.elements.iter().cloned();
        large.elements = elements
            .map(|element| scale_dashes(element, SCALE))
            .collect();
        Self(large)
    }

    /// The pixels: a tenth of a second's work.
    pub fn picture(&self) -> Result<Picture> {
        let large = kuva::RasterBackend::new()
            .with_scale(SCALE as f32)
            .render_scene(&self.0)
            .map_err(|said| unfit(&said))?;
        halve_png(&large).map_err(|said| unfit(&said))
    }
}

/// kuva scales everything in a raster but the dashes.
fn scale_dashes(mut element: Primitive, scale: u32) -> Primitive {
    if let Primitive::Line {
        stroke_dasharray: Some(dashes),
        ..
    }
    | Primitive::PolyLine {
        stroke_dasharray: Some(dashes),
        ..
    } = &mut element
    {
        let lengths = dashes
            .split(' ')
            .filter_map(|length| length.parse::<u32>().ok());
        let scaled: Vec<String> = lengths.map(|length| (length * scale).to_string()).collect();
        *dashes = scaled.join(" ");
    }
    element
}

fn unfit(said: &dyn std::fmt::Display) -> Error {
    Error::input("picture", said, "a size that fits into a PNG file")
}

/// A PNG's picture at half the size (rounded down), each element the mean of four; opaque.
fn halve_png(large: &[u8]) -> std::result::Result<Picture, Box<dyn std::error::Error>> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(large)).read_info()?;
    let mut elements = vec![0; reader.output_buffer_size().ok_or("too large a picture")?];
    let info = reader.next_frame(&mut elements)?;
    let channels = info.color_type.samples();
    let (width, height) = (info.width as usize / 2, info.height as usize / 2);
    let mut small = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        let rows = [2 * y, 2 * y + 1].map(|row| &elements[row * info.line_size..]);
        for x in 0..width {
            for channel in 0..3 {
                let (left, right) = (2 * x * channels + channel, (2 * x + 1) * channels + channel);
                let sum: u16 = rows
                    .iter()
                    .map(|row| u16::from(row[left]) + u16::from(row[right]))
                    .sum();
                small.push(((sum + 2) / 4) as u8);
            }
        }
    }
    Ok(Picture {
        width,
        height,
        rgb: small,
    })
}
