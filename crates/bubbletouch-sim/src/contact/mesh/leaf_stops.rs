//! Heights at which a mesh stops the taxels of a leaf: eight neighbouring taxels with axes of any directions.
//!
//! The search descends the tree of the mesh's blocks. A node is compared with a thick line around all taxels first; its children that remain are compared with
//! each taxel. A block is compared with each taxel if few remain, otherwise each triangle of the block is compared with all taxels. The remaining pairs of a
//! taxel and a triangle are evaluated in double precision.
//!
//! A triangle counts for a taxel unless its far side is behind the taxel's substrate. The rule is evaluated only for triangles that reach behind the substrate
//! ([`MeshAt::stop_in_front`]). A taxel whose substrate may be inside a solid mesh is examined by [`MeshAt::entered`].

use super::eight::{Eight, GROUPS, N};
use super::line_search::{Boxes, Triangles};
use super::skin_mesh::{MeshAt, Stop};
use super::taxel_lines::{Lines, TaxelLines, Thickness};
use crate::contact::instructions::for_instructions;
use crate::contact::law::triangle;
use crate::objects::mesh_blocks::{Block, BlockNode, LANES, MAX_DEPTH};
use crate::world::{LEAF, Leaf};
use glam::DMat3;

/// Maximum number of taxels of a block that are compared with the triangles one after the other. If larger, blocks of large triangles take longer; if smaller,
/// blocks of small triangles.
const FEW: u32 = 3;

/// Heights at which meshes stop the taxels of a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafStops {
    /// Stopping heights of the taxels' centres along their axes, relative to the undeflected taxels, metres. Initially the limits below which stops are
    /// searched.
    pub heights: [f64; LEAF],
    /// Indices of the triangles in the mesh; `None` if no triangle stops the taxel below the limit.
    pub triangles: [Option<u32>; LEAF],
    /// Whether only the lowest height of all taxels is searched.
    is_lowest: bool,
}

impl LeafStops {
    /// Creates the state before the search: a stop counts if its height is below 0.
    pub fn below_rest() -> Self {
        Self::below(0.0, false)
    }

    /// Creates the state before a search for the lowest stop of all taxels, below a limit in metres. Then only the lowest of `heights` is meaningful.
    pub fn lowest_below(limit: f64) -> Self {
        Self::below(limit, true)
    }

    fn below(limit: f64, is_lowest: bool) -> Self {
        Self {
            heights: [limit; LEAF],
            triangles: [None; LEAF],
            is_lowest,
        }
    }
}

/// Nodes and blocks that wait to be examined; scratch memory of searches.
pub(crate) struct SearchStack([Waiting; STACK]);

const STACK: usize = (LANES - 1) * MAX_DEPTH + 1;

/// Node or block that waits to be examined.
#[derive(Clone, Copy)]
struct Waiting {
    /// Lower bounds of the heights for each taxel, metres.
    low: [f32; N],
    /// Lower bound of the heights along the thick line, metres.
    lowest: f32,
    /// Twice the index of a node, or twice the index of a block plus one.
    child: u32,
    /// One bit for each taxel that may touch the part.
    taxels: u32,
}

impl SearchStack {
    pub fn new() -> Self {
        let root = Waiting {
            low: [f32::NEG_INFINITY; N],
            lowest: f32::NEG_INFINITY,
            child: 0,
            taxels: 0,
        };
        Self([root; STACK])
    }
}

for_instructions! {
    /// Finds the triangles of a mesh that stop the taxels of a leaf.
    ///
    /// If several triangles stop a taxel at equal heights, the choice among them is arbitrary but reproducible.
    pub(crate) fn stop_leaf(
        mesh: &MeshAt,
        leaf: &Leaf,
        stops: &mut LeafStops,
        stack: &mut SearchStack,
    ) = stop_each
}

#[inline(always)]
fn stop_each(mesh: &MeshAt, leaf: &Leaf, stops: &mut LeafStops, stack: &mut SearchStack) {
    let Some(lines) = TaxelLines::new(mesh, leaf, &stops.heights) else {
        return;
    };
    let mut search = LeafSearch {
        mesh,
        leaf,
        lines: &lines,
        limits: stops.heights.map(rounded_up),
        behind: 0,
        stops,
    };
    search.descend(&mut stack.0);
    for taxel in set_bits(search.behind & lines.active) {
        search.enter(taxel);
    }
}

#[inline(always)]
fn rounded_up(height: f64) -> f32 {
    (height as f32).next_up()
}

/// Returns the indices of the set bits, ascending.
#[inline(always)]
fn set_bits(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (lane < 32).then_some(lane as usize)
    })
}

/// State of the search for the triangles that stop the taxels of one leaf.
struct LeafSearch<'a> {
    mesh: &'a MeshAt<'a>,
    leaf: &'a Leaf,
    lines: &'a TaxelLines,
    /// Heights of the taxels, rounded up to single precision, metres.
    limits: [f32; N],
    /// One bit for each taxel behind whose substrate triangles may lie.
    behind: u32,
    stops: &'a mut LeafStops,
}

impl LeafSearch<'_> {
    /// Returns one bit for each taxel with a lower bound below its present height.
    #[inline(always)]
    fn below(&self, low: Eight) -> u32 {
        low.is_below(Eight::new(&self.limits)).bits()
    }

    /// Returns the largest height along the thick line at which a triangle stops a taxel below its present height, metres.
    #[inline(always)]
    fn top(&self) -> f32 {
        self.lines.top(Eight::new(&self.limits)) + self.lines.slack
    }

    #[inline(always)]
    fn descend(&mut self, stack: &mut [Waiting; STACK]) {
        let blocks = self.mesh.model().blocks();
        stack[0] = Waiting {
            low: [f32::NEG_INFINITY; N],
            lowest: f32::NEG_INFINITY,
            child: 0,
            taxels: self.lines.active,
        };
        let mut n_waiting = 1;
        while n_waiting > 0 {
            n_waiting -= 1;
            let waiting = &stack[n_waiting];
            let (child, number) = (waiting.child, (waiting.child / 2) as usize);
            let taxels = waiting.taxels & self.below(Eight::new(&waiting.low));
            if taxels == 0 || waiting.lowest > self.top() {
                continue;
            }
            if child % 2 == 1 {
                self.visit(&blocks.blocks[number], taxels);
            } else {
                self.push_children(&blocks.nodes[number], taxels, (stack, &mut n_waiting));
            }
        }
    }

    /// Adds the children of a node that taxels may touch to the stack, the lowest last, so that the lowest child is visited first.
    #[inline(always)]
    fn push_children(
        &mut self,
        node: &BlockNode,
        taxels: u32,
        (stack, n_waiting): (&mut [Waiting; STACK], &mut usize),
    ) {
        let TaxelLines {
            lines,
            middle,
            thickness,
            slack,
            ..
        } = self.lines;
        let limit = Eight::splat(self.top());
        let (mut near, mut behind, mut lows) = (0, 0, [[0.0; N]; GROUPS]);
        for (group, low) in lows.iter_mut().enumerate() {
            let children = Boxes::of_node(node, group);
            let thick = children.compare::<true>(middle, thickness, *slack);
            near |= (thick.near & thick.low.is_at_most(limit).bits()) << (N * group);
            behind |= thick.behind << (N * group);
            *low = thick.low.to_lanes();
        }
        let start = *n_waiting;
        for lane in set_bits(near & node.used) {
            let mut waiting = Waiting {
                low: [f32::NEG_INFINITY; N],
                lowest: lows[lane / N][lane % N],
                child: node.children[lane],
                taxels,
            };
            // An inner node in front of all substrates is larger than most leaves, so the comparison with each taxel would exclude few.
            if waiting.child % 2 == 1 || behind >> lane & 1 == 1 {
                let child = Boxes::of_child(node, lane);
                let pairs = child.compare::<false>(lines, &Thickness::ZERO, *slack);
                self.behind |= pairs.behind & taxels;
                waiting.taxels &= pairs.near & self.below(pairs.low);
                waiting.low = pairs.low.to_lanes();
            }
            if waiting.taxels == 0 {
                continue;
            }
            let mut at = *n_waiting;
            while at > start && stack[at - 1].lowest < waiting.lowest {
                stack[at] = stack[at - 1];
                at -= 1;
            }
            stack[at] = waiting;
            *n_waiting += 1;
        }
    }

    /// Compares a block with taxels and evaluates the remaining pairs.
    #[inline(always)]
    fn visit(&mut self, block: &Block, taxels: u32) {
        let TaxelLines {
            rays,
            lines,
            middle,
            thickness,
            slack,
            ..
        } = self.lines;
        let first = block.first as usize;
        if taxels.count_ones() <= FEW {
            let center = self.mesh.model().blocks().center;
            for taxel in set_bits(taxels) {
                let line = Lines::one(&rays[taxel], center, self.leaf.behind[taxel]);
                for group in 0..GROUPS {
                    let used = block.used >> (N * group) & 0xff;
                    let triangles = Triangles::of_block(block, group);
                    let pairs = triangles.compare::<false>(&line, &Thickness::ZERO, *slack);
                    self.behind |= u32::from(pairs.behind & used != 0) << taxel;
                    let low = pairs.low.to_lanes();
                    for lane in set_bits(pairs.near & used) {
                        if low[lane] < self.limits[taxel] {
                            self.lower(first + N * group + lane, taxel);
                        }
                    }
                }
            }
            return;
        }
        let limit = Eight::splat(self.top());
        let mut near = 0;
        for group in 0..GROUPS {
            let triangles = Triangles::of_block(block, group);
            let thick = triangles.compare::<true>(middle, thickness, *slack);
            near |= (thick.near & thick.low.is_at_most(limit).bits()) << (N * group);
        }
        for lane in set_bits(near & block.used) {
            let triangle = Triangles::of_lane(block, lane);
            let pairs = triangle.compare::<false>(lines, &Thickness::ZERO, *slack);
            self.behind |= pairs.behind & taxels;
            for taxel in set_bits(pairs.near & taxels & self.below(pairs.low)) {
                self.lower(first + lane, taxel);
            }
        }
    }

    /// Lowers the height of a taxel to the height at which a triangle stops the taxel. `place` is the index of the triangle in the order of the blocks.
    #[inline(never)]
    fn lower(&mut self, place: usize, taxel: usize) {
        let ray = &self.lines.rays[taxel];
        // In this frame the taxel rises from the origin along z.
        let (x, y) = ray.direction.any_orthonormal_pair();
        let turn = DMat3::from_cols(x, y, ray.direction).transpose();
        let triangle = &self.mesh.model().blocks().triangles[place];
        let corners = triangle.corners.map(|corner| turn * (corner - ray.origin));
        let lowest = corners[0].z.min(corners[1].z).min(corners[2].z);
        let height = match lowest - ray.reach < self.leaf.behind[taxel] {
            true => self.height_by_rule(place, taxel),
            false => triangle::stop(&corners, &triangle.face, &turn, ray.reach),
        };
        if height < self.stops.heights[taxel] {
            self.stops.triangles[taxel] = Some(self.mesh.model().blocks().numbers[place]);
            if self.stops.is_lowest {
                self.stops.heights = [height; LEAF];
                self.limits = [rounded_up(height); N];
            } else {
                self.stops.heights[taxel] = height;
                self.limits[taxel] = rounded_up(height);
            }
        }
    }

    /// Returns the height at which a triangle stops a taxel, metres; infinite if the far side of the triangle is behind the taxel's substrate.
    #[cold]
    #[inline(never)]
    fn height_by_rule(&self, place: usize, taxel: usize) -> f64 {
        let number = self.mesh.model().blocks().numbers[place] as usize;
        let height = self.mesh.stop_in_front(&self.leaf.taxel(taxel), number);
        height.unwrap_or(f64::INFINITY)
    }

    /// Stops a taxel whose substrate is inside the solid mesh.
    #[cold]
    #[inline(never)]
    fn enter(&mut self, taxel: usize) {
        let (stops, leaf) = (&mut self.stops, self.leaf);
        // A taxel at its stroke stays there, even if the mesh reaches further.
        if stops.heights[taxel] < leaf.behind[taxel] + leaf.radii[taxel] {
            return;
        }
        if let Some(Stop { height, triangle }) = self.mesh.entered(&leaf.taxel(taxel)) {
            stops.heights[taxel] = height;
            stops.triangles[taxel] = Some(triangle as u32);
        }
    }
}
