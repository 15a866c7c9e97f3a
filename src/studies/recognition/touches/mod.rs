//! Touches drawn from placements.

pub mod drawn_touches;
pub mod scaled_poses;
