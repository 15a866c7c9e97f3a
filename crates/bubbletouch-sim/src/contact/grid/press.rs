//! Press kernel of a flat grid along its axis. The kernel evaluates only spheres and triangles that reach the skin, and only the taxels under these parts.

use super::envelope::Envelope;
use super::grid_values::GridValues;
use super::lines::GridLines;
use super::output_buffer::{OutputBuffer, Row};
use super::placed_objects::PlacedObjects;
use super::sphere_search::{SphereSearch, search};
use crate::contact::instructions::{Instructions, for_instructions};
use crate::contact::law::saturation_limit;
use crate::contact::object_at::PlacedSphere;
use crate::contact::{Contact, Until};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{EvenGrid, Grid};

/// Scratch memory of one thread for presses of flat grids.
#[derive(Clone, Debug, Default)]
pub(crate) struct GridScratch {
    /// Lines (columns and rows) of the last grid.
    lines: GridLines,
    /// Search for the spheres that can press a taxel.
    search: SphereSearch,
    /// Heights at which the meshes stop the taxels.
    envelope: Envelope,
    /// Whether there are meshes.
    has_meshes: bool,
    /// Height of the substrate, metres, below which spheres push only taxels whose substrate is inside the sphere. The value is −∞ if the press comes from
    /// the front, where spheres push at any distance behind the taxels.
    behind: f64,
    /// Travels at which the taxels began to move in the last press to a force, metres.
    starts: Vec<f64>,
}

/// Press of a flat grid along its axis.
#[derive(Debug)]
pub(crate) struct GridPress<'a> {
    pub grid: &'a EvenGrid,
    pub instructions: Instructions,
    pub scratch: &'a mut GridScratch,
    /// Deflections, metres, row by row (patch y, ascending).
    pub deflections: &'a mut GridValues,
}

impl GridPress<'_> {
    /// Collects the spheres that press a taxel before the goal of the press is reached. Returns the travel at first contact if the goal is a depth; `None` if
    /// the patch meets nothing.
    pub fn gather(
        &mut self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        until: Until,
    ) -> Option<f64> {
        assert_eq!(
            objects.len(),
            patch_from_objects.len(),
            "one pose an object"
        );
        let (grid, instructions) = (self.grid, self.instructions);
        let scratch = &mut *self.scratch;
        scratch.lines.lay(&grid.grid);
        scratch.behind = match until {
            Until::Pose => grid.behind,
            _ => f64::NEG_INFINITY,
        };
        let placed = PlacedObjects {
            objects,
            patch_from_objects,
            radius: grid.radius,
            behind: scratch.behind,
            lines: &scratch.lines,
        };
        let mut first = search(instructions, &mut scratch.search, &placed, until);
        let envelope = &mut scratch.envelope;
        scratch.has_meshes = envelope.look(&placed, (until, first), instructions);
        if scratch.has_meshes {
            first = first.min(envelope.first);
        }
        first.is_finite().then_some(first)
    }

    /// Computes the deflections of the patch at a travel. The method `gather` must have been called before, for this travel or a larger travel.
    pub fn indent(&mut self, travel: f64, output: &mut OutputBuffer) -> Contact {
        self.push(travel, output);
        output.finish();
        let (stroke, row) = (self.grid.stroke, &mut output.row);
        let [n_touched, n_saturated] =
            stop_at_stroke(self.instructions, self.deflections, stroke, row);
        Contact {
            travel,
            n_touched,
            n_saturated,
        }
    }

    /// Returns the travel at which each taxel begins to move, metres, for the taxels that the gathered objects touch before `travel`.
    pub fn starts(&mut self, travel: f64) -> &[f64] {
        self.push(travel, &mut OutputBuffer::none());
        let starts = &mut self.scratch.starts;
        starts.clear();
        starts.reserve(self.grid.grid.n_taxels());
        self.deflections.each_row(|_, taxels| {
            let touched = taxels.iter().filter(|needed| **needed > 0.0);
            starts.extend(touched.map(|needed| travel - *needed));
        });
        starts
    }

    /// Sets the deflections of all taxels of the grid to zero.
    pub fn touch_nothing(&mut self) {
        let Grid { nx, ny, .. } = self.grid.grid;
        self.deflections.clear(nx, ny, 0.0);
    }

    /// Computes the deflections that contact with the objects requires at a travel of the patch, not limited to the stroke.
    fn push(&mut self, travel: f64, output: &mut OutputBuffer) {
        self.touch_nothing();
        let scratch = &mut *self.scratch;
        output.in_steps(scratch.search.found.len());
        indent_all(
            self.instructions,
            &scratch.search.found,
            &scratch.lines,
            (travel, scratch.behind),
            self.deflections,
            output,
        );
        if scratch.has_meshes {
            let heights = &mut scratch.envelope.heights;
            let (rows, columns) = heights.rectangle();
            self.deflections.cover(&rows, &columns);
            for row in rows {
                let taxels = self.deflections.row(row, columns.clone()).iter_mut();
                for (deflection, height) in taxels.zip(heights.row(row, columns.clone())) {
                    *deflection = deflection.max(travel - *height);
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
        deflections: &mut GridValues,
        output: &mut OutputBuffer,
    ) = indent_each
}

#[inline(always)]
fn indent_each(
    spheres: &[PlacedSphere],
    lines: &GridLines,
    (travel, behind): (f64, f64),
    deflections: &mut GridValues,
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
    fn stop_at_stroke(deflections: &mut GridValues, stroke: f64, row: &mut Row) -> [usize; 2] = stop_each
}

#[inline(always)]
fn stop_each(deflections: &mut GridValues, stroke: f64, row: &mut Row) -> [usize; 2] {
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
