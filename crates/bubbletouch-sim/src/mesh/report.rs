//! What is wrong with a mesh, and what it measures. It is looked at, never repaired.

use super::welded::{Joined, has_equal};
use super::{Hole, Side, TriangleMesh, Welded};
use crate::geometry::Aabb;
use std::collections::BTreeMap;
use std::fmt;

/// Counts and measures of a mesh whose corners at exactly the same place are one.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// Different places of corners that a triangle has.
    pub n_vertices: usize,
    /// Triangles.
    pub n_triangles: usize,
    /// Edges, each once.
    pub n_edges: usize,
    /// Parts that share no corner.
    pub n_components: usize,
    /// Triangles with a corner twice.
    pub n_collapsed: usize,
    /// Other triangles whose corners lie in a line, so that they have no normal.
    pub n_slivers: usize,
    /// Triangles with the same three corners as an earlier one, either way round.
    pub n_duplicates: usize,
    /// Edges of three or more triangles.
    pub n_crowded_edges: usize,
    /// Corners at which several fans of triangles touch only there.
    pub n_pinched_vertices: usize,
    /// Edges of two triangles that disagree about the outside.
    pub n_flipped_edges: usize,
    /// For each hole the length of its border, metres, longest first: loops of edges with one triangle.
    pub holes: Vec<f64>,
    /// Sum of the triangles' areas, m².
    pub area: f64,
    /// What the triangles enclose, m³; negative if they face inwards. Of a mesh with holes only about right.
    pub volume: f64,
    /// Around all triangles, metres.
    pub bounds: Aabb,
}

impl MeshReport {
    /// Looks at a mesh.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let welded = Welded::new(mesh);
        let collapsed = |corners: &&[u32; 3]| has_equal(**corners);
        let n_collapsed = welded.corners.iter().filter(collapsed).count();
        let has_normal = |t: &usize| mesh.triangle(*t).normal().is_some();
        let n_flat = mesh.n_triangles() - (0..mesh.n_triangles()).filter(has_normal).count();
        let mut used: Vec<u32> = welded.corners.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let is_flipped =
            |sides: &&[Side]| sides.len() == 2 && sides[0].is_forward == sides[1].is_forward;
        Self {
            n_vertices: used.len(),
            n_triangles: mesh.n_triangles(),
            n_edges: welded.edges().count(),
            n_components: n_components(&welded, &used),
            n_collapsed,
            n_slivers: n_flat - n_collapsed,
            n_duplicates: n_duplicates(&welded),
            n_crowded_edges: welded.edges().filter(|sides| sides.len() > 2).count(),
            n_pinched_vertices: n_pinched(&welded),
            n_flipped_edges: welded.edges().filter(is_flipped).count(),
            holes: Hole::all(mesh, &welded)
                .iter()
                .map(|hole| hole.length)
                .collect(),
            area: mesh.area(),
            volume: mesh.volume_and_centroid().0,
            bounds: mesh.bounds(),
        }
    }

    /// Whether the mesh has no border: every edge has two triangles or more.
    pub fn is_watertight(&self) -> bool {
        self.holes.is_empty() && self.n_edges > 0
    }

    /// Whether it also encloses a volume without doubt: every edge has exactly two triangles that agree about the outside,
    /// and the outside is outside.
    pub fn is_solid(&self) -> bool {
        self.is_watertight()
            && self.n_crowded_edges == 0
            && self.n_flipped_edges == 0
            && self.volume > 0.0
    }

    /// What is wrong, a phrase each; empty if nothing is.
    pub fn faults(&self) -> Vec<String> {
        let count = |n: usize, one: &str, many: &str| {
            (n > 0).then(|| format!("{n} {}", if n == 1 { one } else { many }))
        };
        let holes = count(self.holes.len(), "hole", "holes").map(|holes| {
            let longest = 1e3 * self.holes[0];
            format!("{holes} (longest border {longest:.1} mm)")
        });
        let inwards = self.is_watertight() && self.n_flipped_edges == 0 && self.volume < 0.0;
        let faults = [
            holes,
            inwards.then(|| "faces that face inwards".to_owned()),
            count(
                self.n_flipped_edges,
                "edge whose faces disagree about the outside",
                "edges whose faces disagree about the outside",
            ),
            count(
                self.n_crowded_edges,
                "edge of more than two faces",
                "edges of more than two faces",
            ),
            count(
                self.n_pinched_vertices,
                "vertex where separate parts touch",
                "vertices where separate parts touch",
            ),
            count(
                self.n_collapsed,
                "face with a corner twice",
                "faces with a corner twice",
            ),
            count(self.n_slivers, "face without area", "faces without area"),
            count(self.n_duplicates, "duplicate face", "duplicate faces"),
        ];
        faults.into_iter().flatten().collect()
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = 1e3 * self.bounds.size();
        let low = 1e3 * self.bounds.min;
        let high = 1e3 * self.bounds.max;
        writeln!(
            f,
            "size        {:.1} × {:.1} × {:.1} mm",
            size.x, size.y, size.z
        )?;
        writeln!(f, "from        {:.1}, {:.1}, {:.1} mm", low.x, low.y, low.z)?;
        writeln!(
            f,
            "to          {:.1}, {:.1}, {:.1} mm",
            high.x, high.y, high.z
        )?;
        writeln!(f, "triangles   {}", self.n_triangles)?;
        writeln!(f, "vertices    {}", self.n_vertices)?;
        writeln!(f, "components  {}", self.n_components)?;
        writeln!(f, "area        {:.2} cm²", 1e4 * self.area)?;
        let about = if self.is_solid() { "" } else { " (about)" };
        writeln!(f, "volume      {:.2} cm³{about}", 1e6 * self.volume)?;
        let yes = |yes: bool| if yes { "yes" } else { "no" };
        writeln!(f, "watertight  {}", yes(self.is_watertight()))?;
        writeln!(f, "solid       {}", yes(self.is_solid()))?;
        let faults = self.faults();
        write!(
            f,
            "faults      {}",
            faults.first().map_or("none", String::as_str)
        )?;
        for fault in faults.iter().skip(1) {
            write!(f, "\n            {fault}")?;
        }
        Ok(())
    }
}

fn n_components(welded: &Welded, used: &[u32]) -> usize {
    let mut joined = Joined::of(used.last().map_or(0, |&last| last as usize + 1));
    for &[a, b, c] in &welded.corners {
        joined.join(a, b);
        joined.join(b, c);
    }
    used.iter()
        .filter(|&&vertex| joined.root(vertex) == vertex)
        .count()
}

fn n_duplicates(welded: &Welded) -> usize {
    let mut sorted = welded.corners.clone();
    for corners in &mut sorted {
        corners.sort_unstable();
    }
    sorted.sort_unstable();
    let n = sorted.len();
    sorted.dedup();
    n - sorted.len()
}

/// Corners whose triangles fall into several fans when they may be joined only across edges.
fn n_pinched(welded: &Welded) -> usize {
    // One thing for each corner of each triangle: 3 · triangle + corner.
    let mut joined = Joined::of(3 * welded.corners.len());
    let at = |side: &Side, vertex: u32| {
        let corners = welded.corners[side.triangle as usize];
        let place = corners.iter().position(|&corner| corner == vertex);
        3 * side.triangle + place.unwrap_or(0) as u32
    };
    for sides in welded.edges() {
        for pair in sides.windows(2) {
            for vertex in pair[0].edge {
                joined.join(at(&pair[0], vertex), at(&pair[1], vertex));
            }
        }
    }
    let mut fans: BTreeMap<u32, usize> = BTreeMap::new();
    for (triangle, &corners) in welded.corners.iter().enumerate() {
        for (k, &vertex) in corners.iter().enumerate() {
            let thing = (3 * triangle + k) as u32;
            if !has_equal(corners) && joined.root(thing) == thing {
                *fans.entry(vertex).or_default() += 1;
            }
        }
    }
    fans.values().filter(|&&n| n > 1).count()
}
