//! Objects: creates contact models ([`Model`]) from shapes, meshes or spheres.
//!
//! | from | by | gives |
//! |---|---|---|
//! | a [`Catalogue`] of [`Solid`]s (TOML, mm) | [`pack`] | few spheres, surface within a stated error |
//! | a [`Hand`] with posed fingers | [`pack`] | few spheres, surface within a stated error |
//! | the vertices of a [mesh](crate::mesh) | [`vertex_spheres`] | one sphere per vertex, as in the original \[BT\] |
//! | a [`TriangleMesh`](crate::mesh::TriangleMesh) | [`MeshModel::new`] | the triangles themselves |
//! | a [`TriangleMesh`](crate::mesh::TriangleMesh) and a radius | [`MeshModel::rounded`], [`MeshModel::capsule`] | all points within the radius of a triangle |
//! | a CSV file | [`read_spheres`] | the spheres of the file |
//!
//! [`surface_error`] measures the distance between spheres and a solid.

mod block;
mod catalogue;
mod difference;
mod fit;
mod hand;
mod lathe;
pub(crate) mod mesh_blocks;
mod mesh_model;
mod model;
mod outline;
mod pack;
mod prism;
mod shape;
mod solid;
mod solid_mass;
mod solid_toml;
mod sphere_clusters;
mod sphere_csv;
mod sphere_mass;
mod sphere_sweep;
mod sphere_union;
mod surface_error;
mod surface_patch;
mod torus;
mod vertex_spheres;

pub use catalogue::{Catalogue, Entry};
pub use fit::MAX_SPHERES;
pub use hand::{FingerPose, Hand};
pub(crate) use mesh_model::FLAT;
pub use mesh_model::{ContactFace, MeshModel};
pub use model::Model;
pub use pack::pack;
pub use shape::Shape;
pub use solid::{Part, Solid};
pub use sphere_clusters::SphereClusters;
pub(crate) use sphere_clusters::{Cluster, MAX_IN_CLUSTER};
pub use sphere_csv::{read_spheres, write_spheres};
pub use sphere_union::{Represented, Sphere, SphereUnion};
pub use surface_error::{SurfaceError, surface_error};
pub(crate) use vertex_spheres::nearest_distances;
pub use vertex_spheres::vertex_spheres;

/// Named object that a patch can touch.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name of the object, unique within its set, such as `mug` or `can_68x40`.
    pub name: String,
    /// Contact model in the object's frame. The object lies on z = 0 with z up, centred in x and y, unless its source defines another frame.
    pub model: Model,
    /// Number of solid parts of the object (1 for a mesh).
    pub n_parts: usize,
}

impl Object {
    /// Creates an object with one part, such as a mesh.
    pub fn of_one_part(name: impl Into<String>, model: Model) -> Self {
        Self {
            name: name.into(),
            model,
            n_parts: 1,
        }
    }
}
