//! Contact with meshes: the heights at which triangles stop a taxel.
//!
//! | stage | input → output |
//! |---|---|
//! | `swept_triangle` | a triangle and a place on a grid → the height at which the triangle stops a taxel |
//! | `taxel_lines` | eight taxels of any layout → their axes in the frame of a mesh, and a thick line around them |
//! | `line_search` | lines, and boxes or triangles → pairs that may touch, with lower bounds of the heights |
//! | `line_stop` | a triangle and an axis → the height at which the triangle stops the taxel |
//! | `leaf_stops` | a mesh and eight taxels → heights and triangles |
//! | `skin_mesh` | a mesh at a pose: rules for triangles behind the substrate and for substrates inside the mesh |

mod eight;
mod leaf_stops;
#[cfg(test)]
mod leaf_stops_laws;
mod line_search;
mod line_stop;
pub(super) mod skin_mesh;
pub(super) mod swept_triangle;
mod taxel_lines;

pub(super) use leaf_stops::{LeafStops, SearchStack, stop_leaf};
pub use swept_triangle::stopping_height;
