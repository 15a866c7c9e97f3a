//! Check for objects that overlap a free object at the start of a scene.

use super::plan_object::{Movement, PlannedObject};
use super::planned::PlannedRobot;
use super::robot_state::RobotState;
use crate::contact::equilibrium;
use crate::error::Result;
use crate::geometry::Pose;
use crate::inputs::check::Check;
use crate::inputs::units::MM;
use crate::mesh::Welded;
use crate::objects::{Model, Sphere, SphereUnion};

/// Maximum accepted overlap of two objects at the start, divided by the radius of the smaller object. With a larger value, deeper overlaps are accepted; with a
/// smaller value, objects of coarse spheres are rejected.
const MAX_SHARE: f64 = 0.5;

/// Object at its initial pose in the scene, with its model in the object frame.
struct Start<'a> {
    object: &'a PlannedObject,
    model: &'a Model,
    pose: Pose,
}

/// Checks that no free object starts inside another object.
///
/// The tolerance for the overlap is the sum of the surface errors of both objects.
///
/// # Errors
/// If a free object overlaps another object by more than the tolerance. The error names both objects and their overlap. If an object beside a free object is an
/// open mesh, whose inside is unknown.
pub(super) fn check_starts(
    check: &Check,
    objects: &[PlannedObject],
    models: &[Model],
    robots: &[PlannedRobot],
) -> Result<()> {
    let is_free = |object: &PlannedObject| matches!(object.movement, Movement::Free { .. });
    if !objects.iter().any(is_free) {
        return Ok(());
    }
    for (object, model) in objects.iter().zip(models) {
        if let Model::Mesh(mesh) = model
            && objects.len() > 1
            && Welded::new(mesh.mesh()).n_unbalanced() > 0
        {
            let given = "an open mesh, beside another object in a scene with a free object";
            let allowed =
                "a closed mesh, or model = \"vertex_spheres\": an open mesh has no inside";
            return Err(check.error(&format!("objects.{}.mesh", object.name), given, allowed));
        }
    }
    let mut states: Vec<RobotState> = robots.iter().map(RobotState::new).collect();
    for state in &mut states {
        state.place(0.0)?;
    }
    let starts = objects.iter().zip(models).map(|(object, model)| {
        let pose = match &object.movement {
            Movement::Imposed { carrier, motion } => {
                carrier.place(&motion.pose_at(0.0), &states, &[])
            }
            Movement::Free { start, .. } => *start,
        };
        Start {
            object,
            model,
            pose,
        }
    });
    let starts: Vec<Start> = starts.collect();
    for (number, other) in starts.iter().enumerate() {
        for first in &starts[..number] {
            // The error has the key of a free object; of two free objects, the later one.
            let (free, other) = match is_free(other.object) {
                true => (other, first),
                false => (first, other),
            };
            if !is_free(free.object) {
                continue;
            }
            let smaller = free.object.ball.radius.min(other.object.ball.radius);
            let tolerance = free.object.surface_error + other.object.surface_error;
            let overlap = free.overlap(other);
            if overlap > tolerance.min(MAX_SHARE * smaller) {
                let names = (&free.object.name, &other.object.name);
                let given = format!(
                    "free object `{}` starts {:.1} mm inside `{}`",
                    names.0,
                    overlap / MM,
                    names.1
                );
                let allowed = "free objects that overlap no other object at the start";
                return Err(check.error(&format!("objects.{}.at", names.0), given, allowed));
            }
        }
    }
    Ok(())
}

impl Start<'_> {
    /// Returns the bounding ball of the object in the world frame, metres.
    fn ball(&self) -> Sphere {
        self.object.ball.placed(&self.pose)
    }

    /// Returns the spheres of the object in the world frame that intersect a ball, sorted by their smallest x coordinate.
    fn spheres_near(&self, ball: &Sphere) -> Vec<Sphere> {
        let spheres = self.model.spheres().map_or(&[][..], SphereUnion::spheres);
        let placed = spheres.iter().map(|sphere| sphere.placed(&self.pose));
        let mut near: Vec<Sphere> = placed
            .filter(|sphere| overlap(sphere, ball) > 0.0)
            .collect();
        near.sort_by(|a, b| begin(a).total_cmp(&begin(b)));
        near
    }

    /// Returns the largest overlap between a sphere of this object and a sphere of the other object, metres; 0 if the objects do not overlap. With a mesh, it is
    /// the depth of a corner or a sphere behind the surface of the other object.
    fn overlap(&self, other: &Self) -> f64 {
        let (ball, other_ball) = (self.ball(), other.ball());
        if overlap(&ball, &other_ball) <= 0.0 {
            return 0.0;
        }
        if [self.model, other.model]
            .iter()
            .any(|model| model.spheres().is_none())
        {
            let other = (other.model.into(), &other.pose);
            return equilibrium::overlap((self.model.into(), &self.pose), other);
        }
        let (own, others) = (
            self.spheres_near(&other.ball()),
            other.spheres_near(&self.ball()),
        );
        let widest = others
            .iter()
            .map(|sphere| sphere.radius)
            .fold(0.0, f64::max);
        let mut deepest = 0.0_f64;
        for sphere in &own {
            let first = others.partition_point(|other| begin(other) < begin(sphere) - 2.0 * widest);
            let end = sphere.center.x + sphere.radius;
            let reached = others[first..]
                .iter()
                .take_while(|other| begin(other) < end);
            deepest = reached
                .map(|other| overlap(sphere, other))
                .fold(deepest, f64::max);
        }
        deepest
    }
}

fn begin(sphere: &Sphere) -> f64 {
    sphere.center.x - sphere.radius
}

fn overlap(a: &Sphere, b: &Sphere) -> f64 {
    a.radius + b.radius - a.center.distance(b.center)
}
