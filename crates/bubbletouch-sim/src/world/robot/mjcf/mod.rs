//! MJCF reader \[MJCF\], which converts the text of a MuJoCo model to links and joints. Each error contains its file and line.
//!
//! | file | content |
//! |---|---|
//! | `source` | the text of the model with the text of its `<include>`s |
//! | `compiler` | settings of `<compiler>`: units of angles, Euler sequences, folders of meshes |
//! | `classes` | `<default>` classes, and attributes of elements with their defaults |
//! | `orientation` | orientations as quaternions, Euler angles, axes or matrices, and poses of elements |
//! | `frames` | children of a body in the frames of `<frame>` and `<replicate>` |
//! | `geom` | `<geom>` and mesh assets → shapes of links |
//! | `joint` | `<joint>` → joints |
//! | `equality` | `<equality><joint>` → mimicking joints |
//! | `submodels`, `attach` | models in other files, and their bodies that `<attach>` adds |
//! | `model` | the tree of bodies → a robot |
//!
//! The reader uses the elements that place bodies and sites, and the shapes that skin can cover. A note lists the kinds of the other elements.

mod attach;
mod classes;
mod compiler;
mod equality;
mod frames;
mod geom;
mod joint;
mod model;
mod orientation;
mod source;
mod submodels;

pub(super) use model::read_mjcf;
