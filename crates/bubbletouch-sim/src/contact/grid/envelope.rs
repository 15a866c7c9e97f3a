//! Heights at which meshes stop the taxels of a flat grid, computed only for triangles that taxels may touch.
//!
//! The search descends the tree of each mesh ([`block_search`](super::block_search)) and evaluates the remaining triangles for their candidate taxels.
//! Faces are evaluated row by row, edges and corners taxel by taxel. Nodes and triangles with few candidates are skipped if these taxels are already stopped
//! below.
//!
//! In a press from the front, each triangle counts. At a pose, a triangle counts for a taxel unless its far side is behind the taxel's substrate. Triangles
//! whose near side is in front of the substrate count for each taxel; the rule is evaluated only for other triangles ([`stop_in_front`]).

use super::block_search::{BlockSearch, Candidates};
use super::lines::GridLines;
use super::placed_objects::{PlacedObjects, TravelGoal};
use crate::contact::instructions::{Instructions, for_instructions};
use crate::contact::mesh::skin_mesh::{MeshAt, stop_in_front};
use crate::contact::mesh::swept_triangle::{FACE_SLACK, SweptEdge, SweptFace, corner_height};
use crate::mesh::Triangle;
use crate::objects::mesh_blocks::{ContactTriangle, LANES, MAX_DEPTH, MeshBlocks};
use crate::objects::{ContactFace, Model};
use glam::{DMat3, DVec2, DVec3};
use std::ops::Range;

/// Travel of the patch at which a triangle first stops each taxel, given as the least height in the patch frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Envelope {
    /// Heights at which triangles stop the taxels, metres, shape (n_taxels,); infinite if no triangle evaluated so far stops the taxel.
    heights: Vec<f64>,
    n_columns: usize,
    /// Rectangle of taxels that contains all finite heights.
    rows: Range<usize>,
    columns: Range<usize>,
    /// Smallest of the heights, metres; infinite if the goal of the press does not depend on it.
    pub first: f64,
}

impl Envelope {
    /// Resets the heights to infinity. If the grid is unchanged, only the rectangle of finite heights is written.
    fn clear(&mut self, n_columns: usize, n_rows: usize) {
        if (self.n_columns, self.heights.len()) == (n_columns, n_columns * n_rows) {
            for row in self.rows.clone() {
                self.heights[row * n_columns..][self.columns.clone()].fill(f64::INFINITY);
            }
        } else {
            self.n_columns = n_columns;
            self.heights.clear();
            self.heights.resize(n_columns * n_rows, f64::INFINITY);
        }
        (self.rows, self.columns) = (n_rows..0, n_columns..0);
        self.first = f64::INFINITY;
    }

    /// Returns the rows and the columns of the taxels that a mesh may stop.
    pub fn rectangle(&self) -> (&Range<usize>, &Range<usize>) {
        (&self.rows, &self.columns)
    }

    /// Returns the heights at which meshes stop the taxels of a row, for the columns of the rectangle, metres.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.heights[row * self.n_columns..][self.columns.clone()]
    }

    /// Computes the heights at which meshes stop the taxels, up to the goal of the press. Returns whether there is a mesh. `first` is the travel at first
    /// contact with spheres.
    pub fn look(
        &mut self,
        placed: &PlacedObjects,
        (goal, first): (TravelGoal, f64),
        instructions: Instructions,
    ) -> bool {
        self.clear(
            placed.lines.x.positions.len(),
            placed.lines.y.positions.len(),
        );
        let mut has_meshes = false;
        for (object, pose) in placed.objects.iter().zip(placed.patch_from_objects) {
            let Model::Mesh(mesh) = object else {
                continue;
            };
            has_meshes = true;
            let reach = placed.radius + mesh.rounding();
            let rotation = DMat3::from_quat(pose.rotation);
            let mut sweep = Sweep {
                rotation,
                translation: pose.translation,
                reach,
                behind: placed.behind,
                lines: placed.lines,
                goal,
                others: first,
                envelope: self,
                behind_substrate: [0..0, 0..0],
            };
            let bounds =
                BlockSearch::new(mesh.blocks(), pose, (reach, placed.behind), placed.lines);
            sweep_blocks(instructions, &mut sweep, mesh.blocks(), &bounds);
            let may_enter = sweep.behind_substrate;
            self.enter(&MeshAt::new(mesh, pose), placed, may_enter);
        }
        has_meshes
    }

    /// Stops the taxels of a rectangle whose substrates are inside the solid mesh.
    fn enter(&mut self, mesh: &MeshAt, placed: &PlacedObjects, [columns, rows]: [Range<usize>; 2]) {
        for row in rows {
            for column in columns.clone() {
                let height = &mut self.heights[row * self.n_columns + column];
                // A taxel at its stroke stays there, even if the mesh reaches further.
                if *height < placed.behind + placed.radius {
                    continue;
                }
                let (x, y) = (
                    placed.lines.x.positions[column],
                    placed.lines.y.positions[row],
                );
                let at = DVec3::new(x, y, 0.0);
                if let Some(entered) = mesh.entered_on_grid(at, placed.radius, placed.behind) {
                    *height = height.min(entered);
                    cover(&mut self.rows, row..row + 1);
                    cover(&mut self.columns, column..column + 1);
                }
            }
        }
    }
}

/// Enlarges a range so that it contains another.
#[inline(always)]
fn cover(range: &mut Range<usize>, part: Range<usize>) {
    *range = match range.start < range.end {
        true => range.start.min(part.start)..range.end.max(part.end),
        false => part,
    };
}

/// Maximum number of candidate taxels of a node or triangle for which the search tests whether all are already stopped below it. If larger, tests are wasted on
/// large triangles; if smaller, small triangles are evaluated needlessly.
const FEW: usize = 4;

/// State of the search over one mesh.
struct Sweep<'a> {
    rotation: DMat3,
    translation: DVec3,
    /// Sum of a taxel's radius and the rounding of the mesh, metres.
    reach: f64,
    /// Height of the substrate, metres; −∞ if the press comes from the front.
    behind: f64,
    lines: &'a GridLines,
    goal: TravelGoal,
    /// Travel at first contact with the spheres, metres.
    others: f64,
    envelope: &'a mut Envelope,
    /// Columns and rows of the taxels behind whose substrates triangles may lie.
    behind_substrate: [Range<usize>; 2],
}

for_instructions! {
    /// Lowers the heights of the envelope to the heights at which the triangles of a mesh stop the taxels, up to the goal of the press.
    fn sweep_blocks(
        sweep: &mut Sweep,
        blocks: &MeshBlocks,
        bounds: &BlockSearch,
    ) = sweep_each_block
}

#[inline(always)]
fn sweep_each_block(sweep: &mut Sweep, blocks: &MeshBlocks, bounds: &BlockSearch) {
    const STACK: usize = (LANES - 1) * MAX_DEPTH + 1;
    let mut stack = [(f32::NEG_INFINITY, 0_u32); STACK];
    let mut n_waiting = 1;
    while n_waiting > 0 {
        n_waiting -= 1;
        let (low, child) = stack[n_waiting];
        // Rounded up, so that no triangle below the limit is lost.
        let limit = (sweep.limit() as f32).next_up();
        if low >= limit {
            continue;
        }
        let number = (child / 2) as usize;
        if child % 2 == 1 {
            let block = &blocks.blocks[number];
            let candidates = bounds.block(block, limit);
            sweep.note_behind(&candidates);
            for lane in lanes(candidates.lanes) {
                let rectangle = candidates.rectangle(lane);
                if !sweep.is_hidden(&rectangle, candidates.low[lane]) {
                    let triangle = &blocks.triangles[block.first as usize + lane];
                    sweep.lower(triangle, rectangle);
                }
            }
            continue;
        }
        let node = &blocks.nodes[number];
        let candidates = bounds.node(node, limit);
        sweep.note_behind(&candidates);
        // The children are sorted with the lowest last, so that the lowest child is visited first.
        let start = n_waiting;
        for lane in lanes(candidates.lanes) {
            let low = candidates.low[lane];
            if sweep.is_hidden(&candidates.rectangle(lane), low) {
                continue;
            }
            let mut at = n_waiting;
            while at > start && stack[at - 1].0 < low {
                stack[at] = stack[at - 1];
                at -= 1;
            }
            stack[at] = (low, node.children[lane]);
            n_waiting += 1;
        }
    }
}

/// Returns the indices of the set bits, ascending.
#[inline(always)]
fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (lane < 32).then_some(lane as usize)
    })
}

impl Sweep<'_> {
    /// Returns the travel, metres, beyond which the heights do not affect the press.
    #[inline(always)]
    fn limit(&self) -> f64 {
        match self.goal {
            TravelGoal::Travel(travel) => travel,
            TravelGoal::Pose => 0.0,
            TravelGoal::Depth(depth) => self.envelope.first.min(self.others) + depth,
        }
    }

    /// Adds the candidates behind whose substrates triangles may lie.
    #[inline(always)]
    fn note_behind(&mut self, candidates: &Candidates) {
        for lane in lanes(candidates.behind) {
            let [columns, rows] = candidates.rectangle(lane);
            cover(&mut self.behind_substrate[0], columns);
            cover(&mut self.behind_substrate[1], rows);
        }
    }

    /// Returns whether the taxels of a rectangle, if they are few, are already stopped below triangles with the lower bound `low`, metres.
    #[inline(always)]
    fn is_hidden(&self, [columns, rows]: &[Range<usize>; 2], low: f32) -> bool {
        let (low, n_columns) = (f64::from(low), self.envelope.n_columns);
        let first = rows.start * n_columns + columns.start;
        match columns.len() * rows.len() {
            1 => self.envelope.heights[first] <= low,
            2..=FEW => rows.clone().all(|row| {
                let heights = &self.envelope.heights[row * n_columns..][columns.clone()];
                heights.iter().all(|&height| height <= low)
            }),
            _ => false,
        }
    }

    /// Lowers the heights of a rectangle of taxels to the heights at which a triangle stops them.
    #[inline(always)]
    fn lower(&mut self, triangle: &ContactTriangle, [columns, rows]: [Range<usize>; 2]) {
        let place = |corner: DVec3| self.rotation * corner + self.translation;
        let [a, b, c] = triangle.corners;
        let corners = [place(a), place(b), place(c)];
        let lowest = corners[0].z.min(corners[1].z).min(corners[2].z);
        if lowest - self.reach < self.behind {
            return self.lower_by_rule(&Triangle(corners), [columns, rows]);
        }
        let face = &triangle.face;
        let normal = self.rotation * face.normal;
        let swept = SweptFace::new(&corners, normal, self.reach);
        if columns.len() * rows.len() == 1 {
            let place = (rows.start, columns.start);
            return self.lower_one(face, (&corners, normal, swept), place);
        }
        if let Some(swept) = swept {
            self.lower_to_face(&swept, [columns.clone(), rows.clone()]);
            cover(&mut self.envelope.rows, rows.clone());
            cover(&mut self.envelope.columns, columns.clone());
        }
        for k in 0..3 {
            if face.has_edge[k] {
                let (from, to) = (corners[k], corners[(k + 1) % 3]);
                let across = self.rotation * face.across[k];
                if let Some(swept) = SweptEdge::new(from, to, self.reach, [normal, across]) {
                    self.lower_under(swept.ground(), [&columns, &rows], |at| swept.height(at));
                }
            }
            if face.has_corner[k] && face.is_sharp[k] {
                let corner = corners[k];
                let ground = (
                    corner.truncate() - self.reach,
                    corner.truncate() + self.reach,
                );
                let reach = self.reach;
                self.lower_under(ground, [&columns, &rows], |at| {
                    corner_height(corner, reach, at)
                });
            }
        }
    }

    /// Lowers the height of one taxel to the height at which a triangle stops it. If the taxel is under the face, no edge or corner is lower.
    /// Otherwise the function evaluates the sides that have the taxel on their outer side, and the corners of these sides.
    #[inline(always)]
    fn lower_one(
        &mut self,
        face: &ContactFace,
        (corners, normal, swept): (&[DVec3; 3], DVec3, Option<SweptFace>),
        (row, column): (usize, usize),
    ) {
        let at = DVec2::new(self.lines.x.positions[column], self.lines.y.positions[row]);
        let mut is_outside = [true; 3];
        if let Some(swept) = swept {
            is_outside = swept.is_outside(at, FACE_SLACK * self.reach);
            if is_outside == [false; 3] {
                return self.lower_to(row, column, swept.height_at(at));
            }
        }
        for k in 0..3 {
            let next = (k + 1) % 3;
            if face.has_edge[k] && is_outside[k] {
                let across = self.rotation * face.across[k];
                let swept = SweptEdge::new(corners[k], corners[next], self.reach, [normal, across]);
                if let Some(height) = swept.and_then(|swept| swept.height(at)) {
                    self.lower_to(row, column, height);
                }
            }
            // The corner at the end of side k is the start of the next side.
            if (is_outside[k] || is_outside[next]) && face.has_corner[next] && face.is_sharp[next] {
                let lowest = self.envelope.heights[row * self.envelope.n_columns + column];
                if corners[next].z - self.reach < lowest
                    && let Some(height) = corner_height(corners[next], self.reach, at)
                {
                    self.lower_to(row, column, height);
                }
            }
        }
    }

    #[inline(always)]
    fn lower_to(&mut self, row: usize, column: usize, height: f64) {
        let lowest = &mut self.envelope.heights[row * self.envelope.n_columns + column];
        if height < *lowest {
            *lowest = height;
            self.envelope.first = self.envelope.first.min(height);
            cover(&mut self.envelope.rows, row..row + 1);
            cover(&mut self.envelope.columns, column..column + 1);
        }
    }

    /// Lowers the heights of the taxels of a rectangle that a face stops, row by row.
    #[inline(always)]
    fn lower_to_face(&mut self, face: &SweptFace, [columns, rows]: [Range<usize>; 2]) {
        let slack = FACE_SLACK * self.reach;
        let is_for_depth = matches!(self.goal, TravelGoal::Depth(_));
        for row in rows {
            let y = self.lines.y.positions[row];
            let first = row * self.envelope.n_columns;
            let heights = &mut self.envelope.heights[first..][columns.clone()];
            face.lower_row(y, &self.lines.x.positions[columns.clone()], slack, heights);
            if is_for_depth {
                let lowest = heights.iter().fold(self.envelope.first, |a, &b| a.min(b));
                self.envelope.first = lowest;
            }
        }
    }

    /// Lowers the height of each taxel in a rectangle to the value of the function `height` at the taxel. The rectangle is the intersection of the candidates
    /// (`columns` and `rows`) with the places between the corners `low` and `high`.
    #[inline(always)]
    fn lower_under(
        &mut self,
        (low, high): (DVec2, DVec2),
        [columns, rows]: [&Range<usize>; 2],
        height: impl Fn(DVec2) -> Option<f64>,
    ) {
        let lines = self.lines;
        for row in rows.clone() {
            let y = lines.y.positions[row];
            if y < low.y || y > high.y {
                continue;
            }
            for column in columns.clone() {
                let x = lines.x.positions[column];
                if x >= low.x
                    && x <= high.x
                    && let Some(height) = height(DVec2::new(x, y))
                {
                    self.lower_to(row, column, height);
                }
            }
        }
    }

    /// Lowers the heights of the taxels of a rectangle to the heights at which a triangle stops them. Taxels are skipped if the far side of the triangle is
    /// behind their substrates.
    #[cold]
    #[inline(never)]
    fn lower_by_rule(&mut self, triangle: &Triangle, [columns, rows]: [Range<usize>; 2]) {
        for row in rows {
            for column in columns.clone() {
                let at = DVec2::new(self.lines.x.positions[column], self.lines.y.positions[row]);
                if let Some(height) = stop_in_front(triangle, self.reach, at, self.behind) {
                    self.lower_to(row, column, height);
                }
            }
        }
    }
}
