//! Points all over the outer surface, as dense as the balls there are small, and balls that touch it.

use super::ball::Ball;
use super::target::{Target, bisected, triangle_middle};
use crate::mesh::{Bvh, Triangle, TriangleMesh};
use glam::DVec3;

/// A point that some ball must cover, standing for the surface around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub position: DVec3,
    /// Of the surface that it stands for, metres.
    pub radius: f64,
}

/// What is to be covered, and what with.
pub(super) struct Sampling {
    /// Triangles that are not buried inside the mesh.
    pub outer: Vec<usize>,
    pub samples: Vec<Sample>,
    pub balls: Vec<Ball>,
}

/// Samples in the area that one ball has to itself in the best covering of a plane. More: fewer gaps to mend, slower;
/// fewer: the local search plans for gaps that it cannot see.
pub(super) const SAMPLES_A_BALL: f64 = 80.0;
/// Places at which candidate balls touch, in that area. More: better coverings, slower.
const FEET_A_BALL: f64 = 25.0;
/// Slacks of the candidates at each foot, in tolerances. With slack 2 the foot is at the rim of what the ball covers.
const SLACKS: [f64; 3] = [2.0, 1.0, 0.0];
/// Share of a plane's covering by discs of unit radius that each has to itself: 3·√3/2, a hexagon.
const HEXAGON: f64 = 2.598_076_211_353_316;

/// Samples the surface; the same mesh always gives the same samples.
pub(super) fn sample(target: &Target) -> Sampling {
    let mut sampler = Sampler {
        target,
        due_samples: 1.0,
        due_feet: 1.0,
        known: None,
        sampling: Sampling {
            outer: Vec::new(),
            samples: Vec::new(),
            balls: Vec::new(),
        },
    };
    // In the order of the tree, neighbours on the surface are neighbours in the list.
    let surface = target.surface;
    surface.bvh().each_in_box(&surface.bounds(), |number, triangle| {
        if let Some(normal) = triangle.normal()
            && !target.is_buried(triangle, normal)
        {
            sampler.sampling.outer.push(number);
            sampler.visit(*triangle, normal);
        }
    });
    sampler.sampling
}

struct Sampler<'a> {
    target: &'a Target<'a>,
    /// A sample is placed whenever this passes one: evenly, however the surface is cut into triangles.
    due_samples: f64,
    due_feet: f64,
    /// Where the local size was last computed.
    known: Option<Local>,
    sampling: Sampling,
}

/// How large balls are somewhere.
#[derive(Clone, Copy)]
struct Local {
    foot: DVec3,
    normal: DVec3,
    /// Of what one ball covers, metres.
    half_width: f64,
}

impl Sampler<'_> {
    fn visit(&mut self, triangle: Triangle, normal: DVec3) {
        let mut waiting = vec![triangle];
        while let Some(triangle) = waiting.pop() {
            let foot = triangle_middle(&triangle);
            let share = HEXAGON * self.half_width(foot, normal).powi(2);
            let balls = triangle.area() / share;
            // Compact pieces only: a long one reaches to places that its middle knows nothing of.
            let is_long = triangle.longest_edge_squared() * SAMPLES_A_BALL > 8.0 * share;
            if balls * SAMPLES_A_BALL > 1.0 || is_long {
                let [first, second] = bisected(&triangle);
                waiting.extend([second, first]);
                continue;
            }
            self.due_samples += balls * SAMPLES_A_BALL;
            if self.due_samples >= 1.0 {
                self.due_samples -= 1.0;
                self.sampling.samples.push(Sample {
                    position: foot,
                    radius: (share / (HEXAGON * SAMPLES_A_BALL)).sqrt(),
                });
            }
            self.due_feet += balls * FEET_A_BALL;
            if self.due_feet >= 1.0 {
                self.due_feet -= 1.0;
                let candidates = candidates(self.target, foot, normal);
                self.sampling.balls.extend(candidates);
            }
        }
    }

    /// Of the largest ball that covers a point.
    fn half_width(&mut self, foot: DVec3, normal: DVec3) -> f64 {
        if let Some(known) = self.known
            && foot.distance(known.foot) < 0.15 * known.half_width
            && normal.dot(known.normal) > 0.95
        {
            return known.half_width;
        }
        let (slack, limit) = (2.0 * self.target.e, self.target.largest_radius());
        let ball = Ball::largest(self.target, foot, -normal, slack, limit);
        let half_width = ball.unwrap_or(Ball::on_surface(foot)).half_width(self.target.e);
        self.known = Some(Local {
            foot,
            normal,
            half_width,
        });
        half_width
    }
}

/// Balls that cover a point of the surface, larger and smaller; at least one.
pub(super) fn candidates(target: &Target, foot: DVec3, normal: DVec3) -> Vec<Ball> {
    let mut limit = target.largest_radius();
    let mut balls = Vec::with_capacity(SLACKS.len());
    for slack in SLACKS {
        if let Some(ball) = Ball::largest(target, foot, -normal, slack * target.e, limit) {
            // Less slack never allows a larger one.
            limit = ball.center.distance(foot);
            balls.push(ball);
        }
    }
    if balls.is_empty() {
        balls.push(Ball::on_surface(foot));
    }
    balls
}

/// A tree over samples, as triangles without size.
pub(super) struct SampleTree {
    bvh: Bvh,
}

/// How much of a sample's radius must be covered too, by the slope of the ball there. More: more spheres; less: more gaps
/// to mend, which takes more spheres in the end.
const MARGIN: f64 = 0.7;

impl SampleTree {
    pub fn new(samples: &[Sample]) -> Self {
        let positions = samples.iter().map(|s| s.position).collect();
        let points = (0..samples.len() as u32).map(|i| [i; 3]).collect();
        let mesh = TriangleMesh::new("samples", positions, points);
        Self {
            bvh: Bvh::new(&mesh.expect("samples are finite, and there are some")),
        }
    }

    /// Calls `visit` with the number of each sample that a ball covers.
    pub fn each_covered(
        &self,
        samples: &[Sample],
        ball: &Ball,
        e: f64,
        mut visit: impl FnMut(usize),
    ) {
        let reach = ball.reach(e);
        let slope = MARGIN * ball.half_width(e) / reach;
        self.bvh.search(
            reach * reach,
            |bounds| bounds.distance_squared(ball.center),
            |number, _, limit| {
                let Sample { position, radius } = samples[number];
                if position.distance(ball.center) <= reach - slope * radius {
                    visit(number);
                }
                limit
            },
        );
    }
}
