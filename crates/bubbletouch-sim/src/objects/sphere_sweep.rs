//! Ball of varying size swept along a polyline, which represents balls, capsules, handles and bananas.

use super::Sphere;
use super::fit::{Fit, MAX_SPHERES};
use super::solid::Form;
use super::solid_mass::turned;
use super::surface_patch::{SurfacePatch, frame};
use crate::geometry::Pose;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Sphere swept along a polyline: the union of the convex hulls of consecutive balls.
#[derive(Clone, Debug)]
pub(super) struct SphereSweep {
    /// Balls at the points of the polyline, at least one.
    balls: Vec<Sphere>,
}

/// Convex hull of two balls, neither of which contains the other.
struct Hull {
    first: Sphere,
    along: DVec3,
    length: f64,
    /// Change of the ball's radius per metre along the axis. The value is the sine of the cone's half angle, negative if the cone becomes narrower.
    slope: f64,
}

impl Hull {
    /// Creates the convex hull of two balls; `None` if one ball contains the other, because the larger ball is then the hull.
    fn new(first: Sphere, last: Sphere) -> Option<Self> {
        let axis = last.center - first.center;
        let length = axis.length();
        let slope = (last.radius - first.radius) / length;
        (slope.abs() < 1.0).then(|| Self {
            first,
            along: axis / length,
            length,
            slope,
        })
    }

    fn ball(&self, t: f64) -> Sphere {
        Sphere {
            center: self.first.center + t * self.along,
            radius: self.first.radius + t * self.slope,
        }
    }

    fn cosine(&self) -> f64 {
        (1.0 - self.slope * self.slope).sqrt()
    }

    /// Returns the volume, m³, and the centroid, metres: two caps of balls and the frustum of a cone between the circles at which it touches the balls.
    fn volume_and_center(&self) -> (f64, DVec3) {
        let (first, last) = (
            self.first.radius,
            self.first.radius + self.length * self.slope,
        );
        let [low, high] = [-first * self.slope, self.length - last * self.slope];
        let cap = |radius: f64, center: f64| move |z: f64| radius * radius - (z - center).powi(2);
        let side = |z: f64| ((first + self.slope * z) / self.cosine()).powi(2);
        let sections = [
            turned(-first, low, cap(first, 0.0)),
            turned(low, high, side),
            turned(high, self.length + last, cap(last, self.length)),
        ];
        let volume: f64 = sections.iter().map(|[volume, _]| volume).sum();
        let moment: f64 = sections.iter().map(|[_, moment]| moment).sum();
        (volume, self.first.center + moment / volume * self.along)
    }

    /// Returns the signed distance from a point p to the hull, metres. This is the minimum of |p − c(t)| − r(t) over the balls with centre c(t) and radius
    /// r(t). This function is convex in t.
    fn distance(&self, point: DVec3) -> f64 {
        let from_first = point - self.first.center;
        let x = from_first.dot(self.along);
        let y = (from_first - x * self.along).length();
        let t = (x + self.slope * y / self.cosine()).clamp(0.0, self.length);
        y.hypot(x - t) - self.first.radius - t * self.slope
    }

    /// Packs balls between the two ends of a hull, each as far ahead as possible without leaving a gap behind it.
    ///
    /// A ball of radius r at the distance t along the axis touches the hull at u = t·cos along its side. The ball covers the interval u ± sqrt((r + h)² −
    /// r²), where h is the sum of both tolerances. The balls at the ends are not enlarged and cover less.
    fn pack_between(&self, fit: Fit, spheres: &mut Vec<Sphere>) {
        let exact = fit.unswollen();
        let end = self.length * self.cosine() - exact.disc(self.ball(self.length).radius);
        let reach = |t: f64| fit.disc(self.ball(t).radius);
        let back = |t: f64| t * self.cosine() - reach(t);
        let mut covered = exact.disc(self.first.radius);
        while covered < end && spheres.len() <= MAX_SPHERES {
            let (mut low, mut high) = (0.0, self.length);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if back(middle) <= covered {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let ball = self.ball(low);
            let around = (low * self.cosine() - covered)
                .max(end.min(low * self.cosine() + reach(low)) - low * self.cosine());
            spheres.push(fit.covering(ball.center, ball.radius, ball.radius.hypot(around)));
            covered = low * self.cosine() + reach(low);
        }
    }
}

impl Form for SphereSweep {
    /// Returns the signed distance from a point to the sweep, metres; exact outside, and a lower bound of the depth inside.
    fn distance(&self, point: DVec3) -> f64 {
        let to_balls = self
            .balls
            .iter()
            .map(|b| (point - b.center).length() - b.radius);
        let to_hulls = self.hulls().map(|hull| hull.distance(point));
        to_balls.chain(to_hulls).fold(f64::INFINITY, f64::min)
    }

    fn support(&self, direction: DVec3) -> f64 {
        let length = direction.length();
        let supports = self
            .balls
            .iter()
            .map(|b| b.center.dot(direction) + b.radius * length);
        supports.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns the volume and the centroid of a sweep of one or two balls.
    fn volume_and_center(&self) -> (f64, DVec3) {
        let ball = |ball: &Sphere| (4.0 / 3.0 * PI * ball.radius.powi(3), ball.center);
        let larger = self
            .balls
            .iter()
            .max_by(|a, b| a.radius.total_cmp(&b.radius));
        self.hulls().next().map_or_else(
            || larger.map_or((0.0, DVec3::ZERO), ball),
            |hull| hull.volume_and_center(),
        )
    }

    /// Packs the sweep: the balls at the points of the polyline, and a row of enlarged balls along each hull.
    fn pack(&self, fit: Fit, spheres: &mut Vec<Sphere>) {
        let closed = self.balls.len() > 1 && self.balls.first() == self.balls.last();
        let ends = &self.balls[usize::from(closed)..];
        spheres.extend_from_slice(ends);
        for hull in self.hulls() {
            hull.pack_between(fit, spheres);
        }
    }

    fn patches(&self) -> Vec<SurfacePatch> {
        let balls = self.balls.iter();
        let balls = balls.map(|ball| SurfacePatch::ball(ball.center, ball.radius));
        let sides = self.hulls().map(|hull| {
            let touched = |t: f64| {
                let radius = hull.ball(t).radius;
                DVec2::new(radius * hull.cosine(), t - radius * hull.slope)
            };
            let (x, y) = hull.along.any_orthonormal_pair();
            let (x, y) = if x.cross(y).dot(hull.along) > 0.0 {
                (x, y)
            } else {
                (y, x)
            };
            SurfacePatch::turned(touched(0.0), touched(hull.length), [0.0, TAU])
                .moved(&Pose::new(frame(x, y), hull.first.center))
        });
        balls.chain(sides).collect()
    }
}

impl SphereSweep {
    /// Creates a sweep from the points of the polyline, metres, and the diameter of the ball at each point.
    pub fn new(points: &[DVec3], diameters: &[f64]) -> Self {
        let balls = points.iter().zip(diameters).map(|(&center, &diameter)| {
            let radius = 0.5 * diameter;
            Sphere { center, radius }
        });
        Self {
            balls: balls.collect(),
        }
    }

    fn hulls(&self) -> impl Iterator<Item = Hull> {
        self.balls
            .windows(2)
            .filter_map(|pair| Hull::new(pair[0], pair[1]))
    }
}

/// Adds points on a sphere along a Fibonacci spiral, about `spacing` apart, metres.
pub(super) fn sphere_points(sphere: &Sphere, spacing: f64, points: &mut Vec<DVec3>) {
    let ratio = sphere.radius / spacing;
    let n = (4.0 * PI * ratio * ratio).ceil().max(24.0);
    let golden = PI * (3.0 - 5f64.sqrt());
    points.extend((0..n as usize).map(|i| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / n;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let out = (1.0 - z * z).sqrt();
        sphere.center + sphere.radius * DVec3::new(out * cos, out * sin, z)
    }));
}
