//! Presses of patches of any layout: a search tree finds the taxels near each sphere.
//!
//! | stage | input → output |
//! |---|---|
//! | `near_spheres` | a sphere and taxels → the deflections that contact requires |
//! | `press` | objects and poses → deflections and contacts |
//! | `path` | a direction → presses from step to step along it |
//! | `approach` | a direction → first contact, and presses past it |
//! | `approach_force` | force → travel |

mod approach;
mod approach_force;
mod near_spheres;
mod path;
mod press;

pub use approach::Approach;
pub(super) use press::deflect;
pub(crate) use press::deflect_with_contacts;
