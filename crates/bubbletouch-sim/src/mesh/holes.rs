//! Holes of a mesh: detection, measures, and closing on request.

use super::{LengthUnit, TriangleMesh, Welded};
use crate::disjoint_sets::DisjointSets;
use crate::error::{Error, Result};
use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt;

/// Hole of a mesh: a connected part of its border, which consists of the edges with one face.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Border edges in the direction of their faces, from corner to corner.
    pub border: Vec<[u32; 2]>,
    /// Length of the hole's border, metres.
    pub length: f64,
    /// Largest distance between two corners of the border, metres.
    pub width: f64,
}

impl Hole {
    /// Returns all holes of a mesh, the longest first.
    pub fn all(mesh: &TriangleMesh, welded: &Welded) -> Vec<Self> {
        let single = welded.edges().filter(|sides| sides.len() == 1);
        let borders: Vec<[u32; 2]> = single
            .map(|sides| match (sides[0].edge, sides[0].is_forward) {
                (edge, true) => edge,
                ([low, high], false) => [high, low],
            })
            .collect();
        let mut joined = DisjointSets::new(mesh.vertices().len());
        for &[a, b] in &borders {
            joined.join(a as usize, b as usize);
        }
        let mut parts: BTreeMap<usize, Vec<[u32; 2]>> = BTreeMap::new();
        for edge in borders {
            let root = joined.root(edge[0] as usize);
            parts.entry(root).or_default().push(edge);
        }
        let mut holes: Vec<Self> = parts.into_values().map(|b| Self::new(mesh, b)).collect();
        holes.sort_by(|a, b| b.length.total_cmp(&a.length));
        holes
    }

    fn new(mesh: &TriangleMesh, border: Vec<[u32; 2]>) -> Self {
        let place = |corner: u32| mesh.vertices()[corner as usize];
        let edges = border.iter().map(|&[a, b]| place(a).distance(place(b)));
        Self {
            length: edges.sum(),
            width: width(border.iter().map(|&[from, _]| place(from)).collect()),
            border,
        }
    }

    /// Returns whether the border enters every corner as often as it leaves the corner. In this case a cone can close the hole.
    fn is_circuit(&self) -> bool {
        let mut balance: BTreeMap<u32, i32> = BTreeMap::new();
        for &[from, to] in &self.border {
            *balance.entry(from).or_default() += 1;
            *balance.entry(to).or_default() -= 1;
        }
        balance.values().all(|&sum| sum == 0)
    }
}

/// Returns the largest distance between two of the points.
fn width(mut points: Vec<DVec3>) -> f64 {
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    // Far points come first: two points closer to the middle than half the width cannot be farther apart.
    points.sort_by(|a, b| {
        let [a, b] = [a, b].map(|point| point.distance_squared(middle));
        b.total_cmp(&a)
    });
    let mut widest = 0.0;
    for (number, point) in points.iter().enumerate() {
        if 2.0 * point.distance(middle) <= widest {
            break;
        }
        for other in &points[number + 1..] {
            widest = f64::max(widest, point.distance(*other));
        }
    }
    widest
}

/// Result of closing the holes of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedHoles {
    /// Mesh with a cone over each closed hole. A cone has one triangle per border edge, each with the mean of the border's corners as its apex.
    pub mesh: TriangleMesh,
    /// Width of each closed hole, metres, the widest first.
    pub widths: Vec<f64>,
}

impl TriangleMesh {
    /// Closes all holes of the mesh whose width is at most `widest` (metres, not negative).
    ///
    /// # Errors
    /// If the width is negative or NaN.
    pub fn with_holes_closed(&self, widest: f64) -> Result<ClosedHoles> {
        if widest.is_nan() || widest < 0.0 {
            let given = format!("{} mm", 1e3 * widest);
            return Err(Error::input("width of holes", given, "0 mm or more"));
        }
        let (mut vertices, mut triangles) = (self.vertices().to_vec(), self.triangles().to_vec());
        let mut widths = Vec::new();
        for hole in Hole::all(self, &Welded::new(self)) {
            if hole.width > widest || !hole.is_circuit() {
                continue;
            }
            let corners = hole.border.iter().map(|&[from, _]| vertices[from as usize]);
            let middle = corners.sum::<DVec3>() / hole.border.len() as f64;
            let apex = vertices.len() as u32;
            vertices.push(middle);
            triangles.extend(hole.border.iter().map(|&[from, to]| [to, from, apex]));
            widths.push(hole.width);
        }
        widths.sort_by(|a, b| b.total_cmp(a));
        // The size was checked when the mesh was created, unless its unit was given.
        let place = "mesh with closed holes";
        let mesh = Self::in_unit(place, LengthUnit::Metre, vertices, triangles)?;
        Ok(ClosedHoles { mesh, widths })
    }
}

impl fmt::Display for ClosedHoles {
    /// Formats the result as a phrase, such as `closed 2 holes, at most 0.93 mm wide`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widest = self
            .widths
            .first()
            .map(|widest| format!("{:.2} mm wide", 1e3 * widest));
        match (self.widths.len(), widest.unwrap_or_default()) {
            (0, _) => write!(f, "closed no hole"),
            (1, width) => write!(f, "closed 1 hole, {width}"),
            (n, widest) => write!(f, "closed {n} holes, at most {widest}"),
        }
    }
}
