//! Sphere packing: a mesh and a tolerance → a union of few spheres.

mod ball;
mod cells;
mod certificate;
mod cover_surface;
mod pack;
mod packing_error;
mod sampling;
mod set_cover;
mod target;

pub use pack::{Packing, pack_mesh};
pub use packing_error::{PackingError, Spread, packing_error};
pub use target::Body;

pub(crate) fn knob(name: &str, default: f64) -> f64 {
    std::env::var(name)
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(default)
}
