//! Cells of a skin picture: adjacent squares for a grid, discs at the taxels for other layouts.
//!
//! A skin is seen along the mean of its axes or, if there is none, on its broad side. If some taxels face away, the picture also shows the view from behind.

use super::header::RecordedPatch;
use crate::report::pictures::{
    Area, Drawing, GRID, INK, Picture, Point, Rgb, Side, Stroke, block_sentence, draw_map_axis,
    draw_scale_bar, grid_sentence,
};
use crate::world::Grid;
use bubbletouch_sim::raster::pixels::{CellShape, paint_cells};
use glam::{DMat3, DVec2, DVec3};

/// Height of a patch in its picture, pixels; the width is at most twice the height.
const SIDE: f64 = 400.0;
/// Maximum number of cells along each side of a grid's picture. In a larger grid, each cell shows the largest value of a block of taxels.
const MAX_CELLS: usize = 400;
/// Distance of all maps from the left edge of the drawing, pixels.
pub(super) const LEFT: f64 = 70.0;
const TOP: f64 = 76.0;
/// Maximum radius of the disc that represents a taxel, pixels.
const LARGEST_DISC: f64 = 24.0;

/// Cells of a patch's picture (one per taxel or block of taxels), in pixels from the top left corner of the drawing.
pub(crate) struct Cells {
    /// Area that contains all cells, pixels.
    pub area: Area,
    /// Centres of the cells: row by row for a grid, otherwise one centre per taxel.
    pub places: Vec<DVec2>,
    /// Half the side of a square cell, or the radius of a disc, pixels.
    pub radius: f64,
    /// Shape of a cell: square or disc.
    pub shape: CellShape,
    /// Number of taxels along each side of a cell, if the taxels form a grid.
    pub block: usize,
    /// Sentence below the picture that describes the view of the patch.
    pub sentence: String,
    pub pixels_per_metre: f64,
}

impl Cells {
    /// Paints each cell in its colour onto a picture that is `fine` times as large as the drawing.
    pub fn paint(&self, picture: &mut Picture, fine: f64, colours: &[Rgb]) {
        let places: Vec<DVec2> = self.places.iter().map(|&place| fine * place).collect();
        let rgb = (&mut picture.rgb[..], picture.width);
        paint_cells(rgb, &places, (self.shape, fine * self.radius), colours);
    }

    /// Creates the cells of a patch: squares if the taxels form a grid, discs for any other layout.
    pub fn new(patch: &RecordedPatch) -> Self {
        match &patch.grid {
            Some(grid) => {
                let largest = grid.nx.max(grid.ny);
                let block = largest.div_ceil(MAX_CELLS);
                let side = whole_pixels(SIDE, largest.div_ceil(block));
                Self::of_grid(grid, block, side, (LEFT, TOP))
            }
            None => Self::of_skin(patch),
        }
    }

    /// Creates square cells with sides of `side` pixels; each cell shows a block of `block` × `block` taxels of a grid. The first cell starts at the given top
    /// left corner.
    pub fn of_grid(grid: &Grid, block: usize, side: f64, (x, y): Point) -> Self {
        let (rows, columns) = (grid.ny.div_ceil(block), grid.nx.div_ceil(block));
        let area = Area::new((x, y), (side * columns as f64, side * rows as f64));
        let place = |cell: usize| {
            let (row, column) = ((cell / columns) as f64, (cell % columns) as f64);
            DVec2::new(
                x + (column + 0.5) * side,
                y + area.height - (row + 0.5) * side,
            )
        };
        let size = grid_sentence((grid.nx, grid.ny), grid.pitch * 1e3);
        Self {
            area,
            places: (0..rows * columns).map(place).collect(),
            radius: 0.5 * side,
            shape: CellShape::Square,
            block,
            sentence: size + &block_sentence(block),
            pixels_per_metre: side / (block as f64 * grid.pitch),
        }
    }

    fn of_skin(patch: &RecordedPatch) -> Self {
        let projected = project(&patch.centers, &patch.axes);
        let places = projected.places;
        let radius = 0.47 * typical_spacing(&patch.centers);
        let margin = DVec2::splat(1.6 * radius);
        let low = places.iter().fold(DVec2::INFINITY, |a, &b| a.min(b)) - margin;
        let high = places.iter().fold(DVec2::NEG_INFINITY, |a, &b| a.max(b)) + margin;
        let size = high - low;
        let widest = (2.0 * SIDE / size.x).min(SIDE / size.y);
        let scale = widest.min(LARGEST_DISC / radius);
        let place = |place: &DVec2| {
            let [x, y] = [place.x - low.x, high.y - place.y];
            DVec2::new(LEFT + scale * x, TOP + scale * y)
        };
        let plural = if places.len() == 1 { "" } else { "s" };
        Self {
            area: Area::new((LEFT, TOP), (scale * size.x, scale * size.y)),
            places: places.iter().map(place).collect(),
            radius: scale * radius,
            shape: CellShape::Disc,
            block: 1,
            sentence: format!("{} taxel{plural}, {}", places.len(), projected.sentence),
            pixels_per_metre: scale,
        }
    }

    /// Draws axes in millimetres if the taxels form a grid; otherwise draws a scale bar.
    pub fn draw_frame(&self, drawing: &mut Drawing, is_grid: bool) {
        let area = self.area;
        if is_grid {
            let millimetres = |pixels: f64| pixels / self.pixels_per_metre * 1e3;
            draw_map_axis(drawing, area, Side::Below, millimetres(area.width));
            draw_map_axis(drawing, area, Side::Left, millimetres(area.height));
            drawing.frame(area, Stroke::new(INK, 1.0));
            return;
        }
        drawing.area(area, GRID);
        let (x, y) = area.at(0.5, 0.0);
        let longest = 0.3 * area.width;
        draw_scale_bar(drawing, (x, y + 26.0), self.pixels_per_metre, longest);
    }
}

/// Returns the side length of square cells if `n_cells` must fit into `room` pixels: a whole number of pixels, which avoids gaps.
pub(crate) fn whole_pixels(room: f64, n_cells: usize) -> f64 {
    (room / n_cells as f64).floor().max(1.0)
}

/// Returns the median distance of a taxel to its nearest neighbour, metres, estimated from about 200 taxels; 1 mm for a single taxel. The distance affects only
/// the appearance of pictures.
pub(crate) fn typical_spacing(centers: &[DVec3]) -> f64 {
    let sample = centers.iter().step_by(centers.len().div_ceil(200).max(1));
    let nearest = sample.filter_map(|center| {
        let distances = centers.iter().map(|other| other.distance(*center));
        distances
            .filter(|distance| *distance > 0.0)
            .min_by(f64::total_cmp)
    });
    let mut distances: Vec<f64> = nearest.collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied().unwrap_or(1e-3)
}

/// Positions of the taxels of a skin after projection onto a plane.
struct Projected {
    /// Position of each taxel in the plane, to the right and up, metres.
    places: Vec<DVec2>,
    /// Sentence below the picture that describes the projection.
    sentence: String,
}

/// Returns a matrix whose rows are the directions right, up and towards the viewer in a picture. If the view is along z, y is up, as in a heat map; otherwise z
/// is up.
pub(crate) fn view_from(towards_eye: DVec3) -> DMat3 {
    let is_above = towards_eye.z.abs() > 0.7;
    let up = if is_above { DVec3::Y } else { DVec3::Z };
    let right = up.cross(towards_eye).normalize();
    DMat3::from_cols(right, towards_eye.cross(right), towards_eye).transpose()
}

/// Projects the taxels of a skin along the mean direction of their axes. If there is no mean direction, they are projected from the broad side along +x, +y or
/// +z. For each centre (metres), `axes` contains a unit vector.
fn project(centers: &[DVec3], axes: &[DVec3]) -> Projected {
    let mean = axes.iter().sum::<DVec3>() / axes.len() as f64;
    let towards_eye = if mean.length() > 0.1 {
        mean.normalize()
    } else {
        let low = centers.iter().fold(DVec3::INFINITY, |a, &b| a.min(b));
        let high = centers.iter().fold(DVec3::NEG_INFINITY, |a, &b| a.max(b));
        let thinnest = (high - low).min_position();
        DVec3::AXES[thinnest]
    };
    let view = view_from(towards_eye);
    let faces_away = |axis: &DVec3| axis.dot(towards_eye) < 0.0;
    let mut places: Vec<DVec2> = centers
        .iter()
        .map(|center| (view * center).truncate())
        .collect();
    let sentence = format!("seen from {}", direction(towards_eye));
    if !axes.iter().any(faces_away) {
        return Projected { places, sentence };
    }
    // In the view from behind, right is left. The two views are separated by a tenth of the width plus 2 mm.
    let low = places.iter().fold(DVec2::INFINITY, |a, &b| a.min(b)).x;
    let high = places.iter().fold(DVec2::NEG_INFINITY, |a, &b| a.max(b)).x;
    let mirror = high + 0.05 * (high - low) + 1e-3;
    for (place, axis) in places.iter_mut().zip(axes) {
        if faces_away(axis) {
            place.x = 2.0 * mirror - place.x;
        }
    }
    Projected {
        places,
        sentence: format!("left {sentence}, right the taxels that face away, from behind"),
    }
}

/// Returns a direction as text: `+z` if it is within half a degree of an axis, otherwise three components.
fn direction(vector: DVec3) -> String {
    for (axis, name) in DVec3::AXES.into_iter().zip(["x", "y", "z"]) {
        let along = vector.dot(axis);
        if along.abs() > 1.0 - 4e-5 {
            return format!("{}{name}", if along > 0.0 { '+' } else { '−' });
        }
    }
    // Adding zero turns −0 into 0.
    let parts = vector.to_array().map(|c| (100.0 * c).round() / 100.0 + 0.0);
    let parts = parts.map(|c| format!("{c:.2}").replace('-', "−"));
    format!("({})", parts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_is_seen_as_a_heat_map_shows_it() {
        let centers = [DVec3::ZERO, DVec3::new(0.1, 0.02, 0.0)];
        let projected = project(&centers, &[DVec3::Z; 2]);
        assert_eq!(projected.sentence, "seen from +z");
        assert_eq!(projected.places[1], DVec2::new(0.1, 0.02));
    }

    #[test]
    fn a_closed_skin_is_seen_from_both_sides_and_each_taxel_once() {
        let axes: Vec<DVec3> = (0..200)
            .map(|i| {
                let z = -1.0 + (f64::from(i) + 0.5) / 100.0;
                let azimuth = 2.4 * f64::from(i);
                let ring = (1.0 - z * z).sqrt();
                DVec3::new(ring * azimuth.cos(), ring * azimuth.sin(), z)
            })
            .collect();
        let scale = DVec3::new(0.08, 0.05, 0.02);
        let centers: Vec<DVec3> = axes.iter().map(|&axis| axis * scale).collect();
        let projected = project(&centers, &axes);
        assert!(
            projected
                .sentence
                .starts_with("left seen from +z, right the")
        );
        // In the view from behind, right is left. The two views do not overlap.
        let shift = |taxel: usize| projected.places[taxel].x + centers[taxel].x;
        let away = (0..200).find(|&taxel| axes[taxel].z < 0.0).unwrap();
        for (taxel, place) in projected.places.iter().enumerate() {
            let is_away = axes[taxel].z < 0.0;
            assert_eq!(is_away, place.x > 0.08);
            match is_away {
                true => assert!((shift(taxel) - shift(away)).abs() < 1e-12),
                false => assert_eq!(place.x, centers[taxel].x),
            }
        }
    }
}
