//! Presses of flat grids along their axis: the kernel works along rows of taxels.
//!
//! | stage | input → output |
//! |---|---|
//! | `lines` | a grid → the places of its rows and columns |
//! | `placed_objects` | objects and poses → objects in the frame of the grid |
//! | `sphere_search` | sphere unions → the spheres that reach a taxel |
//! | `placed_sphere` | a sphere → the deflections of the taxels under it |
//! | `block_search` | a mesh → the triangles that taxels may touch |
//! | `pair_batch` | pairs of a taxel and a triangle → the height at which the triangle stops the taxel |
//! | `envelope` | meshes → the height at which they stop each taxel |
//! | `grid_values` | deflections or heights of all taxels, and the rectangle that a press reaches |
//! | `output_buffer` | deflections → a row of the caller's array |
//! | `press` | travel → deflections |
//! | `force` | force → travel |

mod block_search;
mod envelope;
pub(super) mod force;
mod grid_values;
mod lines;
mod output_buffer;
mod pair_batch;
mod placed_objects;
mod placed_sphere;
mod press;
mod sphere_search;

pub(super) use grid_values::GridValues;
pub use lines::Lines;
pub(super) use output_buffer::OutputBuffer;
pub use output_buffer::Row;
pub(super) use press::{GridPress, GridScratch};
