//! Triangles of a mesh in blocks of sixteen, with a tree of nodes with sixteen children. The tree is searched for the triangles that taxels of a grid touch.
//!
//! A ball of radius ρ that touches the mesh at a point p has its centre at p + ρ d. The unit vector d is a *direction of contact*. On a face, d is the
//! normal n of the face. On an edge, d is a vector between the normals of the two faces. On a corner, d is a vector among the normals of the faces around
//! the corner. The `spread` of a triangle is the largest distance |d − n| between a direction of contact and the normal of the triangle. The spread covers
//! the face, and the edges and corners that belong to the triangle. A node has an `axis` and a spread that contain the directions of all its triangles. The
//! centres of balls in contact are thereby bounded far more tightly than by boxes enlarged by ρ.
//!
//! For contact from the other side of the surface, all directions are reversed. A concave edge is touched from the other side only.
//!
//! Numbers are rounded to single precision; searches enlarge all bounds accordingly.

use super::ContactFace;
use crate::geometry::Aabb;
use crate::mesh::Triangle;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Number of triangles in a block and of children of a node: sixteen f32 values in a vector of 512 bits.
pub(crate) const LANES: usize = 16;
/// Maximum depth of the tree: nodes are divided at medians, and sixteen triangles are in a block.
const MAX_DEPTH: usize = 8;
/// Largest number of nodes and blocks that wait during a search of the tree from the root.
pub(crate) const STACK: usize = (LANES - 1) * MAX_DEPTH + 1;

/// One number for each lane. Structs of lanes are aligned to 64 bytes, so that no lane lies in two lines of the cache.
pub(crate) type Lane = [f32; LANES];

/// Returns the vector of a lane.
#[inline(always)]
pub(crate) fn vector([x, y, z]: &[Lane; 3], lane: usize) -> Vec3 {
    Vec3::new(x[lane], y[lane], z[lane])
}

/// Triangles of a mesh in blocks, and the tree of the blocks.
#[derive(Clone, Debug)]
pub(crate) struct MeshBlocks {
    /// Nodes of the tree, the root first.
    pub nodes: Vec<BlockNode>,
    pub blocks: Vec<Block>,
    /// Triangles with their contact data, in the order of the blocks.
    pub triangles: Vec<ContactTriangle>,
    /// Indices of these triangles in the mesh.
    pub numbers: Vec<u32>,
    /// Centre of the mesh, to which all positions in nodes and blocks are relative, metres.
    pub center: DVec3,
    /// Radius of a ball around the centre that contains the mesh, metres.
    pub radius: f64,
}

/// Node with up to sixteen children.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(crate) struct BlockNode {
    /// Centres and half sizes of the bounding boxes of the children's triangles, metres.
    pub center: [Lane; 3],
    pub half: [Lane; 3],
    /// Centre and radius of a ball that contains the directions of contact of the children's triangles, on the side of their normals.
    pub axis: [Lane; 3],
    pub spread: Lane,
    /// Children: twice the index of a node, or twice the index of a block plus one.
    pub children: [u32; LANES],
    /// One bit for each lane that contains a child.
    pub used: u32,
}

/// Up to sixteen triangles.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Block {
    /// Corners of the triangles, metres.
    pub corners: [[Lane; 3]; 3],
    /// Unit normals of the triangles.
    pub normal: [Lane; 3],
    /// Largest distances of the directions of contact from the normals.
    pub spread: Lane,
    /// Bits of the sides beyond which a triangle can stop balls: the side or a corner of the side is evaluated for the triangle. Bit [`ALL_SIDES`] + k is
    /// for side k. If the directions are certain, bit [`OUTER_SIDES`] + k is for contact from the side of the normal, and bit [`INNER_SIDES`] + k for
    /// contact from the other side.
    pub sides: [u32; LANES],
    /// Index of the first triangle; the triangles of the other lanes follow.
    pub first: u32,
    /// One bit for each lane that contains a triangle.
    pub used: u32,
}

/// Triangle in double precision with its contact data, stored together because they are read together. All numbers but the normals across the sides lie in two
/// lines of 64 bytes of the cache.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct ContactTriangle {
    /// Corners of the triangle, metres.
    pub corners: [DVec3; 3],
    pub face: ContactFace,
}

/// First bits of [`Block::sides`].
pub(crate) const ALL_SIDES: u32 = 0;
pub(crate) const OUTER_SIDES: u32 = 3;
pub(crate) const INNER_SIDES: u32 = 6;

/// Sine of the angle between two triangles from which their common edge counts as convex or concave. If smaller, the rounding of the evaluation may decide; if
/// larger, more pairs are evaluated needlessly.
const BENT: f64 = 1e-2;

impl MeshBlocks {
    /// Builds the blocks of triangles with their contact data, in equal order; at least one triangle.
    pub fn new(triangles: &[Triangle], faces: &[ContactFace]) -> Self {
        let bounds = Aabb::around(triangles.iter().map(Triangle::bounds));
        let bounds = bounds.expect("a mesh has at least one triangle");
        let mut builder = Builder {
            triangles,
            faces,
            middles: triangles.iter().map(Triangle::middle).collect(),
            order: (0..triangles.len() as u32).collect(),
            built: Self {
                nodes: Vec::new(),
                blocks: Vec::with_capacity(triangles.len().div_ceil(LANES)),
                triangles: Vec::with_capacity(triangles.len()),
                numbers: Vec::new(),
                center: bounds.center(),
                radius: 0.5 * bounds.size().length(),
            },
        };
        builder.node(0..triangles.len());
        MeshBlocks {
            numbers: builder.order,
            ..builder.built
        }
    }
}

struct Builder<'a> {
    triangles: &'a [Triangle],
    faces: &'a [ContactFace],
    middles: Vec<DVec3>,
    /// Indices of the triangles, sorted into blocks.
    order: Vec<u32>,
    built: MeshBlocks,
}

impl Builder<'_> {
    /// Adds the node of the triangles `order[range]` and everything below it; returns its index.
    fn node(&mut self, range: Range<usize>) -> u32 {
        let number = self.built.nodes.len();
        let mut node = BlockNode::default();
        self.built.nodes.push(node.clone());
        for (lane, part) in self.parts(range).into_iter().enumerate() {
            self.summarise(&mut node, lane, part.clone());
            node.used |= 1 << lane;
            node.children[lane] = match part.len() <= LANES {
                true => 2 * self.block(part) + 1,
                false => 2 * self.node(part),
            };
        }
        self.built.nodes[number] = node;
        number as u32
    }

    /// Divides a range into up to sixteen parts, the largest part first, by medians along the longest side.
    fn parts(&mut self, range: Range<usize>) -> Vec<Range<usize>> {
        // Triangles of a child whose nodes and blocks are all full.
        let mut full = LANES;
        while full * LANES < range.len() {
            full *= LANES;
        }
        let mut parts = vec![range];
        while parts.len() < LANES {
            let largest = (0..parts.len()).max_by_key(|&part| (parts[part].len(), part));
            let largest = largest.expect("there is a part");
            let part = parts[largest].clone();
            if part.len() <= full {
                break;
            }
            let cut = part.start + part.len().div_ceil(2).next_multiple_of(full);
            let places = self.order[part.clone()].iter();
            let middles = places.map(|&place| self.middles[place as usize]);
            let axis = Aabb::around_points(middles).size().max_position();
            let middles = &self.middles;
            self.order[part.clone()].select_nth_unstable_by(cut - part.start, |&a, &b| {
                let along = |place: u32| middles[place as usize][axis];
                along(a).total_cmp(&along(b)).then(a.cmp(&b))
            });
            parts[largest] = part.start..cut;
            parts.insert(largest + 1, cut..part.end);
        }
        parts
    }

    /// Writes the bounds of the triangles `order[range]` into a lane of a node.
    fn summarise(&self, node: &mut BlockNode, lane: usize, range: Range<usize>) {
        let places = self.order[range].iter().map(|&place| place as usize);
        let bounds = places.clone().map(|place| self.triangles[place].bounds());
        let bounds = Aabb::around(bounds).expect("a part has triangles");
        let normals = places.clone().map(|place| self.faces[place].normal);
        let axis = Aabb::around_points(normals).center();
        let spreads = places.map(|place| {
            let face = &self.faces[place];
            face.normal.distance(axis) + face.spread
        });
        node.spread[lane] = spreads.fold(0.0, f64::max) as f32;
        let center = bounds.center() - self.built.center;
        let half = 0.5 * bounds.size();
        for k in 0..3 {
            node.center[k][lane] = center[k] as f32;
            node.half[k][lane] = half[k] as f32;
            node.axis[k][lane] = axis[k] as f32;
        }
    }

    /// Adds the block of the triangles `order[range]`; returns its index.
    fn block(&mut self, range: Range<usize>) -> u32 {
        let mut block = Block {
            first: self.built.triangles.len() as u32,
            ..Block::default()
        };
        for (lane, &place) in self.order[range].iter().enumerate() {
            let face = self.faces[place as usize];
            let corners = self.triangles[place as usize].0;
            for k in 0..3 {
                for (own, corner) in block.corners.iter_mut().zip(corners) {
                    own[k][lane] = (corner - self.built.center)[k] as f32;
                }
                block.normal[k][lane] = face.normal[k] as f32;
            }
            block.spread[lane] = face.spread as f32;
            block.sides[lane] = sides(&face, &corners);
            block.used |= 1 << lane;
            self.built.triangles.push(ContactTriangle { corners, face });
        }
        self.built.blocks.push(block);
        (self.built.blocks.len() - 1) as u32
    }
}

/// Returns the bits of [`Block::sides`] of a triangle. Balls touch a convex edge from the side of the normals only, and a concave edge from the other side only.
fn sides(face: &ContactFace, corners: &[DVec3; 3]) -> u32 {
    (0..3).fold(0, |bits, k| {
        let next = (k + 1) % 3;
        let outward = (corners[next] - corners[k]).cross(face.normal);
        // Zero if the neighbour is unknown.
        let rise = -face.across[k].dot(outward.normalize_or_zero());
        let has_corner = face.has_corner(k) || face.has_corner(next);
        let bit =
            |is_open: bool, first: u32| u32::from(is_open || has_corner) << (first + k as u32);
        bits | bit(face.has_edge(k), ALL_SIDES)
            | bit(face.has_edge(k) && rise > -BENT, OUTER_SIDES)
            | bit(face.has_edge(k) && rise < BENT, INNER_SIDES)
    })
}
