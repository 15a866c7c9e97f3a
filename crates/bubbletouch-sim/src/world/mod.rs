//! World: taxels, layouts, touches and robots, from which poses of patches and objects are computed.
//!
//! In the **patch frame** the taxels of a flat [`Patch`] rest in the plane z = 0 with their axes along +z, away from the substrate. On other [`Layout`]s each
//! taxel has its own position and axis. In the **table frame** z points up, and objects rest on z = 0.
//!
//! | stage | input → output |
//! |---|---|
//! | `layouts` | a pitch and a shape → places and axes of taxels ([`Layout`]) |
//! | `patch`, `taxel`, `shear` | a layout and properties of taxels → a [`Patch`] and its search tree |
//! | `neighbours` | a patch → the neighbours of each taxel ([`Neighbours`]) |
//! | `rest` | an object → its resting poses on a table ([`RestPose`]) |
//! | `placement`, `touches` | ranges of offsets, turns and depths → [`Touch`]es |
//! | `robot` | URDF or MJCF → links and joints ([`Robot`]) |
//! | `motion`, `trajectory` | way points → poses and joint positions over time |
//! | `human_touch` | a kind of touch by a hand → poses of fingers over time ([`HumanTouch`]) |

mod human_touch;
mod layouts;
mod motion;
mod neighbours;
mod patch;
mod per_taxel;
mod placement;
mod rest;
mod robot;
mod shear;
mod taxel;
mod taxel_tree;
mod touches;
mod trajectory;

pub use human_touch::{HandState, HumanTouch, TOUCH_KINDS, TouchKind, TouchRanges};
pub(crate) use layouts::Rule;
pub use layouts::{
    ArrayLayout, Dome, DomeRing, DrapeRegion, Extrusion, Layout, MAX_TAXELS, MissingTaxels,
    Projected, nearest_distances, unit_axis,
};
pub use motion::{Interpolation, JointTrajectory, Motion, Oscillation, PoseTrajectory};
pub use neighbours::Neighbours;
pub use patch::Patch;
pub(crate) use patch::{EvenGrid, Travelling};
pub use per_taxel::{PerTaxel, Taxels};
pub use placement::{Placement, RestPoses, Spread, Touch, TouchAxis};
pub use rest::{RestPose, as_modelled, stable_poses, stable_poses_about};
pub use robot::{
    Coordinate, Dimension, Joint, JointKind, Limits, Link, LinkGeometry, LinkShape, MeshFolders,
    Mimic, Robot, ShapeRole, TactileSensor,
};
pub use shear::{Shear, Shears};
pub use taxel::{Grid, ImageShape, Taxel};
pub(crate) use taxel_tree::{LEAF, Leaf, Node, PlacedTaxel, RADIUS_ROUNDING, TaxelTree};
pub use touches::{MAX_TOUCHES, TouchSource, touches};
pub use trajectory::{Phase, VelocityPlan};

/// Taxels, grids and random numbers that the tests of this folder share.
#[cfg(test)]
mod fixtures {
    use super::{Grid, Taxel};
    use glam::DVec3;
    use rand::Rng;

    pub const TAXEL: Taxel = Taxel {
        radius: 1e-3,
        stiffness: 100.0,
        damping: 0.0,
        stroke: 5e-3,
    };

    pub fn grid(nx: usize, ny: usize, pitch: f64) -> Grid {
        Grid { nx, ny, pitch }
    }

    /// Returns a vector in the cube from −1 to 1.
    pub fn vector(rng: &mut impl Rng) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| rng.gen_range(-1.0..1.0)))
    }
}
