//! Operations on the pixels of pictures: rows from the top, red, green and blue in a byte each.

use super::Rgb;
use glam::DVec2;

/// Shape of the cells (taxels) of a map, such as a pressure map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellShape {
    /// Square cell with sides parallel to the picture's sides.
    Square,
    /// Disc-shaped cell.
    Disc,
}

/// Returns a picture at half the size (rounded down); each pixel is the mean of four. `width` is the number of pixels in a row.
pub fn halved(rgb: &[u8], width: usize) -> Vec<u8> {
    if width < 2 {
        return Vec::new();
    }
    let mut half = Vec::with_capacity(rgb.len() / 4);
    for rows in rgb.chunks_exact(6 * width) {
        let (above, below) = rows.split_at(3 * width);
        for (above, below) in above.chunks_exact(6).zip(below.chunks_exact(6)) {
            half.extend([0, 1, 2].map(|channel| {
                let sum = [above, below]
                    .map(|pair| u16::from(pair[channel]) + u16::from(pair[channel + 3]));
                ((sum[0] + sum[1] + 2) / 4) as u8
            }));
        }
    }
    half
}

/// Returns the first three of every `n_samples` values, which are the colours of pixels without their opacity.
///
/// # Panics
/// If `n_samples` is less than 3.
pub fn without_opacity(samples: &[u8], n_samples: usize) -> Vec<u8> {
    let mut rgb = Vec::with_capacity(samples.len() / n_samples * 3);
    for pixel in samples.chunks_exact(n_samples) {
        rgb.extend_from_slice(&pixel[..3]);
    }
    rgb
}

/// Replaces each value of a picture by the value of another picture of equal size if the other value is darker.
pub fn darken(rgb: &mut [u8], other: &[u8]) {
    for (value, &other) in rgb.iter_mut().zip(other) {
        *value = (*value).min(other);
    }
}

/// Paints the cells of a map, one colour each, on a picture with `width` pixels in a row. `places` are the centres, pixels from the top left corner; `radius`
/// is half the side of a square, or the radius of a disc, pixels.
pub fn paint_cells(
    (rgb, width): (&mut [u8], usize),
    places: &[DVec2],
    (shape, radius): (CellShape, f64),
    colours: &[Rgb],
) {
    let height = rgb.len() / (3 * width);
    let range = |middle: f64, n: usize| {
        let clamp = |place: f64| place.clamp(0.0, n as f64) as usize;
        clamp((middle - radius - 1.0).floor())..clamp((middle + radius + 1.0).ceil())
    };
    for (middle, colour) in places.iter().zip(colours) {
        for row in range(middle.y, height) {
            for column in range(middle.x, width) {
                let x = (column as f64 + 0.5 - middle.x).abs();
                let y = (row as f64 + 0.5 - middle.y).abs();
                let distance = match shape {
                    CellShape::Square => x.max(y),
                    CellShape::Disc => x.hypot(y),
                };
                // Anti-aliasing: the rim is approximated as straight within a pixel.
                let cover = (radius - distance + 0.5).clamp(0.0, 1.0);
                let at = 3 * (row * width + column);
                for (value, &colour) in rgb[at..at + 3].iter_mut().zip(colour) {
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

    #[test]
    fn a_pixel_of_half_the_size_is_the_rounded_mean_of_four_and_an_odd_rest_is_cut_off() {
        // 3 × 3 pixels; the last row and column are not used.
        let rgb = [
            [1, 10, 0],
            [2, 20, 0],
            [99, 99, 99],
            [3, 30, 255],
            [4, 40, 255],
            [99, 99, 99],
            [99, 99, 99],
            [99, 99, 99],
            [99, 99, 99],
        ];
        assert_eq!(halved(rgb.as_flattened(), 3), [3, 25, 128]);
        assert!(halved(&rgb.as_flattened()[..9], 1).is_empty());
    }

    #[test]
    fn opacity_is_left_out_and_ink_darkens() {
        let mut rgb = without_opacity(&[1, 2, 3, 255, 4, 5, 6, 0], 4);
        assert_eq!(rgb, [1, 2, 3, 4, 5, 6]);
        darken(&mut rgb, &[255, 0, 3, 3, 255, 255]);
        assert_eq!(rgb, [1, 0, 3, 3, 5, 6]);
    }

    /// Counts the pixels that each of three colours covers in a picture of 80 × 60 pixels.
    fn covered(places: &[[f64; 2]], shape: CellShape, radius: f64) -> [f64; 3] {
        let mut rgb = vec![0; 3 * 80 * 60];
        let places: Vec<DVec2> = places.iter().map(|&place| DVec2::from(place)).collect();
        let colours = [[255, 0, 0], [0, 255, 0], [0, 0, 255]];
        paint_cells((&mut rgb, 80), &places, (shape, radius), &colours);
        [0, 1, 2].map(|channel| {
            let values = rgb.chunks(3).map(|pixel| f64::from(pixel[channel]));
            values.sum::<f64>() / 255.0
        })
    }

    #[test]
    fn a_disc_has_its_area_and_keeps_to_the_picture() {
        let places = [[40.3, 30.8], [3.0, 5.0], [80.0, 60.0]];
        let [red, _, blue] = covered(&places, CellShape::Disc, 12.25);
        let disc = std::f64::consts::PI * 12.25 * 12.25;
        assert!((red / disc - 1.0).abs() < 0.01, "{red} of {disc}");
        assert!((blue / disc - 0.25).abs() < 0.01, "{blue} of {disc}");
    }

    #[test]
    fn squares_side_by_side_share_no_pixel() {
        let places = [[10.0, 10.0], [14.0, 10.0], [14.0, 14.0]];
        assert_eq!(covered(&places, CellShape::Square, 2.0), [16.0; 3]);
    }
}
