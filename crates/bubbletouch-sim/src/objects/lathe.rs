//! Solid of revolution: a polygon in the half plane (distance from the axis, height) that is rotated about z.
//!
//! The surface point nearest to a query point lies in the half plane of the query point. The distance to the solid therefore equals the distance to the
//! polygon.

use super::Sphere;
use super::fit::{Fit, MAX_SPHERES};
use super::outline::Outline;
use super::solid::Form;
use super::solid_mass::turned;
use super::surface_patch::SurfacePatch;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Solid of revolution, given by a polygon that is rotated about the z axis.
#[derive(Clone, Debug)]
pub(super) struct Lathe {
    outline: Outline,
}

/// Smallest gap that a packing may leave, relative to the size of the solid. Intervals on its edges have an accuracy of 1e-9 of an edge. The rim of a sharp edge
/// reaches the limit of spheres long before. If larger, fine packings are rejected; if smaller, edges count as covered although no sphere covers them.
const MIN_REACH: f64 = 1e-8;

/// Ring of balls: balls of one radius, equally spaced on a circle about the axis.
#[derive(Clone, Copy, Debug)]
struct Ring {
    /// Distance from the axis, and height, of the balls' centres, metres.
    center: DVec2,
    /// Radius of the balls before enlargement, metres.
    radius: f64,
    n: f64,
}

/// Intervals of each edge of the polygon that no ring of balls covers yet, as distances from the edge's start.
struct Uncovered {
    intervals: Vec<Vec<[f64; 2]>>,
}

impl Form for Lathe {
    fn distance(&self, point: DVec3) -> f64 {
        self.outline
            .distance(DVec2::new(point.truncate().length(), point.z))
    }

    fn support(&self, direction: DVec3) -> f64 {
        let across = direction.truncate().length();
        self.outline.support(DVec2::new(across, direction.z))
    }

    /// Integrates over slices under the edges of the profile, which count positively where the edges go up.
    fn volume_and_center(&self) -> (f64, DVec3) {
        let corners = self.outline.vertices();
        let slices = corners.iter().enumerate().filter_map(|(k, &from)| {
            let to = corners[(k + 1) % corners.len()];
            let slope = (to.x - from.x) / (to.y - from.y);
            let square = |z: f64| (from.x + slope * (z - from.y)).powi(2);
            (from.y != to.y).then(|| turned(from.y, to.y, square))
        });
        let [volume, moment] = slices.fold([0.0; 2], |sum, slice| {
            [sum[0] + slice[0], sum[1] + slice[1]]
        });
        (volume, moment / volume * DVec3::Z)
    }

    /// Packs the solid with spheres: adds rings of balls until every point of the profile is covered at all angles about the axis.
    fn pack(&self, fit: Fit, spheres: &mut Vec<Sphere>) {
        let mut uncovered = Uncovered::new(&self.outline);
        while let Some(ring) = self.next_ring(&uncovered, fit) {
            let mut farthest = ring.radius;
            for (edge, intervals) in uncovered.intervals.iter_mut().enumerate() {
                if let Some(covered) = self.covered(&ring, edge, fit) {
                    for [low, high] in common(intervals, covered) {
                        let edge = &self.outline.edges[edge];
                        let distances = [low, high].map(|at| ring.distance(edge.point(at)));
                        farthest = distances.into_iter().fold(farthest, f64::max);
                    }
                    subtract(intervals, covered);
                }
            }
            ring.push_spheres(farthest, fit, spheres);
            if spheres.len() > MAX_SPHERES {
                return;
            }
        }
    }

    fn patches(&self) -> Vec<SurfacePatch> {
        let edges = self.outline.edges.iter();
        edges
            .map(|edge| SurfacePatch::turned(edge.start, edge.point(edge.length), [0.0, TAU]))
            .collect()
    }

    fn min_reach(&self) -> f64 {
        MIN_REACH
    }
}

impl Lathe {
    /// Creates a solid of revolution from a profile of (distance from the axis ≥ 0, height), metres. Sides on the axis do not belong to the surface.
    pub fn new(profile: &[DVec2]) -> Self {
        Self {
            outline: Outline::new(profile, |a, b| a.x > 0.0 || b.x > 0.0),
        }
    }

    /// Creates a cone frustum about z, centred on the origin; one of the diameters may be 0.
    pub fn frustum(bottom_diameter: f64, top_diameter: f64, height: f64) -> Self {
        let (bottom, top, z) = (0.5 * bottom_diameter, 0.5 * top_diameter, 0.5 * height);
        let mut corners = vec![
            DVec2::new(0.0, -z),
            DVec2::new(bottom, -z),
            DVec2::new(top, z),
            DVec2::new(0.0, z),
        ];
        corners.dedup();
        Self::new(&corners)
    }

    /// Returns the best ring of balls among those that cover an end of the first uncovered interval. The best ring covers the largest length of edges per
    /// sphere.
    fn next_ring(&self, uncovered: &Uncovered, fit: Fit) -> Option<Ring> {
        let (edge, target, step) = uncovered.first_end(&self.outline)?;
        let available = if step > 0.0 {
            self.outline.edges[edge].length - target
        } else {
            target
        };
        let smallest = 5e-3 * fit.reach().min(available);
        let mut best: Option<(f64, f64, Ring)> = None;
        let mut consider = |ahead: f64| {
            for ring in self.rings(edge, target + step * ahead, fit) {
                if !self.covers(&ring, edge, target, fit) {
                    continue;
                }
                let gain = self.gain(&ring, uncovered, fit) / ring.n;
                if best.is_none_or(|(most, ..)| gain > most) {
                    best = Some((gain, ahead, ring));
                }
            }
            best.map(|(_, ahead, _)| ahead)
        };
        const N_COARSE: i32 = 40;
        const N_FINE: i32 = 6;
        let ratio = (available / smallest).powf(1.0 / f64::from(N_COARSE));
        let mut coarse = None;
        for k in 0..N_COARSE {
            coarse = consider(smallest * ratio.powi(k));
        }
        for k in -N_FINE..=N_FINE {
            let near = coarse? * ratio.powf(f64::from(k) / f64::from(N_FINE));
            if near < available {
                consider(near);
            }
        }
        best.map(|(.., ring)| ring)
    }

    /// Returns candidate rings with different numbers of balls. Every ball is the largest one inside the solid that touches the edge with index `edge` at the
    /// distance `along`.
    fn rings(&self, edge: usize, along: f64, fit: Fit) -> impl Iterator<Item = Ring> {
        let foot = self.outline.edges[edge].point(along);
        let inward = self.outline.edges[edge].inward;
        let to_axis = if inward.x < 0.0 {
            foot.x / -inward.x
        } else {
            f64::INFINITY
        };
        let radius = self.outline.tangent_radius(edge, foot).min(to_axis);
        let mut center = foot + radius * inward;
        // A centre close to the axis is moved onto the axis, so that the ring has one ball.
        if radius == to_axis || center.x < 1e-9 * radius {
            center.x = 0.0;
        }
        let budget = fit.disc_squared(radius);
        [0.35, 0.5, 0.65, 0.8].into_iter().map(move |share| {
            let sine = (share * budget / (4.0 * foot.x * center.x)).sqrt();
            let n = if sine < 1.0 {
                (0.5 * PI / sine.asin()).ceil()
            } else {
                1.0
            };
            Ring { center, radius, n }
        })
    }

    /// Returns the interval of an edge that a ring of balls covers at all angles about the axis; `None` if there is none.
    ///
    /// A ring has n balls of radius r with centres at the distance ρc from the axis and the height zc. Half-way between two balls the squared distance of the
    /// profile point (ρ, z) from their centres is `(ρ − ρc)² + (z − zc)² + 4 ρ ρc sin²(π/2n)`. The squared distance is quadratic along an edge. The point is
    /// covered if this value is at most `(r + h)²`, where h is the sum of both tolerances.
    fn covered(&self, ring: &Ring, edge: usize, fit: Fit) -> Option<[f64; 2]> {
        let edge = &self.outline.edges[edge];
        let from_center = edge.start - ring.center;
        let lag = 2.0 * ring.center.x * (0.5 * PI / ring.n).sin().powi(2);
        let reach = ring.radius + fit.reach();
        let half_linear = from_center.dot(edge.along) + lag * edge.along.x;
        let constant = from_center.length_squared() + 2.0 * lag * edge.start.x - reach * reach;
        let square = half_linear * half_linear - constant;
        if square <= 0.0 {
            return None;
        }
        let root = square.sqrt();
        let (low, high) = (-half_linear - root, -half_linear + root);
        let (low, high) = (low.max(0.0), high.min(edge.length));
        (low < high).then_some([low, high])
    }

    fn covers(&self, ring: &Ring, edge: usize, at: f64, fit: Fit) -> bool {
        let slack = 1e-9 * self.outline.edges[edge].length;
        self.covered(ring, edge, fit)
            .is_some_and(|[low, high]| low <= at + slack && at - slack <= high)
    }

    fn gain(&self, ring: &Ring, uncovered: &Uncovered, fit: Fit) -> f64 {
        let edges = uncovered.intervals.iter().enumerate();
        edges
            .filter(|(_, intervals)| !intervals.is_empty())
            .filter_map(|(edge, intervals)| Some((self.covered(ring, edge, fit)?, intervals)))
            .flat_map(|(covered, intervals)| common(intervals, covered))
            .map(|[start, end]| end - start)
            .sum()
    }
}

impl Ring {
    /// Returns the distance from a profile point to the centres of the two nearest balls, metres. The profile point is half-way between these balls.
    fn distance(&self, point: DVec2) -> f64 {
        let apart = 4.0 * point.x * self.center.x * (0.5 * PI / self.n).sin().powi(2);
        ((point - self.center).length_squared() + apart).sqrt()
    }

    /// Adds the spheres of a ring. The spheres must cover profile points up to the distance `farthest` from their centres.
    fn push_spheres(&self, farthest: f64, fit: Fit, spheres: &mut Vec<Sphere>) {
        let centers = around_axis(self.center, self.n);
        spheres.extend(centers.map(|center| fit.covering(center, self.radius, farthest)));
    }
}

/// Returns `n` points, equally spaced on the circle about z through the point `at` (distance from the axis, height); at most one more than [`MAX_SPHERES`].
pub(super) fn around_axis(at: DVec2, n: f64) -> impl Iterator<Item = DVec3> {
    (0..n as usize).take(MAX_SPHERES + 1).map(move |i| {
        let (sin, cos) = (TAU * i as f64 / n).sin_cos();
        DVec3::new(at.x * cos, at.x * sin, at.y)
    })
}

impl Uncovered {
    fn new(outline: &Outline) -> Self {
        let whole = |length: f64| vec![[0.0, length]];
        Self {
            intervals: outline.edges.iter().map(|e| whole(e.length)).collect(),
        }
    }

    /// Returns the index of the first edge that is not completely covered, and one end of its first uncovered interval. Also returns the direction (±1) from
    /// this end into the interval. The end is the one nearer to a corner, so balls are added from both corners of an edge towards its middle.
    fn first_end(&self, outline: &Outline) -> Option<(usize, f64, f64)> {
        let edge = self.intervals.iter().position(|i| !i.is_empty())?;
        let first = self.intervals[edge][0];
        let last = self.intervals[edge].last()?;
        if first[0] <= outline.edges[edge].length - last[1] {
            Some((edge, first[0], 1.0))
        } else {
            Some((edge, last[1], -1.0))
        }
    }
}

/// Removes an interval from a list of intervals. Remaining pieces shorter than a billionth of the interval are rounding errors and are also removed.
fn subtract(intervals: &mut Vec<[f64; 2]>, [low, high]: [f64; 2]) {
    let slack = 1e-9 * (high - low);
    *intervals = intervals
        .iter()
        .flat_map(|&[start, end]| [[start, end.min(low)], [start.max(high), end]])
        .filter(|[start, end]| end - start > slack)
        .collect();
}

/// Returns the intersections of an interval with a list of intervals.
fn common(intervals: &[[f64; 2]], [low, high]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> + '_ {
    let cut = move |[start, end]: &[f64; 2]| [start.max(low), end.min(high)];
    intervals.iter().map(cut).filter(|[start, end]| start < end)
}
