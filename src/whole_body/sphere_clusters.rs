//! Spheres of an object, neighbours together, so that those far from a patch are left out by the dozen.

use crate::objects::{Sphere, SphereUnion};
use glam::DVec3;

/// Spheres in a cluster, at most. More: spheres are looked at in vain; fewer: clusters are.
const MOST: usize = 16;

/// The spheres of an object in clusters; the same spheres always give the same clusters.
#[derive(Clone, Debug)]
pub struct SphereClusters {
    spheres: Vec<Sphere>,
    /// In the order of the spheres.
    clusters: Vec<Cluster>,
    /// Around all.
    ball: Sphere,
}

/// Some spheres, one after the other, and a ball around them.
#[derive(Clone, Copy, Debug)]
struct Cluster {
    ball: Sphere,
    n_spheres: usize,
}

impl SphereClusters {
    /// Sorts the spheres of an object into clusters; about 100 ns a sphere.
    pub fn new(union: &SphereUnion) -> Self {
        let mut spheres = union.spheres().to_vec();
        let mut clusters = Vec::new();
        cut(&mut spheres, &mut clusters);
        Self {
            ball: ball_around(&spheres),
            spheres,
            clusters,
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
    pub(super) fn each(&self) -> impl Iterator<Item = (Sphere, &[Sphere])> {
        let mut rest = &self.spheres[..];
        self.clusters.iter().map(move |cluster| {
            let (its, behind) = rest.split_at(cluster.n_spheres);
            rest = behind;
            (cluster.ball, its)
        })
    }
}

/// Halves spheres across the longest side of where their centres are, until few are left.
fn cut(spheres: &mut [Sphere], clusters: &mut Vec<Cluster>) {
    if spheres.len() <= MOST {
        clusters.push(Cluster {
            ball: ball_around(spheres),
            n_spheres: spheres.len(),
        });
        return;
    }
    let centers = || spheres.iter().map(|sphere| sphere.center);
    let low = centers().fold(DVec3::INFINITY, DVec3::min);
    let high = centers().fold(DVec3::NEG_INFINITY, DVec3::max);
    let side = (high - low).max_position();
    spheres.sort_by(|a, b| a.center[side].total_cmp(&b.center[side]));
    let (left, right) = spheres.split_at_mut(spheres.len() / 2);
    cut(left, clusters);
    cut(right, clusters);
}

fn ball_around(spheres: &[Sphere]) -> Sphere {
    let center = spheres.iter().map(|sphere| sphere.center).sum::<DVec3>() / spheres.len() as f64;
    let reaches = spheres
        .iter()
        .map(|sphere| sphere.center.distance(center) + sphere.radius);
    Sphere {
        center,
        radius: reaches.fold(0.0, f64::max),
    }
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
