//! Where the dots of a skin stand in its picture.

use super::skin_picture::{LEFT, SIDE, TOP};
use super::unrolled::Unrolled;
use crate::report::drawing::{Area, Drawing};
use crate::report::picture_axes::draw_scale_bar;
use glam::DVec2;

/// The largest radius of a dot, pixels.
const LARGEST_DOT: f64 = 24.0;
/// Between two views, pixels.
const GAP: f64 = 30.0;

/// Where dots are drawn.
pub(super) struct Dots {
    /// All views together.
    pub area: Area,
    /// One a view.
    pub panels: Vec<Area>,
    /// The place of each view that is in its panel's lower left corner, metres.
    corners: Vec<DVec2>,
    pixels_per_metre: f64,
    /// Pixels.
    pub radius: f64,
}

impl Dots {
    pub fn new(unrolled: &Unrolled) -> Self {
        // A single taxel is drawn as if it had a neighbour a millimetre away.
        let radius = 0.47 * typical_distance(unrolled).unwrap_or(1e-3);
        let margin = DVec2::splat(1.6 * radius);
        let bounds = unrolled.views.iter().map(|view| {
            let places = || view.places.iter().map(|place| place.1);
            let low = places().fold(DVec2::INFINITY, DVec2::min) - margin;
            (
                low,
                places().fold(DVec2::NEG_INFINITY, DVec2::max) + margin - low,
            )
        });
        let (corners, sizes): (Vec<DVec2>, Vec<DVec2>) = bounds.unzip();
        let width: f64 = sizes.iter().map(|size| size.x).sum();
        let height = sizes.iter().fold(0.0, |h: f64, size| h.max(size.y));
        let room = SIDE * sizes.len().min(2) as f64;
        let pixels_per_metre = (room / width).min(SIDE / height).min(LARGEST_DOT / radius);
        let mut right = LEFT;
        let panel = |size: &DVec2| {
            let panel = Area {
                x: right,
                y: TOP,
                width: size.x * pixels_per_metre,
                height: height * pixels_per_metre,
            };
            right += panel.width + GAP;
            panel
        };
        let panels: Vec<Area> = sizes.iter().map(panel).collect();
        // Lower views stand in the middle of the height that all have.
        let lowered = corners.iter().zip(&sizes);
        let corners = lowered.map(|(low, size)| low - DVec2::new(0.0, 0.5 * (height - size.y)));
        Self {
            area: Area {
                x: LEFT,
                y: TOP,
                width: right - GAP - LEFT,
                height: height * pixels_per_metre,
            },
            corners: corners.collect(),
            panels,
            pixels_per_metre,
            radius: radius * pixels_per_metre,
        }
    }

    /// Pixels from the top left corner, one a taxel.
    pub fn places(&self, unrolled: &Unrolled, n_taxels: usize) -> Vec<DVec2> {
        let mut places = vec![DVec2::ZERO; n_taxels];
        for ((view, panel), corner) in unrolled.views.iter().zip(&self.panels).zip(&self.corners) {
            for &(taxel, place) in &view.places {
                let from_corner = (place - corner) * self.pixels_per_metre;
                let down = panel.y + panel.height - from_corner.y;
                places[taxel] = DVec2::new(panel.x + from_corner.x, down);
            }
        }
        places
    }

    /// A bar of a round length, `below` pixels under the panels.
    pub fn draw_scale_bar(&self, drawing: &mut Drawing, below: f64) {
        let (x, y) = self.area.at(0.5, 0.0);
        let longest = 0.3 * self.area.width;
        draw_scale_bar(drawing, (x, y + below), self.pixels_per_metre, longest);
    }
}

/// The median of distances to the nearest taxel of the same view, metres; of up to 200 taxels, since it is a look, no number.
fn typical_distance(unrolled: &Unrolled) -> Option<f64> {
    let mut distances = Vec::new();
    for view in &unrolled.views {
        for &(taxel, place) in view
            .places
            .iter()
            .step_by(view.places.len().div_ceil(200).max(1))
        {
            let others = view.places.iter().filter(|other| other.0 != taxel);
            let squares = others.map(|other| other.1.distance_squared(place));
            // Taxels behind each other have no distance in the picture.
            let apart = squares.filter(|&square| square > 1e-12);
            distances.extend(apart.min_by(f64::total_cmp).map(f64::sqrt));
        }
    }
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied()
}
