//! Contact with meshes: the heights at which triangles stop a taxel.
//!
//! | stage | input → output |
//! |---|---|
//! | `taxel_lines` | eight taxels of any layout → their axes in the frame of a mesh, and a thick line around them |
//! | `line_search` | lines, and boxes or triangles → pairs that may touch, with lower bounds of the heights |
//! | `leaf_stops` | a mesh and eight taxels → heights and triangles |
//! | `skin_mesh` | a mesh at a pose: rules for triangles behind the substrate and for substrates inside the mesh |

mod eight;
mod leaf_stops;
mod line_search;
pub(super) mod skin_mesh;
mod taxel_lines;

pub(super) use leaf_stops::{LeafStops, SearchStack, stop_leaf};
