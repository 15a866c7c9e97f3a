//! Raster picture and its PNG file.

use crate::error::{Error, Result};

/// Brightness of the blank background, 0 to 255.
pub(crate) const BACKGROUND: u8 = 250;

/// Opaque raster picture, rows from the top, 3 bytes for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width of the picture, pixels.
    pub width: usize,
    /// Height of the picture, pixels.
    pub height: usize,
    /// Red, green, blue; length 3 × width × height.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// Returns the picture as a PNG file.
    ///
    /// # Errors
    /// If the picture has no pixels.
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

    /// Decodes an opaque PNG file.
    pub(crate) fn of_png(png: &[u8]) -> Result<Self> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(png))
            .read_info()
            .map_err(unfit)?;
        let mut elements = vec![0; reader.output_buffer_size().unwrap_or(0)];
        let info = reader.next_frame(&mut elements).map_err(unfit)?;
        let (width, height) = (info.width as usize, info.height as usize);
        let n_samples = info.color_type.samples();
        let mut rgb = vec![0; 3 * width * height];
        // Slices and plain loops: this crate is compiled without optimisation. Iterators over 5 million pixels would take most of the time of a small study.
        let (from, to) = (&elements[..], &mut rgb[..]);
        let (mut source, mut target) = (0, 0);
        while target < to.len() {
            to[target] = from[source];
            to[target + 1] = from[source + 1];
            to[target + 2] = from[source + 2];
            source += n_samples;
            target += 3;
        }
        Ok(Self { width, height, rgb })
    }

    /// Returns the picture at half the size (rounded down); each pixel is the mean of four.
    pub(crate) fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mut rgb = vec![0; 3 * width * height];
        let (from, to) = (&self.rgb[..], &mut rgb[..]);
        let mut target = 0;
        for y in 0..height {
            let mut above = 6 * y * self.width;
            let mut below = above + 3 * self.width;
            let end = target + 3 * width;
            // A slice and a plain loop, as in `of_png`.
            while target < end {
                let mut channel = 0;
                while channel < 3 {
                    let sum = from[above] as u16
                        + from[above + 3] as u16
                        + from[below] as u16
                        + from[below + 3] as u16;
                    to[target] = ((sum + 2) / 4) as u8;
                    (above, below, target, channel) =
                        (above + 1, below + 1, target + 1, channel + 1);
                }
                (above, below) = (above + 3, below + 3);
            }
        }
        Self { width, height, rgb }
    }

    /// Creates a blank picture, each side 64 to 20,000 pixels.
    pub(crate) fn blank(width: usize, height: usize) -> Result<Self> {
        // The maximum is the side of a table of 100 × 100 tiles of 200 pixels.
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

    /// Copies another picture to the given top left corner. Parts outside this picture are cut off.
    pub(crate) fn paste(&mut self, other: &Self, [left, top]: [usize; 2]) {
        let n = 3 * other.width.min(self.width - left);
        let rows = self.rgb.chunks_mut(3 * self.width).skip(top);
        for (row, pixels) in rows.zip(other.rgb.chunks(3 * other.width)) {
            row[3 * left..3 * left + n].copy_from_slice(&pixels[..n]);
        }
    }
}

/// Converts an error of the PNG or drawing crate.
pub(crate) fn unfit(said: impl std::fmt::Display) -> Error {
    Error::input("picture", said, "a size that fits into a PNG file")
}
