//! The picture of an object: its spheres seen from above and to the side, and a sheet of many such pictures.

use super::shaded_view::{BACKGROUND, ShadedView};
use crate::error::{Error, Result};
use crate::objects::SphereUnion;
use glam::DVec2;
use kuva::render::render::{Primitive, Scene, TextAnchor};
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

/// One object: orthographic, z up, light background, its name (or nothing for "") above and a bar of known length below.
///
/// The picture is the same bytes for the same input. `width` and `height` in pixels, each at least 64.
pub fn object_picture(
    name: &str,
    union: &SphereUnion,
    width: usize,
    height: usize,
) -> Result<Picture> {
    let mut picture = Picture::blank(width, height)?;
    let mut labels = Vec::new();
    draw_tile(
        &mut picture,
        [0, 0, width, height],
        name,
        union,
        &mut labels,
    );
    picture.write_labels(&labels)?;
    Ok(picture)
}

/// Many objects, each at its own scale, in rows of `n_columns` tiles of `tile` × `tile` pixels.
///
/// An error for no objects, no columns, or tiles of fewer than 64 pixels.
pub fn contact_sheet(
    objects: &[(&str, &SphereUnion)],
    n_columns: usize,
    tile: usize,
) -> Result<Picture> {
    if objects.is_empty() || n_columns == 0 {
        return Err(Error::input(
            "contact sheet",
            format!("{} objects in {n_columns} columns", objects.len()),
            "at least one of each",
        ));
    }
    let n_columns = n_columns.min(objects.len());
    let n_rows = objects.len().div_ceil(n_columns);
    let mut picture = Picture::blank(n_columns * tile, n_rows * tile)?;
    let mut labels = Vec::new();
    for (index, (name, union)) in objects.iter().enumerate() {
        let corner = [index % n_columns * tile, index / n_columns * tile];
        let area = [corner[0], corner[1], tile, tile];
        draw_tile(&mut picture, area, name, union, &mut labels);
    }
    picture.write_labels(&labels)?;
    Ok(picture)
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

    fn blank(width: usize, height: usize) -> Result<Self> {
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
    fn write_labels(&mut self, labels: &[Label]) -> Result<()> {
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
}

struct Label {
    text: String,
    x: f64,
    y: f64,
    size: u32,
}

fn draw_tile(
    picture: &mut Picture,
    [left, top, width, height]: [usize; 4],
    name: &str,
    union: &SphereUnion,
    labels: &mut Vec<Label>,
) {
    let side = width.min(height) as f64;
    let margin = (0.10 * side).max(14.0);
    let room = DVec2::new(width as f64 - 1.6 * margin, height as f64 - 2.8 * margin);
    let view = ShadedView::new(union.spheres(), [width, height], room);
    for y in 0..height {
        for x in 0..width {
            let at = 3 * ((top + y) * picture.width + left + x);
            picture.rgb[at..at + 3].copy_from_slice(&view.rgb(x, y));
        }
    }
    let middle = left as f64 + 0.5 * width as f64;
    let size = (0.045 * side).clamp(9.0, 18.0);
    let mut label = |text: String, y: f64| {
        let (x, y, size) = (middle, top as f64 + y, size as u32);
        labels.push(Label { text, x, y, size });
    };
    if !name.is_empty() {
        label(name.to_string(), 0.55 * margin + 0.5 * size);
    }
    let millimetres = bar_length(0.22 * width as f64 / view.pixels_per_metre * 1e3);
    let length = millimetres * 1e-3 * view.pixels_per_metre;
    let below = height as f64 - 0.35 * margin;
    label(format!("{millimetres} mm"), below - 5.0);
    draw_bar(picture, middle - 0.5 * length, top as f64 + below, length);
}

/// The longest of 1, 2, 5, 10, … that fits.
fn bar_length(largest: f64) -> f64 {
    let power = 10f64.powf(largest.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps.into_iter().find(|&s| s <= largest).unwrap_or(power)
}

fn draw_bar(picture: &mut Picture, left: f64, top: f64, length: f64) {
    let (first, last) = (left.round() as usize, (left + length).round() as usize);
    for y in [top as usize, top as usize + 1] {
        for x in first..last.min(picture.width) {
            let at = 3 * (y * picture.width + x);
            picture.rgb[at..at + 3].fill(60);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::Sphere;
    use glam::DVec3;

    fn ball(radius: f64) -> SphereUnion {
        let center = DVec3::new(0.0, 0.0, radius);
        SphereUnion::new(vec![Sphere { center, radius }]).unwrap()
    }

    /// Paint is bluer than red; floor, shadow and type are grey.
    fn n_painted(picture: &Picture) -> usize {
        let painted = |pixel: &&[u8]| i16::from(pixel[2]) > i16::from(pixel[0]) + 8;
        picture.rgb.chunks(3).filter(painted).count()
    }

    #[test]
    fn a_ball_is_drawn_as_a_disc_that_fills_its_tile_whatever_its_size() {
        let small = object_picture("", &ball(1e-3), 200, 200).unwrap();
        let large = object_picture("", &ball(0.3), 200, 200).unwrap();
        // The room is 200 − 2.8 × 20 pixels high.
        let disc = 0.25 * std::f64::consts::PI * 144.0 * 144.0;
        for picture in [&small, &large] {
            let painted = n_painted(picture) as f64;
            assert!(
                (painted / disc - 1.0).abs() < 0.03,
                "{painted} pixels of {disc}"
            );
        }
    }

    #[test]
    fn the_same_object_gives_the_same_bytes() {
        let draw = || {
            object_picture("ball", &ball(0.02), 160, 120)
                .unwrap()
                .png()
                .unwrap()
        };
        assert_eq!(draw(), draw());
        assert!(draw().starts_with(b"\x89PNG"));
    }

    #[test]
    fn a_name_and_the_length_of_the_bar_are_written() {
        let dark = |name| {
            let picture = object_picture(name, &ball(0.02), 200, 200).unwrap();
            let head = &picture.rgb[..3 * 200 * 20];
            head.iter().filter(|&&value| value < 100).count()
        };
        assert_eq!(dark(""), 0);
        assert!(dark("ball") > 30);
    }

    #[test]
    fn a_sheet_holds_all_tiles_and_refuses_none() {
        let union = ball(0.02);
        let sheet = contact_sheet(&[("a", &union); 5], 3, 100).unwrap();
        assert_eq!((sheet.width, sheet.height), (300, 200));
        let tile = object_picture("a", &union, 100, 100).unwrap();
        assert_eq!(n_painted(&sheet), 5 * n_painted(&tile));
        assert_eq!(contact_sheet(&[], 3, 100).unwrap_err().exit_code(), 2);
        assert_eq!(
            object_picture("a", &union, 10, 100)
                .unwrap_err()
                .exit_code(),
            2
        );
    }

    #[test]
    fn bars_are_the_longest_round_number_that_fits() {
        let lengths = [1.0, 1.99, 2.5, 7.0, 12.0, 49.0, 0.03].map(bar_length);
        let expected = [1.0, 1.0, 2.0, 5.0, 10.0, 20.0, 0.02];
        for (length, expected) in lengths.into_iter().zip(expected) {
            assert!((length - expected).abs() < 1e-12, "{length}");
        }
    }
}
