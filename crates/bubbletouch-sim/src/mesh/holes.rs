//! Holes of a mesh: found, measured, and closed on request.

use super::welded::Joined;
use super::{TriangleMesh, Welded};
use crate::error::{Error, Result};
use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt;

/// A connected part of the border of a mesh: edges with one face.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Its edges as their faces pass them, from corner to corner.
    pub border: Vec<[u32; 2]>,
    /// Length of the border, metres.
    pub length: f64,
    /// The largest distance between two corners of the border, metres.
    pub width: f64,
}

impl Hole {
    /// All holes of a mesh, the longest first.
    pub fn all(mesh: &TriangleMesh, welded: &Welded) -> Vec<Self> {
        let single = welded.edges().filter(|sides| sides.len() == 1);
        let borders: Vec<[u32; 2]> = single
            .map(|sides| match (sides[0].edge, sides[0].is_forward) {
                (edge, true) => edge,
                ([low, high], false) => [high, low],
            })
            .collect();
        let mut joined = Joined::of(mesh.vertices().len());
        for &[a, b] in &borders {
            joined.join(a, b);
        }
        let mut parts: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
        for edge in borders {
            parts.entry(joined.root(edge[0])).or_default().push(edge);
        }
        let mut holes: Vec<Self> = parts.into_values().map(|b| Self::of(mesh, b)).collect();
        holes.sort_by(|a, b| b.length.total_cmp(&a.length));
        holes
    }

    fn of(mesh: &TriangleMesh, border: Vec<[u32; 2]>) -> Self {
        let place = |corner: u32| mesh.vertices()[corner as usize];
        let edges = border.iter().map(|&[a, b]| place(a).distance(place(b)));
        Self {
            length: edges.sum(),
            width: width(border.iter().map(|&[from, _]| place(from)).collect()),
            border,
        }
    }

    /// Whether its border enters every corner as often as it leaves it, so that a cone closes it.
    fn is_circuit(&self) -> bool {
        let mut balance: BTreeMap<u32, i32> = BTreeMap::new();
        for &[from, to] in &self.border {
            *balance.entry(from).or_default() += 1;
            *balance.entry(to).or_default() -= 1;
        }
        balance.values().all(|&sum| sum == 0)
    }
}

/// The largest distance between two points.
fn width(mut points: Vec<DVec3>) -> f64 {
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    // Far ones first: two that lie nearer to the middle than half the width cannot be wider.
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

/// What was closed.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedHoles {
    /// The mesh with a cone over each of them: a triangle for each edge of the border, to the middle of its corners.
    pub mesh: TriangleMesh,
    /// The width of each, metres, the widest first.
    pub widths: Vec<f64>,
}

impl TriangleMesh {
    /// Closes all holes at most this wide (metres, not negative); wider ones stay.
    ///
    /// # Errors
    /// The width is negative or not a number.
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
        let mesh = Self::new("mesh with closed holes", vertices, triangles)?;
        Ok(ClosedHoles { mesh, widths })
    }
}

impl fmt::Display for ClosedHoles {
    /// `closed 2 holes, at most 0.93 mm wide`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.widths[..] {
            [] => write!(f, "closed no hole"),
            [width] => write!(f, "closed 1 hole, {:.2} mm wide", 1e3 * width),
            [widest, ..] => write!(
                f,
                "closed {} holes, at most {:.2} mm wide",
                self.widths.len(),
                1e3 * widest
            ),
        }
    }
}
