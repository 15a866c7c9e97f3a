//! Balls inside a mesh, and the largest that a point of its surface allows.

use super::target::{Body, Target};
use crate::objects::Sphere;
use glam::DVec3;

/// A ball around a point inside a mesh. Inflated by a part of the tolerance it is a sphere of the packing.
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

/// The share of the tolerance that spheres reach outside the mesh; of what they leave open inside it all is used.
///
/// With 1 the spheres are fewest (a quarter fewer than with ½), but the middle of their rough surface lies half the tolerance
/// outside the mesh, and a skin feels it: on eight scans the mean deflection error is 0.059 mm at a tolerance of 0.1 mm with 1,
/// 0.033 with 0.6 and 0.027 with 0.45.
const PROTRUSION: f64 = 0.5;

/// How far apart the highest and the lowest places of the spheres' surface may be, when they are made for a tolerance `e`.
pub(super) fn relief(e: f64) -> f64 {
    (1.0 + PROTRUSION) * e
}

/// Distance beside the centre of a ball on the surface, relative to the tolerance, at which it is tested whether the centre lies in the solid.
/// It must be less than the rounding reserve of [`Target::new`], since it adds to the protrusion; smaller: rounding decides.
const BESIDE: f64 = 1e-7;

impl Ball {
    /// Returns the largest ball that touches the surface from inside at `foot`; on a sheet the ball around `foot`.
    pub fn at(target: &Target, foot: DVec3, normal: DVec3) -> Self {
        let largest = Self::largest(target, foot, -normal, 0.0, target.largest_radius());
        largest.unwrap_or(Self::on_surface(foot))
    }

    /// Returns the largest ball that touches the surface at the point nearest to the shifted centre of this ball; on a sheet the ball around
    /// this point. Returns `None` if the shifted centre is outside a solid.
    pub fn beside(&self, target: &Target, shift: DVec3) -> Option<Self> {
        let center = self.center + shift;
        let nearest = target.surface.closest(center, f64::INFINITY)?;
        if target.body == Body::Sheet {
            return Some(Self::on_surface(nearest.point));
        }
        let is_inside = shift.length() < self.depth || !target.surface.is_outside(center, &nearest);
        if nearest.distance <= 0.0 || !is_inside {
            return None;
        }
        let inward = (center - nearest.point) / nearest.distance;
        Self::largest(target, nearest.point, inward, 0.0, target.largest_radius())
    }

    /// Returns whether the centre is in the solid. The centre of a ball on the surface lies on a face, which need not bound the solid where
    /// parts overlap.
    pub fn has_center_in(&self, target: &Target) -> bool {
        if target.body == Body::Sheet {
            return true;
        }
        if self.depth > 0.0 {
            return target.surface.contains(self.center);
        }
        let lift = BESIDE * target.e * target.normal_at(self.center);
        target.surface.contains(self.center - lift) || target.surface.contains(self.center + lift)
    }

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
    /// so t shrinks from `limit` until no such q is left. `None` if the centre is beyond a wall
    /// thinner than the slack, and for a sheet.
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
        // The ray inward meets a point q with u·(q − foot) = |q − foot|, which makes the bound (|q − foot| + s) / 2; from
        // there on queries are cheap, since they are not far from the surface.
        let beyond_foot = 1e-9 * limit..2.0 * limit;
        let hit = surface.bvh().first_hit(foot, inward, beyond_foot);
        let mut t = hit.map_or(limit, |hit| {
            (0.5 * (hit.along + slack)).min(limit).max(slack)
        });
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
                let ball = Self {
                    center,
                    depth: nearest.distance,
                    foot,
                };
                // Nothing lies between the foot and the centre of a ball without slack.
                let is_inside = slack == 0.0
                    || (center - nearest.point).dot(surface.pseudonormal(&nearest)) < 0.0;
                return is_inside.then_some(ball);
            }
            t = next.max(slack);
        }
        None
    }

    /// The last resort: around a point of the surface itself. It covers what is within [`relief`] of it, whatever the
    /// surface is like.
    pub fn on_surface(foot: DVec3) -> Self {
        Self {
            center: foot,
            depth: 0.0,
            foot,
        }
    }

    /// The sphere that reaches [`PROTRUSION`] of `e` outside the mesh, no more.
    pub fn sphere(&self, e: f64) -> Sphere {
        Sphere {
            center: self.center,
            radius: self.depth + PROTRUSION * e,
        }
    }

    /// How far from the centre a point of the surface may be for the sphere to come within `e` of it.
    pub fn reach(&self, e: f64) -> f64 {
        self.depth + relief(e)
    }

    /// Half the width of what it covers of a flat face at the distance of its depth.
    pub fn half_width(&self, e: f64) -> f64 {
        let relief = relief(e);
        (relief * (2.0 * self.depth + relief)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packing::brick::brick;

    #[test]
    fn the_largest_ball_in_a_box_is_as_deep_as_the_nearest_other_face_allows() {
        let surface = brick();
        let target = Target::new(&surface, Body::Solid, 0.1).unwrap();
        for (x, y) in [(0.3, 0.2), (2.75, 0.1), (2.9, 1.5), (-1.0, -1.9)] {
            let foot = DVec3::new(x, y, 1.0);
            // Tangent to the top at the foot, and to the bottom or the nearest side.
            let to_side = (3.0 - f64::abs(x)).min(2.0 - f64::abs(y));
            let depth = f64::min(1.0, to_side);
            let ball = Ball::largest(&target, foot, DVec3::NEG_Z, 0.0, 5.0).unwrap();
            assert!((ball.depth - depth).abs() < 1e-7, "{ball:?} at {foot}");
            assert!((ball.center - (foot + depth * DVec3::NEG_Z)).length() < 1e-7);
        }
    }

    #[test]
    fn slack_lets_the_centre_sink_as_far_as_other_faces_intrude_that_much() {
        let surface = brick();
        let target = Target::new(&surface, Body::Solid, 0.1).unwrap();
        // 0.5 from a side: t − 0.2 = 0.5 where the side is the nearest.
        let foot = DVec3::new(2.5, 0.0, 1.0);
        let ball = Ball::largest(&target, foot, DVec3::NEG_Z, 0.2, 5.0).unwrap();
        assert!((ball.center.z - 0.3).abs() < 1e-7, "{ball:?}");
        assert!((ball.depth - 0.5).abs() < 1e-7, "{ball:?}");
    }
}
