//! Triangle mesh as an object, with precomputed data for contacts.
//!
//! A mesh can be rounded by a radius R: the object is then the set of all points within R of a triangle. A taxel of radius ρ touches this object where a taxel
//! of radius ρ + R would touch the triangles. Therefore the contact of rounded shapes is exact. A capsule is a rounded line segment.

use super::mesh_blocks::MeshBlocks;
use crate::error::Result;
use crate::geometry::Aabb;
use crate::mesh::primitives::check_capsule;
use crate::mesh::{Bvh, LengthUnit, MeshFeatures, Triangle, TriangleMesh, Welded};
use crate::text::in_range::not_negative;
use glam::{DMat3, DQuat, DVec3};
use std::sync::{Arc, OnceLock};

/// Mesh that taxels can touch exactly; each triangle is solid from either side. Clones share their data.
#[derive(Clone, Debug)]
pub struct MeshModel {
    data: Arc<Data>,
}

#[derive(Debug)]
struct Data {
    mesh: TriangleMesh,
    /// Distance of the object's surface from the triangles, metres; 0 for a mesh that is not rounded.
    rounding: f64,
    bvh: Bvh,
    /// Triangles with their contact data, in blocks.
    blocks: MeshBlocks,
    /// Parts for contacts of free objects, computed on first use.
    features: OnceLock<MeshFeatures>,
}

/// Contact data of one triangle: its face, and the edges and corners that belong to no earlier triangle.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct ContactFace {
    /// Unit normal of the triangle; zero if the triangle is too thin.
    pub normal: DVec3,
    /// Largest distance of a direction of contact from the normal, over the face, its own edges and its own corners. The value is 2 if the directions are
    /// unknown.
    pub spread: f64,
    /// For each side, the largest distance beyond the side at which the centre of a touching ball can be, in units of the ball's radius. The distance is
    /// measured from the side moved by the radius along the normal. The value is 2 if the directions are unknown.
    pub side_spread: [f32; 3],
    /// Bits for the edges and corners with which contact is evaluated for this triangle. Bit k is for the side from corner k to the next corner, bit 3 + k
    /// for corner k. Bit 6 + k is set if corner k belongs to this triangle, and not to another triangle with the same corner.
    ///
    /// A side is evaluated if it belongs to this triangle (not to the neighbouring triangle), and the two triangles do not lie in one plane. A corner is evaluated
    /// if it belongs to this triangle, and the triangles around the corner do not lie in one plane.
    pub parts: u32,
    /// Unit normal of the neighbouring triangle across each side. The neighbour's corners are ordered as if it passed the side in the direction of this
    /// triangle. On a smooth surface this normal is therefore approximately minus the normal of this triangle. The normal is zero if there is not exactly one
    /// neighbour, or if the neighbour is too thin.
    pub across: [DVec3; 3],
}

/// Distance between the unit normals of two triangles up to which the triangles lie in one plane. If larger, a gap opens between faces whose common edge is
/// omitted; if smaller, edges inside flat faces are evaluated needlessly.
pub(crate) const FLAT: f64 = 1e-8;
/// Distance of a direction of contact from the normal beyond which a triangle's directions count as unknown. Directions around a corner are bounded by the
/// normals around it if all these normals are within 90° (distance √2) of one normal.
const MAX_SPREAD: f64 = 1.3;
/// Spread of a triangle with unknown directions of contact; larger than any distance between unit vectors.
const UNKNOWN: f64 = 2.0;

impl MeshModel {
    /// Prepares a mesh for contacts; takes a few microseconds per triangle.
    pub fn new(mesh: TriangleMesh) -> Self {
        Self::prepared(mesh, 0.0)
    }

    /// Prepares a rounded mesh for contacts: the set of all points within `rounding` metres of a triangle.
    ///
    /// # Errors
    /// If the rounding is negative or not finite.
    pub fn rounded(mesh: TriangleMesh, rounding: f64) -> Result<Self> {
        let rounding = not_negative("rounding", rounding, "m")?;
        Ok(Self::prepared(mesh, rounding))
    }

    fn prepared(mesh: TriangleMesh, rounding: f64) -> Self {
        let faces = contact_faces(&mesh, &Welded::new(&mesh));
        let triangles: Vec<Triangle> = (0..faces.len()).map(|t| mesh.triangle(t)).collect();
        let data = Data {
            rounding,
            bvh: Bvh::new(&mesh),
            blocks: MeshBlocks::new(&triangles, &faces),
            mesh,
            features: OnceLock::new(),
        };
        Self {
            data: Arc::new(data),
        }
    }

    /// Creates a capsule about the origin along z, a rounded line segment. `length` is the distance between the centres of its hemispheres, zero or more,
    /// metres.
    ///
    /// # Errors
    /// If the radius is not positive or the length is negative; errors begin with `capsule`.
    pub fn capsule(radius: f64, length: f64) -> Result<Self> {
        const PLACE: &str = "capsule";
        check_capsule(PLACE, radius, length)?;
        let end = DVec3::new(0.0, 0.0, 0.5 * length);
        let line = vec![-end, end];
        let line = TriangleMesh::in_unit(PLACE, LengthUnit::Metre, line, vec![[0, 1, 1]])?;
        Self::rounded(line, radius)
    }

    /// Returns the triangle mesh without its rounding, metres.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.data.mesh
    }

    /// Returns the distance of the object's surface from the triangles, metres; 0 unless the mesh is rounded.
    pub fn rounding(&self) -> f64 {
        self.data.rounding
    }

    /// Returns the tree of the triangles' bounding boxes, without the rounding.
    pub fn bvh(&self) -> &Bvh {
        &self.data.bvh
    }

    /// Returns the triangles in blocks, for searches with vector instructions.
    pub(crate) fn blocks(&self) -> &MeshBlocks {
        &self.data.blocks
    }

    /// Returns the corners, edges and faces of the mesh, computed at the first call.
    pub fn features(&self) -> &MeshFeatures {
        let data = &self.data;
        data.features.get_or_init(|| MeshFeatures::new(&data.mesh))
    }

    /// Returns the bounding box of the object, metres.
    pub fn bounds(&self) -> Aabb {
        self.data.bvh.bounds().widened(self.data.rounding)
    }

    /// Returns the bounding box of the object after a rotation about its origin, metres.
    pub fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        let rotation = DMat3::from_quat(rotation);
        let corners = self.corners().map(|corner| rotation * corner);
        Aabb::around_points(corners).widened(self.data.rounding)
    }

    /// Returns each vertex that belongs to a triangle, once.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> {
        let triangles = self.data.blocks.triangles.iter();
        let corners = triangles.flat_map(|t| (0..3).map(|k| (t.corners[k], t.face.owns(k))));
        corners.filter_map(|(corner, is_own)| is_own.then_some(corner))
    }
}

fn contact_faces(mesh: &TriangleMesh, welded: &Welded) -> Vec<ContactFace> {
    let mut corners: Vec<CornerNormals> = vec![CornerNormals::default(); mesh.vertices().len()];
    let mut faces: Vec<ContactFace> = (0..mesh.n_triangles())
        .map(|number| {
            let normal = mesh.triangle(number).normal().unwrap_or(DVec3::ZERO);
            // Initially all sides are listed; shared sides are removed below. A triangle with a repeated corner has one side, which is not shared.
            let mut parts = match welded.corners[number] {
                [a, b, c] if a == b => u32::from(b != c) << 1,
                [a, b, c] if b == c || c == a => 1,
                _ => 0b111,
            };
            for (k, &corner) in welded.corners[number].iter().enumerate() {
                parts |= u32::from(corners[corner as usize].add(normal)) << (6 + k);
            }
            ContactFace {
                normal,
                spread: 0.0,
                side_spread: [0.0; 3],
                parts,
                across: [DVec3::ZERO; 3],
            }
        })
        .collect();
    for sides in welded.edges() {
        let (first, others) = sides.split_first().expect("an edge has a side");
        for side in others {
            faces[side.triangle as usize].parts &= !(1 << side.side);
        }
        if let [neighbour] = others {
            let normal = faces[neighbour.triangle as usize].normal;
            let is_same_way = neighbour.is_forward == first.is_forward;
            let across = if is_same_way { normal } else { -normal };
            let face = &mut faces[first.triangle as usize];
            face.across[usize::from(first.side)] = across;
            if normal != DVec3::ZERO && (face.normal + across).length() < FLAT {
                face.parts &= !(1 << first.side);
            }
        } else {
            for corner in first.edge {
                corners[corner as usize].spread = UNKNOWN;
            }
        }
    }
    for (number, (face, numbers)) in faces.iter_mut().zip(&welded.corners).enumerate() {
        let around = numbers.map(|corner| corners[corner as usize].spread);
        for (k, spread) in around.into_iter().enumerate() {
            face.parts |= u32::from(face.owns(k) && spread > FLAT) << (3 + k);
        }
        face.measure_spread(&mesh.triangle(number), around);
    }
    faces
}

impl ContactFace {
    /// Returns whether contact with a side, 0 to 2, is evaluated for this triangle.
    #[inline(always)]
    pub fn has_edge(&self, side: usize) -> bool {
        self.parts >> side & 1 == 1
    }

    /// Returns whether contact with a corner, 0 to 2, is evaluated for this triangle.
    #[inline(always)]
    pub fn has_corner(&self, corner: usize) -> bool {
        self.parts >> (3 + corner) & 1 == 1
    }

    /// Returns whether a corner, 0 to 2, belongs to this triangle.
    fn owns(&self, corner: usize) -> bool {
        self.parts >> (6 + corner) & 1 == 1
    }

    /// Sets the spreads of the triangle and of its sides. `around` contains, for each corner, the largest distance of a normal around the corner from the normal of
    /// the triangle that owns the corner.
    ///
    /// A direction of contact with side k is n cos φ + o sin φ. Here o is the outward direction of the side in the plane of the triangle. With s = |d − n|,
    /// the centre of the ball is therefore at most ρ (s o·o' + s²/2) beyond a side with the outward direction o'.
    fn measure_spread(&mut self, triangle: &Triangle, around: [f64; 3]) {
        let corners = triangle.0;
        let outward = [0, 1, 2].map(|side| {
            let along = corners[(side + 1) % 3] - corners[side];
            along.cross(self.normal).normalize_or_zero()
        });
        let of_edges = [0, 1, 2].map(|side| match self.across[side] {
            _ if !self.has_edge(side) => 0.0,
            across if across == DVec3::ZERO => UNKNOWN,
            across => (self.normal + across).length(),
        });
        let edges = of_edges.into_iter().fold(0.0, f64::max);
        let own_corners = (0..3).filter(|&corner| self.owns(corner));
        let corners = own_corners.fold(0.0, |spread, corner| around[corner].max(spread));
        let spread = match self.normal == DVec3::ZERO {
            true => UNKNOWN,
            false => edges.max(corners),
        };
        let is_known = spread <= MAX_SPREAD;
        self.spread = if is_known { spread } else { UNKNOWN };
        self.side_spread = outward.map(|beyond| {
            let shares = [0, 1, 2].map(|side| of_edges[side] * outward[side].dot(beyond));
            let edges = shares.into_iter().fold(0.0, f64::max) + 0.5 * edges * edges;
            // Rounded up, because the spread is a bound.
            (self.spread.min(edges.max(corners)) as f32).next_up()
        });
        if !is_known {
            self.side_spread = [UNKNOWN as f32; 3];
        }
    }
}

/// Normals of the triangles around a corner.
#[derive(Clone, Copy, Debug, Default)]
struct CornerNormals {
    /// Normal of the first triangle, which owns the corner.
    first: Option<DVec3>,
    /// Largest distance of a normal from the first normal.
    spread: f64,
}

impl CornerNormals {
    /// Adds the normal of a triangle, zero if the triangle is too thin. Returns whether the triangle is the first.
    fn add(&mut self, normal: DVec3) -> bool {
        let is_first = self.first.is_none();
        let first = *self.first.get_or_insert(normal);
        let distance = match normal == DVec3::ZERO {
            true => UNKNOWN,
            false => normal.distance(first),
        };
        self.spread = self.spread.max(distance);
        is_first
    }
}
