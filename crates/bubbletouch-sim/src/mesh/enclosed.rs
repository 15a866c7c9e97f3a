//! Area, volume and centroids of a mesh. In the solid of a closed mesh, closed parts that overlap count once.
//!
//! Let w be the winding number, and χ = 1 where w > 0, otherwise 0. The boundary of the solid consists of the faces across which χ changes. By the divergence
//! theorem, the volume is a sum over pieces of faces. A piece counts χ₋ − χ₊ times, where − is its back and + its front. If n faces coincide, w changes by
//! n = w₋ − w₊, and each of them counts 1/n times. Faces that coincide back to back cancel (n = 0).
//!
//! The winding numbers on both sides are constant over faces that no other face meets and that are joined by edges. All other faces are cut where the planes
//! of other faces meet them.

use super::crossings::winding;
use super::{Bvh, Triangle, TriangleMesh, Welded};
use crate::disjoint_sets::DisjointSets;
use glam::DVec3;
use rayon::prelude::*;

/// Distance from a face at which the winding number of its side is computed, relative to the size of the mesh. If smaller, rounding decides beside faces that
/// nearly coincide; if larger, the number is wrong in clefts and walls that are thinner.
const LIFT: f64 = 1e-8;
/// Fraction by which triangles are shrunk before they are tested for contact, so that neighbours with a common edge or corner do not count. If larger,
/// overlaps of this width are missed; if smaller, rounding makes neighbours meet.
const SHRINK: f64 = 1e-6;
/// Number of faces that meet a piece up to which the piece is cut by their planes; a piece that meets more of them is halved first. If larger, the number of
/// pieces grows quadratically; if smaller, more pieces are halved in vain.
const MAX_CUTS: usize = 4;
/// Maximum number of times that a face is halved. Near a corner of many faces, the number of faces does not decrease.
const MAX_HALVINGS: usize = 16;

/// Volume relative to area^(3/2) below which a mesh counts as a surface without volume. A ball has 0.094, a plate of 100 × 100 × 0.1 mm 0.0004.
const HOLLOW: f64 = 1e-4;

impl TriangleMesh {
    /// Returns the area of the mesh, the sum of its triangles' areas, m².
    pub fn area(&self) -> f64 {
        (0..self.n_triangles())
            .map(|t| self.triangle(t).area())
            .sum()
    }

    /// Returns the centroid of the mesh's surface, metres: the mean of the triangles' centroids, weighted by area.
    pub fn surface_centroid(&self) -> DVec3 {
        let mut area = 0.0;
        let mut moment = DVec3::ZERO;
        for t in 0..self.n_triangles() {
            let triangle = self.triangle(t);
            let [a, b, c] = triangle.0;
            area += triangle.area();
            moment += triangle.area() * (a + b + c) / 3.0;
        }
        if area > 0.0 {
            moment / area
        } else {
            self.bounds().center()
        }
    }

    /// Returns the centre of mass of the homogeneous solid of the mesh, metres. A mesh without volume, such as a single surface, is treated as a surface of
    /// constant density.
    pub fn center_of_mass(&self) -> DVec3 {
        let (volume, center) = self.volume_and_centroid();
        match volume.abs() > HOLLOW * self.area().powf(1.5) {
            true => center,
            false => self.surface_centroid(),
        }
    }

    /// Returns the volume of the solid of the mesh, m³ (negative if the triangles face inwards), and the centroid of this volume, metres.
    ///
    /// The result is exact for a closed mesh; closed parts that overlap count once. A hole is treated as closed by a cone whose apex is the centroid of the
    /// surface; overlapping parts of a mesh with holes count several times.
    pub fn volume_and_centroid(&self) -> (f64, DVec3) {
        let apex = self.surface_centroid();
        let mut enclosed = Enclosed::default();
        for t in 0..self.n_triangles() {
            enclosed.add(self.triangle(t).0.map(|corner| corner - apex), 1.0);
        }
        let welded = Welded::new(self);
        if enclosed.volume != 0.0 && welded.n_unbalanced() == 0 {
            let sign = enclosed.volume.signum();
            enclosed = Enclosed::of_solid(self, &welded, apex, sign);
        }
        let Enclosed { volume, moment } = enclosed;
        match volume == 0.0 {
            true => (volume, apex),
            false => (volume, apex + moment / volume),
        }
    }
}

/// Sum over pieces of faces: the volume of the tetrahedra from a common apex, m³, and the first moment of this volume about the apex, m⁴.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Enclosed {
    pub volume: f64,
    pub moment: DVec3,
}

impl Enclosed {
    /// Adds the tetrahedron between the origin and a triangle, `weight` times.
    pub fn add(&mut self, [a, b, c]: [DVec3; 3], weight: f64) {
        let part = weight * a.dot(b.cross(c)) / 6.0;
        self.volume += part;
        self.moment += part * 0.25 * (a + b + c);
    }

    /// Returns the sum over the boundary of the solid of a closed mesh, about `apex`. The solid is where the winding number has the sign `sign`; both sums are
    /// negative if it is −1.
    pub fn of_solid(mesh: &TriangleMesh, welded: &Welded, apex: DVec3, sign: f64) -> Self {
        let bvh = Bvh::new(mesh);
        let faces = Faces {
            lift: LIFT * bvh.bounds().size().length(),
            bvh,
            sign,
        };
        let triangles: Vec<Triangle> = (0..mesh.n_triangles()).map(|t| mesh.triangle(t)).collect();
        let met = triangles
            .par_iter()
            .enumerate()
            .map(|(t, face)| faces.met_by(t, face));
        let met: Vec<Vec<Triangle>> = met.collect();
        let mut joined = DisjointSets::new(triangles.len());
        for sides in welded.edges() {
            if let [a, b] = sides
                && a.is_forward != b.is_forward
                && [a, b]
                    .iter()
                    .all(|side| met[side.triangle as usize].is_empty())
            {
                joined.join(a.triangle as usize, b.triangle as usize);
            }
        }
        let mut largest: Vec<usize> = (0..triangles.len()).collect();
        let groups = joined.roots();
        for (t, &group) in groups.iter().enumerate() {
            if triangles[t].area() > triangles[largest[group]].area() {
                largest[group] = t;
            }
        }
        let mut weights: Vec<Option<f64>> = vec![None; triangles.len()];
        let mut sum = Self::default();
        for (t, triangle) in triangles.iter().enumerate() {
            let Some(normal) = triangle.normal() else {
                continue;
            };
            if met[t].is_empty() {
                let group = groups[t];
                let weight = *weights[group].get_or_insert_with(|| {
                    let largest = &triangles[largest[group]];
                    faces.weight(largest.middle(), largest.normal().unwrap_or(normal))
                });
                sum.add(triangle.0.map(|corner| corner - apex), weight);
            } else {
                faces.each_piece(*triangle, normal, &met[t], MAX_HALVINGS, &mut |piece| {
                    let [first, rest @ ..] = piece else { return };
                    let middle = piece.iter().sum::<DVec3>() / piece.len() as f64;
                    let weight = faces.weight(middle, normal);
                    for pair in rest.windows(2) {
                        sum.add(
                            [*first, pair[0], pair[1]].map(|corner| corner - apex),
                            weight,
                        );
                    }
                });
            }
        }
        sum
    }
}

/// Faces of a closed mesh whose solid is where the winding number has the sign `sign`.
struct Faces {
    bvh: Bvh,
    /// Distance from a face at which the winding number of its side is computed, metres.
    lift: f64,
    sign: f64,
}

impl Faces {
    /// Returns the faces that may meet the face with index `number`, other than at common edges and corners.
    fn met_by(&self, number: usize, face: &Triangle) -> Vec<Triangle> {
        let shrunk_face = shrunk(face);
        let mut met = Vec::new();
        self.bvh.each_in_box(&face.bounds(), |other_number, other| {
            if other_number != number && !are_apart(&shrunk_face, &shrunk(other)) {
                met.push(*other);
            }
        });
        met
    }

    /// Returns how often a piece of a face counts as boundary of the solid; the point is in its interior.
    fn weight(&self, point: DVec3, normal: DVec3) -> f64 {
        let [front, back] = [1.0, -1.0]
            .map(|side| f64::from(winding(&self.bvh, point + side * self.lift * normal)));
        let [is_front, is_back] = [front, back].map(|w| f64::from(u8::from(self.sign * w > 0.0)));
        match back - front {
            0.0 => 0.0,
            jump => self.sign * (is_back - is_front) / jump,
        }
    }

    /// Visits convex pieces of a face that the faces `met` may meet. The winding numbers on both sides are constant over each piece.
    fn each_piece(
        &self,
        face: Triangle,
        normal: DVec3,
        met: &[Triangle],
        n_halvings: usize,
        visit: &mut impl FnMut(&[DVec3]),
    ) {
        if met.len() > MAX_CUTS && n_halvings > 0 {
            let halves = face.bisected().map(|half| {
                let shrunk_half = shrunk(&half);
                let near = met
                    .iter()
                    .filter(|other| !are_apart(&shrunk_half, &shrunk(other)));
                (half, near.copied().collect::<Vec<_>>())
            });
            if halves.iter().any(|(_, near)| near.len() < met.len()) {
                for (half, near) in halves {
                    self.each_piece(half, normal, &near, n_halvings - 1, visit);
                }
                return;
            }
        }
        let mut pieces = vec![face.0.to_vec()];
        for (point, across) in met
            .iter()
            .flat_map(|other| cuts(&face, normal, other, self.lift))
        {
            let cut =
                |piece: Vec<DVec3>| [across, -across].map(|across| beyond(&piece, point, across));
            pieces = pieces
                .into_iter()
                .flat_map(cut)
                .filter(|piece| piece.len() > 2)
                .collect();
        }
        pieces.iter().for_each(|piece| visit(piece));
    }
}

/// Returns planes (point and normal) that divide a face where another face meets it. A face in the same plane cuts with the planes through its edges.
fn cuts(face: &Triangle, normal: DVec3, other: &Triangle, flat: f64) -> Vec<(DVec3, DVec3)> {
    let [a, b, c] = other.0;
    let is_flat = |corner: &DVec3| (*corner - face.0[0]).dot(normal).abs() <= flat;
    match other.normal() {
        Some(across) if !other.0.iter().all(is_flat) => vec![(a, across)],
        _ => [(a, b), (b, c), (c, a)]
            .map(|(from, to)| (from, (to - from).cross(normal).normalize_or_zero()))
            .to_vec(),
    }
}

/// Returns the part of a convex polygon on the side of a plane to which `across` points; empty if the polygon is not on this side.
fn beyond(polygon: &[DVec3], point: DVec3, across: DVec3) -> Vec<DVec3> {
    let height = |corner: DVec3| (corner - point).dot(across);
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &corner) in polygon.iter().enumerate() {
        let next = polygon[(k + 1) % polygon.len()];
        let [here, there] = [height(corner), height(next)];
        if here >= 0.0 {
            kept.push(corner);
        }
        if here * there < 0.0 {
            kept.push(corner + (next - corner) * (here / (here - there)));
        }
    }
    kept
}

fn shrunk(triangle: &Triangle) -> Triangle {
    let middle = triangle.middle();
    Triangle(triangle.0.map(|corner| corner + SHRINK * (middle - corner)))
}

/// Returns whether two triangles are apart, also if they lie in one plane.
fn are_apart(one: &Triangle, other: &Triangle) -> bool {
    one.is_apart(other) || one.is_beside(other) || other.is_beside(one)
}
