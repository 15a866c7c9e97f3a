//! Depth of two overlapping shapes.

use super::super::rigid_shape::RigidShape;
use super::contacts::each_contact;
use super::found::{Depth, Placed, Range};
use crate::geometry::Pose;
use glam::DVec3;

/// Returns the depth, metres, by which two shapes at their poses overlap; 0 if they do not overlap or if both are unions of spheres. The depth is the largest
/// distance of a corner or sphere of one shape behind the surface of the other.
pub fn overlap(one: (RigidShape, &Pose), other: (RigidShape, &Pose)) -> f64 {
    /// Depth up to which ridges and edges are searched, relative to the smaller shape; deeper shapes have corners inside each other.
    const RIDGES: f64 = 0.05;
    let size = |shape: &RigidShape| 0.5 * shape.bounds().size().length();
    let smaller = size(&one.0).min(size(&other.0));
    let [one, other] = [one, other].map(|(shape, pose)| Placed { shape, pose: *pose });
    let range = Range {
        gap: 0.0,
        depth: Depth::up_to(RIDGES * smaller),
    };
    let mut deepest = 0.0_f64;
    each_contact(&one, &other, range, |found| {
        if found.beyond <= 0.0 {
            deepest = deepest.max(found.penetration);
        }
    });
    for (of, mesh) in [(&one, &other), (&other, &one)] {
        let RigidShape::Mesh(model) = mesh.shape else {
            continue;
        };
        let mesh_from_points = of.pose.seen_from(&mesh.pose);
        let mut look = |point: DVec3, radius: f64| {
            let place = mesh_from_points.transform_point(point);
            if model.bvh().bounds().distance_squared(place) > 0.0 {
                return;
            }
            if let Some(nearest) = model.bvh().closest(place, f64::INFINITY)
                && model.features().is_inside(model.bvh(), place, &nearest)
            {
                deepest = deepest.max(radius + nearest.distance);
            }
        };
        for sphere in of.shape.spheres() {
            look(sphere.center, sphere.radius);
        }
        if let RigidShape::Mesh(of) = of.shape {
            let corners = of.features().corners().iter();
            corners.for_each(|corner| look(*corner, of.rounding()));
        }
    }
    deepest
}
