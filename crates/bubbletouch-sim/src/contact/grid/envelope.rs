//! Heights at which meshes stop the taxels of a flat grid, computed only for triangles that taxels may touch.
//!
//! The search descends the tree of each mesh ([`block_search`](super::block_search)). Nodes with few candidates are skipped if these taxels are already stopped
//! below. The remaining triangles are evaluated in one of two ways:
//!
//! - A triangle with many candidates is evaluated at once: its face row by row, its edges and corners taxel by taxel.
//! - A triangle with few candidates gives pairs of a taxel and the triangle. The search bounds the height of each pair from below, and from above if the taxel is
//!   certainly under the face. At the end of the search, the pairs that no other pair excludes are evaluated many at once ([`pair_batch`](super::pair_batch)).
//!
//! In a press from the front, each triangle counts. At a pose, a triangle counts for a taxel unless its far side is behind the taxel's substrate. Triangles
//! whose near side is in front of the substrate count for each taxel; the rule is evaluated only for other triangles ([`stop_in_front`]).

use super::block_search::{BlockSearch, Candidates, PlacedBlock, PlacedPairs, Tested};
use super::grid_values::{GridValues, NOTHING, joined};
use super::lines::GridLines;
use super::pair_batch::{Column, EdgePairs, FacePairs, MAY_BE_BEHIND, PAIRS, Pair, PairList};
use super::placed_objects::PlacedObjects;
use crate::contact::Until;
use crate::contact::instructions::{Instructions, for_instructions};
use crate::contact::lanes::SelectedLanes;
use crate::contact::law::stop_in_front;
use crate::contact::law::triangle::{FACE_SLACK, SweptEdge, SweptFace, corner_height};
use crate::contact::mesh::skin_mesh::MeshAt;
use crate::contact::object_at::ObjectAt;
use crate::mesh::Triangle;
use crate::objects::Model;
use crate::objects::mesh_blocks::{ContactTriangle, LANES, Lane, MeshBlocks, STACK};
use glam::{DVec2, DVec3};
use std::ops::Range;

/// Travel of the patch at which a triangle first stops each taxel, given as the least height in the patch frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Envelope {
    /// Heights at which triangles stop the taxels, metres; infinite if no triangle evaluated so far stops the taxel. During a search, some heights are upper
    /// bounds.
    pub heights: GridValues,
    /// Smallest of the heights, metres; infinite if the goal of the press does not depend on it.
    pub first: f64,
    /// Scratch memory of the search.
    scratch: Option<Box<Scratch>>,
}

/// Scratch memory of a search: the triangles of a block, and the fields of [`Sweep`].
#[derive(Clone, Debug, Default)]
struct Scratch {
    waiting: [PairList; 2],
    tests: [Tested; TESTS],
    placed: PlacedBlock,
    beside: PlacedPairs,
    faces: FacePairs,
    edges: EdgePairs,
}

impl Envelope {
    /// Computes the heights at which meshes stop the taxels, up to the goal of the press. Returns whether there is a mesh. `first` is the travel at first
    /// contact with spheres.
    pub fn look(
        &mut self,
        placed: &PlacedObjects,
        (until, first): (Until, f64),
        instructions: Instructions,
    ) -> bool {
        let lines = placed.lines;
        let (n_columns, n_rows) = (lines.x.positions.len(), lines.y.positions.len());
        self.heights.clear(n_columns, n_rows, f64::INFINITY);
        self.first = f64::INFINITY;
        let mut has_meshes = false;
        let mut scratch = self.scratch.take().unwrap_or_default();
        for (object, pose) in placed.objects.iter().zip(placed.patch_from_objects) {
            let Model::Mesh(mesh) = object else {
                continue;
            };
            has_meshes = true;
            let object = ObjectAt::new(pose, placed.radius + mesh.rounding());
            let mut sweep = Sweep {
                triangles: &mesh.blocks().triangles,
                object,
                behind: placed.behind,
                lines,
                until,
                others: first,
                bound: f64::INFINITY,
                waiting: &mut scratch.waiting,
                tests: &mut scratch.tests,
                beside: &mut scratch.beside,
                is_in_front: false,
                faces: &mut scratch.faces,
                edges: &mut scratch.edges,
                envelope: self,
                behind_substrate: [NOTHING, NOTHING],
            };
            let bounds = BlockSearch::new(mesh.blocks(), &object, placed.behind, lines);
            sweep_blocks(
                instructions,
                &mut sweep,
                (mesh.blocks(), &mut scratch.placed),
                &bounds,
            );
            let may_enter = sweep.behind_substrate;
            self.enter(&MeshAt::new(mesh, pose), placed, may_enter);
        }
        self.scratch = Some(scratch);
        has_meshes
    }

    /// Lowers the heights of the taxels of `n` pairs. The rectangle of finite heights then contains all these taxels: the height of a taxel may be an upper bound
    /// even if no pair lowers it. The loop has no branches, because the processor cannot predict them.
    #[inline(always)]
    fn lower_pairs(&mut self, pairs: &[Pair; PAIRS], heights: &Column, n: usize) {
        let (mut first, mut last) = ([u32::MAX; 2], [0; 2]);
        for (pair, &height) in pairs.iter().zip(heights).take(n) {
            let lowest = &mut self.heights[pair.taxel as usize];
            *lowest = if height < *lowest { height } else { *lowest };
            for (k, line) in [pair.row, pair.column].into_iter().enumerate() {
                first[k] = first[k].min(line);
                last[k] = last[k].max(line + 1);
            }
            self.first = if height < self.first {
                height
            } else {
                self.first
            };
        }
        if n > 0 {
            let [rows, columns] = [0, 1].map(|k| first[k] as usize..last[k] as usize);
            self.heights.cover(&rows, &columns);
        }
    }

    /// Stops the taxels of a rectangle whose substrates are inside the solid mesh.
    fn enter(&mut self, mesh: &MeshAt, placed: &PlacedObjects, [columns, rows]: [Range<usize>; 2]) {
        for row in rows {
            for column in columns.clone() {
                let taxel = self.heights.number(row, column);
                let height = &mut self.heights[taxel];
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
                    self.heights.cover(&(row..row + 1), &(column..column + 1));
                }
            }
        }
    }
}

/// Maximum number of rows and of columns of the candidate taxels of a node for which the search tests whether all are already stopped below it. The test reads the
/// four taxels in the corners of the rectangle: these are all taxels up to two rows and columns.
const FEW: usize = 2;

/// Maximum number of candidate taxels of a triangle whose pairs are evaluated in batches. If larger, more candidates are tested one after the other; if smaller,
/// more triangles are evaluated row by row, each with its own branches.
const MAX_PAIRS: u32 = 8;

/// Number of candidates of each triangle that are tested before their pairs are added in one loop, whose end the processor cannot predict. The tested pairs are the
/// bits of one u64. If smaller, more loops end.
const TESTS: usize = 4;

/// State of the search over one mesh.
struct Sweep<'a> {
    /// Triangles in the order of the blocks.
    triangles: &'a [ContactTriangle],
    object: ObjectAt,
    /// Upper bound of the least height, metres.
    bound: f64,
    /// Pairs of taxels and triangles that are not yet evaluated: pairs whose taxels are certainly under the faces, and other pairs.
    waiting: &'a mut [PairList; 2],
    /// Memory for the tested candidates of a block.
    tests: &'a mut [Tested; TESTS],
    /// Pairs whose taxels may be beside the faces of the triangles, and whose bounds are not yet computed.
    beside: &'a mut PlacedPairs,
    /// Whether certainly no triangle is behind the substrate.
    is_in_front: bool,
    /// Pairs of taxels and triangles that are evaluated next.
    faces: &'a mut FacePairs,
    /// Pairs of taxels and edges that are not yet evaluated.
    edges: &'a mut EdgePairs,
    /// Height of the substrate, metres; −∞ if the press comes from the front.
    behind: f64,
    lines: &'a GridLines,
    until: Until,
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
        blocks: (&MeshBlocks, &mut PlacedBlock),
        bounds: &BlockSearch,
    ) = sweep_each_block
}

#[inline(always)]
fn sweep_each_block(
    sweep: &mut Sweep,
    (blocks, placed): (&MeshBlocks, &mut PlacedBlock),
    bounds: &BlockSearch,
) {
    sweep.is_in_front = bounds.is_in_front(blocks);
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
            bounds.block(block, (limit, MAX_PAIRS), placed);
            sweep.note_behind(&placed.candidates);
            // The lowest triangle is evaluated first, because it can lower the limit.
            let (mut large, low) = (placed.candidates.lanes, &placed.candidates.low);
            while large != 0 {
                let mut lowest = large.trailing_zeros() as usize;
                for lane in SelectedLanes::of_bits(large) {
                    lowest = if low[lane] < low[lowest] {
                        lane
                    } else {
                        lowest
                    };
                }
                large &= !(1 << lowest);
                if f64::from(low[lowest]) < sweep.limit() {
                    let rectangle = placed.candidates.rectangle(lowest);
                    sweep.lower(block.first as usize + lowest, rectangle);
                }
            }
            for first in (0..placed.n_few as usize).step_by(TESTS) {
                let n_tests = TESTS.min(placed.n_few as usize - first);
                for tested in &mut sweep.tests[..n_tests] {
                    bounds.test(block, placed, limit, tested);
                }
                sweep.pair(bounds, (block.first, placed), n_tests);
            }
            continue;
        }
        let node = &blocks.nodes[number];
        let candidates = bounds.node(node, limit);
        sweep.note_behind(&candidates);
        // The children are sorted with the lowest last, so that the lowest child is visited first.
        let start = n_waiting;
        for lane in SelectedLanes::of_bits(candidates.lanes) {
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
    if sweep.beside.n > 0 {
        sweep.bound_beside(bounds);
    }
    sweep.evaluate_waiting();
}

impl Sweep<'_> {
    /// Returns the travel, metres, beyond which the heights do not affect the press.
    #[inline(always)]
    fn limit(&self) -> f64 {
        let first = self.envelope.first.min(self.bound).min(self.others);
        self.until.limit(first)
    }

    /// Adds the candidates behind whose substrates triangles may lie.
    #[inline(always)]
    fn note_behind(&mut self, candidates: &Candidates) {
        for lane in SelectedLanes::of_bits(candidates.behind) {
            let [columns, rows] = candidates.rectangle(lane);
            let [of_columns, of_rows] = &mut self.behind_substrate;
            *of_columns = joined(of_columns, &columns);
            *of_rows = joined(of_rows, &rows);
        }
    }

    /// Returns whether the taxels of a rectangle, if they are few, are already stopped below triangles with the lower bound `low`, metres. The function has no
    /// branches, because the processor cannot predict them.
    #[inline(always)]
    fn is_hidden(&self, [columns, rows]: &[Range<usize>; 2], low: f32) -> bool {
        let is_hidden = |row: usize, column: usize| {
            let heights = &self.envelope.heights;
            heights[heights.number(row, column)] <= f64::from(low)
        };
        let (last_row, last_column) = (rows.end - 1, columns.end - 1);
        (rows.len() <= FEW)
            & (columns.len() <= FEW)
            & is_hidden(rows.start, columns.start)
            & is_hidden(rows.start, last_column)
            & is_hidden(last_row, columns.start)
            & is_hidden(last_row, last_column)
    }

    /// Adds the pairs of the first `n_tests` tests of a block whose taxels are not stopped below; `first` is the index of the block's first triangle. The loops have
    /// no branches that depend on heights, because the processor cannot predict them.
    #[inline(always)]
    fn pair(&mut self, bounds: &BlockSearch, (first, placed): (u32, &PlacedBlock), n_tests: usize) {
        let (mut faces, mut beside) = (0_u64, 0_u64);
        for (number, tested) in self.tests.iter().take(n_tests).enumerate() {
            faces |= u64::from(tested.lanes & tested.faces) << (number * LANES);
            beside |= u64::from(tested.lanes & !tested.faces) << (number * LANES);
        }
        self.waiting[0].reserve(TESTS * LANES);
        for bit in SelectedLanes::of_bits(faces) {
            let (tested, lane) = (&self.tests[bit / LANES % TESTS], bit % LANES);
            self.wait(0, tested.pair(first, lane), tested.high[lane]);
        }
        for bit in SelectedLanes::of_bits(beside) {
            let (tested, lane) = (&self.tests[bit / LANES % TESTS], bit % LANES);
            let pair = tested.pair(first, lane);
            let is_open = self.envelope.heights[pair.taxel as usize] > f64::from(pair.low);
            self.beside.add((pair, is_open), (placed, tested), lane);
            if self.beside.n == LANES {
                self.bound_beside(bounds);
            }
        }
    }

    /// Adds a pair to a list unless its taxel is stopped below. The height of the taxel is lowered to `high`, the upper bound of its exact height, metres, above
    /// `pair.low`. A height is only lowered if the pair is added: the evaluation of the pair adds the taxel to the rectangle of finite heights.
    #[inline(always)]
    fn wait(&mut self, list: usize, pair: Pair, high: f32) {
        let high = f64::from(high);
        let height = &mut self.envelope.heights[pair.taxel as usize];
        self.waiting[list].add(pair, *height > f64::from(pair.low));
        *height = if high < *height { high } else { *height };
        self.bound = if high < self.bound { high } else { self.bound };
    }

    /// Bounds the pairs whose taxels may be beside the faces of their triangles.
    #[inline(always)]
    fn bound_beside(&mut self, bounds: &BlockSearch) {
        bounds.bound(self.beside, self.is_in_front);
        self.waiting[1].reserve(LANES);
        let limit = self.limit();
        for lane in 0..self.beside.n.min(LANES) {
            let is_below = f64::from(self.beside.low[lane]) < limit;
            let bound = |bound: &Lane| if is_below { bound[lane] } else { f32::INFINITY };
            let pair = Pair {
                low: bound(&self.beside.low),
                ..self.beside.pairs[lane]
            };
            self.wait(1, pair, bound(&self.beside.high));
        }
        self.beside.n = 0;
    }

    /// Evaluates the waiting pairs whose taxels are not certainly stopped by other triangles.
    #[inline(always)]
    fn evaluate_waiting(&mut self) {
        for list in 0..2 {
            for number in 0..self.waiting[list].n {
                let pair = self.waiting[list].pairs[number];
                let is_open = self.envelope.heights[pair.taxel as usize] > f64::from(pair.low);
                self.faces.add(pair, is_open);
                if self.faces.n == PAIRS {
                    self.evaluate_batch(list);
                }
            }
            self.evaluate_batch(list);
            self.waiting[list].n = 0;
        }
        self.evaluate_edges();
    }

    #[inline(always)]
    fn evaluate_batch(&mut self, list: usize) {
        match list {
            0 => self.evaluate_under(),
            _ => self.evaluate_faces(),
        }
    }

    /// Evaluates the faces of the waiting pairs whose taxels are certainly under the faces.
    #[inline(always)]
    fn evaluate_under(&mut self) {
        self.faces
            .evaluate_under((self.triangles, &self.object), self.lines);
        let n = self.faces.n;
        self.envelope
            .lower_pairs(&self.faces.pairs, &self.faces.heights, n);
        self.faces.n = 0;
    }

    /// Evaluates the waiting pairs of taxels and triangles.
    #[inline(always)]
    fn evaluate_faces(&mut self) {
        let slack = FACE_SLACK * self.object.reach;
        self.faces.evaluate(
            (self.triangles, &self.object),
            (self.lines, self.envelope.heights.all()),
            (slack, self.behind),
        );
        let n = self.faces.n;
        self.envelope
            .lower_pairs(&self.faces.pairs, &self.faces.heights, n);
        // The pairs with edges or corners to evaluate are listed without branches, because the processor cannot predict them.
        let (mut lanes_with_parts, mut n_lanes) = ([0_u8; PAIRS], 0);
        for lane in 0..n.min(PAIRS) {
            lanes_with_parts[n_lanes % PAIRS] = lane as u8;
            n_lanes += usize::from(self.faces.parts[lane] != 0);
        }
        for &lane in &lanes_with_parts[..n_lanes.min(PAIRS)] {
            let lane = usize::from(lane) % PAIRS;
            let (pair, parts) = (self.faces.pairs[lane], self.faces.parts[lane]);
            self.lower_beside(pair, parts);
        }
        self.faces.n = 0;
    }

    /// Lowers the height of a taxel to the heights at which the given edges and corners of a triangle stop it.
    #[inline(always)]
    fn lower_beside(&mut self, pair: Pair, parts: u64) {
        let (row, column) = (pair.row as usize, pair.column as usize);
        let triangle = &self.triangles[pair.triangle as usize];
        if parts == MAY_BE_BEHIND {
            let triangle = self.object.triangle(&Triangle(triangle.corners));
            return self.lower_by_rule(&triangle, [column..column + 1, row..row + 1]);
        }
        let at = DVec2::new(self.lines.x.positions[column], self.lines.y.positions[row]);
        for part in SelectedLanes::of_bits(parts) {
            if part < 3 {
                self.edges.add(pair, at, (triangle, part));
                continue;
            }
            let corner = self.object.place(triangle.corners[part - 3]);
            let reach = self.object.reach;
            if corner.z - reach < self.envelope.heights[pair.taxel as usize] {
                self.lower_to(row, column, corner_height(corner, reach, at));
            }
        }
        if self.edges.n > PAIRS - 3 {
            self.evaluate_edges();
        }
    }

    /// Evaluates the waiting pairs of taxels and edges.
    #[inline(always)]
    fn evaluate_edges(&mut self) {
        self.edges.evaluate(&self.object);
        let n = self.edges.n;
        self.envelope
            .lower_pairs(&self.edges.pairs, &self.edges.heights, n);
        self.edges.n = 0;
    }

    /// Lowers the heights of a rectangle of taxels to the heights at which a triangle stops them.
    #[inline(always)]
    fn lower(&mut self, triangle: usize, [columns, rows]: [Range<usize>; 2]) {
        let triangle = &self.triangles[triangle];
        let Triangle(corners) = self.object.triangle(&Triangle(triangle.corners));
        let reach = self.object.reach;
        let lowest = corners[0].z.min(corners[1].z).min(corners[2].z);
        if lowest - reach < self.behind {
            return self.lower_by_rule(&Triangle(corners), [columns, rows]);
        }
        let face = &triangle.face;
        let normal = self.object.turn(face.normal);
        let swept = SweptFace::new(&corners, normal, reach);
        if !swept.is_steep() {
            self.lower_to_face(&swept, [columns.clone(), rows.clone()]);
            self.envelope.heights.cover(&rows, &columns);
        }
        for k in 0..3 {
            if face.has_edge(k) {
                let (from, to) = (corners[k], corners[(k + 1) % 3]);
                let across = self.object.turn(face.across[k]);
                let swept = SweptEdge::new(from, to, reach, &[normal, across]);
                self.lower_under(swept.ground(), [&columns, &rows], |at| {
                    match swept.is_beside(at) {
                        true => swept.height(at),
                        false => f64::INFINITY,
                    }
                });
            }
            if face.has_corner(k) {
                let corner = corners[k];
                let ground = (corner.truncate() - reach, corner.truncate() + reach);
                self.lower_under(ground, [&columns, &rows], |at| {
                    corner_height(corner, reach, at)
                });
            }
        }
    }

    #[inline(always)]
    fn lower_to(&mut self, row: usize, column: usize, height: f64) {
        let heights = &mut self.envelope.heights;
        let taxel = heights.number(row, column);
        if height < heights[taxel] {
            heights[taxel] = height;
            heights.cover(&(row..row + 1), &(column..column + 1));
            self.envelope.first = self.envelope.first.min(height);
        }
    }

    /// Lowers the heights of the taxels of a rectangle that a face stops, row by row.
    #[inline(always)]
    fn lower_to_face(&mut self, face: &SweptFace, [columns, rows]: [Range<usize>; 2]) {
        let slack = FACE_SLACK * self.object.reach;
        let is_for_depth = matches!(self.until, Until::Depth(_));
        for row in rows {
            let y = self.lines.y.positions[row];
            let heights = self.envelope.heights.row(row, columns.clone());
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
        height: impl Fn(DVec2) -> f64,
    ) {
        let lines = self.lines;
        for row in rows.clone() {
            let y = lines.y.positions[row];
            if y < low.y || y > high.y {
                continue;
            }
            for column in columns.clone() {
                let x = lines.x.positions[column];
                if x >= low.x && x <= high.x {
                    self.lower_to(row, column, height(DVec2::new(x, y)));
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
                if let Some(height) = stop_in_front(triangle, self.object.reach, at, self.behind) {
                    self.lower_to(row, column, height);
                }
            }
        }
    }
}
