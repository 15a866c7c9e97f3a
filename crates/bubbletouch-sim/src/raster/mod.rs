//! Pictures of surfaces in orthographic projection, with soft light and outlines.
//!
//! The input is spheres, or a surface with a function for the first hit of a ray. A [`Canvas`] computes the hits of all rays, and shading computes the colours
//! of its pixels.

mod canvas;
pub mod pixels;
mod shading;

pub use canvas::{Canvas, Hit, SurfaceHit, three_quarter_view, view_from};
pub use shading::{BACKGROUND, Lighting, Rgb};
