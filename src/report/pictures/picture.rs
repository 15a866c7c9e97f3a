//! A picture of pixels, and the PNG file that holds it.

use crate::error::{Error, Result};

/// Brightness of blank paper, 0 to 255.
pub(crate) const BACKGROUND: u8 = 250;

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

impl Picture {
    /// The picture as a PNG file's bytes.
    ///
    /// # Errors
    /// It has no pixels.
    pub fn png(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(unfit)?;
        writer.write_image_data(&self.rgb).map_err(unfit)?;
        writer.finish().map_err(unfit)?;
        Ok(bytes)
    }

    /// Of a PNG file's bytes; opaque.
    pub(crate) fn of_png(png: &[u8]) -> Result<Self> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png))
            .read_info()
            .map_err(unfit)?;
        let mut elements = vec![0; reader.output_buffer_size().unwrap_or(0)];
        let info = reader.next_frame(&mut elements).map_err(unfit)?;
        let pixels = elements.chunks_exact(info.color_type.samples());
        Ok(Self {
            width: info.width as usize,
            height: info.height as usize,
            rgb: pixels.flat_map(|pixel| &pixel[..3]).copied().collect(),
        })
    }

    /// The same at half the size (rounded down), each pixel the mean of four.
    pub(crate) fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mut rgb = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            let rows = [2 * y, 2 * y + 1].map(|row| &self.rgb[3 * row * self.width..]);
            for value in (0..width).flat_map(|x| [6 * x, 6 * x + 1, 6 * x + 2]) {
                let sum = |row: &[u8]| u16::from(row[value]) + u16::from(row[value + 3]);
                rgb.push(((sum(rows[0]) + sum(rows[1]) + 2) / 4) as u8);
            }
        }
        Self { width, height, rgb }
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

    /// Copies another picture to a place from the top left corner, as far as it is on the paper.
    pub(crate) fn paste(&mut self, other: &Self, [left, top]: [usize; 2]) {
        let n = 3 * other.width.min(self.width - left);
        let rows = self.rgb.chunks_mut(3 * self.width).skip(top);
        for (row, pixels) in rows.zip(other.rgb.chunks(3 * other.width)) {
            row[3 * left..3 * left + n].copy_from_slice(&pixels[..n]);
        }
    }
}

pub(crate) fn unfit(said: impl std::fmt::Display) -> Error {
    Error::input("picture", said, "a size that fits into a PNG file")
}
