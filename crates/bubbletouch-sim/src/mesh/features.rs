//! Faces, edges and corners of a mesh, and the conditions under which the nearest point of the mesh lies on one of them.
//!
//! The point of a mesh nearest to a point c lies on a face if the foot of c is inside the face. The nearest point lies on an edge or at a corner if no
//! adjacent part is nearer. Let d be the unit vector from the nearest point to c:
//!
//! | part | condition |
//! |---|---|
//! | edge | d·s ≤ 0 for the direction s of each adjacent face, perpendicular to the edge |
//! | corner v | d·(w − v) ≤ 0 for each other end w of an edge at v |
//!
//! Exactly one part fulfils its condition where the nearest point changes smoothly, so no part is counted twice.

use super::crossings::winding;
use super::pseudonormals::Pseudonormals;
use super::welded::{Welded, has_equal};
use super::{Bvh, Closest, MeshFeature, TriangleMesh};
use crate::disjoint_sets::DisjointSets;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// Largest cosine that counts as zero in the conditions above. If larger, parts that are not nearest are kept; if smaller, rounding can lose the nearest
/// point on the boundary between two parts.
const FLAT: f64 = 1e-9;
/// Smallest angle between the normals of two faces at a crease, radians (30°, the usual limit of smooth shading). If larger, a corner that stands on a
/// floor and at a wall has a single contact, in which floor and wall share the force. If smaller, a corner that slides over a finely triangulated surface
/// loses its multiplier more often.
pub(crate) const CREASE: f64 = std::f64::consts::FRAC_PI_6;

/// Parts of a mesh that objects can touch; vertices with equal coordinates are one corner.
///
/// Numbers of parts: first the corners, then the edges, then the faces.
#[derive(Clone, Debug)]
pub struct MeshFeatures {
    corners: Vec<DVec3>,
    /// Unit vectors along the edges at each corner, corner by corner.
    directions: Lists<DVec3>,
    /// For each corner, whether one of its edges is a ridge.
    is_on_ridge: Vec<bool>,
    edges: Vec<Edge>,
    /// Unit vectors in the adjacent faces of each edge, perpendicular to the edge and into the face.
    sides: Lists<DVec3>,
    faces: Vec<Face>,
    /// For each part, the number of the part that represents its smooth patch.
    patches: Vec<u32>,
    normals: Pseudonormals,
    is_closed: bool,
}

/// Edge of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Start of the edge, metres.
    pub from: DVec3,
    /// Unit vector along the edge.
    pub direction: DVec3,
    /// Length of the edge, metres.
    pub length: f64,
    /// Whether the adjacent faces form a ridge, or there is only one. The edge can then touch an edge of another mesh.
    pub is_ridge: bool,
    /// Whether the adjacent faces lie in one plane; the edge is then no part of its own.
    is_flat: bool,
}

/// Face of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Corners of the face, metres, counter-clockwise as seen from outside.
    pub corners: [DVec3; 3],
    /// Outward unit normal; `None` if the triangle is too thin.
    pub normal: Option<DVec3>,
    /// For each side, from corner k to the next corner: the edge's index.
    edges: [u32; 3],
    corner_numbers: [u32; 3],
    /// For each side, whether the edge belongs to this face and to no earlier one.
    owns_edge: [bool; 3],
    owns_corner: [bool; 3],
    /// For each side, whether the face continues behind the face beyond the side, which rises there.
    is_valley: [bool; 3],
}

#[derive(Clone, Debug)]
struct Lists<T> {
    first: Vec<u32>,
    all: Vec<T>,
}

impl<T> Lists<T> {
    fn at(&self, index: usize) -> &[T] {
        &self.all[self.first[index] as usize..self.first[index + 1] as usize]
    }
}

/// Builds lists from pairs of list index and entry.
fn lists<T: Copy>(n: usize, mut pairs: Vec<(u32, T)>) -> Lists<T> {
    pairs.sort_by_key(|pair| pair.0);
    let first = (0..=n as u32).map(|index| pairs.partition_point(|pair| pair.0 < index) as u32);
    Lists {
        first: first.collect(),
        all: pairs.into_iter().map(|pair| pair.1).collect(),
    }
}

impl MeshFeatures {
    /// Collects the parts of a mesh.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let welded = Welded::new(mesh);
        let mut number = vec![u32::MAX; mesh.vertices().len()];
        let mut corners = Vec::new();
        let mut faces = Vec::with_capacity(welded.corners.len());
        for (triangle, vertices) in welded.corners.iter().enumerate() {
            let mut owns_corner = [false; 3];
            for (vertex, owns) in vertices.iter().zip(&mut owns_corner) {
                let number = &mut number[*vertex as usize];
                if *number == u32::MAX {
                    *number = corners.len() as u32;
                    corners.push(mesh.vertices()[*vertex as usize]);
                    *owns = true;
                }
            }
            let triangle = mesh.triangle(triangle);
            faces.push(Face {
                corners: triangle.0,
                normal: triangle.normal(),
                edges: [u32::MAX; 3],
                corner_numbers: vertices.map(|vertex| number[vertex as usize]),
                owns_edge: [false; 3],
                owns_corner,
                is_valley: [false; 3],
            });
        }
        let (mut edges, mut sides, mut directions) = (Vec::new(), Vec::new(), Vec::new());
        let mut is_on_ridge = vec![false; corners.len()];
        let place = |corner: u32| corners[corner as usize];
        let mut add_edge = |ends: [u32; 2], rise: f64| {
            let [from, to] = ends.map(place);
            let direction = (to - from).normalize();
            directions.extend([(ends[0], direction), (ends[1], -direction)]);
            let edge = Edge {
                from,
                direction,
                length: from.distance(to),
                is_ridge: rise < -FLAT,
                is_flat: rise.abs() <= FLAT,
            };
            for end in ends {
                is_on_ridge[end as usize] |= edge.is_ridge;
            }
            edges.push(edge);
        };
        let mut n_edges = 0;
        for group in welded.edges() {
            let ends = group[0].edge.map(|vertex| number[vertex as usize]);
            let [from, to] = ends.map(place);
            let direction = (to - from).normalize();
            let mut own: Vec<(DVec3, DVec3)> = Vec::new();
            for (index, side) in group.iter().enumerate() {
                let face = &mut faces[side.triangle as usize];
                face.edges[usize::from(side.side)] = n_edges;
                face.owns_edge[usize::from(side.side)] = index == 0;
                let opposite = face.corners[usize::from(side.side + 2) % 3];
                let inward = (opposite - from).reject_from_normalized(direction);
                own.extend(face.normal.map(|normal| (inward.normalize(), normal)));
            }
            sides.extend(own.iter().map(|(inward, _)| (n_edges, *inward)));
            let rise = match own[..] {
                [(_, normal), (inward, _)] => normal.dot(inward),
                _ => -1.0,
            };
            for side in group.iter().filter(|_| rise > FLAT) {
                faces[side.triangle as usize].is_valley[usize::from(side.side)] = true;
            }
            add_edge(ends, rise);
            n_edges += 1;
        }
        // A triangle with two equal corners is a line.
        for (face, &vertices) in faces.iter_mut().zip(&welded.corners) {
            let [a, b, c] = vertices;
            if !has_equal(vertices) || (a == b && b == c) {
                continue;
            }
            let side = usize::from(a == b);
            face.edges[side] = n_edges;
            face.owns_edge[side] = true;
            let ends = [side, (side + 1) % 3].map(|k| face.corner_numbers[k]);
            add_edge(ends, -1.0);
            n_edges += 1;
        }
        let patches = smooth_patches(&faces, corners.len(), edges.len());
        Self {
            patches,
            is_on_ridge,
            directions: lists(corners.len(), directions),
            sides: lists(edges.len(), sides),
            corners,
            edges,
            faces,
            normals: Pseudonormals::new(mesh, &welded),
            is_closed: welded.is_closed(),
        }
    }

    /// Returns the corners, metres.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    /// Returns the edges.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Returns a face by the index of its triangle.
    pub fn face(&self, triangle: usize) -> &Face {
        &self.faces[triangle]
    }

    /// Returns the edges of a triangle that belong to no earlier triangle and whose faces do not lie in one plane.
    pub fn own_edges(&self, triangle: usize) -> impl Iterator<Item = usize> {
        let face = &self.faces[triangle];
        let edges = face.edges.iter().zip(face.owns_edge);
        let own = edges.filter(|(edge, owns)| *owns && !self.edges[**edge as usize].is_flat);
        own.map(|(edge, _)| *edge as usize)
    }

    /// Returns the corners of a triangle that belong to no earlier triangle.
    pub fn own_corners(&self, triangle: usize) -> impl Iterator<Item = usize> {
        let face = &self.faces[triangle];
        let corners = face.corner_numbers.iter().zip(face.owns_corner);
        corners.filter_map(|(corner, owns)| owns.then_some(*corner as usize))
    }

    /// Returns whether one of the edges at a corner is a ridge. Another corner does not protrude from its faces, and touches nothing before they do.
    pub fn is_on_ridge(&self, corner: usize) -> bool {
        self.is_on_ridge[corner]
    }

    /// Returns the number of an edge among all parts.
    pub fn edge_number(&self, edge: usize) -> u32 {
        (self.corners.len() + edge) as u32
    }

    /// Returns the number of a face among all parts.
    pub fn face_number(&self, triangle: usize) -> u32 {
        (self.corners.len() + self.edges.len() + triangle) as u32
    }

    /// Returns the number of the part that contains a nearest point.
    pub fn part_of(&self, closest: &Closest) -> u32 {
        let face = &self.faces[closest.triangle];
        match closest.feature {
            MeshFeature::Face => self.face_number(closest.triangle),
            // A triangle with two equal corners has sides that are no edges.
            MeshFeature::Edge(k) => match face.edges[usize::from(k)] {
                u32::MAX => face.corner_numbers[usize::from(k)],
                edge => self.edge_number(edge as usize),
            },
            MeshFeature::Vertex(k) => face.corner_numbers[usize::from(k)],
        }
    }

    /// Returns the number of the part that represents the smooth patch of `part`. A smooth patch consists of faces that are connected over edges without a
    /// crease, and of the edges and corners that only these faces have. An edge or a corner of several patches represents itself.
    pub fn smooth_patch(&self, part: u32) -> u32 {
        self.patches[part as usize]
    }

    /// Returns whether the face, edge or corner that contains a nearest point is a part of the triangle.
    pub fn has_nearest(&self, triangle: usize, closest: &Closest) -> bool {
        let of = &self.faces[closest.triangle].corner_numbers;
        let has = |k: usize| self.faces[triangle].corner_numbers.contains(&of[k % 3]);
        match closest.feature {
            MeshFeature::Face => triangle == closest.triangle,
            MeshFeature::Edge(k) => has(usize::from(k)) && has(usize::from(k) + 1),
            MeshFeature::Vertex(k) => has(usize::from(k)),
        }
    }

    /// Returns whether a point is inside the solid of the mesh, given the nearest point of the mesh. `bvh` is the tree of the mesh's triangles.
    pub fn is_inside(&self, bvh: &Bvh, point: DVec3, closest: &Closest) -> bool {
        let by_normal = match self.is_closed || closest.feature == MeshFeature::Face {
            true => self.normals.is_outside(point, closest),
            false => None,
        };
        !by_normal.unwrap_or_else(|| winding(bvh, point) <= 0)
    }

    /// Returns whether an edge is nearer than its faces to a point in the direction `d` (unit vector) from the edge.
    pub fn edge_is_nearest(&self, edge: usize, d: DVec3) -> bool {
        self.edge_points_along(edge, d, FLAT)
    }

    /// Returns whether the direction `d` (unit vector) is between the normals of the faces at a ridge, or beyond them by at most `slack` radians.
    pub fn edge_points_along(&self, edge: usize, d: DVec3, slack: f64) -> bool {
        self.sides.at(edge).iter().all(|side| d.dot(*side) <= slack)
    }

    /// Returns whether a corner is nearer than its edges and faces to a point in the direction `d` (unit vector) from the corner.
    pub fn corner_is_nearest(&self, corner: usize, d: DVec3) -> bool {
        let along = self.directions.at(corner);
        along.iter().all(|along| d.dot(*along) <= FLAT)
    }
}

/// Returns, for each part, the number of the part that represents its smooth patch ([`MeshFeatures::smooth_patch`]).
fn smooth_patches(faces: &[Face], n_corners: usize, n_edges: usize) -> Vec<u32> {
    let mut of_edge: Vec<(u32, u32)> = faces
        .iter()
        .zip(0..)
        .flat_map(|(face, number)| face.edges.map(|edge| (edge, number)))
        .filter(|(edge, _)| *edge != u32::MAX)
        .collect();
    of_edge.sort_unstable();
    let mut joined = DisjointSets::new(faces.len());
    for sides in of_edge.chunk_by(|a, b| a.0 == b.0) {
        let [one, other] = *sides else { continue };
        let normals = [one, other].map(|side| faces[side.1 as usize].normal);
        // A triangle without a normal belongs to its neighbours.
        let is_smooth = match normals {
            [Some(a), Some(b)] => a.dot(b) > CREASE.cos(),
            _ => true,
        };
        if is_smooth {
            joined.join(one.1 as usize, other.1 as usize);
        }
    }
    let n_rest = n_corners + n_edges;
    let mut patches = vec![u32::MAX; n_rest];
    for (number, face) in faces.iter().enumerate() {
        let patch = (n_rest + joined.root(number)) as u32;
        let corners = face.corner_numbers.map(|corner| corner as usize);
        let edges = face.edges.iter().filter(|edge| **edge != u32::MAX);
        let edges = edges.map(|edge| n_corners + *edge as usize);
        for part in corners.into_iter().chain(edges) {
            let of = &mut patches[part];
            *of = match *of {
                u32::MAX => patch,
                same if same == patch => patch,
                _ => part as u32,
            };
        }
        patches.push(patch);
    }
    patches
}

impl Face {
    /// Returns the distance of a point, metres, beyond the side of the face that it is furthest beyond; negative inside. A point beyond a side where another
    /// face rises counts only from `valley` metres on.
    pub fn beyond(&self, point: DVec3, normal: DVec3, valley: f64) -> f64 {
        let mut furthest = f64::NEG_INFINITY;
        for k in 0..3 {
            let (from, to) = (self.corners[k], self.corners[(k + 1) % 3]);
            let outward = (to - from).cross(normal).normalize_or_zero();
            let allowed = if self.is_valley[k] { valley } else { 0.0 };
            furthest = furthest.max(outward.dot(point - from) - allowed);
        }
        furthest
    }
}

impl Edge {
    /// Returns the edge after a rotation and a translation (metres).
    pub fn moved(&self, rotation: &DMat3, translation: DVec3) -> Self {
        Self {
            from: *rotation * self.from + translation,
            direction: *rotation * self.direction,
            ..*self
        }
    }

    /// Returns the range of positions along the edge, metres, with an allowance for rounding.
    pub fn range(&self) -> Range<f64> {
        let slack = 1e-12 * self.length;
        -slack..self.length + slack
    }
}
