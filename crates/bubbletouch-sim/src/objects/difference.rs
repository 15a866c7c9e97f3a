//! Packing of solids from which shapes are subtracted (cuts).
//!
//! The surface of A minus B consists of a part of A's surface and a part of B's surface. The two surfaces are divided into cells. A cell is halved until it
//! is proved to lie in an empty ball, to lie in a solid ball, or to be covered by one sphere. In the first two cases the cell contains no surface. The
//! depth inside A minus B is the minimum of the depth in A and the distance from B. A ball of this radius therefore lies inside, and after enlargement it
//! reaches outside by at most the enlargement.
//!
//! A cut that ends exactly at the surface of a part would leave a membrane of zero thickness that passes all tests. Cuts are therefore
//! enlarged by [`GROWTH`], and walls thinner than this beside a cut are lost.

use super::fit::{Fit, MAX_SPHERES};
use super::surface_patch::{PatchCell, SurfacePatch};
use super::{Part, Solid, Sphere};
use glam::DVec3;

/// Enlargement of cuts (subtracted shapes), relative to the allowed gap. If larger, thin walls beside cuts are lost. If smaller, cells where a cut ends in
/// the surface of a part must be divided further before they are proved to be empty.
const GROWTH: f64 = 0.01;
/// Maximum number of tested surface cells: four per allowed sphere.
const MAX_CELLS: usize = 4 * MAX_SPHERES;
/// Number of recent spheres that are tested for covering the next surface cell.
const LAST_SPHERES: usize = 24;

/// Returns the spheres that approximate a solid with cuts; `None` if more than [`MAX_SPHERES`] are needed, or if the proof needs too many cells.
pub(super) fn pack_difference(solid: &Solid, fit: Fit) -> Option<Vec<Sphere>> {
    let growth = GROWTH * fit.inside;
    let mut covering = Covering {
        solid,
        growth,
        // The covered surface is the surface after enlarging the cuts.
        fit: Fit {
            inside: fit.inside - 2.0 * growth,
            ..fit
        },
        size: solid.bounds().size().length(),
        balls: Vec::new(),
        doubtful: Vec::new(),
        n_cells: 0,
    };
    for patch in solid.parts().iter().flat_map(Part::patches) {
        covering.cover(&patch, -1.0)?;
    }
    for patch in solid.cuts().iter().flat_map(Part::patches) {
        covering.cover(&patch.grown(growth), 1.0)?;
    }
    covering.spheres()
}

/// Ball inside the solid, with the distance from its centre to the farthest surface point that it covers.
struct InnerBall {
    center: DVec3,
    radius: f64,
    farthest: f64,
}

struct Covering<'a> {
    solid: &'a Solid,
    growth: f64,
    fit: Fit,
    /// Maximum radius of a ball, metres.
    size: f64,
    balls: Vec<InnerBall>,
    /// Surface cells that are smaller than the enlargement of the cuts, but are not proved to be covered or empty.
    doubtful: Vec<PatchCell>,
    n_cells: usize,
}

impl Covering<'_> {
    /// Covers a patch of the surface by spheres; the solid is in the direction of `inwards` times the normal. Returns `None` if too many spheres or cells are
    /// needed.
    fn cover(&mut self, patch: &SurfacePatch, inwards: f64) -> Option<()> {
        let mut cells = patch.cells();
        while let Some(cell) = cells.pop() {
            self.n_cells += 1;
            if self.balls.len() > MAX_SPHERES || self.n_cells > MAX_CELLS {
                return None;
            }
            let places = cell.places().map(|place| {
                let (point, normal) = patch.at(place);
                (point, inwards * normal)
            });
            if self.is_no_surface(&cell, places[0]) || self.is_covered(&cell) {
                continue;
            }
            let mut balls = places.iter().filter_map(|&place| self.ball_at(place));
            match balls.find(|ball| self.covers(ball, &cell)) {
                Some(ball) => self.balls.push(InnerBall {
                    farthest: cell.farthest(ball.center),
                    ..ball
                }),
                None if cell.farthest(places[0].0) < self.growth => self.doubtful.push(cell),
                None => cells.extend(patch.halves(&cell)),
            }
        }
        Some(())
    }

    /// Returns a lower bound of the distance from a point inside the solid to its surface, metres; negative outside.
    fn depth(&self, point: DVec3) -> f64 {
        self.solid.depth_with_cuts_grown(point, self.growth)
    }

    /// Returns whether the cell is proved to contain no surface of the solid: a ball that is entirely solid or entirely empty contains the cell. This ball is
    /// centred on the normal through the cell's middle.
    fn is_no_surface(&self, cell: &PatchCell, (middle, normal): (DVec3, DVec3)) -> bool {
        let holds = |away: f64| {
            let center = middle + away * normal;
            self.depth(center).abs() >= cell.farthest(center)
        };
        if holds(0.0) {
            return true;
        }
        let mut away = 0.5 * cell.farthest(middle);
        while away < self.size {
            if holds(away) || holds(-away) {
                return true;
            }
            away *= 3.0;
        }
        false
    }

    /// Returns approximately the largest ball inside the solid that touches the surface at the point `foot`.
    fn ball_at(&self, (foot, inward): (DVec3, DVec3)) -> Option<InnerBall> {
        let fits = |radius: f64| self.depth(foot + radius * inward) >= radius - 1.5 * self.growth;
        let mut low = 2.0 * self.growth;
        if !fits(low) {
            return None;
        }
        while fits(2.0 * low) && low < self.size {
            low *= 2.0;
        }
        let mut high = 2.0 * low;
        while high - low > 0.01 * low {
            let middle = 0.5 * (low + high);
            if fits(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let center = foot + low * inward;
        Some(InnerBall {
            center,
            radius: self.depth(center).max(0.0),
            farthest: 0.0,
        })
    }

    fn covers(&self, ball: &InnerBall, cell: &PatchCell) -> bool {
        cell.farthest(ball.center) <= ball.radius + self.fit.reach()
    }

    /// Returns whether one of the most recent spheres covers a cell. If so, the cell is assigned to this sphere.
    fn is_covered(&mut self, cell: &PatchCell) -> bool {
        let last = self.balls.len().saturating_sub(LAST_SPHERES);
        let reach = self.fit.reach();
        for ball in self.balls[last..].iter_mut().rev() {
            let farthest = cell.farthest(ball.center);
            if farthest <= ball.radius + reach {
                ball.farthest = ball.farthest.max(farthest);
                return true;
            }
        }
        false
    }

    /// Returns the spheres; `None` if no sphere covers one of the doubtful cells.
    fn spheres(mut self) -> Option<Vec<Sphere>> {
        for cell in std::mem::take(&mut self.doubtful) {
            let reach = self.fit.reach();
            let farthest = |ball: &InnerBall| cell.farthest(ball.center);
            let ball = self
                .balls
                .iter_mut()
                .find(|ball| farthest(ball) <= ball.radius + reach)?;
            ball.farthest = ball.farthest.max(cell.farthest(ball.center));
        }
        let sphere = |ball: &InnerBall| self.fit.covering(ball.center, ball.radius, ball.farthest);
        Some(self.balls.iter().map(sphere).collect())
    }
}
