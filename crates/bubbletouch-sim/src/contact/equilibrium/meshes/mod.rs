//! Contacts of free meshes with taxels, planes, spheres and other meshes.
//!
//! | file | content |
//! |---|---|
//! | `reach` | deflection of a taxel by the parts of a mesh |
//! | `contacts` | all contacts of two shapes of which at least one is a mesh |
//! | `points` | contacts of corners and spheres with a mesh |
//! | `ridges` | contacts of the ridges of two meshes |
//! | `near` | corners and ridges of a mesh that are near another shape |
//! | `overlap` | depth of two overlapping shapes |

mod contacts;
mod found;
mod near;
mod overlap;
mod points;
mod reach;
mod ridges;

pub(super) use contacts::{each_below_plane, each_contact};
pub(super) use found::{Depth, Placed, Range};
pub use overlap::overlap;
pub(super) use reach::{MeshOnSkin, MeshReach};
