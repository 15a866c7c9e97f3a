//! An object in the air: how far it certainly falls before it meets a skin.

use super::free_object::{FreeObject, PlacedSkin};
use crate::geometry::Aabb;
use glam::DVec3;

/// What is below an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fall {
    /// A skin is too near to say.
    Near,
    /// Nothing for this far, metres.
    Free(f64),
    /// No skin at all.
    Endless,
}

/// What the object meets on its way `down` (unit) from where its centre of mass is.
pub(super) fn fall(object: &FreeObject, skins: &[PlacedSkin], center: DVec3, down: DVec3) -> Fall {
    let mut way = f64::INFINITY;
    for skin in skins {
        let Some(bounds) = skin.patch.tree().bounds() else {
            continue;
        };
        let to_patch = skin.world_from_patch.inverse();
        let (center, down) = (
            to_patch.transform_point(center),
            to_patch.transform_vector(down),
        );
        let reach = object.radius + skin.patch.tree().largest_radius();
        let gap = bounds.distance_squared(center).sqrt() - reach;
        if gap <= 0.0 {
            return Fall::Near;
        }
        if meets(bounds, reach, center, down) {
            way = way.min(gap);
        }
    }
    if way.is_finite() {
        Fall::Free(way)
    } else {
        Fall::Endless
    }
}

/// Whether a ray enters a box that is wider by `margin` on every side.
fn meets(bounds: &Aabb, margin: f64, origin: DVec3, direction: DVec3) -> bool {
    let (mut start, mut end) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let low = bounds.min[axis] - margin - origin[axis];
        let high = bounds.max[axis] + margin - origin[axis];
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        start = start.max(a.min(b));
        end = end.min(a.max(b));
    }
    start <= end
}
