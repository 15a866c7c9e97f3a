//! Joints of a body: hinges, slides, balls and free bodies.

use super::classes::Item;
use crate::error::Result;
use crate::geometry::{Pose, rpy_from_rotation};
use crate::text::xml::unit_direction;
use crate::world::robot::{Joint, JointKind, Limits};
use glam::DVec3;

/// Reads `<joint>` or `<freejoint>` with the name, links and origin of `joint`. `frame` is the pose `child_from_frame` of the frame that contains the element.
///
/// # Errors
/// If an attribute is invalid.
pub(super) fn read_joint(item: &Item, frame: &Pose, joint: Joint) -> Result<Joint> {
    let (own, compiler) = (item.own(), item.compiler);
    own.check_attributes(
        "name class type group pos axis springdamper limited actuatorfrclimited solreflimit solimplimit solreffriction solimpfriction stiffness range \
         actuatorfrcrange actuatorgravcomp margin ref springref armature damping frictionloss user align",
    )?;
    const KINDS: [(&str, JointKind); 4] = [
        ("free", JointKind::Floating),
        ("ball", JointKind::Ball),
        ("slide", JointKind::Prismatic),
        ("hinge", JointKind::Revolute),
    ];
    let kind = match own.tag() {
        "freejoint" => JointKind::Floating,
        _ => item.one_of("type", &KINDS, JointKind::Revolute)?,
    };
    let mut joint = Joint { kind, ..joint };
    if kind.has_one_coordinate() {
        let unit = match kind {
            JointKind::Prismatic => 1.0,
            _ => compiler.angle,
        };
        joint.limits = read_limits(item, unit)?;
        if joint.limits.is_none() && kind == JointKind::Revolute {
            joint.kind = JointKind::Continuous;
        }
        joint.axis = frame.transform_vector(read_axis(item, &joint.name)?);
        joint.reference = item.number("ref", 0.0)? * unit;
    }
    let alignments = [
        ("false", false),
        ("true", true),
        ("auto", compiler.aligns_free),
    ];
    let aligns = own.one_of("align", &alignments)?;
    if kind != JointKind::Floating {
        let anchor = item.vector("pos", DVec3::ZERO)?;
        joint.anchor = frame.transform_point(anchor);
        return Ok(joint);
    }
    if aligns.unwrap_or(compiler.aligns_free) {
        let given = format!("the aligned free joint `{}`", joint.name);
        let consequence =
            "the body keeps its frame, which MuJoCo moves to the frame of its inertia";
        own.note(given, "`align` \"false\"", consequence);
    }
    // The coordinates of a free joint are the pose in the world.
    joint.origin = Pose::IDENTITY;
    Ok(joint)
}

/// Returns the default positions of a joint (`qpos0`); `body_poses` are the poses of all bodies in their parents.
pub(super) fn rest_of(joint: &Joint, body_poses: &[Pose]) -> Vec<f64> {
    match joint.kind {
        JointKind::Floating => {
            let origin = &body_poses[joint.child];
            let rpy = rpy_from_rotation(origin.rotation);
            [origin.translation.to_array(), rpy.to_array()].concat()
        }
        kind if kind.has_one_coordinate() => vec![joint.reference],
        kind => vec![0.0; kind.coordinates().len()],
    }
}

fn read_axis(item: &Item, joint: &str) -> Result<DVec3> {
    unit_direction(item.vector("axis", DVec3::Z)?).ok_or_else(|| {
        let given = format!("joint `{joint}` with an axis of length zero");
        item.own().refuse(given, "a direction")
    })
}

/// Reads the limits of a hinge or slide; `unit` is the size of the numbers in rad or m. Returns `None` if the joint is not limited.
fn read_limits(item: &Item, unit: f64) -> Result<Option<Limits>> {
    let words = [("false", Some(false)), ("true", Some(true)), ("auto", None)];
    let limited = item.one_of("limited", &words, None)?;
    let range = item.numbers::<2>("range")?.unwrap_or([0.0; 2]);
    let has_range = range != [0.0; 2];
    if limited == Some(false)
        || (limited.is_none() && !(has_range && item.compiler.has_auto_limits))
    {
        return Ok(None);
    }
    let [lower, upper] = range.map(|end| end * unit);
    if lower >= upper {
        let layer = item.layer(&["range"]);
        let given = format!("{} with range {} to {}", layer.called(), range[0], range[1]);
        return Err(layer.refuse(given, "a lower end below the upper end"));
    }
    let effort = item.numbers::<2>("actuatorfrcrange")?;
    let effort = effort.map_or(f64::INFINITY, |[least, most]| most.max(-least));
    Ok(Some(Limits {
        lower,
        upper,
        velocity: f64::INFINITY,
        effort: if effort > 0.0 { effort } else { f64::INFINITY },
    }))
}
