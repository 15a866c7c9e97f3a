//! MJCF reader \[MJCF\], which converts the text of a MuJoCo model to links and joints. Each error contains its file and line.
//!
//! | file | content |
//! |---|---|
//! | `model` | what the elements of one file refer to: settings, default classes, meshes, named parts, other models |
//! | `compiler` | settings of `<compiler>`: units of angles, Euler sequences, folders of meshes |
//! | `classes` | `<default>` classes, and attributes of elements with their defaults |
//! | `orientation` | orientations as quaternions, Euler angles, axes or matrices, and poses of elements |
//! | `geom` | `<geom>` and mesh assets → shapes of links |
//! | `joint` | `<joint>` → joints |
//! | `placed` | children of a body in the frames of `<frame>`, `<replicate>` and `<attach>` |
//! | `bodies` | the tree of bodies → a robot |
//! | `equality` | `<equality><joint>` → mimicking joints |
//! | `limits` | limits of counts |
//!
//! The reader uses the elements that place bodies and sites, and the shapes that skin can cover. A note lists the kinds of the other elements.

mod bodies;
mod classes;
mod compiler;
mod equality;
mod geom;
mod joint;
mod limits;
mod model;
mod orientation;
mod placed;

pub(super) use bodies::read_mjcf;
