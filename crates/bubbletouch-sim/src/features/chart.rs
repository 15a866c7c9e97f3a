//! Charts: images of layouts without rows and columns.

use crate::world::ImageShape;
use glam::DVec2;
use ndarray::{Array2, ArrayView2};

/// Distance, in pitches, up to which a taxel contributes to a pixel. On a hexagonal lattice with one taxel per square pitch, the largest distance of a
/// point from a taxel is 0.62. On rings on a sphere it is 0.8. If smaller, images have holes; if larger, images are blurred.
const NEAR: f64 = 1.0;
/// Maximum distance, in pitches, from a pixel of the patch to its nearest taxel. Pixels without a taxel within this distance lie beside the patch and are 0.
const ON_PATCH: f64 = 0.8;

/// Map from a frame to an image: the positions of a patch's taxels on a plane, with the weights of the taxels for each pixel. A pixel is the weighted mean of
/// the taxels near it; weights decrease linearly to 0 at a distance of one pitch. The image of a square grid equals the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    shape: ImageShape,
    /// Indices and weights of the taxels that contribute to each pixel, pixel after pixel; the weights of a pixel have sum 1.
    terms: Vec<(u32, f64)>,
    /// Index after the last entry of each pixel in `terms`.
    ends: Vec<usize>,
}

impl Chart {
    /// Creates the map from the positions of taxels on the plane (metres) and their approximate pitch. The image has square pixels of the
    /// given size (metres), centred on the origin.
    pub fn new(places: &[DVec2], pitch: f64, image: (ImageShape, f64)) -> Self {
        Self::with_gaps(places, (pitch, 1.0), image)
    }

    /// Creates the map for taxels whose distance varies, up to `widest` pitches. A pixel in a gap between taxels shows the nearest taxel.
    pub fn with_gaps(
        places: &[DVec2],
        (pitch, widest): (f64, f64),
        (shape, pixel): (ImageShape, f64),
    ) -> Self {
        let ImageShape {
            ny: rows,
            nx: columns,
        } = shape;
        let (mut terms, mut ends) = (Vec::new(), Vec::with_capacity(rows * columns));
        for row in 0..rows {
            for column in 0..columns {
                let at = |k: usize, n: usize| (k as f64 - 0.5 * (n as f64 - 1.0)) * pixel;
                let place = DVec2::new(at(column, columns), at(row, rows));
                let start = terms.len();
                let distances = places.iter().map(|taxel| taxel.distance(place) / pitch);
                let near = distances.enumerate().filter(|(_, d)| *d < NEAR);
                terms.extend(near.map(|(taxel, d)| (taxel as u32, 1.0 - d / NEAR)));
                let own = &mut terms[start..];
                let largest = own.iter().fold(0.0, |a: f64, (_, weight)| a.max(*weight));
                if largest < 1.0 - ON_PATCH / NEAR {
                    terms.truncate(start);
                    let distances = places.iter().map(|taxel| taxel.distance(place) / pitch);
                    let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
                    let nearest = nearest.filter(|(_, d)| *d <= ON_PATCH * widest);
                    terms.extend(nearest.map(|(taxel, _)| (taxel as u32, 1.0)));
                } else {
                    let sum: f64 = own.iter().map(|(_, weight)| weight).sum();
                    own.iter_mut().for_each(|(_, weight)| *weight /= sum);
                }
                ends.push(terms.len());
            }
        }
        Self { shape, terms, ends }
    }

    /// Returns the images of frames, shape (n, pixels), with pixels row by row. The frames have the shape (n, taxels).
    ///
    /// # Panics
    /// If the frames have fewer taxels than the chart.
    pub fn images(&self, frames: ArrayView2<f64>) -> Array2<f64> {
        let mut images = Array2::zeros((frames.nrows(), self.ends.len()));
        for (mut image, frame) in images.outer_iter_mut().zip(frames.outer_iter()) {
            let mut start = 0;
            for (pixel, &end) in image.iter_mut().zip(&self.ends) {
                let terms = self.terms[start..end].iter();
                *pixel = terms.map(|&(taxel, w)| w * frame[taxel as usize]).sum();
                start = end;
            }
        }
        images
    }

    /// Returns the numbers of rows and columns of the image.
    pub fn shape(&self) -> ImageShape {
        self.shape
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::shape;
    use super::*;
    use crate::world::{ArrayLayout, Grid};

    /// Returns the places of n × n taxels of a layout with pitch 1.
    fn places(layout: ArrayLayout, n: usize) -> Vec<DVec2> {
        let grid = Grid {
            nx: n,
            ny: n,
            pitch: 1.0,
        };
        let taxels = layout.taxels(&grid, 0.0).unwrap();
        taxels.centers().iter().map(|c| c.truncate()).collect()
    }

    #[test]
    fn the_image_of_a_square_grid_is_the_grid() {
        let places: Vec<DVec2> = (0..12)
            .map(|k| DVec2::new(f64::from(k % 4) - 1.5, f64::from(k / 4) - 1.0) * 2e-3)
            .collect();
        let chart = Chart::new(&places, 2e-3, (shape(3, 4), 2e-3));
        let frames = Array2::from_shape_fn((5, 12), |(i, j)| (7 * i + j) as f64);
        let difference = chart.images(frames.view()) - &frames;
        assert!(difference.iter().all(|d| d.abs() < 1e-12));
    }

    #[test]
    fn the_image_of_a_foveated_grid_has_no_holes() {
        let layout = ArrayLayout::Foveated;
        let places = places(layout, 24);
        let half = places.iter().map(|place| place.x).fold(0.0, f64::max);
        let image = (shape(24, 24), (2.0 * half + 1.0) / 24.0);
        let ones = Array2::ones((1, 576));
        let chart = Chart::with_gaps(&places, (1.0, layout.widest_pitches()), image);
        let found = chart.images(ones.view());
        assert!(found.iter().all(|&pixel| (pixel - 1.0).abs() < 1e-12));
        // If `widest` is not considered, pixels between the outer taxels have no taxel.
        let holes = Chart::new(&places, 1.0, image).images(ones.view());
        assert!(holes.iter().any(|&pixel| pixel == 0.0));
    }

    #[test]
    fn a_constant_stays_and_a_slope_is_followed_wherever_the_patch_is() {
        let places = places(ArrayLayout::Hexagonal, 16);
        let chart = Chart::new(&places, 1.0, (shape(30, 30), 1.0));
        let slope = DVec2::new(0.3, -0.2);
        let values = |of: &dyn Fn(&DVec2) -> f64| {
            let frame: Vec<f64> = places.iter().map(of).collect();
            let frame = Array2::from_shape_vec((1, places.len()), frame).unwrap();
            chart.images(frame.view())
        };
        let (ones, sloping) = (values(&|_| 1.0), values(&|p| slope.dot(*p)));
        for (pixel, (&one, &value)) in ones.iter().zip(&sloping).enumerate() {
            let [row, column] = [pixel / 30, pixel % 30];
            let place = DVec2::new(column as f64 - 14.5, row as f64 - 14.5);
            let outermost = place.abs().max_element();
            if outermost > 9.0 {
                assert_eq!(one, 0.0, "{place} is beside the patch");
            } else if outermost < 7.0 {
                assert!((one - 1.0).abs() < 1e-12);
                // A pixel is a mean of taxels less than a pitch away, mostly on opposite sides.
                assert!((value - slope.dot(place)).abs() < 0.5 * slope.length());
            }
        }
    }
}
