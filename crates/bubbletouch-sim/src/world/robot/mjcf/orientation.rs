//! Orientations and poses of MJCF elements: `quat`, `axisangle`, `xyaxes`, `zaxis` or `euler` beside `pos`.

use super::classes::Item;
use super::compiler::Compiler;
use crate::error::Result;
use crate::geometry::Pose;
use crate::text::xml::unit_direction;
use glam::{DMat3, DQuat, DVec3};

/// Attributes that contain an orientation.
const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];
/// Smallest length of a direction or quaternion, as in MuJoCo. With a larger value, valid directions are refused; with a smaller value, rounding errors decide.
const MIN_LENGTH: f64 = 1e-14;

/// Returns the pose that the attributes of an element describe.
///
/// # Errors
/// If an attribute is invalid, a direction has length zero, or one element has several orientations.
pub(super) fn pose_of(item: &Item) -> Result<Pose> {
    let translation = item.vector("pos", DVec3::ZERO)?;
    Ok(Pose::new(rotation_of(item)?, translation))
}

fn rotation_of(item: &Item) -> Result<DQuat> {
    let layer = item.layer(&ORIENTATIONS);
    let given = ORIENTATIONS.iter().copied();
    let given: Vec<&str> = given.filter(|it| layer.attribute(it).is_some()).collect();
    let attribute = match given.as_slice() {
        [] => return Ok(DQuat::IDENTITY),
        [attribute] => *attribute,
        several => {
            let given = format!("{} with {}", layer.called(), several.join(" and "));
            return Err(layer.refuse(given, "one orientation"));
        }
    };
    let direction = |vector: DVec3| {
        let is_long = vector.abs().max_element() >= MIN_LENGTH;
        let unit = unit_direction(vector).filter(|_| is_long);
        unit.ok_or_else(|| {
            let given = format!("`{attribute}` with a direction of length zero");
            layer.refuse(given, "directions")
        })
    };
    Ok(match attribute {
        "quat" => quaternion_of(item, attribute)?,
        "axisangle" => {
            let [x, y, z, angle] = layer.needed_numbers(attribute)?;
            let axis = direction(DVec3::new(x, y, z))?;
            DQuat::from_axis_angle(axis, angle * item.compiler.angle)
        }
        "xyaxes" => {
            let [a, b, c, d, e, f] = layer.needed_numbers(attribute)?;
            let x = direction(DVec3::new(a, b, c))?;
            let y = DVec3::new(d, e, f);
            let y = direction(y - x.dot(y) * x)?;
            DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize()
        }
        "zaxis" => from_z_to(direction(DVec3::from(layer.needed_numbers(attribute)?))?),
        _ => from_euler(layer.needed_numbers(attribute)?, item.compiler),
    })
}

/// Returns the unit quaternion in an attribute, scalar part first; the identity if the attribute is missing.
///
/// # Errors
/// If the value is not four finite numbers, or its length is zero.
pub(super) fn quaternion_of(item: &Item, attribute: &str) -> Result<DQuat> {
    let Some([w, x, y, z]) = item.numbers(attribute)? else {
        return Ok(DQuat::IDENTITY);
    };
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    if quaternion.length() < MIN_LENGTH {
        let given = format!("`{attribute}` of length zero");
        return Err(item.own().refuse(given, "a quaternion w, x, y, z"));
    }
    Ok(quaternion.normalize())
}

/// Returns the rotation of three Euler angles in the sequence and unit of the model.
pub(super) fn from_euler(angles: [f64; 3], compiler: &Compiler) -> DQuat {
    let axes = compiler.euler_sequence.chars();
    axes.zip(angles)
        .fold(DQuat::IDENTITY, |before, (axis, angle)| {
            let angle = angle * compiler.angle;
            let turn = match axis.to_ascii_lowercase() {
                'x' => DQuat::from_rotation_x(angle),
                'y' => DQuat::from_rotation_y(angle),
                _ => DQuat::from_rotation_z(angle),
            };
            match axis.is_ascii_lowercase() {
                true => before * turn,
                false => turn * before,
            }
        })
}

/// Returns the smallest rotation from the z axis to a unit vector; about x if the vector is parallel to z.
pub(super) fn from_z_to(direction: DVec3) -> DQuat {
    let axis = DVec3::Z.cross(direction);
    let sine = axis.length();
    let axis = if sine < 1e-10 { DVec3::X } else { axis / sine };
    DQuat::from_axis_angle(axis, sine.atan2(direction.z))
}
