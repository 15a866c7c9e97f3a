//! Spheres of an object, grouped into clusters of neighbours so that distant spheres can be skipped together.

use super::Sphere;
use glam::{DVec3, DVec4};

/// Maximum number of spheres in a cluster. If larger, more distant spheres are tested; if smaller, more clusters are tested.
pub(crate) const MAX_IN_CLUSTER: usize = 16;

/// Spheres of an object, grouped in clusters of similar position and size. Equal spheres give equal clusters.
#[derive(Clone, Debug)]
pub struct SphereClusters {
    /// Centres of the spheres, cluster by cluster: x, y, z, metres. Zeros follow the last sphere, so that a full cluster can be
    /// loaded from any position.
    centers: [Vec<f64>; 3],
    /// Radii of the spheres, metres.
    radii: Vec<f64>,
    /// Index of each sphere in the object.
    numbers: Vec<u32>,
    /// Index of the first sphere of each cluster, followed by the total number of spheres.
    starts: Vec<u32>,
    bounds: ClusterBounds,
    /// Ball that contains all spheres, metres, in the frame of the object.
    ball: Sphere,
}

/// Bounding boxes and balls of all clusters, stored coordinate by coordinate for vectorised tests; metres, in the frame of the object.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClusterBounds {
    /// Centres of the boxes around the sphere centres of each cluster: x, y, z, metres.
    pub middle: [Vec<f64>; 3],
    /// Half sides of the boxes around the sphere centres of each cluster: x, y, z, metres.
    pub half: [Vec<f64>; 3],
    /// Radius of the largest sphere of each cluster, metres.
    pub largest: Vec<f64>,
    /// Radius of the ball that contains the spheres of each cluster, centred at `middle`, metres.
    pub radius: Vec<f64>,
}

impl SphereClusters {
    /// Groups the spheres of an object into clusters; takes about 100 ns per sphere.
    pub(super) fn from_spheres(spheres: &[Sphere]) -> Self {
        let mut numbered: Vec<(u32, Sphere)> = (0..).zip(spheres.to_vec()).collect();
        let mut sizes = Vec::new();
        cut(&mut numbered, &mut sizes);
        let (numbers, spheres): (Vec<u32>, Vec<Sphere>) = numbered.into_iter().unzip();
        let mut starts = vec![0];
        let mut bounds = ClusterBounds::default();
        let mut rest = &spheres[..];
        for &size in &sizes {
            let (its, behind) = rest.split_at(size);
            bounds.push(its);
            starts.push((spheres.len() - behind.len()) as u32);
            rest = behind;
        }
        let padded = |of: fn(&Sphere) -> f64| {
            let behind = [0.0; MAX_IN_CLUSTER];
            spheres.iter().map(of).chain(behind).collect()
        };
        Self {
            centers: [
                padded(|s| s.center.x),
                padded(|s| s.center.y),
                padded(|s| s.center.z),
            ],
            radii: padded(|s| s.radius),
            numbers,
            ball: CenterBounds::new(spheres.iter()).ball(&spheres),
            starts,
            bounds,
        }
    }

    /// Returns the number of spheres in all clusters.
    pub fn n_spheres(&self) -> usize {
        self.starts[self.starts.len() - 1] as usize
    }

    /// Returns a ball that contains all spheres, in the frame of the object, metres.
    pub fn ball(&self) -> Sphere {
        self.ball
    }

    /// Returns the bounding boxes and balls of the clusters.
    pub(crate) fn bounds(&self) -> &ClusterBounds {
        &self.bounds
    }

    /// Returns the indices of the spheres of a cluster in the object.
    pub(crate) fn numbers(&self, cluster: usize) -> &[u32] {
        &self.numbers[self.starts[cluster] as usize..self.starts[cluster + 1] as usize]
    }

    /// Returns the spheres of a cluster.
    #[inline(always)]
    pub(crate) fn cluster(&self, cluster: usize) -> Cluster<'_> {
        let first = self.starts[cluster] as usize;
        let [x, y, z] = &self.centers;
        Cluster {
            n_spheres: self.starts[cluster + 1] as usize - first,
            centers: [lanes(&x[first..]), lanes(&y[first..]), lanes(&z[first..])],
            radii: lanes(&self.radii[first..]),
        }
    }
}

/// Spheres of one cluster; entries beyond the number of spheres contain arbitrary spheres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cluster<'a> {
    pub n_spheres: usize,
    /// Centres x, y, z of the spheres in the frame of the object, metres.
    pub centers: [&'a [f64; MAX_IN_CLUSTER]; 3],
    /// Radii of the spheres, metres.
    pub radii: &'a [f64; MAX_IN_CLUSTER],
}

impl Cluster<'_> {
    /// Returns the sphere with index `k` in the cluster.
    #[inline(always)]
    pub fn at(&self, k: usize) -> Sphere {
        let [x, y, z] = self.centers;
        Sphere {
            center: DVec3::new(x[k], y[k], z[k]),
            radius: self.radii[k],
        }
    }
}

#[inline(always)]
fn lanes(values: &[f64]) -> &[f64; MAX_IN_CLUSTER] {
    values.first_chunk().expect("values are padded")
}

impl ClusterBounds {
    fn push(&mut self, spheres: &[Sphere]) {
        let extent = CenterBounds::new(spheres.iter());
        let ball = extent.ball(spheres);
        for axis in 0..3 {
            self.middle[axis].push(ball.center[axis]);
            self.half[axis].push(0.5 * extent.sides()[axis]);
        }
        self.largest.push(extent.high.w);
        self.radius.push(ball.radius);
    }

    /// Returns the bounding ball of a cluster, metres, in the frame of the object.
    pub fn ball(&self, cluster: usize) -> Sphere {
        Sphere {
            center: DVec3::from_array([0, 1, 2].map(|axis| self.middle[axis][cluster])),
            radius: self.radius[cluster],
        }
    }

    /// Returns the number of clusters.
    pub fn len(&self) -> usize {
        self.radius.len()
    }
}

/// Minimum and maximum of the centres (x, y, z) and of the radii (component w) of several spheres.
struct CenterBounds {
    low: DVec4,
    high: DVec4,
}

impl CenterBounds {
    fn new<'a>(spheres: impl Iterator<Item = &'a Sphere> + Clone) -> Self {
        let all = || spheres.clone().map(|s| s.center.extend(s.radius));
        Self {
            low: all().fold(DVec4::INFINITY, DVec4::min),
            high: all().fold(DVec4::NEG_INFINITY, DVec4::max),
        }
    }

    fn sides(&self) -> DVec4 {
        self.high - self.low
    }

    /// Returns a ball that contains the spheres, centred at the middle of the range of their centres.
    fn ball(&self, spheres: &[Sphere]) -> Sphere {
        let center = (0.5 * (self.low + self.high)).truncate();
        let reaches = spheres.iter().map(|s| s.center.distance(center) + s.radius);
        Sphere {
            center,
            radius: reaches.fold(0.0, f64::max),
        }
    }
}

/// Divides spheres into halves until each cluster is small enough. Each cut is along the coordinate of the centres, or the radius, with the largest range.
fn cut(spheres: &mut [(u32, Sphere)], sizes: &mut Vec<usize>) {
    if spheres.len() <= MAX_IN_CLUSTER {
        sizes.push(spheres.len());
        return;
    }
    let all = spheres.iter().map(|(_, sphere)| sphere);
    let side = CenterBounds::new(all).sides().max_position();
    let along = |(_, sphere): &(u32, Sphere)| sphere.center.extend(sphere.radius)[side];
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
            let mut sphere = || Sphere {
                center: DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0))),
                radius: rng.gen_range(0.01..0.2),
            };
            let spheres: Vec<Sphere> = (0..n).map(|_| sphere()).collect();
            let clusters = SphereClusters::from_spheres(&spheres);
            let is_inside = |inner: &Sphere, outer: &Sphere| {
                inner.center.distance(outer.center) + inner.radius <= outer.radius * (1.0 + 1e-12)
            };
            let mut found = Vec::new();
            let bounds = clusters.bounds();
            for cluster in 0..bounds.len() {
                let ball = bounds.ball(cluster);
                let its = clusters.cluster(cluster);
                let its: Vec<Sphere> = (0..its.n_spheres).map(|k| its.at(k)).collect();
                let numbers = clusters.numbers(cluster).iter();
                assert!(numbers.map(|&n| &spheres[n as usize]).eq(&its));
                assert!((1..=MAX_IN_CLUSTER).contains(&its.len()));
                assert!(its.iter().all(|sphere| is_inside(sphere, &ball)));
                found.extend(its);
            }
            let all = clusters.ball();
            assert!(found.iter().all(|sphere| is_inside(sphere, &all)));
            let bits = |s: &Sphere| (s.center.to_array().map(f64::to_bits), s.radius.to_bits());
            let mut pairs = [spheres, found].map(|all| all.iter().map(bits).collect::<Vec<_>>());
            pairs.iter_mut().for_each(|all| all.sort_unstable());
            assert_eq!(pairs[0], pairs[1]);
        }
    }
}
