//! Heights at which a mesh stops the taxels of a leaf: eight neighbouring taxels with axes of any directions.
//!
//! The search descends the tree of the mesh's blocks. A node is compared with a thick line around all taxels first; its children that remain are compared with
//! each taxel. A block is compared with each taxel if few remain, otherwise each triangle of the block is compared with all taxels. The remaining pairs of a
//! taxel and a triangle are evaluated in double precision.
//!
//! A triangle counts for a taxel unless its far side is behind the taxel's substrate. The rule is evaluated only for triangles that reach behind the substrate
//! ([`MeshAt::stop_in_front`]). A taxel whose substrate may be inside a solid mesh is examined by [`MeshAt::entered`].

use super::line_search::{Bounds, Facet, Pairs};
use super::skin_mesh::{MeshAt, Stop};
use super::taxel_lines::{Ray, TaxelLines, Thickness};
use crate::contact::instructions::for_instructions;
use crate::contact::lanes::SelectedLanes;
use crate::contact::law::triangle;
use crate::objects::mesh_blocks::{Block, BlockNode, LANES, STACK};
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

/// Node or block that waits to be examined.
#[derive(Clone, Copy)]
struct Waiting {
    /// Lower bounds of the heights for each taxel, metres.
    low: [f32; LEAF],
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
            low: [f32::NEG_INFINITY; LEAF],
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
    for taxel in SelectedLanes::of_bits(search.behind & lines.active) {
        search.enter(taxel);
    }
}

#[inline(always)]
fn rounded_up(height: f64) -> f32 {
    (height as f32).next_up()
}

/// Returns one bit for each lane whose value is below its limit.
#[inline(always)]
fn lanes_below<const N: usize>(values: &[f32; N], limits: &[f32; N]) -> u32 {
    let mut bits = 0;
    for k in 0..N {
        bits |= u32::from(values[k] < limits[k]) << k;
    }
    bits
}

/// State of the search for the triangles that stop the taxels of one leaf.
struct LeafSearch<'a> {
    mesh: &'a MeshAt<'a>,
    leaf: &'a Leaf,
    lines: &'a TaxelLines,
    /// Heights of the taxels, rounded up to single precision, metres.
    limits: [f32; LEAF],
    /// One bit for each taxel behind whose substrate triangles may lie.
    behind: u32,
    stops: &'a mut LeafStops,
}

impl LeafSearch<'_> {
    /// Returns the largest height along the thick line at which a triangle stops a taxel below its present height, metres.
    #[inline(always)]
    fn top(&self) -> f32 {
        self.lines.thick.top(&self.limits) + self.lines.slack
    }

    /// Returns the limit of the lower bounds along the thick line of parts that may stop a taxel, metres.
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.top().next_up()
    }

    #[inline(always)]
    fn descend(&mut self, stack: &mut [Waiting; STACK]) {
        let blocks = self.mesh.mesh.blocks();
        stack[0] = Waiting {
            low: [f32::NEG_INFINITY; LEAF],
            lowest: f32::NEG_INFINITY,
            child: 0,
            taxels: self.lines.active,
        };
        let mut n_waiting = 1;
        while n_waiting > 0 {
            n_waiting -= 1;
            let waiting = &stack[n_waiting];
            let (child, number) = (waiting.child, (waiting.child / 2) as usize);
            let taxels = waiting.taxels & lanes_below(&waiting.low, &self.limits);
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
            thick,
            slack,
            ..
        } = self.lines;
        let mut children = Pairs::<LANES>::NONE;
        for lane in 0..LANES {
            let child = Bounds::of_child(node, lane);
            children.set(
                lane,
                child.compare::<true>(&thick.line, &thick.thickness, *slack),
            );
        }
        let near = children.near & node.used & lanes_below(&children.low, &[self.limit(); LANES]);
        let start = *n_waiting;
        for lane in SelectedLanes::of_bits(near) {
            let mut waiting = Waiting {
                low: [f32::NEG_INFINITY; LEAF],
                lowest: children.low[lane],
                child: node.children[lane],
                taxels,
            };
            // An inner node in front of all substrates is larger than most leaves, so the comparison with each taxel would exclude few.
            if waiting.child % 2 == 1 || children.behind >> lane & 1 == 1 {
                let child = Bounds::of_child(node, lane);
                let mut pairs = Pairs::<LEAF>::NONE;
                for k in 0..LEAF {
                    pairs.set(
                        k,
                        child.compare::<false>(&lines.at(k), &Thickness::default(), *slack),
                    );
                }
                self.behind |= pairs.behind & taxels;
                waiting.taxels &= pairs.near & lanes_below(&pairs.low, &self.limits);
                waiting.low = pairs.low;
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
            lines,
            thick,
            slack,
            ..
        } = self.lines;
        let first = block.first as usize;
        if taxels.count_ones() <= FEW {
            for taxel in SelectedLanes::of_bits(taxels) {
                let line = lines.at(taxel);
                let mut pairs = Pairs::<LANES>::NONE;
                for lane in 0..LANES {
                    let facet = Facet::of_block(block, lane);
                    pairs.set(
                        lane,
                        facet.compare::<false>(&line, &Thickness::default(), *slack),
                    );
                }
                self.behind |= u32::from(pairs.behind & block.used != 0) << taxel;
                for lane in SelectedLanes::of_bits(pairs.near & block.used) {
                    if pairs.low[lane] < self.limits[taxel] {
                        self.lower(first + lane, taxel);
                    }
                }
            }
            return;
        }
        let mut triangles = Pairs::<LANES>::NONE;
        for lane in 0..LANES {
            let facet = Facet::of_block(block, lane);
            triangles.set(
                lane,
                facet.compare::<true>(&thick.line, &thick.thickness, *slack),
            );
        }
        let low = lanes_below(&triangles.low, &[self.limit(); LANES]);
        for lane in SelectedLanes::of_bits(triangles.near & block.used & low) {
            let facet = Facet::of_block(block, lane);
            let mut pairs = Pairs::<LEAF>::NONE;
            for k in 0..LEAF {
                pairs.set(
                    k,
                    facet.compare::<false>(&lines.at(k), &Thickness::default(), *slack),
                );
            }
            self.behind |= pairs.behind & taxels;
            let low = lanes_below(&pairs.low, &self.limits);
            for taxel in SelectedLanes::of_bits(pairs.near & taxels & low) {
                self.lower(first + lane, taxel);
            }
        }
    }

    /// Lowers the height of a taxel to the height at which a triangle stops the taxel. `place` is the index of the triangle in the order of the blocks.
    #[inline(never)]
    fn lower(&mut self, place: usize, taxel: usize) {
        let ray = Ray::new(self.mesh, self.leaf, taxel);
        // In this frame the taxel rises from the origin along z.
        let (x, y) = ray.direction.any_orthonormal_pair();
        let turn = DMat3::from_cols(x, y, ray.direction).transpose();
        let triangle = &self.mesh.mesh.blocks().triangles[place];
        let corners = triangle.corners.map(|corner| turn * (corner - ray.origin));
        let lowest = corners[0].z.min(corners[1].z).min(corners[2].z);
        let height = match lowest - ray.reach < self.leaf.behind[taxel] {
            true => self.height_by_rule(place, taxel),
            false => triangle::stop(&corners, &triangle.face, &turn, ray.reach),
        };
        if height < self.stops.heights[taxel] {
            self.stops.triangles[taxel] = Some(self.mesh.mesh.blocks().numbers[place]);
            if self.stops.is_lowest {
                self.stops.heights = [height; LEAF];
                self.limits = [rounded_up(height); LEAF];
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
        let number = self.mesh.mesh.blocks().numbers[place] as usize;
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
