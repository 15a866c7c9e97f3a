//! Picture of objects: their spheres in an oblique view, arranged in tiles.

use crate::error::{Error, Result};
use crate::objects::SphereUnion;
pub use crate::report::pictures::picture::Picture;
use crate::report::pictures::{Align, Drawing, PAINT, TextStyle, draw_scale_bar};
use bubbletouch_sim::raster::{Canvas, Lighting, three_quarter_view};
use glam::DVec2;

/// Draws objects, each at its own scale, in rows of `n_columns` tiles of `tile` × `tile` pixels. The view is orthographic with z up, on a light background.
/// Each tile has the object's name above and a scale bar below.
///
/// Equal input gives equal bytes.
///
/// # Errors
/// If there are no objects or columns, or tiles have fewer than 64 pixels.
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
    let mut drawing = Drawing::new(picture.width as f64, picture.height as f64);
    let side = tile as f64;
    let margin = (0.10 * side).max(14.0);
    let room = DVec2::new(side - 1.6 * margin, side - 2.8 * margin);
    let size = (0.045 * side).clamp(9.0, 18.0) as u32;
    let style = TextStyle::new(size).align(Align::Middle);
    let view = three_quarter_view();
    for (index, (name, union)) in objects.iter().enumerate() {
        let corner = [index % n_columns * tile, index / n_columns * tile];
        let canvas = Canvas::new(view, union.spheres(), [tile; 2], room);
        let hits = canvas.hits(union.spheres());
        let lighting = Lighting::Smoothed;
        picture.paint(&canvas, corner, &hits, lighting, &|_, _| PAINT);
        let (middle, top) = (corner[0] as f64 + 0.5 * side, corner[1] as f64);
        let above = top + 0.55 * margin + 0.5 * f64::from(size);
        drawing.text((middle, above), name, style);
        let below = (middle, top + side - 0.35 * margin);
        draw_scale_bar(&mut drawing, below, canvas.pixels_per_metre(), 0.22 * side);
    }
    picture.print(&drawing)?;
    Ok(picture)
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

    fn picture(name: &str, radius: f64) -> Picture {
        contact_sheet(&[(name, &ball(radius))], 1, 200).unwrap()
    }

    /// Returns the number of pixels that show an object. The object's colour has more blue than red; background and text are grey.
    fn n_painted(picture: &Picture) -> usize {
        let painted = |pixel: &&[u8]| i16::from(pixel[2]) > i16::from(pixel[0]) + 12;
        picture.rgb.chunks(3).filter(painted).count()
    }

    #[test]
    fn a_ball_is_drawn_as_a_disc_that_fills_its_tile_whatever_its_size() {
        // The height of the room is 200 − 2.8 × 20 pixels.
        let disc = 0.25 * std::f64::consts::PI * 144.0 * 144.0;
        for radius in [1e-3, 0.3] {
            let painted = n_painted(&picture("", radius)) as f64;
            assert!(
                (painted / disc - 1.0).abs() < 0.03,
                "{painted} pixels of {disc}"
            );
        }
    }

    #[test]
    fn the_same_object_gives_the_same_bytes() {
        let draw = || picture("ball", 0.02).png().unwrap();
        assert_eq!(draw(), draw());
        assert!(draw().starts_with(b"\x89PNG"));
    }

    #[test]
    fn a_name_is_written_above() {
        let dark = |name| {
            let head = &picture(name, 0.02).rgb[..3 * 200 * 20];
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
        let tile = contact_sheet(&[("a", &union)], 1, 100).unwrap();
        assert_eq!(n_painted(&sheet), 5 * n_painted(&tile));
        let refused = |objects: &[(&str, &SphereUnion)], tile| {
            let error = contact_sheet(objects, 3, tile).unwrap_err();
            assert_eq!(error.exit_code(), 2);
        };
        refused(&[], 100);
        refused(&[("a", &union)], 10);
    }
}
