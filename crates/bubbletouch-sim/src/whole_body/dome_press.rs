//! Presses of spheres on a spherical patch, in which a sphere covers one interval of each ring of taxels.
//!
//! The axis of every taxel passes through the centre. With t = c·n and Q = |c|² − S² contact with the sphere therefore requires `δ = √(t² − Q) − (t − R)` for
//! any taxel. The deflection is positive where t is above
//!
//! ```text
//! √Q                if 0 ≤ Q ≤ R²: for smaller t the sphere misses the taxel's axis
//! (R² + Q) / (2R)   if Q > R²: for smaller t the sphere is above the taxel at rest
//! ```
//!
//! With B = R − s − ρ the sphere is in front of the substrate (module `law`) where `t + √(t² − Q) ≥ B`. The inequality holds where t is at least B or (B² + Q)
//! / (2B). On a ring t = A + A' cos(φ − φ_c), so the condition selects an interval.

use super::dome_patch::DomePatch;
use super::object_press::Pushed;
use super::patch_state::PatchState;
use crate::contact::law;
use crate::contact::object_at::PlacedSphere;
use crate::world::DomeRing;
use glam::Vec3Swizzles;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Bound of rounding errors in the angles of an interval, radians: far above 1e-16 and far below any measurable angle.
const ROUNDING: f64 = 1e-9;
/// Bound of the rounding error of an arc cosine, radians: near 1 the arc cosine turns an error of 1e-16 into an error of 1e-8.
const ACOS_ROUNDING: f64 = 1e-7;

impl Pushed for DomePatch {
    /// Always returns true: the caller has already tested the bounding ball, and a dome has no narrower bound.
    #[inline(always)]
    fn is_near(&self, _: &PlacedSphere) -> bool {
        true
    }

    #[inline(always)]
    fn push(&self, state: &mut PatchState, sphere: &PlacedSphere) {
        let PlacedSphere { center, reach } = *sphere;
        let radius = self.dome.radius();
        let power = center.length_squared() - reach * reach;
        let substrate = self.substrate;
        let behind = substrate.min((substrate * substrate + power) / (2.0 * substrate));
        let least = self.least_along(power).max(behind);
        let across = center.xy().length();
        let angle = center.y.atan2(center.x);
        for (row, ring) in self.dome.rings().iter().enumerate() {
            let (along, around) = (center.z * ring.cos, across * ring.sin);
            let Some(half_width) = half_width(least - along, around) else {
                continue;
            };
            let directions = &self.dome.directions()[ring.first..ring.first + ring.n];
            let slope = ring.sin * center.xy();
            let needed = |column: usize| {
                let t = along + slope.dot(directions[column]);
                let q = t * t - power;
                match q > 0.0 && t >= behind {
                    true => law::deflection(q, t - radius),
                    false => 0.0,
                }
            };
            for columns in covered(ring, angle, half_width) {
                if !columns.is_empty() {
                    state.push_row(row, ring.first, columns, needed);
                }
            }
        }
    }
}

/// Returns the largest angle φ, radians, for which `around · cos φ` is at least `least`, plus a rounding margin. Returns `None` if there is no such angle.
#[inline(always)]
fn half_width(least: f64, around: f64) -> Option<f64> {
    if least > around * (1.0 + ROUNDING) {
        return None;
    }
    if least <= -around {
        return Some(PI);
    }
    Some((least / around).min(1.0).acos() + ACOS_ROUNDING)
}

/// Returns the taxels of a ring within `half_width` radians of an angle, as ranges of indices in the ring. There are up to three ranges if the ring is
/// closed.
#[inline(always)]
fn covered(ring: &DomeRing, angle: f64, half_width: f64) -> [Range<usize>; 3] {
    [-TAU, 0.0, TAU].map(|turn| {
        let middle = (angle + turn - ring.start) / ring.step;
        let spread = half_width / ring.step + ROUNDING;
        let first = (middle - spread).ceil().max(0.0) as usize;
        let last = (middle + spread).floor();
        // A cast of a negative number would give the first column.
        let end = if last < 0.0 { 0 } else { last as usize + 1 };
        first..end.min(ring.n)
    })
}
