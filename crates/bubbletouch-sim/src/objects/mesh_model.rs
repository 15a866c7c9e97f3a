//! Triangle mesh as an object, with precomputed data for contacts.

use crate::geometry::Aabb;
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
        let bvh = Bvh::new(&mesh);
        let faces = contact_faces(&mesh, &Welded::new(&mesh));
        let faces = (0..faces.len()).map(|place| faces[bvh.number(place)]);
        let faces = faces.collect();
        Self {
            data: Arc::new(Data { mesh, bvh, faces }),
        }
    }

    /// Returns the triangle mesh, metres.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.data.mesh
    }

    /// Returns the tree of the triangles' bounding boxes.
    pub fn bvh(&self) -> &Bvh {
        &self.data.bvh
    }

    /// Returns the contact data per triangle, in the order of the tree.
    pub fn faces(&self) -> &[ContactFace] {
        &self.data.faces
    }

    /// Returns the bounding box of the mesh, metres.
    pub fn bounds(&self) -> Aabb {
        self.data.bvh.bounds()
    }

    /// Returns the bounding box of the mesh after a rotation about its origin, metres.
    pub fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        let rotation = DMat3::from_quat(rotation);
        let corners = self.corners().map(|corner| rotation * corner);
        let points = corners.map(|point| Aabb {
            min: point,
            max: point,
        });
        Aabb::around(points).expect("a mesh has at least one triangle")
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
            // Initially all sides; shared ones are removed below. The sides of a triangle with a repeated corner are not shared.
            has_edge: [true; 3],
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
