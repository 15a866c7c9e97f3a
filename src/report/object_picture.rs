//! The picture of an object: its spheres seen from above and to the side, and a sheet of many such pictures.

use super::picture::Label;
pub use super::picture::Picture;
use super::shaded_view::{Lighting, PAINT, Stage};
use crate::error::{Error, Result};
use crate::objects::SphereUnion;
use glam::DVec2;

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
    let stage = Stage::new(union.spheres(), [width, height], room);
    let hits = stage.canvas.hits(union.spheres());
    let view = stage.view(&hits, Lighting::Smoothed, |_| PAINT);
    picture.place(&view, [left, top], [width, height]);
    let middle = left as f64 + 0.5 * width as f64;
    let size = (0.045 * side).clamp(9.0, 18.0);
    if !name.is_empty() {
        labels.push(Label {
            text: name.to_string(),
            x: middle,
            y: top as f64 + 0.55 * margin + 0.5 * size,
            size: size as u32,
        });
    }
    let below = top as f64 + height as f64 - 0.35 * margin;
    let bar = [middle, below];
    labels.push(picture.draw_scale(stage.pixels_per_metre, width as f64, bar, size as u32));
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
}
