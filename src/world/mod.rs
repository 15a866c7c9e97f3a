//! World: taxels, layouts, touches and robots → what presses where.
//!
//! Frames: in the **patch frame** the taxels rest in the plane z = 0 with their axes along +z, away from the substrate.
//! In the **table frame** z points up and objects rest on z = 0.

mod basins;
mod body;
mod mass;
mod motion;
mod patch;
mod placement;
mod rest;
mod robot;
mod scene;
mod settle;
mod support;
mod touches;
mod trajectory;

pub use body::Body;
pub use mass::center_of_mass;
pub use motion::{Interpolation, JointTrajectory, Motion, PoseTrajectory};
pub use patch::{Grid, Patch, Taxel};
pub use placement::{Placement, RestPoses, Spread, Touch, TouchAxis};
pub use rest::{RestPose, as_modelled, stable_poses, stable_poses_about};
pub use robot::{
    Coordinate, Dimension, Joint, JointKind, Limits, Link, LinkGeometry, LinkShape, Mimic, Robot,
    ShapeRole,
};
pub use scene::Scene;
pub use touches::{TouchSource, touches};
pub use trajectory::{Phase, VelocityPlan};
