//! The parameters of SkinSim \[SK\], which the quasi-static model was built to replace: each taxel a body on a spring-loaded joint in a
//! dynamics engine; reported to be unstable near 280 joints. Springs and dampers are forces that its plug-in sets before each step.

use crate::world::Taxel;

/// m, kg.
pub const TAXEL_MASS: f64 = 1e-3;
/// k, N/m.
pub const STIFFNESS: f64 = 16.37;
/// What the taxels of a patch hang on, kg; its published model builder keeps it "not too small because of stability".
pub const BASE_MASS: f64 = 0.01;
/// c, N·s/m.
pub const DAMPING: f64 = 0.13;
/// Δt, seconds.
pub const DT: f64 = 0.5e-3;
/// Joints near which it was reported to be unstable.
pub const UNSTABLE_JOINTS: usize = 280;

/// The taxel, of a radius and a stroke that are not told there, metres.
pub fn taxel(radius: f64, stroke: f64) -> Taxel {
    Taxel {
        radius,
        stiffness: STIFFNESS,
        damping: DAMPING,
        stroke,
    }
}
