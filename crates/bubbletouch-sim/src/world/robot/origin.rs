//! Poses in URDF files: `<origin xyz rpy quat_xyzw>`, and the attributes `xyz` and `rpy` of other elements.

use crate::error::Result;
use crate::geometry::{Pose, rotation_from_rpy, written_rotation};
use crate::text::xml::Element;
use glam::{DQuat, DVec3};

/// Returns the pose in the child element `<origin>`; the identity if there is none.
///
/// # Errors
/// If a value is invalid or an attribute is a misspelling.
pub(super) fn origin_of(element: Element) -> Result<Pose> {
    check_origin(element)?;
    origin_ignoring_slips(element)
}

/// Returns an error if an attribute of `<origin>` is a misspelling.
pub(super) fn check_origin(element: Element) -> Result<()> {
    let origin = element.child("origin")?;
    origin.map_or(Ok(()), |it| it.check_attributes("xyz rpy quat_xyzw"))
}

/// Returns the pose as [`origin_of`] does, but ignores misspelt attributes.
pub(super) fn origin_ignoring_slips(element: Element) -> Result<Pose> {
    let origin = element.child("origin")?;
    origin.map_or(Ok(Pose::IDENTITY), pose_of)
}

/// Returns the pose in the attributes of an element. The attribute `rpy` rotates about the fixed axes x, y, z in this order; `quat_xyzw` (URDF 1.1) replaces
/// this attribute.
pub(super) fn pose_of(element: Element) -> Result<Pose> {
    let translation = element.vector("xyz", DVec3::ZERO)?;
    let rotation = match (element.numbers("rpy")?, element.numbers("quat_xyzw")?) {
        (Some(_), Some(_)) => {
            return Err(element.refuse("both `rpy` and `quat_xyzw`", "one of them"));
        }
        (None, Some(xyzw)) => {
            let quaternion = DQuat::from_array(xyzw);
            written_rotation(quaternion).ok_or_else(|| {
                let given = format!("a quaternion of length {}", quaternion.length());
                element.refuse(given, "length 1")
            })?
        }
        (rpy, None) => rotation_from_rpy(DVec3::from(rpy.unwrap_or([0.0; 3]))),
    };
    Ok(Pose::new(rotation, translation))
}
