//! The kernel of a flat grid pressed along its axis: only the spheres and triangles that reach the skin, only the taxels under them.

use super::Contact;
use super::envelope::Envelope;
use super::grid_lines::GridLines;
use super::instructions::{Instructions, for_instructions};
use super::placed_sphere::PlacedSphere;
use super::row::{Filling, Row};
use super::sheet::Sheet;
use super::sphere_search::{SphereSearch, search};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::EvenGrid;

/// Scratch of one thread.
#[derive(Clone, Debug, Default)]
pub(super) struct GridPress {
    pub instructions: Instructions,
    /// Of the last grid.
    lines: GridLines,
    /// Spheres that can press.
    search: SphereSearch,
    /// Where the meshes stop the taxels; empty if there are none.
    envelope: Envelope,
    sheet: Sheet,
    /// Height of the substrate, metres. A sphere with a lower centre pushes only taxels whose substrate is inside the sphere. −s − ρ at a pose;
    /// −∞ if the press comes from the front, where all spheres count.
    behind: f64,
    /// Of the last press to a force: see [`starts`](Self::starts).
    starts: Vec<f64>,
}

impl GridPress {
    /// Deflections of the last press: n_taxels, metres, row (patch y, ascending) by row.
    pub fn deflections(&self) -> &[f64] {
        self.sheet.deflections()
    }

    /// Keeps the spheres that press a taxel on the way to the goal, and returns the travel to first contact if the
    /// goal is a depth (`None` where no travel touches anything).
    pub(super) fn gather(
        &mut self,
        grid: &EvenGrid,
        objects: &[Model],
        patch_from_objects: &[Pose],
        goal: Until,
    ) -> Option<f64> {
        assert_eq!(
            objects.len(),
            patch_from_objects.len(),
            "one pose an object"
        );
        self.lines.lay(&grid.grid);
        self.behind = match goal {
            Until::Pose => grid.behind,
            Until::Travel(_) | Until::Depth(_) => f64::NEG_INFINITY,
        };
        let placed = Placed {
            objects,
            patch_from_objects,
            radius: grid.radius,
            behind: self.behind,
            lines: &self.lines,
        };
        let mut first = search(self.instructions, &mut self.search, &placed, goal);
        if self.envelope.look(&placed, (goal, first)) {
            first = first.min(self.envelope.first);
        }
        first.is_finite().then_some(first)
    }

    /// Indents the patch at a travel, after a depth of at least as much has been gathered for.
    pub(super) fn indent(
        &mut self,
        grid: &EvenGrid,
        travel: f64,
        filling: &mut Filling,
    ) -> Contact {
        let stroke = grid.stroke;
        self.push(grid, travel, filling);
        filling.finish();
        let row = &mut filling.row;
        let [n_touched, n_saturated] =
            stop_at_stroke(self.instructions, &mut self.sheet, stroke, row);
        Contact {
            travel,
            n_touched,
            n_saturated,
        }
    }

    /// For each taxel that what has been gathered reaches up to `travel`, the travel at which it begins to move, metres.
    pub(super) fn starts(&mut self, grid: &EvenGrid, travel: f64) -> &[f64] {
        self.push(grid, travel, &mut Filling::nothing());
        self.starts.clear();
        self.starts.reserve(grid.grid.n_taxels());
        let Self { sheet, starts, .. } = self;
        sheet.each_row(|_, taxels| {
            let touched = taxels.iter().filter(|needed| **needed > 0.0);
            starts.extend(touched.map(|needed| travel - *needed));
        });
        &self.starts
    }

    /// Leaves all taxels of a patch at rest.
    pub(super) fn touch_nothing(&mut self, grid: &EvenGrid) {
        self.sheet.clear(grid.grid.nx, grid.grid.ny);
    }

    /// Sets the deflections to what the taxels need at a travel, without a stop.
    fn push(&mut self, grid: &EvenGrid, travel: f64, filling: &mut Filling) {
        self.touch_nothing(grid);
        filling.in_steps(self.search.found.len());
        raise_all(
            self.instructions,
            &self.search.found,
            &self.lines,
            (travel, self.behind),
            &mut self.sheet,
            filling,
        );
        if !self.envelope.heights.is_empty() {
            self.sheet.cover(&(0..grid.grid.ny), &(0..grid.grid.nx));
            let mut heights = self.envelope.heights.chunks_exact(grid.grid.nx);
            self.sheet.each_row(|_, taxels| {
                let heights = heights.next().unwrap_or_default();
                for (deflection, height) in taxels.iter_mut().zip(heights) {
                    *deflection = deflection.max(travel - height);
                }
            });
        }
    }
}

for_instructions! {
    /// Raises the deflections to what the spheres need at a travel, if they are not behind the substrate, and fills a row meanwhile.
    fn raise_all(
        spheres: &[PlacedSphere],
        lines: &GridLines,
        travel_and_behind: (f64, f64),
        sheet: &mut Sheet,
        filling: &mut Filling,
    ) = raise_each
}

#[inline(always)]
fn raise_each(
    spheres: &[PlacedSphere],
    lines: &GridLines,
    (travel, behind): (f64, f64),
    sheet: &mut Sheet,
    filling: &mut Filling,
) {
    for sphere in spheres {
        filling.step();
        let height = sphere.center.z - travel;
        if height < behind {
            sphere.raise_through(lines, height, behind, sheet);
        } else if height < sphere.reach {
            sphere.raise(lines, height, sheet);
        }
    }
}

/// How far a press goes, and what counts on the way.
#[derive(Clone, Copy)]
pub(super) enum Until {
    /// To this travel, metres, from the front: all counts.
    Travel(f64),
    /// Nowhere: a sphere that is wholly behind a taxel's substrate does not push it.
    Pose,
    /// To first contact and this far past it, metres, from the front: all counts.
    Depth(f64),
}

/// Objects where a flat grid sees them.
pub(super) struct Placed<'a> {
    pub objects: &'a [Model],
    /// One an object.
    pub patch_from_objects: &'a [Pose],
    /// ρ, metres.
    pub radius: f64,
    /// Height of the substrate, metres: see [`GridPress`].
    pub behind: f64,
    /// Of the grid.
    pub lines: &'a GridLines,
}

/// How far a taxel of this stroke may be pushed without being saturated: a press to a depth of exactly the stroke saturates
/// nothing, and rounding (1e-12 of the stroke) does not count.
pub fn saturation_limit(stroke: f64) -> f64 {
    stroke * (1.0 + 1e-12)
}

for_instructions! {
    /// Counts touched and saturated taxels, stops the latter at their stroke, and writes all into a row of zeros, if it is one.
    fn stop_at_stroke(sheet: &mut Sheet, stroke: f64, row: &mut Row) -> [usize; 2] = stop_each
}

#[inline(always)]
fn stop_each(sheet: &mut Sheet, stroke: f64, row: &mut Row) -> [usize; 2] {
    let mut stop = Stop {
        stroke,
        limit: saturation_limit(stroke),
        n_touched: 0,
        n_saturated: 0,
    };
    match row {
        Row::Double([]) => sheet.each_row(|_, taxels| {
            for taxel in taxels {
                *taxel = stop.of(*taxel);
            }
        }),
        Row::Double(row) => sheet.each_row(|first, taxels| {
            let to = &mut row[first..][..taxels.len()];
            for at in 0..taxels.len() {
                taxels[at] = stop.of(taxels[at]);
                to[at] = taxels[at];
            }
        }),
        Row::Single(row) => sheet.each_row(|first, taxels| {
            let to = &mut row[first..][..taxels.len()];
            for at in 0..taxels.len() {
                taxels[at] = stop.of(taxels[at]);
                to[at] = taxels[at] as f32;
            }
        }),
    }
    [stop.n_touched, stop.n_saturated]
}

/// The end of the taxels' strokes.
struct Stop {
    stroke: f64,
    limit: f64,
    n_touched: usize,
    n_saturated: usize,
}

impl Stop {
    /// Counts a deflection, and what is left of it.
    #[inline(always)]
    fn of(&mut self, deflection: f64) -> f64 {
        self.n_touched += usize::from(deflection > 0.0);
        self.n_saturated += usize::from(deflection > self.limit);
        deflection.min(self.stroke)
    }
}
