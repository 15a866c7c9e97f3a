//! How far a union of spheres is from the solid that it stands for: measured, not promised.

use super::sphere_sweep::sphere_points;
use super::{Solid, Sphere, SphereUnion};
use glam::DVec3;

/// Largest distances found between the surfaces of a solid and of its spheres, metres; never negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceError {
    /// How far a sphere reaches outside the solid.
    pub protrusion: f64,
    /// How far the solid's surface lies outside all spheres.
    pub gap: f64,
    /// How many points of the solid's surface were tried.
    pub n_surface_points: usize,
}

/// Tries points of the solid's surface at most about `spacing` (metres) apart, and points all over each sphere.
pub fn surface_error(solid: &Solid, union: &SphereUnion, spacing: f64) -> SurfaceError {
    let points = solid.surface_points(spacing);
    SurfaceError {
        protrusion: protrusion(solid, union.spheres()),
        gap: gap(&points, union.spheres()),
        n_surface_points: points.len(),
    }
}

fn protrusion(solid: &Solid, spheres: &[Sphere]) -> f64 {
    let mut largest = 0.0f64;
    let mut points = Vec::new();
    for sphere in spheres {
        // No point of a sphere is farther out than this; most spheres cannot raise the largest by more than rounding.
        let bound = solid.distance(sphere.center) + sphere.radius;
        if bound <= largest + 1e-9 * sphere.radius {
            continue;
        }
        points.clear();
        sphere_points(sphere, sphere.radius, &mut points);
        points.push(outermost_point(solid, sphere));
        let distances = points.iter().map(|&point| solid.distance(point));
        largest = distances.fold(largest, f64::max);
    }
    largest
}

/// The point of a sphere in the direction in which the solid's surface is nearest to its centre.
fn outermost_point(solid: &Solid, sphere: &Sphere) -> DVec3 {
    let step = 1e-4 * sphere.radius;
    let slope = |axis: DVec3| {
        solid.distance(sphere.center + step * axis) - solid.distance(sphere.center - step * axis)
    };
    let gradient = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
    sphere.center + sphere.radius * gradient.normalize_or(DVec3::Z)
}

/// Largest over the points of the smallest distance to a sphere.
///
/// A point stops looking as soon as some sphere is nearer than the largest gap so far: it cannot raise it. Neighbours in
/// the list are neighbours on the surface, so the sphere that stopped the last point is tried first.
fn gap(points: &[DVec3], spheres: &[Sphere]) -> f64 {
    let mut largest = 0.0f64;
    let mut last = 0;
    for &point in points {
        let distance = |sphere: &Sphere| (point - sphere.center).length() - sphere.radius;
        if distance(&spheres[last]) <= largest {
            continue;
        }
        match spheres.iter().position(|s| distance(s) <= largest) {
            Some(near) => last = near,
            None => largest = spheres.iter().map(distance).fold(f64::INFINITY, f64::min),
        }
    }
    largest
}
