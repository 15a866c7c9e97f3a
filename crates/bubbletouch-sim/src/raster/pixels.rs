//! Operations on the pixels of pictures: rows from the top, red, green and blue in a byte each.

use super::Rgb;
use glam::DVec2;
use std::collections::HashMap;

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

/// Returns the index of each pixel's colour, and the palette, if channels are rounded to multiples of `step`; `None` if there are more than 256 colours.
pub fn indexed(rgb: &[u8], step: u16) -> Option<(Vec<u8>, Vec<u8>)> {
    let mut known = HashMap::new();
    let mut palette = Vec::new();
    let indices = rgb.as_chunks().0.iter().map(|pixel: &Rgb| {
        let rounded = |channel| (u16::from(channel) + step / 2) / step * step;
        let colour = pixel.map(|channel| rounded(channel).min(255) as u8);
        let next = known.len();
        let index = *known.entry(colour).or_insert(next);
        if index == next {
            palette.extend(colour);
        }
        u8::try_from(index).ok()
    });
    let indices: Option<Vec<u8>> = indices.collect();
    Some((indices?, palette))
}

/// Returns the first three of every `n_samples` values, which are the colours of pixels without their opacity.
///
/// # Panics
/// If `n_samples` is less than 3.
pub fn without_opacity(mut samples: Vec<u8>, n_samples: usize) -> Vec<u8> {
    let n_pixels = samples.len() / n_samples;
    for pixel in 1..n_pixels {
        samples.copy_within(n_samples * pixel..n_samples * pixel + 3, 3 * pixel);
    }
    samples.truncate(3 * n_pixels);
    samples
}

/// Replaces each value of a picture by the value of another picture of equal size if the other value is darker.
pub fn darken(rgb: &mut [u8], other: &[u8]) {
    for (value, &other) in rgb.iter_mut().zip(other) {
        *value = (*value).min(other);
    }
}

/// Compares two pictures of equal size with `width` pixels in a row. Returns the range of rows that differ, and the pixels of these rows with opacity. Pixels
/// that are equal in both pictures are transparent black. Without a picture before, all rows are returned; without a difference, the first row.
pub fn changed_rows(
    before: Option<&[u8]>,
    now: &[u8],
    width: usize,
) -> (std::ops::Range<usize>, Vec<u8>) {
    let height = now.len() / (3 * width);
    let row = |row: usize| 3 * row * width..3 * (row + 1) * width;
    let is_changed =
        |number: &usize| before.is_none_or(|before| before[row(*number)] != now[row(*number)]);
    let first = (0..height).find(is_changed).unwrap_or(0);
    let last = (first..height).rfind(is_changed).unwrap_or(first);
    let part = 3 * first * width..3 * (last + 1) * width;
    let mut rgba = Vec::with_capacity(part.len() / 3 * 4);
    for at in part.step_by(3) {
        let pixel = &now[at..at + 3];
        if before.is_some_and(|before| before[at..at + 3] == *pixel) {
            rgba.extend([0; 4]);
        } else {
            rgba.extend([pixel[0], pixel[1], pixel[2], 255]);
        }
    }
    (first..last + 1, rgba)
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
                // The mixture of a pixel inside or outside is exact without rounding.
                if cover == 0.0 {
                    continue;
                }
                if cover == 1.0 {
                    rgb[at..at + 3].copy_from_slice(colour);
                    continue;
                }
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
        let rest = [99; 3];
        let (above, below) = ([[1, 10, 0], [2, 20, 0]], [[3, 30, 255], [4, 40, 255]]);
        let rgb = [
            above[0], above[1], rest, below[0], below[1], rest, rest, rest, rest,
        ];
        assert_eq!(halved(rgb.as_flattened(), 3), [3, 25, 128]);
        assert!(halved(&rgb.as_flattened()[..9], 1).is_empty());
    }

    #[test]
    fn opacity_is_left_out_and_ink_darkens() {
        let mut rgb = without_opacity(vec![1, 2, 3, 255, 4, 5, 6, 0], 4);
        assert_eq!(rgb, [1, 2, 3, 4, 5, 6]);
        darken(&mut rgb, &[255, 0, 3, 3, 255, 255]);
        assert_eq!(rgb, [1, 0, 3, 3, 5, 6]);
    }

    #[test]
    fn rows_from_the_first_change_to_the_last_are_returned_and_equal_pixels_are_transparent() {
        let before = [[1, 2, 3]; 2 * 4].as_flattened().to_vec();
        let mut now = before.clone();
        assert_eq!(changed_rows(Some(&before), &now, 2), (0..1, vec![0; 8]));
        (now[6], now[3 * 5]) = (9, 8);
        let mut expected = vec![0; 4 * 4];
        expected[..4].copy_from_slice(&[9, 2, 3, 255]);
        expected[12..].copy_from_slice(&[8, 2, 3, 255]);
        assert_eq!(changed_rows(Some(&before), &now, 2), (1..3, expected));
        let (rows, rgba) = changed_rows(None, &now, 2);
        assert_eq!((rows, rgba.len(), rgba[7]), (0..4, 4 * 8, 255));
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
