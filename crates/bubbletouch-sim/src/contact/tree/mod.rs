//! Presses of patches of any layout: a search tree finds the taxels near each sphere.
//!
//! | stage | input → output |
//! |---|---|
//! | `near_spheres` | a sphere and taxels → the deflections that contact requires |
//! | `held_parts` | taxels and the parts that pushed them → deflections behind the substrate |
//! | `press` | objects and poses → deflections and contacts |
//! | `first_contact` | a direction → travel at first contact |
//! | `path` | a condition → presses from step to step along a direction |

mod first_contact;
mod held_parts;
mod near_spheres;
mod path;
mod press;

pub(super) use path::Path;
pub(crate) use press::press;
