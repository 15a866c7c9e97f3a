//! Report of the faults and measures of a mesh, which itself stays unchanged.

use super::welded::{has_equal, is_flipped};
use super::{EdgeSide, Hole, TriangleMesh, Welded};
use crate::disjoint_sets::DisjointSets;
use crate::geometry::Aabb;
use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt;

/// Counts and measurements of a mesh, after corners with identical coordinates were merged.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// Number of distinct corners of all triangles.
    pub n_vertices: usize,
    /// Number of triangles.
    pub n_triangles: usize,
    /// Number of edges, each counted once.
    pub n_edges: usize,
    /// Number of components of the mesh (parts that share no corner).
    pub n_components: usize,
    /// Number of triangles with two equal corners.
    pub n_collapsed: usize,
    /// Number of triangles with three different but collinear corners, which have no normal.
    pub n_slivers: usize,
    /// Number of triangles with the three corners of an earlier triangle, in either direction.
    pub n_duplicates: usize,
    /// Number of edges with three or more triangles.
    pub n_crowded_edges: usize,
    /// Number of corners at which several fans of triangles meet only in this one point.
    pub n_pinched_vertices: usize,
    /// Number of edges with two inconsistently oriented triangles.
    pub n_flipped_edges: usize,
    /// Length of the border of each hole, metres, longest first. A hole is a loop of edges with one triangle.
    pub holes: Vec<f64>,
    /// Sum of the triangles' areas, m².
    pub area: f64,
    /// Volume that the mesh encloses, m³, negative if the triangles face inwards; approximate for a mesh with holes.
    pub volume: f64,
    /// Bounding box of all triangles, metres.
    pub bounds: Aabb,
}

impl MeshReport {
    /// Computes the report of a mesh.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let welded = Welded::new(mesh);
        let collapsed = |corners: &&[u32; 3]| has_equal(**corners);
        let n_collapsed = welded.corners.iter().filter(collapsed).count();
        let has_normal = |t: &usize| mesh.triangle(*t).normal().is_some();
        let n_flat = mesh.n_triangles() - (0..mesh.n_triangles()).filter(has_normal).count();
        let mut used: Vec<u32> = welded.corners.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
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
            n_flipped_edges: welded.edges().filter(|sides| is_flipped(sides)).count(),
            holes: Hole::all(mesh, &welded)
                .iter()
                .map(|hole| hole.length)
                .collect(),
            area: mesh.area(),
            volume: mesh.volume_and_centroid().0,
            bounds: mesh.bounds(),
        }
    }

    /// Returns whether the mesh has no border, that is, every edge has at least two triangles.
    pub fn is_watertight(&self) -> bool {
        self.holes.is_empty() && self.n_edges > 0
    }

    /// Returns whether the mesh is watertight and also encloses a definite volume: every edge has exactly two consistently oriented triangles,
    /// and the volume is positive.
    pub fn is_solid(&self) -> bool {
        self.is_watertight()
            && self.n_crowded_edges == 0
            && self.n_flipped_edges == 0
            && self.volume > 0.0
    }

    /// Returns the faults of the mesh, one phrase each; empty if there are none.
    pub fn faults(&self) -> Vec<String> {
        let count = |n: usize, noun: &str, what: &str| {
            let plural = match (n, noun) {
                (1, _) => noun.to_owned(),
                (_, "vertex") => "vertices".to_owned(),
                _ => format!("{noun}s"),
            };
            (n > 0).then(|| format!("{n} {plural}{what}"))
        };
        let longest = 1e3 * self.holes.first().unwrap_or(&0.0);
        let border = format!(" (longest border {longest:.1} mm)");
        let inwards = self.is_watertight() && self.n_flipped_edges == 0 && self.volume < 0.0;
        let disagree = " whose faces disagree about the outside";
        let faults = [
            count(self.holes.len(), "hole", &border),
            inwards.then(|| "faces that face inwards".to_owned()),
            count(self.n_flipped_edges, "edge", disagree),
            count(self.n_crowded_edges, "edge", " of more than two faces"),
            count(
                self.n_pinched_vertices,
                "vertex",
                " where separate parts touch",
            ),
            count(self.n_collapsed, "face", " with a corner twice"),
            count(self.n_slivers, "face", " without area"),
            count(self.n_duplicates, "duplicate face", ""),
        ];
        faults.into_iter().flatten().collect()
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mm = |lengths: DVec3, between: &str| {
            let lengths = (1e3 * lengths)
                .to_array()
                .map(|length| format!("{length:.1}"));
            format!("{} mm", lengths.join(between))
        };
        writeln!(f, "size        {}", mm(self.bounds.size(), " × "))?;
        writeln!(f, "from        {}", mm(self.bounds.min, ", "))?;
        writeln!(f, "to          {}", mm(self.bounds.max, ", "))?;
        writeln!(f, "triangles   {}", self.n_triangles)?;
        writeln!(f, "vertices    {}", self.n_vertices)?;
        writeln!(f, "components  {}", self.n_components)?;
        writeln!(f, "area        {:.2} cm²", 1e4 * self.area)?;
        let about = if self.is_solid() { "" } else { " (about)" };
        writeln!(f, "volume      {:.2} cm³{about}", 1e6 * self.volume)?;
        let yes = |yes: bool| if yes { "yes" } else { "no" };
        writeln!(f, "watertight  {}", yes(self.is_watertight()))?;
        writeln!(f, "solid       {}", yes(self.is_solid()))?;
        let faults = self.faults().join("\n            ");
        let faults = if faults.is_empty() { "none" } else { &faults };
        write!(f, "faults      {faults}")
    }
}

fn n_components(welded: &Welded, used: &[u32]) -> usize {
    let mut joined = DisjointSets::new(used.last().map_or(0, |&last| last as usize + 1));
    for corners in &welded.corners {
        let [a, b, c] = corners.map(|corner| corner as usize);
        joined.join(a, b);
        joined.join(b, c);
    }
    let used = used.iter().map(|&vertex| vertex as usize);
    used.filter(|&vertex| joined.root(vertex) == vertex).count()
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

/// Returns the number of corners whose triangles form several fans. A fan consists of triangles that are joined across edges.
fn n_pinched(welded: &Welded) -> usize {
    // One element per corner of each triangle: 3 · triangle + corner.
    let mut joined = DisjointSets::new(3 * welded.corners.len());
    let at = |side: &EdgeSide, vertex: u32| {
        let corners = welded.corners[side.triangle as usize];
        let place = corners.iter().position(|&corner| corner == vertex);
        3 * side.triangle as usize + place.unwrap_or(0)
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
            let thing = 3 * triangle + k;
            if !has_equal(corners) && joined.root(thing) == thing {
                *fans.entry(vertex).or_default() += 1;
            }
        }
    }
    fans.values().filter(|&&n| n > 1).count()
}
