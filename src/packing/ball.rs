//! Balls inside a mesh, and the largest that a point of its surface allows.

use super::target::{Body, Target};
use crate::objects::Sphere;
use glam::DVec3;

/// A ball around a point inside a mesh. Inflated by the tolerance it is a sphere of the packing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    /// Inside the mesh, or on it.
    pub center: DVec3,
    /// From there to the nearest point of the mesh, metres.
    pub depth: f64,
    /// A point of the surface for whose sake it is there.
    pub foot: DVec3,
}

/// Queries after which a ball is given up; most take three to eight.
const MAX_STEPS: usize = 60;

impl Ball {
    /// The ball of largest t with centre `foot + t·inward` and no surface nearer to its centre than t − `slack`.
    ///
    /// Without slack it is the largest ball inside the mesh that touches it at the foot \[MBC\]; with slack, surface may
    /// reach that far into the ball of radius t, so bumps lower than the slack do not count. For a point q of the
    /// surface, u inward and s the slack,
    ///
    /// ```text
    /// |foot + t u − q| ≥ t − s   ⟺   t ≤ (|q − foot|² − s²) / (2 (u·(q − foot) − s))   if u·(q − foot) > s
    /// ```
    ///
    /// so t shrinks from `limit` until no such q is left. `None` if the centre is not inside the mesh, and for a sheet.
    pub fn largest(
        target: &Target,
        foot: DVec3,
        inward: DVec3,
        slack: f64,
        limit: f64,
    ) -> Option<Self> {
        if target.body == Body::Sheet {
            return None;
        }
        let surface = target.surface;
        let mut t = limit;
        for _ in 0..MAX_STEPS {
            let center = foot + t * inward;
            // The foot is no farther than t, so there is a nearest point.
            let nearest = surface.closest(center, t * (1.0 + 1e-6))?;
            let offset = nearest.point - foot;
            let rise = inward.dot(offset) - slack;
            let next = (offset.length_squared() - slack * slack) / (2.0 * rise);
            // A hair of room, so that the foot itself does not count.
            let is_clear = nearest.distance >= (t - slack) * (1.0 - 1e-9);
            if is_clear || rise <= 0.0 || next >= t {
                let is_inside = nearest.distance > 0.0 && !surface.is_outside(center, &nearest);
                let depth = nearest.distance;
                return is_inside.then_some(Self {
                    center,
                    depth,
                    foot,
                });
            }
            t = next.max(slack);
        }
        None
    }

    /// The last resort: around a point of the surface itself. It reaches 2e along it, whatever the surface is like.
    pub fn on_surface(foot: DVec3) -> Self {
        Self {
            center: foot,
            depth: 0.0,
            foot,
        }
    }

    /// The sphere that reaches `e` outside the mesh, no more.
    pub fn sphere(&self, e: f64) -> Sphere {
        Sphere {
            center: self.center,
            radius: self.depth + e,
        }
    }

    /// How far from the centre a point of the surface may be for the sphere to come within `e` of it.
    pub fn reach(&self, e: f64) -> f64 {
        self.depth + 2.0 * e
    }

    /// Half the width of what it covers of a flat face at the distance of its depth.
    pub fn half_width(&self, e: f64) -> f64 {
        2.0 * (e * (self.depth + e)).sqrt()
    }
}
