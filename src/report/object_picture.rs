//! The picture of an object: its spheres seen from above and to the side, and a sheet of many such pictures.

use crate::error::{Error, Result};
use crate::objects::{Sphere, SphereUnion};
use glam::{DVec2, DVec3};
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

const BACKGROUND: u8 = 250;

/// Rays a pixel, each way.
const SUPERSAMPLING: usize = 2;

struct Label {
    text: String,
    x: f64,
    y: f64,
    size: u32,
}

/// What a ray of the picture meets first.
#[derive(Clone, Copy)]
struct Hit {
    /// Towards the eye, metres.
    height: f64,
    normal: DVec3,
}

/// Axes of the picture in the object's frame.
struct View {
    right: DVec3,
    up: DVec3,
    towards_eye: DVec3,
}

impl View {
    /// The eye stands before the object (−y), 30° to the right of it and 38° up.
    fn three_quarter() -> Self {
        let (azimuth, elevation) = (30f64.to_radians(), 38f64.to_radians());
        let right = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
        let back = DVec3::new(azimuth.sin(), -azimuth.cos(), 0.0);
        let towards_eye = elevation.cos() * back + elevation.sin() * DVec3::Z;
        Self {
            right,
            up: towards_eye.cross(right),
            towards_eye,
        }
    }

    fn project(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.right), point.dot(self.up))
    }
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
    let view = View::three_quarter();
    let (low, high) = extent(&view, union.spheres());
    let size = high - low;
    let room = DVec2::new(width as f64 - 1.6 * margin, height as f64 - 2.8 * margin);
    let pixels_per_metre = (room / size).min_element();
    let n = SUPERSAMPLING as f64;
    let mut canvas = Canvas {
        width: width * SUPERSAMPLING,
        height: height * SUPERSAMPLING,
        scale: pixels_per_metre * n,
        middle: 0.5 * (low + high),
        view,
    };
    canvas.middle.y += 0.1 * margin / pixels_per_metre;
    let shadow = canvas.shadow(union.spheres());
    let hits = canvas.hits(union.spheres());
    let shades = canvas.shades(&hits, &shadow);
    for y in 0..height {
        for x in 0..width {
            let at = 3 * ((top + y) * picture.width + left + x);
            picture.rgb[at..at + 3].copy_from_slice(&canvas.pixel(&shades, x, y));
        }
    }
    let text = (0.045 * side).clamp(9.0, 18.0);
    let label = |text_: &str, x: f64, y: f64| Label {
        text: text_.to_string(),
        x: left as f64 + x,
        y: top as f64 + y,
        size: text as u32,
    };
    if !name.is_empty() {
        labels.push(label(name, 0.5 * width as f64, 0.55 * margin + 0.5 * text));
    }
    let millimetres = bar_length(0.22 * width as f64 / pixels_per_metre * 1e3);
    let length = millimetres * 1e-3 * pixels_per_metre;
    let start = 0.5 * (width as f64 - length);
    let bar_y = height as f64 - 0.35 * margin;
    draw_bar(picture, left as f64 + start, top as f64 + bar_y, length);
    labels.push(label(
        &format!("{millimetres} mm"),
        0.5 * width as f64,
        bar_y - 5.0,
    ));
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

fn extent(view: &View, spheres: &[Sphere]) -> (DVec2, DVec2) {
    let mut low = DVec2::MAX;
    let mut high = DVec2::MIN;
    for sphere in spheres {
        let center = view.project(sphere.center);
        low = low.min(center - sphere.radius);
        high = high.max(center + sphere.radius);
    }
    (low, high)
}

/// The supersampled tile.
struct Canvas {
    width: usize,
    height: usize,
    /// Rays a metre.
    scale: f64,
    /// The point of the view's plane in the middle of the tile.
    middle: DVec2,
    view: View,
}

impl Canvas {
    fn column_row(&self, point: DVec2) -> DVec2 {
        let offset = (point - self.middle) * self.scale;
        DVec2::new(
            0.5 * self.width as f64 + offset.x,
            0.5 * self.height as f64 - offset.y,
        )
    }

    /// Calls `visit(index, offset from the centre in radii)` for each ray inside an upright ellipse.
    fn each_ray(&self, center: DVec2, radii: DVec2, mut visit: impl FnMut(usize, DVec2)) {
        let middle = self.column_row(center);
        let radii = radii * self.scale;
        let range = |middle: f64, radius: f64, n: usize| {
            let first = (middle - radius).floor().clamp(0.0, n as f64) as usize;
            first..(middle + radius).ceil().clamp(0.0, n as f64) as usize
        };
        for row in range(middle.y, radii.y, self.height) {
            for column in range(middle.x, radii.x, self.width) {
                let at = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let offset = (at - middle) / radii;
                if offset.length_squared() <= 1.0 {
                    visit(row * self.width + column, offset);
                }
            }
        }
    }

    fn hits(&self, spheres: &[Sphere]) -> Vec<Option<Hit>> {
        let mut hits: Vec<Option<Hit>> = vec![None; self.width * self.height];
        for sphere in spheres {
            let height = sphere.center.dot(self.view.towards_eye);
            let center = self.view.project(sphere.center);
            self.each_ray(center, DVec2::splat(sphere.radius), |index, offset| {
                let forward = (1.0 - offset.length_squared()).sqrt();
                let height = height + sphere.radius * forward;
                if hits[index].is_none_or(|hit| hit.height < height) {
                    let normal = DVec3::new(offset.x, -offset.y, forward);
                    hits[index] = Some(Hit { height, normal });
                }
            });
        }
        hits
    }

    /// Darkness of the floor z = lowest point, 0 to 1, under a wide lamp that stands left and above.
    fn shadow(&self, spheres: &[Sphere]) -> Vec<f32> {
        let lowest = spheres.iter().map(|s| s.center.z - s.radius);
        let floor = lowest.fold(f64::INFINITY, f64::min);
        let mut dark = vec![0f32; self.width * self.height];
        let foreshortening = self.view.towards_eye.z;
        for sphere in spheres {
            let height = sphere.center.z - floor;
            let slant = DVec3::new(0.22, 0.16, -1.0);
            let center = self.view.project(sphere.center + height * slant);
            let radii = sphere.radius * DVec2::new(1.0, foreshortening);
            self.each_ray(center, radii, |index, _| dark[index] = 1.0);
        }
        let blur = (self.width.min(self.height) / 40).max(2);
        for _ in 0..2 {
            dark = box_blur(&dark, self.width, blur);
        }
        dark
    }

    /// Brightness of each ray and whether it met the object.
    fn shades(&self, hits: &[Option<Hit>], shadow: &[f32]) -> Vec<(f64, bool)> {
        let normals = self.smooth_normals(hits);
        let lamp = DVec3::new(-0.45, 0.65, 0.62).normalize();
        let fill = DVec3::new(0.8, 0.1, 0.6).normalize();
        let indexed = hits.iter().zip(normals).enumerate();
        indexed
            .map(|(index, (hit, normal))| match hit {
                None => (1.0 - 0.20 * f64::from(shadow[index]), false),
                Some(hit) => {
                    let light =
                        0.30 + 0.62 * normal.dot(lamp).max(0.0) + 0.16 * normal.dot(fill).max(0.0);
                    let outline = self.step_down(hits, index, hit);
                    (light * (1.0 - 0.55 * outline), true)
                }
            })
            .collect()
    }

    /// 1 where a neighbouring ray sees something far behind this one: the object's inner and outer outlines.
    fn step_down(&self, hits: &[Option<Hit>], index: usize, hit: &Hit) -> f64 {
        // A slope of 80° between rays is not yet a step.
        let step = 8.0 / self.scale;
        let neighbours = [1, self.width].into_iter().flat_map(|d| {
            let before = index.checked_sub(d);
            let after = Some(index + d).filter(|&i| i < hits.len());
            [before, after]
        });
        let behind = neighbours.flatten().any(|i| match hits[i] {
            None => true,
            Some(other) => hit.height - other.height > step,
        });
        f64::from(u8::from(behind))
    }

    /// Normals averaged over neighbours at like depth, so that the eye sees the shape and not its spheres.
    fn smooth_normals(&self, hits: &[Option<Hit>]) -> Vec<DVec3> {
        let reach = (self.width.min(self.height) / 150).max(1) as isize;
        let mut normals: Vec<DVec3> = hits
            .iter()
            .map(|hit| hit.map_or(DVec3::ZERO, |h| h.normal))
            .collect();
        for stride in [1, self.width as isize] {
            normals = (0..hits.len())
                .map(|index| {
                    let Some(hit) = hits[index] else {
                        return DVec3::ZERO;
                    };
                    let mut sum = DVec3::ZERO;
                    for k in -reach..=reach {
                        let near = index as isize + k * stride;
                        let Some(Some(other)) = usize::try_from(near)
                            .ok()
                            .map(|i| hits.get(i).copied().flatten())
                        else {
                            continue;
                        };
                        if (other.height - hit.height).abs() * self.scale < 3.0 * (reach as f64) {
                            sum += normals[near as usize];
                        }
                    }
                    sum.normalize_or(hit.normal)
                })
                .collect();
        }
        normals
    }

    fn pixel(&self, shades: &[(f64, bool)], x: usize, y: usize) -> [u8; 3] {
        // Slate blue paint on a near-white floor.
        const PAINT: [f64; 3] = [142.0, 178.0, 214.0];
        let mut sum = [0.0; 3];
        for row in y * SUPERSAMPLING..(y + 1) * SUPERSAMPLING {
            for column in x * SUPERSAMPLING..(x + 1) * SUPERSAMPLING {
                let (light, object) = shades[row * self.width + column];
                for (channel, total) in sum.iter_mut().enumerate() {
                    let color = if object {
                        PAINT[channel]
                    } else {
                        f64::from(BACKGROUND)
                    };
                    *total += (color * light).min(255.0);
                }
            }
        }
        sum.map(|total| (total / (SUPERSAMPLING * SUPERSAMPLING) as f64).round() as u8)
    }
}

/// Mean over a square of side 2 · reach + 1; outside counts as 0.
fn box_blur(values: &[f32], width: usize, reach: usize) -> Vec<f32> {
    let height = values.len() / width;
    let along = |values: &[f32], n: usize, stride: usize, start: usize| -> Vec<f32> {
        let mut sums = Vec::with_capacity(n + 1);
        let mut sum = 0.0;
        sums.push(sum);
        for i in 0..n {
            sum += values[start + i * stride];
            sums.push(sum);
        }
        (0..n)
            .map(|i| {
                let (first, last) = (i.saturating_sub(reach), (i + reach + 1).min(n));
                (sums[last] - sums[first]) / (2 * reach + 1) as f32
            })
            .collect()
    };
    let mut rows = Vec::with_capacity(values.len());
    for row in 0..height {
        rows.extend(along(values, width, 1, row * width));
    }
    let mut blurred = vec![0.0; values.len()];
    for column in 0..width {
        for (row, value) in along(&rows, height, width, column).into_iter().enumerate() {
            blurred[row * width + column] = value;
        }
    }
    blurred
}

#[cfg(test)]
mod tests {
    use super::*;

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
