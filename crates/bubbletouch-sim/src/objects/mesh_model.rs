//! A triangle mesh as an object of its own: what the contact kernel needs to know of it beforehand.

use crate::geometry::Aabb;
use crate::mesh::{Bvh, TriangleMesh, Welded};
use glam::{DMat3, DQuat, DVec3};
use std::sync::Arc;

/// A mesh that taxels can touch, exactly; both sides of a triangle are solid. Copies share their data.
#[derive(Clone, Debug)]
pub struct MeshModel {
    data: Arc<Data>,
}

#[derive(Debug)]
struct Data {
    mesh: TriangleMesh,
    bvh: Bvh,
    /// n_triangles, in the tree's order.
    faces: Vec<ContactFace>,
}

/// One triangle's share of the contact: its face, and those edges and corners that no earlier triangle has.
#[derive(Clone, Copy, Debug)]
pub struct ContactFace {
    /// Unit; zero if the triangle is too thin to have one.
    pub normal: DVec3,
    /// Across each side the neighbour's unit normal, as if it ran along the side in the same direction as this triangle (so
    /// about minus this triangle's where the surface is smooth); zero if there is not exactly one, or it is too thin.
    pub across: [DVec3; 3],
    /// Whether the side from corner k to the next is this triangle's.
    pub has_edge: [bool; 3],
    /// Whether the corner is this triangle's.
    pub has_corner: [bool; 3],
}

impl MeshModel {
    /// Prepares a mesh; a few microseconds a triangle.
    pub fn new(mesh: TriangleMesh) -> Self {
        let bvh = Bvh::new(&mesh);
        let faces = contact_faces(&mesh, &Welded::new(&mesh));
        let faces = (0..faces.len()).map(|place| faces[bvh.number(place)]);
        let faces = faces.collect();
        Self {
            data: Arc::new(Data { mesh, bvh, faces }),
        }
    }

    /// The mesh, metres.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.data.mesh
    }

    /// Its tree of boxes.
    pub fn bvh(&self) -> &Bvh {
        &self.data.bvh
    }

    /// n_triangles, in the tree's order.
    pub fn faces(&self) -> &[ContactFace] {
        &self.data.faces
    }

    /// The box around the mesh, metres.
    pub fn bounds(&self) -> Aabb {
        self.data.bvh.bounds()
    }

    /// The box around the mesh turned about its origin.
    pub fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        let rotation = DMat3::from_quat(rotation);
        let corners = self.corners().map(|corner| rotation * corner);
        let points = corners.map(|point| Aabb {
            min: point,
            max: point,
        });
        Aabb::around(points).expect("a mesh has at least one triangle")
    }

    /// Each vertex that a triangle has, once.
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
            // Until shared below; the sides of a triangle with a corner twice are shared with nobody.
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
