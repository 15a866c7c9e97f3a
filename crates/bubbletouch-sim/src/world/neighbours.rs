//! Neighbours among the taxels of a skin, and their distances along its surface.
//!
//! Two taxels are neighbours if no third one lies in the ball whose diameter they span (a Gabriel graph). At any pitch, an inner taxel has four neighbours in a
//! grid and six in a hexagonal layout. On curved layouts, the neighbours are the surrounding taxels. Taxels with opposed axes belong to opposite sides of a
//! thin wall and are not neighbours. Taxels at one position are neighbours, and share their other neighbours. Positions farther apart than three times the
//! local spacing are not neighbours: the skin has a gap.
//!
//! The distance along the surface is the length of an arc that turns by the angle θ between the axes: chord · (θ/2) / sin(θ/2). The formula is exact on planes,
//! on spheres, and across and along cylinders.

use super::Patch;
use glam::DVec3;

/// Largest distance between neighbouring taxels, as a multiple of the local spacing. If smaller, sparse regions of draped layouts lose some neighbours; if
/// larger, taxels at opposite edges of a gap in the skin become neighbours.
const REACH: f64 = 3.0;
/// Distance, relative to a taxel's radius, below which two taxels count as coincident; smaller distances are ignored when the spacing is computed.
const COINCIDENT: f64 = 0.01;
/// Number of taxels found in one line after which the search for a taxel beside the line ends. If larger, more distant rows become neighbours and long lines
/// take longer.
const MAX_IN_LINE: usize = 256;
/// Cosine of the angle between the directions to two taxels above which both taxels count as lying along one line.
const ALONG: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Cosine of the angle between the axes of two taxels below which they belong to opposite sides of a thin wall.
const OPPOSED: f64 = -0.5;
/// Factor that covers rounding of squared distances: the corners of a square lie exactly on the ball around its diagonal.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Neighbours of every taxel of a skin, as a symmetric graph of taxels.
///
/// If taxel a is a neighbour of b, then b is a neighbour of a. An absent taxel has no neighbours. The neighbours of each taxel are in ascending order.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbours {
    /// Index of each taxel's first neighbour in the list of neighbours, followed by the length of the list.
    starts: Vec<usize>,
    taxels: Vec<u32>,
}

impl Neighbours {
    /// Finds the neighbours of all taxels of a patch; takes about a microsecond per taxel.
    pub fn new(skin: &Patch) -> Self {
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for taxel in 0..skin.n_taxels() {
            let around = around(skin, taxel);
            let is_free = |other: &usize| is_free(skin, [taxel, *other], &around);
            let found = around.iter().copied().filter(is_free);
            pairs.extend(found.flat_map(|other| {
                let (taxel, other) = (taxel as u32, other as u32);
                [[taxel, other], [other, taxel]]
            }));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let first_of = |taxel: usize| pairs.partition_point(|pair| (pair[0] as usize) < taxel);
        Self {
            starts: (0..=skin.n_taxels()).map(first_of).collect(),
            taxels: pairs.into_iter().map(|[_, other]| other).collect(),
        }
    }

    /// Returns the number of taxels of the skin.
    pub fn n_taxels(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the neighbours of a taxel, as ascending indices in the layout.
    ///
    /// # Panics
    /// If the taxel does not exist.
    pub fn of_taxel(&self, taxel: usize) -> impl Iterator<Item = usize> {
        let neighbours = &self.taxels[self.starts[taxel]..self.starts[taxel + 1]];
        neighbours.iter().map(|&other| other as usize)
    }

    /// Returns the largest number of neighbours that a taxel has.
    pub fn most(&self) -> usize {
        let counts = self.starts.windows(2).map(|ends| ends[1] - ends[0]);
        counts.max().unwrap_or(0)
    }

    /// Returns the taxels within `reach` metres of `taxel` along the surface, including the taxel itself, with their distances. Taxels with opposed axes are
    /// included only if a path of neighbours within this distance leads to them, for example around a thin finger.
    pub fn within(&self, skin: &Patch, taxel: usize, reach: f64) -> Vec<(usize, f64)> {
        let near = others_within(skin, taxel, reach.min(size(skin)));
        let near = near
            .into_iter()
            .map(|other| (other, along_surface(skin, [taxel, other])));
        let mut found = vec![(taxel, 0.0)];
        found.extend(near.filter(|&(_, distance)| distance <= reach));
        let mut is_seen: std::collections::HashSet<usize> = found.iter().map(|it| it.0).collect();
        let mut next = 0;
        while let Some(&(at, _)) = found.get(next) {
            next += 1;
            for other in self.of_taxel(at).filter(|&other| is_seen.insert(other)) {
                let distance = along_surface(skin, [taxel, other]);
                if distance <= reach {
                    found.push((other, distance));
                }
            }
        }
        found
    }
}

/// Returns the distance between two taxels along the surface, metres.
fn along_surface(skin: &Patch, [a, b]: [usize; 2]) -> f64 {
    let (centers, axes) = (skin.layout().centers(), skin.layout().axes());
    let half = 0.5 * axes[a].angle_between(axes[b]);
    let bent = if half > 0.0 { half / half.sin() } else { 1.0 };
    centers[a].distance(centers[b]) * bent
}

/// Returns the other taxels within [`REACH`] times the local spacing that lie on the given taxel's side of the skin, nearest first. The spacing is the
/// distance to the nearest taxel in a direction across the direction to the very nearest taxel. Distant rows are therefore neighbours, however dense each row
/// is.
fn around(skin: &Patch, taxel: usize) -> Vec<usize> {
    let centers = skin.layout().centers();
    let away = |other: usize| centers[other] - centers[taxel];
    let size = size(skin);
    let own_radius = skin.taxels().at(taxel).radius;
    let mut radius = own_radius;
    loop {
        let mut others = others_within(skin, taxel, radius);
        others.sort_by(|&a, &b| away(a).length().total_cmp(&away(b).length()));
        let is_apart = |other: &&usize| away(**other).length() > COINCIDENT * own_radius;
        let mut apart = others.iter().filter(is_apart);
        let nearest = apart.next().map(|&other| away(other).normalize());
        let is_across = |other: &&usize| {
            nearest.is_some_and(|way| away(**other).normalize().dot(way).abs() < ALONG)
        };
        let spacing = apart.find(is_across).map(|&other| away(other).length());
        match spacing {
            Some(spacing) if REACH * spacing <= radius => {
                others.retain(|&other| away(other).length() <= REACH * spacing * ROUNDING);
                return others;
            }
            Some(spacing) => radius = REACH * spacing,
            // If all taxels lie in one line, the spacing is the distance along this line.
            None if radius > size || others.len() > MAX_IN_LINE => {
                let nearest = others.iter().find(is_apart);
                let reach = nearest.map_or(0.0, |&other| REACH * away(other).length());
                let reach = reach.max(COINCIDENT * own_radius);
                others.retain(|&other| away(other).length() <= reach * ROUNDING);
                return others;
            }
            None => radius *= 2.0,
        }
    }
}

/// Returns the diagonal of the bounding box of a patch's taxels, metres.
fn size(skin: &Patch) -> f64 {
    let bounds = skin.tree().bounds();
    bounds.map_or(0.0, |bounds| bounds.size().length())
}

fn others_within(skin: &Patch, taxel: usize, radius: f64) -> Vec<usize> {
    let (centers, axes) = (skin.layout().centers(), skin.layout().axes());
    let (center, axis) = (centers[taxel], axes[taxel]);
    let mut others = Vec::new();
    if skin.is_absent(taxel) {
        return others;
    }
    skin.tree().each_near(center, radius, |near| {
        let other = near.number as usize;
        let is_same_side = axes[other].dot(axis) > OPPOSED && !skin.is_absent(other);
        if other != taxel && is_same_side && near.center.distance(center) <= radius * ROUNDING {
            others.push(other);
        }
    });
    others
}

/// Returns whether no taxel of the list `around` lies between the taxels `a` and `b`. A taxel that coincides with `a` or `b` is not between them.
fn is_free(skin: &Patch, [a, b]: [usize; 2], around: &[usize]) -> bool {
    let centers = skin.layout().centers();
    let middle: DVec3 = 0.5 * (centers[a] + centers[b]);
    let square = 0.25 * centers[a].distance_squared(centers[b]) * ROUNDING;
    let same_place = (COINCIDENT * skin.taxels().at(a).radius).powi(2);
    let is_at =
        |other: usize, end: usize| centers[other].distance_squared(centers[end]) <= same_place;
    let is_between = |&&other: &&usize| {
        centers[other].distance_squared(middle) <= square && !is_at(other, a) && !is_at(other, b)
    };
    is_at(a, b) || !around.iter().any(|other| is_between(&other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriangleMesh;
    use crate::random::Seed;
    use crate::world::fixtures::{TAXEL, grid};
    use crate::world::{Layout, Taxels};
    use std::f64::consts::PI;

    const PITCH: f64 = 2e-3;

    fn skin(layout: Layout) -> Patch {
        Patch::new("skin", layout, Taxels::Equal(TAXEL)).unwrap()
    }

    fn counts(neighbours: &Neighbours) -> Vec<usize> {
        let taxels = 0..neighbours.n_taxels();
        taxels.map(|k| neighbours.of_taxel(k).count()).collect()
    }

    #[test]
    fn a_grid_has_four_and_a_hexagonal_layout_six() {
        let layout = Layout::grid(&grid(7, 5, PITCH)).unwrap();
        let neighbours = Neighbours::new(&skin(layout));
        for (taxel, (x, y)) in (0..35).map(|k| (k, (k % 7, k / 7))) {
            let found: Vec<usize> = neighbours.of_taxel(taxel).collect();
            let is_one = |&other: &usize| (other % 7).abs_diff(x) + (other / 7).abs_diff(y) == 1;
            let expected: Vec<usize> = (0..35).filter(is_one).collect();
            assert_eq!(found, expected, "taxel {taxel}");
        }
        let hexagonal = Neighbours::new(&skin(Layout::hexagonal(9, 9, PITCH).unwrap()));
        assert_eq!(hexagonal.of_taxel(40).count(), 6);
        assert_eq!(hexagonal.most(), 6);
        // The rows of a whole cylinder have no ends.
        let cylinder = Layout::cylinder(0.02, 0.05, 2.0 * PI, PITCH).unwrap();
        let counts = counts(&Neighbours::new(&skin(cylinder)));
        assert!(counts.iter().all(|n| (3..=4).contains(n)), "{counts:?}");
    }

    #[test]
    fn on_any_layout_they_are_mutual_and_lead_everywhere() {
        let cap = Layout::sphere_cap(0.02, 1.2, PITCH).unwrap();
        let corner = |k: usize| {
            let side = if k.is_multiple_of(2) { 0.02 } else { -0.02 };
            DVec3::AXES[k / 2] * side
        };
        let face = |k: u32| {
            let [x, y, z] = [k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2)];
            match k.count_ones() % 2 {
                0 => [x, y, z],
                _ => [x, z, y],
            }
        };
        let faces = (0..8).map(face).collect();
        let octahedron = TriangleMesh::new("octahedron", (0..6).map(corner).collect(), faces);
        let draped = Layout::draped(&octahedron.unwrap(), PITCH, &Seed::new(4)).unwrap();
        let disc = Layout::disc(0.02, PITCH).unwrap();
        for layout in [cap, draped, disc] {
            let skin = skin(layout);
            let neighbours = Neighbours::new(&skin);
            for taxel in 0..skin.n_taxels() {
                for other in neighbours.of_taxel(taxel) {
                    assert!(neighbours.of_taxel(other).any(|back| back == taxel));
                }
            }
            assert!(counts(&neighbours).iter().all(|n| (1..=9).contains(n)));
            let all = neighbours.within(&skin, 0, f64::INFINITY);
            assert_eq!(all.len(), skin.n_taxels());
        }
    }

    #[test]
    fn the_way_around_a_cylinder_is_an_arc_and_the_sides_of_a_sheet_are_apart() {
        let radius = 0.02;
        let at = |angle: f64| {
            let axis = DVec3::new(angle.sin(), 0.0, angle.cos());
            (radius * axis, axis)
        };
        let (centers, axes) = (0..40).map(|k| at(0.07 * f64::from(k))).unzip();
        let bent = skin(Layout::new(centers, axes).unwrap());
        let neighbours = Neighbours::new(&bent);
        let found = neighbours.within(&bent, 5, 0.01);
        for &(taxel, distance) in &found {
            let arc = radius * 0.07 * taxel.abs_diff(5) as f64;
            assert!((distance - arc).abs() < 1e-12, "{taxel}");
        }
        // Five taxels before, the taxel itself, and seven behind: 1.4 mm each.
        assert_eq!(found.len(), 13);
        let places =
            (0..10).map(|k| DVec3::new(PITCH * f64::from(k % 5), 0.0, 1e-4 * f64::from(k / 5)));
        let axes = (0..10).map(|k| if k < 5 { -DVec3::Z } else { DVec3::Z });
        let sheet = skin(Layout::new(places.collect(), axes.collect()).unwrap());
        let neighbours = Neighbours::new(&sheet);
        let is_apart = |taxel| {
            let mut around = neighbours.of_taxel(taxel);
            around.all(|other| (other < 5) == (taxel < 5))
        };
        assert!((0..10).all(is_apart));
        assert_eq!(counts(&neighbours), [1, 2, 2, 2, 1, 1, 2, 2, 2, 1]);
    }

    #[test]
    fn rows_far_apart_are_neighbours_and_both_edges_of_a_wide_gap_are_not() {
        for across in [2.9e-3, 3.1e-3, 12e-3] {
            let place =
                |k: u32| DVec3::new(1e-3 * f64::from(k % 9), across * f64::from(k / 9), 0.0);
            let rows = Layout::new((0..27).map(place).collect(), vec![DVec3::Z; 27]);
            let neighbours = Neighbours::new(&skin(rows.unwrap()));
            let found: Vec<usize> = neighbours.of_taxel(13).collect();
            assert_eq!(found, [4, 12, 14, 22], "{across} m");
        }
        // The edges of a cuff with an opening of 90 degrees.
        let cuff = skin(Layout::cylinder(0.02, 0.01, 1.5 * PI, PITCH).unwrap());
        let neighbours = Neighbours::new(&cuff);
        let centers = cuff.layout().centers();
        for taxel in 0..cuff.n_taxels() {
            let mut found = neighbours.of_taxel(taxel);
            assert!(found.all(|other| centers[other].distance(centers[taxel]) < 2.0 * PITCH));
        }
    }

    #[test]
    fn both_ends_of_a_wide_gap_in_a_line_are_not_neighbours() {
        let places = [0.0, 1.0, 2.0, 10.0, 11.0, 12.0].map(|along| PITCH * along * DVec3::X);
        let line = Layout::new(places.to_vec(), vec![DVec3::Z; 6]).unwrap();
        assert_eq!(counts(&Neighbours::new(&skin(line))), [1, 2, 1, 1, 2, 1]);
    }

    #[test]
    fn taxels_at_one_place_have_the_neighbours_of_the_place_and_one_another() {
        let place = |k: u32| PITCH * DVec3::new(f64::from(k / 3 % 4), f64::from(k / 12), 0.0);
        let tripled = Layout::new((0..36).map(place).collect(), vec![DVec3::Z; 36]);
        let neighbours = Neighbours::new(&skin(tripled.unwrap()));
        let found: Vec<usize> = neighbours.of_taxel(16).collect();
        assert_eq!(found, [3, 4, 5, 12, 13, 14, 15, 17, 18, 19, 20, 27, 28, 29]);
    }

    #[test]
    fn a_taxel_alone_has_none() {
        let one = skin(Layout::new(vec![DVec3::ZERO], vec![DVec3::Z]).unwrap());
        let neighbours = Neighbours::new(&one);
        assert_eq!((neighbours.n_taxels(), neighbours.most()), (1, 0));
        assert_eq!(neighbours.within(&one, 0, 1.0), [(0, 0.0)]);
    }
}
