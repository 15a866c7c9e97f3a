//! Robots: links and joints, from which the poses of all links are computed. A robot is read from URDF \[URDF\] or MJCF \[MJCF\], or is one floating link.
//!
//! A robot is a tree of rigid links. Joint j connects its parent link to its child link:
//!
//! `parent_from_child = origin_j · motion_j(q_j)`, with q_j the joint's coordinates:
//!
//! | joint | coordinates | motion |
//! |---|---|---|
//! | fixed | none | none |
//! | revolute, continuous | angle, rad | turn about the axis |
//! | prismatic | travel, m | shift along the axis |
//! | planar | x, y, m; theta, rad | shift in the plane across the axis, then turn about it |
//! | floating | x, y, z, m; roll, pitch, yaw, rad | shift, then turn: `Rz(yaw) Ry(pitch) Rx(roll)` |
//! | ball | roll, pitch, yaw, rad | turn about the anchor: `Rz(yaw) Ry(pitch) Rx(roll)` |
//!
//! In MJCF, hinges turn about an axis through their anchor. Hinges and slides do not move their link at their reference position `ref`. Several joints can move
//! one link. The joints of one link act one after the other, in the order of the file.
//!
//! Links, joints and their origins determine poses and must be valid. A joint whose axis or type cannot be read is fixed. Limits, shapes and `<mimic>` that
//! cannot be read are omitted. Each of these cases is reported in a note of the robot.
//!
//! The **positions** of a robot are the coordinates of its joints in the order of its file, without fixed and mimicking joints.

mod coordinate;
mod joint;
mod link;
mod mesh_folders;
mod mimic;
mod mjcf;
mod model;
mod origin;
mod robot_file;
mod source;
mod tactile;
mod text;
mod tree;
mod urdf;

pub use coordinate::{Coordinate, Dimension};
pub use joint::{Joint, JointKind, Limits, Mimic};
pub use link::{Link, LinkGeometry, LinkShape, ShapeRole};
pub use mesh_folders::MeshFolders;
pub use model::Robot;
pub use tactile::TactileSensor;
