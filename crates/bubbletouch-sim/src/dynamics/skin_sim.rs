//! Parameters of SkinSim \[SK\], the simulator that the quasi-static model was built to replace. In SkinSim, each taxel is a body on a spring-loaded joint
//! in a dynamics engine. A plug-in sets the spring and damper forces before each step. SkinSim was reported to be unstable near 280 joints.

use crate::world::Taxel;

/// Mass of a SkinSim taxel, kg.
pub const TAXEL_MASS: f64 = 1e-3;
/// Spring stiffness of a SkinSim taxel, N/m.
pub const STIFFNESS: f64 = 16.37;
/// Mass of the body that carries the taxels of a patch, kg; the published model builder makes this mass "not too small because of stability".
pub const BASE_MASS: f64 = 0.01;
/// Damping of a SkinSim taxel, N·s/m.
pub const DAMPING: f64 = 0.13;
/// Time step of SkinSim, seconds.
pub const DT: f64 = 0.5e-3;
/// Number of joints near which SkinSim was reported to be unstable.
pub const UNSTABLE_JOINTS: usize = 280;

/// Returns SkinSim's taxel with a given radius and stroke (metres), which the paper does not state.
pub fn taxel(radius: f64, stroke: f64) -> Taxel {
    Taxel {
        radius,
        stiffness: STIFFNESS,
        damping: DAMPING,
        stroke,
    }
}
