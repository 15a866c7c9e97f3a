//! Spheres of an object, neighbours together, so that those far from the skin are left out by the dozen.

use super::{Sphere, SphereUnion};
use glam::{DVec3, DVec4};

/// Spheres in a cluster, at most. More: spheres are looked at in vain; fewer: clusters are.
const MOST: usize = 16;

/// The spheres of an object in clusters: near each other and about as large. The same spheres always give the same clusters.
#[derive(Clone, Debug)]
pub struct SphereClusters {
    /// Cluster by cluster.
    spheres: Vec<Sphere>,
    /// Where each cluster begins among the spheres, and behind them where the last one ends.
    starts: Vec<u32>,
    bounds: ClusterBounds,
    /// Around all.
    ball: Sphere,
}

/// What is around each cluster, coordinate by coordinate, so that several clusters are looked at with one instruction; metres,
/// in the object's frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClusterBounds {
    /// Middles of the boxes around the centres of the spheres: x, y, z.
    pub middle: [Vec<f64>; 3],
    /// Half the sides of these boxes.
    pub half: [Vec<f64>; 3],
    /// Radii of the largest spheres.
    pub largest: Vec<f64>,
    /// Radii of balls about the middles that hold the spheres.
    pub radius: Vec<f64>,
}

impl SphereClusters {
    /// Sorts the spheres of an object into clusters; about 100 ns a sphere.
    pub fn new(union: &SphereUnion) -> Self {
        let mut spheres = union.spheres().to_vec();
        let mut sizes = Vec::new();
        cut(&mut spheres, &mut sizes);
        let mut starts = vec![0];
        let mut bounds = ClusterBounds::default();
        let mut rest = &spheres[..];
        for &size in &sizes {
            let (its, behind) = rest.split_at(size);
            bounds.push(its);
            starts.push((spheres.len() - behind.len()) as u32);
            rest = behind;
        }
        Self {
            ball: Extent::of(&spheres).ball(&spheres),
            spheres,
            starts,
            bounds,
        }
    }

    /// How many spheres.
    pub fn n_spheres(&self) -> usize {
        self.spheres.len()
    }

    /// A ball around all of them, in the object's frame, metres.
    pub fn ball(&self) -> Sphere {
        self.ball
    }

    /// The clusters: a ball around each, and its spheres; in the object's frame, metres.
    pub(crate) fn each(&self) -> impl Iterator<Item = (Sphere, &[Sphere])> {
        (0..self.bounds.len()).map(|cluster| (self.bounds.ball(cluster), self.of(cluster)))
    }

    /// Around each cluster.
    pub(crate) fn bounds(&self) -> &ClusterBounds {
        &self.bounds
    }

    /// The spheres of a cluster.
    pub(crate) fn of(&self, cluster: usize) -> &[Sphere] {
        &self.spheres[self.starts[cluster] as usize..self.starts[cluster + 1] as usize]
    }
}

impl ClusterBounds {
    fn push(&mut self, spheres: &[Sphere]) {
        let extent = Extent::of(spheres);
        let ball = extent.ball(spheres);
        for axis in 0..3 {
            self.middle[axis].push(ball.center[axis]);
            self.half[axis].push(0.5 * extent.sides()[axis]);
        }
        self.largest.push(extent.high.w);
        self.radius.push(ball.radius);
    }

    /// How many clusters.
    pub fn len(&self) -> usize {
        self.radius.len()
    }

    fn ball(&self, cluster: usize) -> Sphere {
        Sphere {
            center: DVec3::from_array([0, 1, 2].map(|axis| self.middle[axis][cluster])),
            radius: self.radius[cluster],
        }
    }
}

/// The smallest and largest centre and radius (as w) of some spheres.
struct Extent {
    low: DVec4,
    high: DVec4,
}

impl Extent {
    fn of(spheres: &[Sphere]) -> Self {
        let all = || spheres.iter().map(|s| s.center.extend(s.radius));
        Self {
            low: all().fold(DVec4::INFINITY, DVec4::min),
            high: all().fold(DVec4::NEG_INFINITY, DVec4::max),
        }
    }

    fn sides(&self) -> DVec4 {
        self.high - self.low
    }

    /// About the middle of the centres, around the spheres.
    fn ball(&self, spheres: &[Sphere]) -> Sphere {
        let center = (0.5 * (self.low + self.high)).truncate();
        let reaches = spheres.iter().map(|s| s.center.distance(center) + s.radius);
        Sphere {
            center,
            radius: reaches.fold(0.0, f64::max),
        }
    }
}

/// Halves spheres across the longest side of where their centres are, or by their size if that differs more, until few are left.
fn cut(spheres: &mut [Sphere], sizes: &mut Vec<usize>) {
    if spheres.len() <= MOST {
        sizes.push(spheres.len());
        return;
    }
    let side = Extent::of(spheres).sides().max_position();
    let along = |sphere: &Sphere| sphere.center.extend(sphere.radius)[side];
    spheres.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let (left, right) = spheres.split_at_mut(spheres.len() / 2);
    cut(left, sizes);
    cut(right, sizes);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn every_sphere_is_in_one_cluster_and_inside_its_ball() {
        let mut rng = Seed::new(1).named("clusters").rng();
        for n in [1, 16, 17, 1000] {
            let spheres: Vec<Sphere> = (0..n)
                .map(|_| Sphere {
                    center: DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0))),
                    radius: rng.gen_range(0.01..0.2),
                })
                .collect();
            let clusters = SphereClusters::new(&SphereUnion::new(spheres.clone()).unwrap());
            let is_inside = |inner: &Sphere, outer: &Sphere| {
                inner.center.distance(outer.center) + inner.radius <= outer.radius * (1.0 + 1e-12)
            };
            let mut found = Vec::new();
            for (ball, its) in clusters.each() {
                assert!((1..=MOST).contains(&its.len()));
                assert!(its.iter().all(|sphere| is_inside(sphere, &ball)));
                found.extend_from_slice(its);
            }
            assert!(
                found
                    .iter()
                    .all(|sphere| is_inside(sphere, &clusters.ball()))
            );
            let bits = |s: &Sphere| (s.center.to_array().map(f64::to_bits), s.radius.to_bits());
            let mut pairs = [spheres, found].map(|all| all.iter().map(bits).collect::<Vec<_>>());
            pairs.iter_mut().for_each(|all| all.sort_unstable());
            assert_eq!(pairs[0], pairs[1]);
        }
    }
}
