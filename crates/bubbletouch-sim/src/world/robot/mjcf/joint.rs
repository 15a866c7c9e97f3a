//! Joints of a body: hinges, slides, balls and free bodies.

use super::classes::Item;
use super::compiler::Compiler;
use crate::error::Result;
use crate::geometry::{Pose, rpy_from_rotation};
use crate::world::robot::{Joint, JointKind, Limits};
use glam::DVec3;

/// Types of joints in MJCF.
#[derive(Clone, Copy, PartialEq)]
enum Type {
    Free,
    Ball,
    Slide,
    Hinge,
}

/// Place of a joint in the robot.
pub(super) struct JointPlace {
    /// Name of the joint.
    pub name: String,
    /// Index of the parent link.
    pub parent: usize,
    /// Index of the link that the joint moves.
    pub child: usize,
    /// Pose `parent_from_joint` at the reference position.
    pub origin: Pose,
    /// Pose `child_from_frame` of the frame that contains the joint.
    pub frame: Pose,
    /// Whether the joint is the only one of a body in the world, as a free joint must be.
    pub is_alone_in_world: bool,
}

/// Reads `<joint>` or `<freejoint>`.
///
/// # Errors
/// If an attribute is invalid.
pub(super) fn read_joint(item: &Item, place: JointPlace, compiler: &Compiler) -> Result<Joint> {
    let own = item.own();
    own.check_attributes(&[
        "name",
        "class",
        "type",
        "group",
        "pos",
        "axis",
        "springdamper",
        "limited",
        "actuatorfrclimited",
        "solreflimit",
        "solimplimit",
        "solreffriction",
        "solimpfriction",
        "stiffness",
        "range",
        "actuatorfrcrange",
        "actuatorgravcomp",
        "margin",
        "ref",
        "springref",
        "armature",
        "damping",
        "frictionloss",
        "user",
        "align",
    ])?;
    let types = [
        ("free", Type::Free),
        ("ball", Type::Ball),
        ("slide", Type::Slide),
        ("hinge", Type::Hinge),
    ];
    let kind = match (own.node.tag_name().name(), item.layer_with(&["type"])) {
        ("freejoint", _) => Type::Free,
        (_, Some(layer)) => layer.one_of("type", &types)?.unwrap_or(Type::Hinge),
        (_, None) => Type::Hinge,
    };
    let (unit, can_have_limits) = match kind {
        Type::Hinge => (compiler.angle, true),
        Type::Slide => (1.0, true),
        Type::Ball | Type::Free => (compiler.angle, false),
    };
    let limits = match can_have_limits {
        true => read_limits(item, unit, compiler)?,
        false => None,
    };
    let aligns = own.one_of(
        "align",
        &[
            ("false", false),
            ("true", true),
            ("auto", compiler.aligns_free),
        ],
    )?;
    if kind == Type::Free && aligns.unwrap_or(compiler.aligns_free) {
        let aligned = Err(own.refuse(
            format!("the aligned free joint `{}`", place.name),
            "`align` \"false\"",
        ));
        let consequence =
            "the body keeps its frame, which MuJoCo moves to the frame of its inertia";
        own.or_note(aligned, (), consequence);
    }
    let kind = match kind {
        Type::Free if !place.is_alone_in_world => {
            let given = format!("the free joint `{}`", place.name);
            let allowed = "the only joint of a body in <worldbody>";
            return Err(own.refuse(given, allowed));
        }
        Type::Free => JointKind::Floating,
        Type::Ball => JointKind::Ball,
        Type::Slide => JointKind::Prismatic,
        Type::Hinge if limits.is_some() => JointKind::Revolute,
        Type::Hinge => JointKind::Continuous,
    };
    let axis = match kind.has_one_coordinate() {
        true => place.frame.transform_vector(read_axis(item, &place.name)?),
        false => DVec3::Z,
    };
    let is_free = kind == JointKind::Floating;
    let reference = match kind.has_one_coordinate() {
        true => item.number("ref", 0.0)? * unit,
        false => 0.0,
    };
    Ok(Joint {
        name: place.name,
        kind,
        parent: place.parent,
        child: place.child,
        // The coordinates of a free joint are the pose in the world.
        origin: if is_free {
            Pose::IDENTITY
        } else {
            place.origin
        },
        axis,
        anchor: match is_free {
            true => DVec3::ZERO,
            false => place
                .frame
                .transform_point(item.vector("pos", DVec3::ZERO)?),
        },
        reference,
        limits,
        mimic: None,
    })
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
    let axis = item.vector("axis", DVec3::Z)?;
    // Scaled first, so that no square overflows or underflows.
    let unit = (axis / axis.abs().max_element()).try_normalize();
    unit.ok_or_else(|| {
        let given = format!("joint `{joint}` with an axis of length zero");
        item.own().refuse(given, "a direction")
    })
}

/// Reads the limits of a hinge or slide; `unit` is the size of the numbers in rad or m. Returns `None` if the joint is not limited.
fn read_limits(item: &Item, unit: f64, compiler: &Compiler) -> Result<Option<Limits>> {
    let words = [("false", Some(false)), ("true", Some(true)), ("auto", None)];
    let limited = match item.layer_with(&["limited"]) {
        Some(layer) => layer.one_of("limited", &words)?.flatten(),
        None => None,
    };
    let range = item.numbers::<2>("range")?.unwrap_or([0.0; 2]);
    let has_range = range != [0.0; 2];
    if limited == Some(false) || (limited.is_none() && !(has_range && compiler.has_auto_limits)) {
        return Ok(None);
    }
    let [lower, upper] = range.map(|end| end * unit);
    if lower >= upper {
        let layer = item.layer_with(&["range"]).unwrap_or(item.own());
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
