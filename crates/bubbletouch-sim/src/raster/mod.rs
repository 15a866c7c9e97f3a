//! Pictures of surfaces: orthographic, with soft light and outlines.
//!
//! Spheres, or another surface with a function for the first hit of a ray → the hits of all rays of a [`Canvas`] → the colours of its pixels.

mod canvas;
pub mod pixels;
mod shading;

pub use canvas::{Canvas, Hit, SurfaceHit, three_quarter_view, view_from};
pub use shading::{BACKGROUND, Lighting, Rgb};
