//! Raster picture and its PNG file.

use crate::error::{Error, Result};
use bubbletouch_sim::raster::pixels::{halved, indexed, without_opacity};
use bubbletouch_sim::raster::{BACKGROUND, Canvas, Hit, Lighting, Rgb};

/// Opaque raster picture: rows of pixels from the top, 3 bytes per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width of the picture, pixels.
    pub width: usize,
    /// Height of the picture, pixels.
    pub height: usize,
    /// Red, green and blue of each pixel, 0 to 255; length 3 × width × height.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// Returns the picture as a PNG file.
    ///
    /// # Errors
    /// If the picture has no pixels.
    pub fn png(&self) -> Result<Vec<u8>> {
        self.encoded(png::ColorType::Rgb, &self.rgb, Vec::new())
    }

    /// Returns the picture as a PNG file of about a third of the size, with a palette of at most 256 colours. Colours are rounded as little as this requires.
    pub(crate) fn small_png(&self) -> Result<Vec<u8>> {
        let mut steps = [1, 2, 4, 8, 16].into_iter();
        match steps.find_map(|step| indexed(&self.rgb, step)) {
            Some((indices, palette)) => self.encoded(png::ColorType::Indexed, &indices, palette),
            None => self.png(),
        }
    }

    fn encoded(&self, kind: png::ColorType, data: &[u8], palette: Vec<u8>) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(kind);
        encoder.set_depth(png::BitDepth::Eight);
        if kind == png::ColorType::Indexed {
            encoder.set_palette(palette);
            encoder.set_filter(png::Filter::NoFilter);
        }
        let mut writer = encoder.write_header().map_err(unfit)?;
        writer.write_image_data(data).map_err(unfit)?;
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
        let rgb = without_opacity(elements, n_samples);
        Ok(Self { width, height, rgb })
    }

    /// Returns the picture at half its width and height (rounded down); each pixel is the mean of four pixels.
    pub(crate) fn halved(&self) -> Self {
        Self {
            width: self.width / 2,
            height: self.height / 2,
            rgb: halved(&self.rgb, self.width),
        }
    }

    /// Creates a white picture whose sides have 64 to 20,000 pixels each.
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

    /// Paints the points where rays hit an object; the given corner is the top left corner of the painted area.
    pub(crate) fn paint(
        &mut self,
        canvas: &Canvas,
        corner: [usize; 2],
        hits: &[Option<Hit>],
        lighting: Lighting,
        paint: &(dyn Fn(usize, &Hit) -> Rgb + Sync),
    ) {
        let (width, height) = (canvas.width / 2, canvas.height / 2);
        let rgb = canvas.paint(hits, lighting, paint);
        self.paste(&Self { width, height, rgb }, corner);
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

/// Converts an error of the PNG library or the drawing library to an error of this crate.
pub(crate) fn unfit(said: impl std::fmt::Display) -> Error {
    Error::input("picture", said, "a size that fits into a PNG file")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_file_has_a_palette_and_the_colours_up_to_a_rounding() {
        let (width, height) = (100, 80);
        for (n_blues, most) in [(1, 0), (90, 8)] {
            let rgb = (0..width * height).flat_map(|place| {
                let shade = (place * place % 7919 % 200) as u8;
                [shade, 255 - shade, (place / 200 % n_blues) as u8]
            });
            let rgb: Vec<u8> = rgb.collect();
            let picture = Picture { width, height, rgb };
            let (small, whole) = (picture.small_png().unwrap(), picture.png().unwrap());
            assert!(small.len() < whole.len());
            let mut decoder = png::Decoder::new(std::io::Cursor::new(&small));
            decoder.set_transformations(png::Transformations::EXPAND);
            let mut reader = decoder.read_info().unwrap();
            assert_eq!(reader.info().color_type, png::ColorType::Indexed);
            let mut found = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut found).unwrap();
            let pairs = found.iter().zip(&picture.rgb);
            let error = pairs.map(|(a, b)| a.abs_diff(*b)).max();
            assert!(error <= Some(most), "{error:?}");
        }
    }
}
