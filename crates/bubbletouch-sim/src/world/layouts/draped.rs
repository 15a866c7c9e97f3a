//! Layout draped over a triangle mesh: taxels keep a minimum distance, and every point of the surface has a taxel nearby.

use super::drape_region::{DrapeRegion, Rays};
use crate::error::{Error, Result};
use crate::mesh::{Triangle, TriangleMesh};
use crate::random::Seed;
use crate::text::in_range::positive;
use crate::world::Layout;
use glam::DVec3;
use rand::seq::SliceRandom;
use std::collections::{BTreeMap, HashMap};

/// Smallest distance between taxels, in pitches. Random points are added as long as a further point can keep this distance from all others. This process
/// yields about 0.7 / distance² taxels per square pitch: at 0.83 as many as on a grid of this pitch.
const LEAST: f64 = 0.83;
/// Longest edge of a piece of surface, in pitches. If smaller, taxels are packed more densely and more memory is used. If larger, the surface between two
/// pieces may be farther from a taxel than a pitch (0.83 + 2/3 of this constant).
const PIECE: f64 = 0.25;
/// Maximum number of surface pieces: enough for some 100,000 taxels, in 2 GB. The bound also covers long triangles without area.
const MAX_PIECES: usize = 1 << 24;
/// Cosine of the angle between normals below which two pieces belong to opposite sides of a thin wall; taxels on them may be close together.
const OPPOSED: f64 = -0.5;

impl Layout {
    /// Distributes taxels over the outer surface of a whole mesh.
    ///
    /// # Errors
    /// If `draped_on`, which also accepts a region, fails.
    pub fn draped(mesh: &TriangleMesh, pitch: f64, seed: &Seed) -> Result<Self> {
        Self::draped_on(mesh, pitch, &DrapeRegion::default(), seed)
    }

    /// Distributes taxels over a region of a mesh's outer surface, as many as on a grid of this pitch (metres). Taxels are ordered by triangle.
    ///
    /// The outer surface consists of the points from which a ray along the axis does not meet the mesh again. Other points, such as the walls of a cavity,
    /// carry no taxel; `n_left_out` counts the taxels omitted there.
    ///
    /// Each taxel is at least 0.83 pitches from the others, except taxels on the back of a thin wall. Every point of the outer surface is within a pitch of a
    /// taxel. Random points are accepted if they are far enough from all accepted ones (dart throwing); equal seeds give equal taxels. The run time is about
    /// 0.3 ms per taxel.
    ///
    /// Axes are the mean normals of the surface within half a pitch. The averaging smooths the facets of a scan and keeps the
    /// sides of a box flat. If a ray along a mean normal meets the mesh again, the axis is the normal of the taxel's own triangle.
    ///
    /// # Errors
    /// If the pitch is not positive, the surface has no area, or the outside of an open mesh is not known. If the region contains no point of the outer
    /// surface, or if the pitch requires more than about 100,000 taxels.
    pub fn draped_on(
        mesh: &TriangleMesh,
        pitch: f64,
        region: &DrapeRegion,
        seed: &Seed,
    ) -> Result<Self> {
        positive("taxel pitch", pitch, "m")?;
        region.check(mesh)?;
        let (mesh, orientation) = mesh.clone().turned_outwards();
        orientation.require("draped layout")?;
        let mesh = &mesh;
        let too_fine = || {
            Error::input(
                "draped layout",
                format!("pitch {pitch} m on {} m²", mesh.area()),
                "a pitch that some 100,000 taxels cover the surface with",
            )
        };
        let pieces = subdivide(mesh, PIECE * pitch).ok_or_else(too_fine)?;
        if pieces.is_empty() {
            let given = "a mesh without area";
            let allowed = "at least one triangle with a normal";
            return Err(Error::input("draped layout", given, allowed));
        }
        let mut order: Vec<usize> = (0..pieces.len()).collect();
        order.shuffle(&mut seed.named("draped layout").rng());
        let rays = Rays::new(mesh);
        let mask = region.mask(mesh);
        order
            .retain(|&index| mask[pieces[index].triangle] && region.contains(pieces[index].middle));
        // Accepted taxels on the outer surface, and rejected points inside the mesh.
        let (mut taxels, mut inner) = (Taken::new(LEAST * pitch), Taken::new(LEAST * pitch));
        let mut n_left_out = 0;
        for &index in &order {
            let piece = &pieces[index];
            let has_room = |taken: &Taken| {
                let is_same_side = |other: usize| pieces[other].normal.dot(piece.normal) > OPPOSED;
                !taken.near(piece.middle, LEAST * pitch).any(is_same_side)
            };
            if !has_room(&taxels) {
                continue;
            }
            if rays.is_free(piece.middle, piece.normal) {
                taxels.take(index, piece.middle);
            } else if has_room(&inner) {
                inner.take(index, piece.middle);
                n_left_out += 1;
            }
        }
        let mut normals = mean_normals(&pieces, &taxels, 0.5 * pitch);
        if normals.is_empty() {
            let given =
                format!("no place of the region on the outer surface ({n_left_out} taxels inside)");
            let allowed = "a region with places from which a ray leaves the mesh freely";
            return Err(Error::input("draped layout", given, allowed));
        }
        for (&index, normal) in &mut normals {
            if !rays.is_free(pieces[index].middle, *normal) {
                *normal = pieces[index].normal;
            }
        }
        let taxels = normals.into_iter();
        let taxels = taxels.map(|(index, normal)| (pieces[index].middle, normal));
        Ok(Self::of_taxels(taxels).with_left_out(n_left_out))
    }
}

/// Small triangle of the surface, which may become the position of a taxel.
struct SurfaceTriangle {
    /// Index of the mesh's triangle that contains this small triangle.
    triangle: usize,
    middle: DVec3,
    /// Unit normal of the triangle.
    normal: DVec3,
    /// Area of the triangle, m².
    area: f64,
}

/// Divides every triangle that has a normal until no edge is longer than `longest_edge` (metres). Returns `None` if this takes too many pieces.
fn subdivide(mesh: &TriangleMesh, longest_edge: f64) -> Option<Vec<SurfaceTriangle>> {
    // The largest possible piece is an equilateral triangle.
    let largest = 0.25 * 3f64.sqrt() * longest_edge * longest_edge;
    if mesh.area() / largest > MAX_PIECES as f64 {
        return None;
    }
    let mut pieces = Vec::new();
    let mut waiting: Vec<Triangle> = Vec::new();
    for number in 0..mesh.n_triangles() {
        let triangle = mesh.triangle(number);
        let Some(normal) = triangle.normal() else {
            continue;
        };
        waiting.push(triangle);
        while let Some(triangle) = waiting.pop() {
            if triangle.longest_edge_squared() > longest_edge * longest_edge {
                let [first, second] = triangle.bisected();
                waiting.extend([second, first]);
                continue;
            }
            if pieces.len() == MAX_PIECES {
                return None;
            }
            pieces.push(SurfaceTriangle {
                triangle: number,
                middle: triangle.middle(),
                normal,
                area: triangle.area(),
            });
        }
    }
    Some(pieces)
}

/// Returns the mean unit normal of the surface within a distance of each taxel, by the index of the taxel's surface piece. Pieces that face away from the
/// taxel's own piece are ignored.
fn mean_normals(pieces: &[SurfaceTriangle], taxels: &Taken, within: f64) -> BTreeMap<usize, DVec3> {
    let mut sums: BTreeMap<usize, DVec3> = BTreeMap::new();
    for piece in pieces {
        for taxel in taxels.near(piece.middle, within) {
            if piece.normal.dot(pieces[taxel].normal) > 0.0 {
                *sums.entry(taxel).or_default() += piece.area * piece.normal;
            }
        }
    }
    for (&taxel, sum) in &mut sums {
        *sum = sum.normalize_or(pieces[taxel].normal);
    }
    sums
}

/// Surface pieces that have been chosen as positions of taxels, stored in cubic cells of space.
struct Taken {
    /// Side of a cell, metres: twice the search distance, so that a ball with this distance as radius meets at most eight cells.
    side: f64,
    cubes: HashMap<[i64; 3], Vec<(usize, DVec3)>>,
}

impl Taken {
    /// Creates an empty set of taxel positions for searches up to the distance `within`, metres.
    fn new(within: f64) -> Self {
        Self {
            side: 2.0 * within,
            cubes: HashMap::new(),
        }
    }

    fn take(&mut self, piece: usize, place: DVec3) {
        let cube = self.cube(place);
        self.cubes.entry(cube).or_default().push((piece, place));
    }

    /// Returns the surface pieces of the taxels that are nearer to a point than `within` metres.
    fn near(&self, place: DVec3, within: f64) -> impl Iterator<Item = usize> {
        let (low, high) = (self.cube(place - within), self.cube(place + within));
        let columns = (low[0]..=high[0]).flat_map(move |x| (low[1]..=high[1]).map(move |y| [x, y]));
        let cubes = columns.flat_map(move |[x, y]| (low[2]..=high[2]).map(move |z| [x, y, z]));
        cubes
            .filter_map(|cube| self.cubes.get(&cube))
            .flatten()
            .filter(move |(_, middle)| middle.distance_squared(place) < within * within)
            .map(|&(piece, _)| piece)
    }

    fn cube(&self, place: DVec3) -> [i64; 3] {
        (place / self.side).floor().to_array().map(|c| c as i64)
    }
}
