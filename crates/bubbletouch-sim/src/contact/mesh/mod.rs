//! Contact with meshes: the heights at which triangles stop a taxel.

pub(super) mod skin_mesh;
pub(super) mod swept_triangle;

pub use swept_triangle::stopping_height;
