//! Spheres for solids from which other shapes are subtracted.
//!
//! The surface of A less B is a part of A's and a part of B's. Both are cut into cells, and a cell is halved until one of three
//! things is proved of it: it lies in a ball of nothing; it lies in a ball of solid (then none of it is surface); or one sphere
//! covers it. Depths inside A less B are the smaller of the depth in A and the distance from B, so a ball of that radius is inside,
//! and swollen it reaches outside by no more than it is swollen by.
//!
//! A cut that ends exactly where a part does leaves nothing there, but a membrane without thickness would pass all tests; so cuts are
//! taken larger by [`GROWTH`]. What is thinner than that beside a cut is lost.

use super::fit::{Fit, MAX_SPHERES};
use super::surface_patch::{PatchCell, SurfacePatch};
use super::{Part, Solid, Sphere};
use glam::DVec3;

/// How much larger cuts are taken, in allowed gaps. Larger: thin walls beside cuts are lost; smaller: cells where a cut ends in the
/// surface of a part must be smaller before it is plain that nothing is there.
const GROWTH: f64 = 0.01;
/// Cells that are looked at for each sphere that is allowed, at most.
const MAX_CELLS: usize = 4 * MAX_SPHERES;
/// Spheres that were made last and may cover another cell.
const LAST_SPHERES: usize = 24;

/// Spheres, or `None` if they are more than [`MAX_SPHERES`], or if that is needed to be sure.
pub(super) fn pack_difference(solid: &Solid, fit: Fit) -> Option<Vec<Sphere>> {
    let growth = GROWTH * fit.inside;
    let mut covering = Covering {
        solid,
        growth,
        // What is covered is the surface of the larger cuts.
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

/// A ball inside the solid, and the farthest surface that it covers.
struct InnerBall {
    center: DVec3,
    radius: f64,
    farthest: f64,
}

struct Covering<'a> {
    solid: &'a Solid,
    growth: f64,
    fit: Fit,
    /// No ball is larger.
    size: f64,
    balls: Vec<InnerBall>,
    /// Cells smaller than the growth of which nothing is proved.
    doubtful: Vec<PatchCell>,
    n_cells: usize,
}

impl Covering<'_> {
    /// Covers what of a patch is surface; the solid is where the normal points times `inwards`. `None` if it takes too much.
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
            let balls = places.iter().filter_map(|&place| self.ball_at(place));
            let mut covers = balls.filter(|ball| self.covers(ball, &cell));
            if let Some(mut ball) = covers.next() {
                drop(covers);
                ball.farthest = cell.farthest(ball.center);
                self.balls.push(ball);
            } else if cell.farthest(places[0].0) < self.growth {
                drop(covers);
                self.doubtful.push(cell);
            } else {
                drop(covers);
                cells.extend(patch.halves(&cell));
            }
        }
        Some(())
    }

    /// Metres from a point inside the solid to its surface, at most; negative outside.
    fn depth(&self, point: DVec3) -> f64 {
        self.solid.depth_with_cuts_grown(point, self.growth)
    }

    /// Whether a ball about a point on the normal through the middle holds the cell and is all solid or all empty.
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

    /// The largest ball inside the solid that touches the surface there, about.
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

    /// Whether one of the spheres that were made last covers a cell, which it then does.
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

    /// `None` if a doubtful cell is covered by none of them.
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
