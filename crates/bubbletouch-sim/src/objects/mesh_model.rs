//! Triangle mesh as an object, with precomputed data for contacts.
//!
//! A mesh can be rounded by a radius R: the object is then the set of all points within R of a triangle. A taxel of radius ρ touches this object where a taxel
//! of radius ρ + R would touch the triangles. Therefore the contact of rounded shapes is exact. A capsule is a rounded line segment.

use super::mesh_blocks::MeshBlocks;
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::mesh::primitives::check_capsule;
use crate::mesh::{Bvh, MeshFeatures, Triangle, TriangleMesh, Welded};
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
pub struct ContactFace {
    /// Unit normal of the triangle; zero if the triangle is too thin.
    pub normal: DVec3,
    /// Unit normal of the neighbouring triangle across each side. The neighbour's corners are ordered as if it passed the side in the direction of this
    /// triangle. On a smooth surface this normal is therefore approximately minus the normal of this triangle. The normal is zero if there is not exactly one
    /// neighbour, or if the neighbour is too thin.
    pub across: [DVec3; 3],
    /// For each side, from corner i to the next corner, whether contact with the side is evaluated for this triangle. The side must belong to this triangle
    /// (not to the neighbouring triangle), and the two triangles must not lie in one plane.
    pub has_edge: [bool; 3],
    /// For each corner, whether the corner belongs to this triangle (and not to another triangle with the same corner).
    pub has_corner: [bool; 3],
    /// For each corner, whether the triangles around the corner do not lie in one plane.
    pub is_sharp: [bool; 3],
    /// Largest distance of a direction of contact from the normal, for the face, its own edges and its own corners; 2 if the directions are unknown.
    pub spread: f64,
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
        let rounding = 0.0;
        let bvh = Bvh::new(&mesh);
        let faces = contact_faces(&mesh, &Welded::new(&mesh));
        let triangles: Vec<Triangle> = (0..faces.len()).map(|t| mesh.triangle(t)).collect();
        let blocks = MeshBlocks::new(&triangles, &faces);
        Self {
            data: Arc::new(Data {
                mesh,
                rounding,
                bvh,
                blocks,
                features: OnceLock::new(),
            }),
        }
    }

    /// Prepares a rounded mesh for contacts: the set of all points within `rounding` metres of a triangle.
    ///
    /// # Errors
    /// If the rounding is negative or not finite.
    pub fn rounded(mesh: TriangleMesh, rounding: f64) -> Result<Self> {
        if !rounding.is_finite() || rounding < 0.0 {
            let allowed = "a finite number of metres, zero or more";
            return Err(Error::input("rounding", rounding, allowed));
        }
        let Self { data } = Self::new(mesh);
        let data = Arc::into_inner(data).expect("a new model has one owner");
        Ok(Self {
            data: Arc::new(Data { rounding, ..data }),
        })
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
        Self::rounded(
            TriangleMesh::new(PLACE, vec![-end, end], vec![[0, 1, 1]])?,
            radius,
        )
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
        self.enlarged(self.data.bvh.bounds())
    }

    /// Returns a box enlarged by the rounding on all sides.
    fn enlarged(&self, bounds: Aabb) -> Aabb {
        Aabb {
            min: bounds.min - self.data.rounding,
            max: bounds.max + self.data.rounding,
        }
    }

    /// Returns the bounding box of the object after a rotation about its origin, metres.
    pub fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        let rotation = DMat3::from_quat(rotation);
        let corners = self.corners().map(|corner| rotation * corner);
        let points = corners.map(|point| Aabb {
            min: point,
            max: point,
        });
        let around = Aabb::around(points).expect("a mesh has at least one triangle");
        self.enlarged(around)
    }

    /// Returns each vertex that belongs to a triangle, once.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> {
        let triangles = self.data.blocks.triangles.iter();
        let corners = triangles.flat_map(|t| t.corners.into_iter().zip(t.face.has_corner));
        corners.filter_map(|(corner, is_own)| is_own.then_some(corner))
    }
}

fn contact_faces(mesh: &TriangleMesh, welded: &Welded) -> Vec<ContactFace> {
    let mut corners: Vec<CornerNormals> = vec![CornerNormals::default(); mesh.vertices().len()];
    let mut faces: Vec<ContactFace> = (0..mesh.n_triangles())
        .map(|number| {
            let normal = mesh.triangle(number).normal().unwrap_or(DVec3::ZERO);
            let mut own = |corner: u32| corners[corner as usize].add(normal);
            ContactFace {
                normal,
                across: [DVec3::ZERO; 3],
                // Initially all sides are listed; shared sides are removed below. A triangle with a repeated corner has one side, which is not shared.
                has_edge: match welded.corners[number] {
                    [a, b, c] if a == b => [false, b != c, false],
                    [a, b, c] if b == c || c == a => [true, false, false],
                    _ => [true; 3],
                },
                has_corner: welded.corners[number].map(&mut own),
                is_sharp: [true; 3],
                spread: 0.0,
            }
        })
        .collect();
    for sides in welded.edges() {
        let (first, others) = sides.split_first().expect("an edge has a side");
        for side in others {
            faces[side.triangle as usize].has_edge[usize::from(side.side)] = false;
        }
        if let [neighbour] = others {
            let normal = faces[neighbour.triangle as usize].normal;
            let is_same_way = neighbour.is_forward == first.is_forward;
            let across = if is_same_way { normal } else { -normal };
            let face = &mut faces[first.triangle as usize];
            face.across[usize::from(first.side)] = across;
            if normal != DVec3::ZERO && (face.normal + across).length() < FLAT {
                face.has_edge[usize::from(first.side)] = false;
            }
        } else {
            for corner in first.edge {
                corners[corner as usize].spread = UNKNOWN;
            }
        }
    }
    for (face, numbers) in faces.iter_mut().zip(&welded.corners) {
        let around = numbers.map(|corner| corners[corner as usize].spread);
        face.is_sharp = around.map(|spread| spread > FLAT);
        face.spread = face.own_spread(around);
    }
    faces
}

impl ContactFace {
    /// Returns the spread of the triangle. `around` contains, for each corner, the largest distance of a normal around the corner from the normal of the
    /// triangle that owns the corner.
    fn own_spread(&self, around: [f64; 3]) -> f64 {
        if self.normal == DVec3::ZERO {
            return UNKNOWN;
        }
        let mut spread = 0.0_f64;
        for (k, around) in around.into_iter().enumerate() {
            if self.has_edge[k] {
                spread = spread.max(match self.across[k] == DVec3::ZERO {
                    true => UNKNOWN,
                    false => (self.normal + self.across[k]).length(),
                });
            }
            if self.has_corner[k] {
                spread = spread.max(around);
            }
        }
        if spread > MAX_SPREAD { UNKNOWN } else { spread }
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
