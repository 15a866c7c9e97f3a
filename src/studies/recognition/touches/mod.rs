//! Touches that are drawn from placements (distributions of touch poses).

pub mod drawn_touches;
pub mod scaled_poses;
