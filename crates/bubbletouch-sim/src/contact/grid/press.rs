//! Press kernel of a flat grid along its axis. The kernel evaluates only spheres and triangles that reach the skin, and only the taxels under these parts.

use super::deflection_grid::DeflectionGrid;
use super::envelope::Envelope;
use super::lines::GridLines;
use super::output_buffer::{OutputBuffer, Row};
use super::placed_objects::PlacedObjects;
use super::placed_sphere::PlacedSphere;
use super::sphere_search::{SphereSearch, search};
use crate::contact::instructions::{Instructions, for_instructions};
use crate::contact::law::saturation_limit;
use crate::contact::{Contact, Until};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::EvenGrid;

/// Scratch memory of one thread for presses of flat grids.
#[derive(Clone, Debug, Default)]
pub(crate) struct GridPress {
    pub instructions: Instructions,
    /// Lines (columns and rows) of the last grid.
    lines: GridLines,
    /// Search for the spheres that can press a taxel.
    search: SphereSearch,
    /// Heights at which the meshes stop the taxels.
    envelope: Envelope,
    /// Whether there are meshes.
    has_meshes: bool,
    deflections: DeflectionGrid,
    /// Height of the substrate, metres, below which spheres push only taxels whose substrate is inside the sphere. The value is −∞ if the press comes from
    /// the front, where spheres push at any distance behind the taxels.
    behind: f64,
    /// Travels at which the taxels began to move in the last press to a force, metres.
    starts: Vec<f64>,
}

impl GridPress {
    /// Returns the deflections of the last press, metres, shape (n_taxels,), row by row (patch y, ascending).
    pub fn deflections(&self) -> &[f64] {
        self.deflections.deflections()
    }

    /// Collects the spheres that press a taxel before the goal of the press is reached. Returns the travel at first contact if the goal is a depth; `None` if
    /// the patch meets nothing.
    pub(crate) fn gather(
        &mut self,
        grid: &EvenGrid,
        objects: &[Model],
        patch_from_objects: &[Pose],
        until: Until,
    ) -> Option<f64> {
        assert_eq!(
            objects.len(),
            patch_from_objects.len(),
            "one pose an object"
        );
        self.lines.lay(&grid.grid);
        self.behind = match until {
            Until::Pose => grid.behind,
            _ => f64::NEG_INFINITY,
        };
        let placed = PlacedObjects {
            objects,
            patch_from_objects,
            radius: grid.radius,
            behind: self.behind,
            lines: &self.lines,
        };
        let mut first = search(self.instructions, &mut self.search, &placed, until);
        let instructions = self.instructions;
        self.has_meshes = self.envelope.look(&placed, (until, first), instructions);
        if self.has_meshes {
            first = first.min(self.envelope.first);
        }
        first.is_finite().then_some(first)
    }

    /// Computes the deflections of the patch at a travel. The method `gather` must have been called before, for this travel or a larger travel.
    pub(crate) fn indent(
        &mut self,
        grid: &EvenGrid,
        travel: f64,
        output: &mut OutputBuffer,
    ) -> Contact {
        let stroke = grid.stroke;
        self.push(grid, travel, output);
        output.finish();
        let row = &mut output.row;
        let [n_touched, n_saturated] =
            stop_at_stroke(self.instructions, &mut self.deflections, stroke, row);
        Contact {
            travel,
            n_touched,
            n_saturated,
        }
    }

    /// Returns the travel at which each taxel begins to move, metres, for the taxels that the gathered objects touch before `travel`.
    pub(crate) fn starts(&mut self, grid: &EvenGrid, travel: f64) -> &[f64] {
        self.push(grid, travel, &mut OutputBuffer::none());
        self.starts.clear();
        self.starts.reserve(grid.grid.n_taxels());
        let Self {
            deflections,
            starts,
            ..
        } = self;
        deflections.each_row(|_, taxels| {
            let touched = taxels.iter().filter(|needed| **needed > 0.0);
            starts.extend(touched.map(|needed| travel - *needed));
        });
        &self.starts
    }

    /// Sets the deflections of all taxels of a grid to zero.
    pub(crate) fn touch_nothing(&mut self, grid: &EvenGrid) {
        self.deflections.clear(grid.grid.nx, grid.grid.ny);
    }

    /// Computes the deflections that contact with the objects requires at a travel of the patch, not limited to the stroke.
    fn push(&mut self, grid: &EvenGrid, travel: f64, output: &mut OutputBuffer) {
        self.touch_nothing(grid);
        output.in_steps(self.search.found.len());
        indent_all(
            self.instructions,
            &self.search.found,
            &self.lines,
            (travel, self.behind),
            &mut self.deflections,
            output,
        );
        if self.has_meshes {
            let (rows, columns) = self.envelope.rectangle();
            self.deflections.cover(rows, columns);
            for row in rows.clone() {
                let taxels = self.deflections.row(row, columns.clone());
                for (deflection, height) in taxels.iter_mut().zip(self.envelope.row(row)) {
                    *deflection = deflection.max(travel - height);
                }
            }
        }
    }
}

for_instructions! {
    /// Raises the deflections by all spheres that push taxels at a travel, and fills the output row with zeros in the meantime.
    fn indent_all(
        spheres: &[PlacedSphere],
        lines: &GridLines,
        travel_and_behind: (f64, f64),
        deflections: &mut DeflectionGrid,
        output: &mut OutputBuffer,
    ) = indent_each
}

#[inline(always)]
fn indent_each(
    spheres: &[PlacedSphere],
    lines: &GridLines,
    (travel, behind): (f64, f64),
    deflections: &mut DeflectionGrid,
    output: &mut OutputBuffer,
) {
    for sphere in spheres {
        output.step();
        let height = sphere.center.z - travel;
        if height < behind {
            sphere.indent_through(lines, height, behind, deflections);
        } else if height < sphere.reach {
            sphere.indent(lines, height, deflections);
        }
    }
}

for_instructions! {
    /// Counts touched and saturated taxels, limits their deflections to the stroke, and writes them into the output row if there is one.
    fn stop_at_stroke(deflections: &mut DeflectionGrid, stroke: f64, row: &mut Row) -> [usize; 2] = stop_each
}

#[inline(always)]
fn stop_each(deflections: &mut DeflectionGrid, stroke: f64, row: &mut Row) -> [usize; 2] {
    let mut stop = Stop {
        stroke,
        limit: saturation_limit(stroke),
        n_touched: 0,
        n_saturated: 0,
    };
    match row {
        Row::Double([]) => deflections.each_row(|_, taxels| {
            for taxel in taxels {
                *taxel = stop.limit(*taxel);
            }
        }),
        Row::Double(row) => deflections.each_row(|first, taxels| {
            let to = &mut row[first..][..taxels.len()];
            for at in 0..taxels.len() {
                taxels[at] = stop.limit(taxels[at]);
                to[at] = taxels[at];
            }
        }),
        Row::Single(row) => deflections.each_row(|first, taxels| {
            let to = &mut row[first..][..taxels.len()];
            for at in 0..taxels.len() {
                taxels[at] = stop.limit(taxels[at]);
                to[at] = taxels[at] as f32;
            }
        }),
    }
    [stop.n_touched, stop.n_saturated]
}

/// Stroke to which deflections are limited, and the numbers of touched and saturated taxels.
struct Stop {
    stroke: f64,
    limit: f64,
    n_touched: usize,
    n_saturated: usize,
}

impl Stop {
    /// Counts a taxel as touched or saturated, and returns its deflection, limited to the stroke.
    #[inline(always)]
    fn limit(&mut self, deflection: f64) -> f64 {
        self.n_touched += usize::from(deflection > 0.0);
        self.n_saturated += usize::from(deflection > self.limit);
        deflection.min(self.stroke)
    }
}
