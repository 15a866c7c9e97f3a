//! Objects that move over the skin of a robot: their models, their paths, the search for the first contact, and the steps with their computing times.

use crate::inputs::objects_spec::ModelSpec;
use crate::objects::{Catalogue, Sphere, SphereUnion, pack};
use crate::scene::Reader;
use crate::studies::prelude::*;
use crate::studies::whole_body::plan::*;
use crate::whole_body::{BodyContact, BodyState, SphereClusters, WholeBody};
use crate::world::Oscillation;
use glam::DVec3;

/// Duration of a time step that is long enough for a damped taxel without contact to return to its rest position, seconds. The value is longer than any
/// relaxation.
pub(super) const FORGOTTEN: f64 = 1e9;
/// Distance that the object moves between two tests for contact in the search for the first contact, metres. Bisection then refines the contact to
/// `SEARCH_END`.
const SEARCH_STEP: f64 = 1e-3;
/// Width of the bisection interval at which the search for the first contact ends, metres.
const SEARCH_END: f64 = 1e-7;
/// Distance between the target and the point at which the search for the first contact starts, metres. The size of the object is added to it.
const SEARCH_START: f64 = 0.05;

/// Robot that is covered with skin, in a given posture, with the poses of its patches and links.
pub(super) struct Posture<'a> {
    pub body: &'a WholeBody,
    /// Pose of each patch in the world, `world_from_patch`.
    pub patches: Vec<Pose>,
    /// Pose of each link in the world, `world_from_link`.
    pub links: Vec<Pose>,
}

/// Motion of an object over the skin, in the frame of a robot link.
#[derive(Clone, Copy)]
pub(super) struct Path {
    /// Pose of the link in the world, `world_from_link`.
    pub world_from_link: Pose,
    /// Motion of the object in the frame of the link.
    pub motion: Oscillation,
}

impl Path {
    /// Returns the pose `world_from_object` at a time, seconds.
    pub fn at(&self, time: f64) -> Pose {
        self.world_from_link.compose(&self.motion.pose_at(time))
    }

    /// Returns the path with its start shifted by the vector `by`, metres, in the frame of the link.
    pub fn shifted(&self, by: DVec3) -> Self {
        let start = self.motion.start;
        self.starting_at(Pose::new(start.rotation, start.translation + by))
    }

    /// Returns a copy of the path with a different initial pose of the object, `link_from_object`.
    pub fn starting_at(&self, start: Pose) -> Self {
        Self {
            motion: Oscillation {
                start,
                ..self.motion
            },
            ..*self
        }
    }
}

/// Object that moves along a path over the skin of a robot.
pub(super) struct Drive<'a> {
    pub body: &'a WholeBody,
    pub state: BodyState,
    pub object: [SphereClusters; 1],
    pub path: Path,
}

impl<'a> Drive<'a> {
    pub fn new(posture: &Posture<'a>, object: &SphereUnion, aim: &Aim) -> Result<Self> {
        let mut state = BodyState::at_rest(posture.body);
        state.place(posture.body, &posture.patches)?;
        Ok(Self {
            body: posture.body,
            state,
            object: [SphereClusters::new(object)],
            path: Path {
                world_from_link: posture.links[aim.link],
                motion: aim.motion,
            },
        })
    }

    /// Presses the object against the undeformed skin at the start of a path.
    pub fn probe(&mut self, path: Path) -> Result<BodyContact> {
        let pose = [path.at(0.0)];
        self.state.press(self.body, &self.object, &pose, FORGOTTEN)
    }

    /// Returns the numbers of the taxels that the last press touched, and their deflections in metres.
    pub fn touched(&self) -> impl Iterator<Item = (usize, f64)> {
        self.state.touched(self.body)
    }

    /// Moves the start of the path in the direction of the unit vector `from`, away from the skin. At the new start, the object is `depth` metres past the
    /// first contact.
    pub fn approach(&mut self, from: DVec3, depth: f64) -> Result<()> {
        let reach = self.object[0].ball().radius + self.object[0].ball().center.length();
        let path = self.path;
        let mut is_touched = |away: f64| -> Result<bool> {
            Ok(self.probe(path.shifted(away * from))?.n_touched > 0)
        };
        let mut outside = reach + SEARCH_START;
        while !is_touched(outside - SEARCH_STEP)? {
            outside -= SEARCH_STEP;
            if outside < -reach {
                let allowed = "a place and a direction from which the object meets the skin";
                return Err(Error::input("approach", "no contact", allowed));
            }
        }
        let mut inside = outside - SEARCH_STEP;
        while outside - inside > SEARCH_END {
            let middle = 0.5 * (outside + inside);
            match is_touched(middle)? {
                true => inside = middle,
                false => outside = middle,
            }
        }
        self.path = path.shifted((inside - depth) * from);
        Ok(())
    }
}

/// Returns the object of a scene as a union of spheres, metres, in the frame of the object.
pub(super) fn of_scene(plan: &WholeBodyPlan, scene: &ScenePlan) -> Result<SphereUnion> {
    let reader = Reader::new(&plan.place, &plan.folder);
    let mut spec = scene.spec.object.clone();
    let model = spec.model.unwrap_or(ModelSpec::Packed);
    let is_packed = spec.spheres.is_none() && (spec.mesh.is_none() || model == ModelSpec::Packed);
    if is_packed && spec.surface_error_mm.is_none() {
        spec.surface_error_mm = Some(plan.spec.whole_body.surface_error_mm);
    }
    let key = format!("objects.{}", spec.name);
    match reader.model(&key, &spec, millimetres(plan.pitch), model)? {
        Model::Spheres(spheres) => Ok(spheres),
        Model::Mesh(_) => {
            let given = "exact contact with triangles";
            let allowed = "model = \"packed\" or \"vertex_spheres\" on a whole body";
            Err(reader.check.error(&format!("{key}.model"), given, allowed))
        }
    }
}

/// Returns a built-in object as a union of spheres, metres; the centre of its bounding box is the origin. The spheres
/// deviate from the surface of the object by at most `surface_error` metres.
pub(super) fn built_in(name: &str, surface_error: f64) -> Result<SphereUnion> {
    let solid = Catalogue::builtin()?.object(name)?.solid.clone();
    let middle = solid.bounds().center();
    let solid = solid.moved(&Pose::from_translation(-middle));
    pack(&solid, surface_error)
}

/// Radius of the spheres that form a cushion (a square of spheres), divided by the distance between neighbouring spheres. With a larger radius, more spheres
/// touch each taxel.
const SPHERE_RADIUS: f64 = 3.0;
/// Golden ratio; its multiples modulo 1 spread any number of points evenly over a square.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Returns a cushion: a square of `n` spheres with side length `side`, metres, bent around a cylinder about z, with its centre at +x. One half of the spheres
/// touch the cylinder (radius `cylinder`, metres) from outside. The other half lie farther out by half a side length.
pub(super) fn cushion(n: usize, side: f64, cylinder: f64) -> Result<SphereUnion> {
    let n_inside = n.div_ceil(2);
    let radius = SPHERE_RADIUS * side / (n_inside as f64).sqrt();
    let sheet = |n: usize, away: f64| {
        (0..n).map(move |k| {
            let around = ((k as f64 * GOLDEN).fract() - 0.5) * side / cylinder;
            let along = ((k as f64 + 0.5) / n as f64 - 0.5) * side;
            let (sin, cos) = around.sin_cos();
            Sphere {
                center: DVec3::new(away * cos, away * sin, along),
                radius,
            }
        })
    };
    let inside = sheet(n_inside, cylinder + radius);
    let outside = sheet(n - n_inside, cylinder + radius + 0.5 * side);
    SphereUnion::new(inside.chain(outside).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_spheres_of_a_cushion_touch_the_cylinder_evenly() {
        let (side, cylinder) = (0.1, 0.08);
        let union = cushion(2000, side, cylinder).unwrap();
        assert_eq!(union.n_spheres(), 2000);
        let mut quarters = [0; 16];
        for sphere in &union.spheres()[..1000] {
            let away = sphere.center.truncate().length();
            assert!((away - sphere.radius - cylinder).abs() < 1e-12);
            let angle = sphere.center.y.atan2(sphere.center.x);
            let places =
                [angle * cylinder, sphere.center.z].map(|at| (4.0 * (at / side + 0.5)) as usize);
            quarters[4 * places[0] + places[1]] += 1;
        }
        assert!(
            quarters.iter().all(|n| (58..68).contains(n)),
            "{quarters:?}"
        );
    }
}
