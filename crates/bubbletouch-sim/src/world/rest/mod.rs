//! Resting poses of an object on a table.
//!
//! | stage | input → output |
//! |---|---|
//! | `body` | an object → its bounds and corners |
//! | `support` | an object → the height of its centre of mass for each direction of down |
//! | `descent` | a direction → the local minimum of the height, reached downhill |
//! | `basins` | all directions → the minima, with the fraction of directions that lead to each |
//! | `rest_pose` | minima → poses with their probabilities ([`RestPose`]) |

mod basins;
mod body;
mod descent;
mod rest_pose;
mod support;

pub use rest_pose::{RestPose, as_modelled, stable_poses, stable_poses_about};
