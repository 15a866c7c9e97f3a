//! Triangle mesh as an object, with precomputed data for contacts.
//!
//! A mesh can be rounded by a radius R: the object is then the set of all points within R of a triangle. A taxel of radius ρ touches this object where a taxel
//! of radius ρ + R would touch the triangles, so the contact of rounded shapes is exact. A capsule is a rounded line segment.

use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::mesh::primitives::check_capsule;
use crate::mesh::{Bvh, TriangleMesh, Welded};
use glam::{DMat3, DQuat, DVec3};
use std::sync::Arc;

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
    /// Contact data per triangle, in the order of the tree.
    faces: Vec<ContactFace>,
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
    /// For each side, from corner i to the next corner, whether the side belongs to this triangle (and not to the neighbouring triangle).
    pub has_edge: [bool; 3],
    /// For each corner, whether the corner belongs to this triangle (and not to another triangle with the same corner).
    pub has_corner: [bool; 3],
}

impl MeshModel {
    /// Prepares a mesh for contacts; takes a few microseconds per triangle.
    pub fn new(mesh: TriangleMesh) -> Self {
        let rounding = 0.0;
        let bvh = Bvh::new(&mesh);
        let faces = contact_faces(&mesh, &Welded::new(&mesh));
        let faces = (0..faces.len()).map(|place| faces[bvh.number(place)]);
        let faces = faces.collect();
        Self {
            data: Arc::new(Data {
                mesh,
                rounding,
                bvh,
                faces,
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

    /// Returns the contact data per triangle, in the order of the tree.
    pub fn faces(&self) -> &[ContactFace] {
        &self.data.faces
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
        let Data { bvh, faces, .. } = &*self.data;
        let triangles = bvh.triangles().iter().zip(faces);
        let corners =
            triangles.flat_map(|(triangle, face)| triangle.0.into_iter().zip(face.has_corner));
        corners.filter_map(|(corner, is_own)| is_own.then_some(corner))
    }
}

fn contact_faces(mesh: &TriangleMesh, welded: &Welded) -> Vec<ContactFace> {
    let mut has_corner_owner = vec![false; mesh.vertices().len()];
    let own = |corner: u32| !std::mem::replace(&mut has_corner_owner[corner as usize], true);
    let mut own_corner = own;
    let mut faces: Vec<ContactFace> = (0..mesh.n_triangles())
        .map(|number| ContactFace {
            normal: mesh.triangle(number).normal().unwrap_or(DVec3::ZERO),
            across: [DVec3::ZERO; 3],
            // Initially all sides; shared ones are removed below. A triangle with a repeated corner has one side, which is not shared.
            has_edge: match welded.corners[number] {
                [a, b, c] if a == b => [false, b != c, false],
                [a, b, c] if b == c || c == a => [true, false, false],
                _ => [true; 3],
            },
            has_corner: welded.corners[number].map(&mut own_corner),
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
            faces[first.triangle as usize].across[usize::from(first.side)] =
                if is_same_way { normal } else { -normal };
        }
    }
    faces
}
