//! World: taxels, layouts and touches → what presses where.
//!
//! Frames: in the **patch frame** the taxels rest in the plane z = 0 with their axes along +z, away from the substrate.
//! In the **table frame** z points up and objects rest on z = 0.

mod patch;
mod scene;
mod trajectory;

pub use patch::{Grid, Patch, Taxel};
pub use scene::Scene;
pub use trajectory::{Phase, VelocityPlan};
