//! An object in the air: how far it certainly falls before it meets a skin.

use super::free_object::{FreeObject, PlacedSkin};
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
        if bounds.widened(reach).entry(center, down, 0.0).is_finite() {
            way = way.min(gap);
        }
    }
    if way.is_finite() {
        Fall::Free(way)
    } else {
        Fall::Endless
    }
}
