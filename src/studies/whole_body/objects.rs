//! Sphere models of the objects that touch a robot: scene objects, built-in objects, and square cushions of spheres for scaling series.

use crate::error::Result;
use crate::geometry::Pose;
use crate::inputs::check::Check;
use crate::inputs::objects_spec::ModelSpec;
use crate::inputs::units::millimetres;
use crate::objects::{Catalogue, Model, Sphere, SphereUnion, pack};
use crate::scene::Reader;
use crate::studies::whole_body::plan::{ScenePlan, WholeBodyPlan};
use glam::DVec3;
use std::collections::BTreeMap;

/// Returns the object of a scene as a union of spheres, metres, in the frame of the object.
pub(super) fn of_scene(plan: &WholeBodyPlan, scene: &ScenePlan) -> Result<SphereUnion> {
    let reader = Reader {
        check: Check { place: &plan.place },
        folder: &plan.folder,
        models: &BTreeMap::new(),
    };
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
