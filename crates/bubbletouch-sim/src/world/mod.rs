//! World: taxels, layouts, touches and robots → what presses where.
//!
//! Frames: in the **patch frame** the taxels of a flat [`Patch`] rest in the plane z = 0 with their axes along +z, away from the substrate;
//! on another [`Layout`] each taxel has its own place and axis.
//! In the **table frame** z points up and objects rest on z = 0.

mod array_layout;
mod basins;
mod body;
mod dome;
mod drape_region;
mod extrusion;
mod human_touch;
mod layout;
mod layout_curved;
mod layout_draped;
mod layout_flat;
mod layout_order;
mod mass;
mod motion;
mod neighbours;
mod patch;
mod per_taxel;
mod placement;
mod rest;
mod ring;
mod robot;
mod settle;
mod shear;
mod support;
mod taxel;
mod taxel_tree;
mod touches;
mod trajectory;

pub use array_layout::ArrayLayout;
pub use dome::{Dome, DomeRing};
pub use drape_region::DrapeRegion;
pub use extrusion::Extrusion;
pub use human_touch::{HandState, HumanTouch, TOUCH_KINDS, TouchKind, TouchRanges};
pub(crate) use layout::Rule;
pub use layout::{Layout, MOST_TAXELS};
pub use mass::center_of_mass;
pub use motion::{Interpolation, JointTrajectory, Motion, PoseTrajectory};
pub use neighbours::Neighbours;
pub(crate) use patch::{EvenGrid, Travelling};
pub use patch::{Patch, Taxels};
pub use per_taxel::PerTaxel;
pub use placement::{Placement, RestPoses, Spread, Touch, TouchAxis};
pub use rest::{RestPose, as_modelled, stable_poses, stable_poses_about};
pub use robot::{
    Coordinate, Dimension, Joint, JointKind, Limits, Link, LinkGeometry, LinkShape, Mimic, Robot,
    ShapeRole,
};
pub use shear::{Shear, Shears};
pub use taxel::{Grid, Taxel};
pub(crate) use taxel_tree::{LEAF, Leaf, Node, PlacedTaxel, TaxelTree};
pub use touches::{MOST_TOUCHES, TouchSource, touches};
pub use trajectory::{Phase, VelocityPlan};
