//! Measured distances between a solid and the spheres that approximate it.

use super::sphere_sweep::sphere_points;
use super::{Solid, Sphere, SphereUnion};
use glam::DVec3;

/// Largest measured distances between the surfaces of a solid and of its spheres, metres; never negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceError {
    /// Largest height to which a sphere protrudes from the solid, metres.
    pub protrusion: f64,
    /// Largest distance from the solid's surface to the nearest sphere, metres.
    pub gap: f64,
    /// Number of tested points of the solid's surface.
    pub n_surface_points: usize,
}

/// Measures both distances at points of the solid's surface, at most about `spacing` (metres) apart, and at points all over each sphere.
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
        // Upper bound for all points of a sphere; most spheres cannot increase the maximum by more than rounding.
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

/// Returns the point of a sphere in the direction from its centre to the nearest point of the solid's surface.
fn outermost_point(solid: &Solid, sphere: &Sphere) -> DVec3 {
    let step = 1e-4 * sphere.radius;
    let slope = |axis: DVec3| {
        solid.distance(sphere.center + step * axis) - solid.distance(sphere.center - step * axis)
    };
    let gradient = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
    sphere.center + sphere.radius * gradient.normalize_or(DVec3::Z)
}

/// Returns the largest distance from one of the points to the nearest sphere, metres.
///
/// The search for the sphere nearest to a point ends as soon as a sphere is nearer than the largest distance so far. Neighbours in the list are neighbours on
/// the surface, so the sphere that ended the previous search is tested first.
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
