//! Orientation of meshes: turns closed parts outwards, and decides whether the faces of open parts face outwards.
//!
//! Let w be the winding number of the space around a closed part, and s = ±1 the sign of the part's signed volume. If
//! w + s < 0, the outside of the part is not enclosed by the mesh, so the triangles of the part are turned. A part that faces inwards inside a part that
//! faces outwards
//! (w = 1, s = −1) is a cavity and is kept. If a part is turned, the parts inside it are turned, too: a mirrored housing keeps
//! its cavity.

use super::crossings::winding;
use super::enclosed::Enclosed;
use super::welded::{is_balanced, is_flipped};
use super::{Bvh, EdgeSide, Triangle, TriangleMesh, Welded};
use crate::disjoint_sets::DisjointSets;
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use std::fmt;

/// Maximum number of triangles from which rays are sent to find the outside of an open part. If larger, the test is slower; if smaller, few rays test parts
/// with narrow openings.
const MAX_RAYS: usize = 2000;

/// Number of points of one part of a mesh that are tested against another part; the majority decides, so the number is odd.
const N_POINTS: usize = 9;

/// Smallest volume of a part relative to its area to the power 3/2. Parts with less volume enclose nothing: they are the two sides of a surface without
/// thickness.
const MIN_VOLUME: f64 = 1e-9;

/// Largest area fraction of an open part that may face inwards. Above this fraction, the orientation of the part is undecided. If smaller, scans with a few
/// flipped triangles are rejected. If larger, a skin on the part may point both ways.
const MAX_DISAGREEING: f64 = 0.05;

/// Orientation of the triangles of a mesh, as determined by `turned_outwards`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Orientation {
    /// The triangles already faced outwards. Flat surfaces and open parts without an outside count as outwards if their faces are consistent.
    Outwards,
    /// The triangles face outwards after some triangles of closed parts were turned.
    Turned {
        /// Number of triangles that were turned.
        n_triangles: usize,
        /// Number of triangles of the mesh.
        n_all: usize,
    },
    /// The orientation is undecided, because an open part faces inwards or its faces are inconsistent. No triangle was turned.
    NotConverged(&'static str),
}

impl Orientation {
    /// Returns an error if the orientation of the mesh is undecided; `place` is the name of its file.
    ///
    /// # Errors
    /// If the orientation is undecided (`NotConverged`); the error begins with `place`.
    pub fn require(&self, place: &str) -> Result<()> {
        match self {
            Self::NotConverged(given) => {
                let allowed = "faces counter-clockwise seen from outside, or a closed mesh, which is turned outwards";
                Err(Error::input(place, given, allowed))
            }
            Self::Outwards | Self::Turned { .. } => Ok(()),
        }
    }

    /// Returns whether triangles were turned.
    pub fn is_turned(&self) -> bool {
        matches!(self, Self::Turned { .. })
    }
}

impl fmt::Display for Orientation {
    /// Formats the orientation as a phrase, such as `12 of 12 triangles faced inwards and were turned outwards`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outwards => write!(f, "faces outwards"),
            Self::Turned {
                n_triangles: n,
                n_all,
            } => {
                write!(
                    f,
                    "{n} of {n_all} triangles faced inwards and were turned outwards"
                )
            }
            Self::NotConverged(given) => write!(f, "{given}"),
        }
    }
}

impl TriangleMesh {
    /// Turns the triangles of closed parts so that the mesh faces outwards: neighbours are consistent, and no point has a negative winding number. Cavities
    /// inside other parts remain cavities. Open parts are not changed; rays from their faces decide whether they face outwards.
    pub fn turned_outwards(self) -> (Self, Orientation) {
        let welded = Welded::new(&self);
        let mut parts = Parts::new(&self, &welded);
        parts.make_neighbours_agree();
        parts.turn_closed_parts();
        if let Some(given) = parts.unsettled() {
            // A partly turned mesh with an undecided part is useless, so the original is returned.
            return (self, Orientation::NotConverged(given));
        }
        let n_triangles = parts.is_turned.iter().filter(|&&turned| turned).count();
        if n_triangles == 0 {
            return (self, Orientation::Outwards);
        }
        let turned = parts.is_turned;
        let n_all = self.n_triangles();
        let orientation = Orientation::Turned { n_triangles, n_all };
        (self.with_turned(&turned), orientation)
    }
}

/// Parts of a mesh. A part consists of the triangles that are connected by edges.
struct Parts<'a> {
    mesh: &'a TriangleMesh,
    welded: &'a Welded,
    /// Indices of the triangles of each part, ascending.
    triangles: Vec<Vec<usize>>,
    /// Index of the part of each triangle.
    part_of: Vec<usize>,
    /// Whether each triangle must be turned to face outwards.
    is_turned: Vec<bool>,
    /// Whether each part is closed: every edge has equally many triangles in both directions.
    is_closed: Vec<bool>,
}

impl<'a> Parts<'a> {
    fn new(mesh: &'a TriangleMesh, welded: &'a Welded) -> Self {
        let n = mesh.n_triangles();
        let mut joined = DisjointSets::new(n);
        for sides in welded.edges() {
            for pair in sides.windows(2) {
                joined.join(pair[0].triangle as usize, pair[1].triangle as usize);
            }
        }
        let (triangles, part_of) = joined.groups();
        let mut parts = Self {
            mesh,
            welded,
            triangles,
            part_of,
            is_turned: vec![false; n],
            is_closed: Vec::new(),
        };
        parts.is_closed = parts.closed();
        parts
    }

    /// Returns whether a side's triangle passes the edge forwards, after the triangle is turned if necessary.
    fn is_forward(&self, side: &EdgeSide) -> bool {
        side.is_forward != self.is_turned[side.triangle as usize]
    }

    /// Returns for each part whether the part is closed, that is, equally many triangles pass every edge in both directions.
    fn closed(&self) -> Vec<bool> {
        // Triangles with a repeated corner have no edges of their own; they are parts that enclose nothing.
        let mut is_closed = vec![true; self.triangles.len()];
        for sides in self.welded.edges() {
            let part = self.part_of[sides[0].triangle as usize];
            is_closed[part] &= is_balanced(sides, |side| self.is_forward(side));
        }
        is_closed
    }

    /// Turns as few triangles as possible in each open part, so that the two triangles at an edge are consistently oriented. Parts that do not become closed
    /// stay unchanged.
    fn make_neighbours_agree(&mut self) {
        if self.is_closed.iter().all(|&closed| closed) {
            return;
        }
        let mut neighbours: Vec<Vec<(u32, bool)>> = vec![Vec::new(); self.part_of.len()];
        for sides in self.welded.edges() {
            if let [a, b] = sides
                && !self.is_closed[self.part_of[a.triangle as usize]]
            {
                let disagree = a.is_forward == b.is_forward;
                neighbours[a.triangle as usize].push((b.triangle, disagree));
                neighbours[b.triangle as usize].push((a.triangle, disagree));
            }
        }
        let mut is_seen = vec![false; self.part_of.len()];
        for start in 0..self.part_of.len() {
            if is_seen[start] || neighbours[start].is_empty() {
                continue;
            }
            is_seen[start] = true;
            let mut reached = vec![start];
            let mut next = 0;
            while next < reached.len() {
                let triangle = reached[next];
                next += 1;
                for &(neighbour, disagree) in &neighbours[triangle] {
                    let neighbour = neighbour as usize;
                    if !std::mem::replace(&mut is_seen[neighbour], true) {
                        self.is_turned[neighbour] = self.is_turned[triangle] != disagree;
                        reached.push(neighbour);
                    }
                }
            }
            let n_turned = reached.iter().filter(|&&t| self.is_turned[t]).count();
            if 2 * n_turned > reached.len() {
                for triangle in reached {
                    self.is_turned[triangle] ^= true;
                }
            }
        }
        self.is_closed = self.closed();
        for (part, triangles) in self.triangles.iter().enumerate() {
            if !self.is_closed[part] {
                triangles.iter().for_each(|&t| self.is_turned[t] = false);
            }
        }
    }

    /// Returns the corners of a triangle; in reversed order if the triangle is marked to be turned.
    fn triangle(&self, triangle: usize) -> Triangle {
        let [a, b, c] = self.mesh.triangle(triangle).0;
        match self.is_turned[triangle] {
            true => Triangle([a, c, b]),
            false => Triangle([a, b, c]),
        }
    }

    /// Returns the signed volume of a closed part, m³; 0 if the part encloses nothing.
    fn volume(&self, part: usize) -> f64 {
        let apex = self.triangle(self.triangles[part][0]).0[0];
        let (mut enclosed, mut area) = (Enclosed::default(), 0.0);
        for triangle in self.triangles[part].iter().map(|&t| self.triangle(t)) {
            enclosed.add(triangle.0.map(|corner| corner - apex), 1.0);
            area += triangle.area();
        }
        let is_solid = enclosed.volume.abs() > MIN_VOLUME * area.powf(1.5);
        if is_solid { enclosed.volume } else { 0.0 }
    }

    /// Turns closed parts so that they face outwards. Cavities, whose outside is enclosed by other parts, keep facing inwards.
    fn turn_closed_parts(&mut self) {
        let closed = (0..self.triangles.len()).filter(|&part| self.is_closed[part]);
        let volumes = closed.map(|part| (part, self.volume(part)));
        let mut solids: Vec<(usize, f64)> = volumes.filter(|(_, volume)| *volume != 0.0).collect();
        if solids.iter().all(|(_, volume)| *volume > 0.0) {
            return;
        }
        // A part is larger than the parts that it encloses.
        solids.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
        let mut placed: Vec<Enclosure> = Vec::new();
        for (part, volume) in solids {
            let triangles = self.triangles[part].iter().map(|&t| self.triangle(t));
            let triangles: Vec<Triangle> = triangles.collect();
            let bounds = Aabb::around_points(triangles.iter().flat_map(|triangle| triangle.0));
            let mut outside = 0;
            // The smallest part that encloses this part comes last.
            let mut is_turned = false;
            for other in placed.iter_mut().filter(|other| other.may_hold(&bounds)) {
                let winding = other.winding_around(&triangles);
                if winding != 0 {
                    outside += if other.is_turned { -winding } else { winding };
                    is_turned = other.is_turned;
                }
            }
            let sign = if (volume > 0.0) == is_turned { -1 } else { 1 };
            is_turned ^= outside + sign < 0;
            if is_turned {
                for &triangle in &self.triangles[part] {
                    self.is_turned[triangle] ^= true;
                }
            }
            placed.push(Enclosure {
                bounds,
                triangles,
                bvh: None,
                is_turned,
            });
        }
    }

    /// Returns the fault of an open part whose faces are inconsistent or face inwards, according to rays from its faces; `None` if there is none.
    fn unsettled(&self) -> Option<&'static str> {
        if self.is_closed.iter().all(|&closed| closed) {
            return None;
        }
        let bvh = Bvh::new(self.mesh);
        let size = bvh.bounds().size().length();
        let mut has_flipped = vec![false; self.triangles.len()];
        for sides in self.welded.edges().filter(|sides| is_flipped(sides)) {
            has_flipped[self.part_of[sides[0].triangle as usize]] = true;
        }
        let open = (0..self.triangles.len()).filter(|&part| !self.is_closed[part]);
        let total: usize = open.clone().map(|part| self.triangles[part].len()).sum();
        let stride = total.div_ceil(MAX_RAYS);
        let (mut outwards, mut inwards, mut is_flipped) = (0.0, 0.0, false);
        let all = open.flat_map(|part| self.triangles[part].iter().map(move |&t| (part, t)));
        for (part, number) in all.step_by(stride) {
            is_flipped |= has_flipped[part];
            let triangle = self.mesh.triangle(number);
            let Some(normal) = triangle.normal() else {
                continue;
            };
            let is_free = |direction| {
                let range = 1e-7 * size..f64::INFINITY;
                bvh.first_hit(triangle.middle(), direction, range).is_none()
            };
            match (is_free(normal), is_free(-normal)) {
                (true, false) => outwards += triangle.area(),
                (false, true) => inwards += triangle.area(),
                _ => {}
            }
        }
        if inwards > outwards {
            return Some("an open mesh whose faces face inwards");
        }
        let disagree = is_flipped && inwards >= MAX_DISAGREEING * (inwards + outwards);
        disagree.then_some("an open mesh whose faces disagree about the outside")
    }
}

/// Closed part that may contain other parts.
struct Enclosure {
    bounds: Aabb,
    /// Triangles of the part before they were turned.
    triangles: Vec<Triangle>,
    bvh: Option<Bvh>,
    is_turned: bool,
}

impl Enclosure {
    fn may_hold(&self, bounds: &Aabb) -> bool {
        self.bounds.min.cmple(bounds.min).all() && self.bounds.max.cmpge(bounds.max).all()
    }

    /// Returns the winding number of this part (before turning) around another part, given by its triangles. The majority of several points decides; the
    /// number is 0 outside.
    fn winding_around(&mut self, triangles: &[Triangle]) -> i32 {
        let bvh = self.bvh.get_or_insert_with(|| {
            Bvh::from_triangles(self.triangles.clone()).expect("a part has triangles")
        });
        let stride = triangles.len().div_ceil(N_POINTS);
        let points = triangles.iter().step_by(stride).map(Triangle::middle);
        let mut windings: Vec<i32> = points.map(|point| winding(bvh, point)).collect();
        windings.sort_unstable();
        windings[windings.len() / 2]
    }
}
