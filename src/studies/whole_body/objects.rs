//! Objects that touch the skin: built-in objects, solids of a few parts, and cushions of spheres.

use crate::error::Result;
use crate::geometry::Pose;
use crate::inputs::units::MM;
use crate::objects::{Catalogue, Part, Shape, Solid, Sphere, SphereUnion, pack};
use crate::studies::whole_body::spec::{BodyPartSpec, BodySceneSpec};
use glam::DVec3;

/// Returns the spheres of a scene's object, in metres.
pub(super) fn of_scene(scene: &BodySceneSpec, surface_error: f64) -> Result<SphereUnion> {
    match &scene.object {
        Some(name) => built_in(name, surface_error),
        None => {
            let parts = scene.parts.iter().map(part).collect::<Result<_>>()?;
            pack(&Solid::new(parts)?, surface_error)
        }
    }
}

/// Returns the spheres of a built-in object, in metres, with the centre of its bounding box at the origin.
pub(super) fn built_in(name: &str, surface_error: f64) -> Result<SphereUnion> {
    let solid = Catalogue::builtin()?.object(name)?.solid.clone();
    let middle = solid.bounds().center();
    let solid = solid.moved(&Pose::from_translation(-middle));
    pack(&solid, surface_error)
}

fn part(part: &BodyPartSpec) -> Result<Part> {
    let (at_mm, shape) = match *part {
        BodyPartSpec::Ball { diameter_mm, at_mm } => {
            let diameter = MM * diameter_mm;
            (at_mm, Shape::Ball { diameter })
        }
        BodyPartSpec::Capsule {
            diameter_mm,
            length_mm,
            at_mm,
        } => {
            let (diameter, length) = (MM * diameter_mm, MM * length_mm);
            (at_mm, Shape::Capsule { diameter, length })
        }
        BodyPartSpec::Torus {
            ring_diameter_mm,
            tube_diameter_mm,
            at_mm,
        } => {
            let shape = Shape::Torus {
                ring_diameter: MM * ring_diameter_mm,
                tube_diameter: MM * tube_diameter_mm,
            };
            (at_mm, shape)
        }
    };
    Part::new(shape, Pose::from_translation(MM * DVec3::from_array(at_mm)))
}

/// Ratio of the radius of a cushion's spheres to their distance. If larger, each taxel is under more spheres.
const SPHERE_RADIUS: f64 = 3.0;
/// Golden ratio: increment of a lattice that is distributed evenly in a square for any number of points.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Returns a square cushion of n spheres with side length `side`, metres, bent around a cylinder about z, with its centre at +x. Half of the spheres touch the
/// cylinder from outside. The other half is on the far side of the cushion, half a side length away.
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
