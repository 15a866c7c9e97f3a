//! What random scenes of touch are drawn from.
#![allow(dead_code, reason = "each test file uses some of them")]

use bubbletouch::geometry::Pose;
use bubbletouch::random::Seed;
use bubbletouch::world::Taxel;
use glam::{DQuat, DVec3};
use rand::Rng;

/// A soft taxel without a damper.
pub const TAXEL: Taxel = Taxel {
    radius: 1e-3,
    stiffness: 100.0,
    damping: 0.0,
    stroke: 5e-3,
};

/// The random numbers of one case of a law.
pub fn rng(law: &str, case: u64) -> impl Rng {
    Seed::new(7).named(law).numbered(case).rng()
}

/// A unit vector.
pub fn direction(rng: &mut impl Rng) -> DVec3 {
    let mut random = || rng.gen_range(-1.0..1.0);
    DVec3::new(random(), random(), random()).normalize_or(DVec3::X)
}

/// Any rotation, this far from the origin, metres.
pub fn random_pose(rng: &mut impl Rng, distance: f64) -> Pose {
    let turn = rng.gen_range(0.0..6.0) * direction(rng);
    Pose::new(DQuat::from_scaled_axis(turn), distance * direction(rng))
}
