//! Contact with meshes: the heights at which triangles stop a taxel.
//!
//! | stage | input → output |
//! |---|---|
//! | `directions` | the axis of a part of a mesh → bounds of the directions of contact; a box → its shadow along a line |
//! | `taxel_lines` | eight taxels of any layout → their axes in the frame of a mesh, and a thick line around them |
//! | `line_search` | a line, and a box or triangle → whether they may touch, with a lower bound of the height |
//! | `leaf_stops` | a mesh and eight taxels → heights and triangles |
//! | `skin_mesh` | a mesh at a pose: rules for triangles behind the substrate and for substrates inside the mesh |

pub(super) mod directions;
mod leaf_stops;
mod line_search;
pub(super) mod skin_mesh;
mod taxel_lines;

pub(super) use leaf_stops::{LeafStops, SearchStack, stop_leaf};
