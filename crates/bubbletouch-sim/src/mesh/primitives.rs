//! Triangle meshes of primitive shapes: box, cylinder, ellipsoid and capsule.
//!
//! A box is exact. A round surface is divided into facets whose corners lie on the surface, so that the mesh is inside the shape. A facet is at most the
//! tolerance t inside the surface. A circle of radius r has n corners, and a sphere n corners around each circle and n / 4 rings in each half:
//!
//! ```text
//! circle:  r (1 − cos(π / n)) ≤ t          sphere:  r (1 − cos(π / n)) ≤ t / 2
//! ```
//!
//! The diagonal of a facet of a sphere is √2 times as long as its sides. Therefore a facet deviates twice as far as a chord of the circle.

use super::triangle_mesh::check_vertices;
use super::{LengthUnit, TriangleMesh};
use crate::error::{Error, Result};
use crate::text::in_range::{not_negative, positive};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Minimum number of facets around a circle. If smaller, large tolerances give coarse prisms instead of round shapes.
const MIN_FACETS: usize = 16;
/// Maximum number of facets around a circle: a sphere then has 2 million triangles. If larger, small tolerances exhaust the memory; if smaller, they are
/// refused.
const MAX_FACETS: usize = 2048;

impl TriangleMesh {
    /// Creates a box about the origin with the given side lengths, metres: 8 vertices and 12 triangles that face outwards.
    ///
    /// # Errors
    /// If a side length is not finite; errors begin with `place`.
    pub fn cuboid(place: &str, sides: DVec3) -> Result<Self> {
        let corner = |corner: u32| {
            let sign = |bit: u32| if corner & bit == 0 { -0.5 } else { 0.5 };
            sides * DVec3::new(sign(1), sign(2), sign(4))
        };
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let halves = faces.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Self::in_unit(
            place,
            LengthUnit::Metre,
            (0..8).map(corner).collect(),
            halves.concat(),
        )
    }

    /// Creates a cylinder about the origin along z. All lengths are in metres.
    ///
    /// # Errors
    /// If a length is not positive, or the tolerance is too small; errors begin with `place`.
    pub fn cylinder(place: &str, radius: f64, length: f64, tolerance: f64) -> Result<Self> {
        check_length(place, "radius", radius)?;
        check_length(place, "length", length)?;
        let half = 0.5 * length;
        let profile = [(0.0, -half), (radius, -half), (radius, half), (0.0, half)];
        revolved(place, &profile, n_facets(place, radius, tolerance)?)
    }

    /// Creates an ellipsoid about the origin with the given radii along the axes. All lengths are in metres.
    ///
    /// # Errors
    /// If a radius is not positive, or the tolerance is too small; errors begin with `place`.
    pub fn ellipsoid(place: &str, radii: DVec3, tolerance: f64) -> Result<Self> {
        for radius in radii.to_array() {
            check_length(place, "radius", radius)?;
        }
        let n = n_facets(place, radii.max_element(), 0.5 * tolerance)?;
        let ball = revolved(place, &ball_profile(1.0, 0.0, n), n)?;
        ball.scaled(place, radii)
    }

    /// Creates a capsule about the origin along z: a cylinder with a hemisphere at each end. `length` is the distance between the centres of the hemispheres,
    /// zero or more. All lengths are in metres.
    ///
    /// # Errors
    /// If the radius is not positive, the length is negative, or the tolerance is too small; errors begin with `place`.
    pub fn capsule(place: &str, radius: f64, length: f64, tolerance: f64) -> Result<Self> {
        check_capsule(place, radius, length)?;
        let n = n_facets(place, radius, 0.5 * tolerance)?;
        revolved(place, &ball_profile(radius, 0.5 * length, n), n)
    }

    /// Returns the mesh with all coordinates multiplied by factors along the axes. If the factors mirror the mesh, its triangles are turned, so that they face
    /// outwards again.
    ///
    /// # Errors
    /// If a product is not finite; errors begin with `place`.
    pub fn scaled(&self, place: &str, factors: DVec3) -> Result<Self> {
        let turned = factors.to_array().iter().product::<f64>() < 0.0;
        let is_turned = vec![turned; self.n_triangles()];
        let scaled = self.with_vertices(|vertex| factors * vertex);
        check_vertices(place, scaled.vertices())?;
        Ok(scaled.with_turned(&is_turned))
    }

    /// Returns the mirror image of the mesh in the plane through the origin whose normal is the axis with the given index (0: x, 1: y, 2: z).
    ///
    /// # Panics
    /// If the index exceeds 2.
    pub fn mirrored(&self, axis: usize) -> Self {
        let mut factors = DVec3::ONE;
        factors[axis] = -1.0;
        self.with_vertices(|vertex| factors * vertex)
            .with_turned(&vec![true; self.n_triangles()])
    }
}

/// Returns an error unless a capsule has a positive radius and a length of zero or more, metres.
pub(crate) fn check_capsule(place: &str, radius: f64, length: f64) -> Result<()> {
    check_length(place, "radius", radius)?;
    not_negative(&format!("{place}: length"), length, "m").map(drop)
}

fn check_length(place: &str, name: &str, length: f64) -> Result<()> {
    positive(&format!("{place}: {name}"), length, "m").map(drop)
}

/// Returns the number of corners on a circle with this radius whose chords are at most the tolerance (metres) inside the circle.
fn n_facets(place: &str, radius: f64, tolerance: f64) -> Result<usize> {
    let cosine = (1.0 - tolerance / radius).max(0.0);
    let n = (PI / cosine.acos()).ceil();
    if tolerance > 0.0 && n <= MAX_FACETS as f64 {
        return Ok((n as usize).max(MIN_FACETS));
    }
    let least = radius * (1.0 - (PI / MAX_FACETS as f64).cos());
    Err(Error::input(
        format!("{place}: tolerance"),
        tolerance,
        format!("at least {least:.3e} m ({MAX_FACETS} facets around the circle)"),
    ))
}

/// Returns the profile (r, z), from pole to pole, of a ball, or of a capsule whose hemispheres are shifted by ±`half` along z.
fn ball_profile(radius: f64, half: f64, n: usize) -> Vec<(f64, f64)> {
    let n_rings = n.div_ceil(4).max(2);
    let point = |ring: usize, sign: f64| {
        let (sin, cos) = (FRAC_PI_2 * ring as f64 / n_rings as f64).sin_cos();
        (radius * cos, sign * (half + radius * sin))
    };
    let pole = |sign: f64| (0.0, sign * (half + radius));
    let lower = (0..n_rings).rev().map(|ring| point(ring, -1.0));
    // A ball has only one equator ring.
    let upper = (usize::from(half == 0.0)..n_rings).map(|ring| point(ring, 1.0));
    let profile = std::iter::once(pole(-1.0)).chain(lower).chain(upper);
    profile.chain([pole(1.0)]).collect()
}

/// Returns the surface of revolution of a profile about z, with n facets around each circle. The profile (r, z) starts at its lower end on the axis and ends at
/// its upper end.
fn revolved(place: &str, profile: &[(f64, f64)], n: usize) -> Result<TriangleMesh> {
    let (lower, upper) = (profile[0].1, profile[profile.len() - 1].1);
    let rings = &profile[1..profile.len() - 1];
    let mut vertices = vec![DVec3::new(0.0, 0.0, lower), DVec3::new(0.0, 0.0, upper)];
    for &(r, z) in rings {
        vertices.extend((0..n).map(|facet| {
            let (sin, cos) = (TAU * facet as f64 / n as f64).sin_cos();
            DVec3::new(r * cos, r * sin, z)
        }));
    }
    let at = |ring: usize, facet: usize| (2 + ring * n + facet % n) as u32;
    let last = rings.len() - 1;
    let mut triangles = Vec::with_capacity(2 * n * rings.len());
    for facet in 0..n {
        triangles.push([0, at(0, facet + 1), at(0, facet)]);
        triangles.push([1, at(last, facet), at(last, facet + 1)]);
        for ring in 0..last {
            let [a, b] = [at(ring, facet), at(ring, facet + 1)];
            let [c, d] = [at(ring + 1, facet + 1), at(ring + 1, facet)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriangleMesh::in_unit(place, LengthUnit::Metre, vertices, triangles)
}
