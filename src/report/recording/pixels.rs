//! Cells as pixels. For four thousand cells, the drawing crate takes a tenth of a second; this code takes some milliseconds.

use super::cells::Cells;
use crate::report::pictures::colours::Rgb;
use crate::report::pictures::picture::Picture;

/// Paints all cells, one colour each, in a picture that is `fine` times as large as the drawing.
pub(crate) fn paint(picture: &mut Picture, cells: &Cells, fine: f64, colours: &[Rgb]) {
    let radius = fine * cells.radius;
    let range = |middle: f64, n: usize| {
        let clamp = |place: f64| place.clamp(0.0, n as f64) as usize;
        clamp((middle - radius - 1.0).floor())..clamp((middle + radius + 1.0).ceil())
    };
    for (place, colour) in cells.places.iter().zip(colours) {
        let middle = fine * *place;
        for row in range(middle.y, picture.height) {
            for column in range(middle.x, picture.width) {
                let x = (column as f64 + 0.5 - middle.x).abs();
                let y = (row as f64 + 0.5 - middle.y).abs();
                // Anti-aliasing: the rim is approximated as straight within a pixel.
                let cover = (radius - (cells.distance)(x, y) + 0.5).clamp(0.0, 1.0);
                let at = 3 * (row * picture.width + column);
                for (value, &colour) in picture.rgb[at..at + 3].iter_mut().zip(colour) {
                    let mixed = cover * f64::from(colour) + (1.0 - cover) * f64::from(*value);
                    *value = mixed.round() as u8;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::pictures::drawing::Area;
    use glam::DVec2;

    fn cells(places: &[[f64; 2]], radius: f64, distance: fn(f64, f64) -> f64) -> Cells {
        Cells {
            area: Area {
                x: 0.0,
                y: 0.0,
                width: 80.0,
                height: 60.0,
            },
            places: places.iter().map(|&place| DVec2::from(place)).collect(),
            radius,
            distance,
            block: 1,
            sentence: String::new(),
            pixels_per_metre: 1.0,
        }
    }

    /// Counts the pixels that each of three colours covers.
    fn covered(cells: &Cells) -> [f64; 3] {
        let (width, height) = (80, 60);
        let mut picture = Picture {
            width,
            height,
            rgb: vec![0; 3 * width * height],
        };
        let colours = [[255, 0, 0], [0, 255, 0], [0, 0, 255]];
        paint(&mut picture, cells, 1.0, &colours);
        [0, 1, 2].map(|channel| {
            let values = picture.rgb.chunks(3).map(|pixel| f64::from(pixel[channel]));
            values.sum::<f64>() / 255.0
        })
    }

    #[test]
    fn a_disc_has_its_area_and_keeps_to_the_picture() {
        let places = [[40.3, 30.8], [3.0, 5.0], [80.0, 60.0]];
        let [red, _, blue] = covered(&cells(&places, 12.25, f64::hypot));
        let disc = std::f64::consts::PI * 12.25 * 12.25;
        assert!((red / disc - 1.0).abs() < 0.01, "{red} of {disc}");
        assert!((blue / disc - 0.25).abs() < 0.01, "{blue} of {disc}");
    }

    #[test]
    fn squares_side_by_side_share_no_pixel() {
        let places = [[10.0, 10.0], [14.0, 10.0], [14.0, 14.0]];
        assert_eq!(covered(&cells(&places, 2.0, f64::max)), [16.0; 3]);
    }
}
