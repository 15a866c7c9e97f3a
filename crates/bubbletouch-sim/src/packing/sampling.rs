//! Points all over the outer surface, as dense as the balls there are small, and balls that touch it.

use super::ball::{Ball, relief};
use super::target::Target;
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::mesh::{BoxTree, Triangle};
use crate::objects::MAX_SPHERES;
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
    pub effort: Effort,
    /// Triangles that are not proved to be buried in the solid.
    pub outer: Vec<usize>,
    pub samples: Vec<Sample>,
    pub balls: Vec<Ball>,
}

/// Sizes are computed anew at this share of what a ball covers. Larger: edges and tips are sampled too thinly; smaller: slower.
const NEAR: f64 = 0.3;
/// Share of a plane's covering by discs of unit radius that each has to itself: 3·√3/2, a hexagon.
const HEXAGON: f64 = 2.598_076_211_353_316;

/// How much work a packing is worth; less for each sphere where there are many.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Samples in the area that one ball has to itself in the best covering of a plane. More: fewer gaps to mend, slower;
    /// fewer: the local search plans for gaps that it cannot see.
    pub samples_a_ball: f64,
    /// Places in that area at which a candidate ball touches. More: better coverings, slower.
    pub feet_a_ball: f64,
    /// Exchanges of the local search for each chosen ball.
    pub steps_a_ball: f64,
    /// Shifted copies of each chosen ball that the next search may take instead.
    pub moves_a_ball: f64,
    /// Searches over all cells.
    pub n_passes: usize,
}

impl Effort {
    /// All of it up to 2,000 spheres, then less for each, so that the time grows more slowly than their number; from 30,000
    /// on, fewer balls to choose from too; and fewer, but some 1,000, where a ball covers many times what it would of a plane,
    /// as on a sphere, whose middle is equally far from all of it: there a ball takes longest to find.
    fn for_about(demand: &Demand) -> Self {
        let share = (2000.0 / demand.flat).clamp(0.03, 1.0);
        let feet_a_ball = 5.0 + 35.0 * share.sqrt();
        let many = (30_000.0 / demand.flat).clamp(0.3, 1.0);
        let fewest = (1000.0 / (feet_a_ball * demand.flat)).clamp(0.1, 1.0);
        let round = (8.0 * demand.bent / demand.flat).clamp(fewest, 1.0);
        Self {
            samples_a_ball: 20.0 + 60.0 * share.sqrt(),
            feet_a_ball: many * round * feet_a_ball,
            steps_a_ball: 200.0 * share,
            moves_a_ball: 8.0 * share,
            n_passes: match share {
                share if share < 0.15 => 1,
                share if share < 0.25 => 2,
                _ => 3,
            },
        }
    }
}

/// Samples the surface; the same mesh always gives the same samples.
///
/// The error is a tolerance at which it takes more than [`MAX_SPHERES`], about.
pub(super) fn sample(target: &Target) -> Result<Sampling> {
    let surface = target.surface;
    let demand = Demand::of(target);
    let n_spheres = demand.bent.min(demand.flat);
    if n_spheres > MAX_SPHERES as f64 {
        return Err(Error::input(
            "tolerance",
            format!(
                "{:.3e} mm, which takes about {n_spheres:.1e} spheres for {:.1} cm² of surface",
                1e3 * target.e,
                1e4 * surface.mesh().area()
            ),
            format!("a larger one, of at most {MAX_SPHERES} spheres"),
        ));
    }
    let effort = Effort::for_about(&demand);
    let mut sampler = Sampler {
        sizes: Sizes::new(target),
        effort,
        due_samples: 1.0,
        due_feet: 1.0,
        sampling: Sampling {
            effort,
            outer: Vec::new(),
            samples: Vec::new(),
            balls: Vec::new(),
        },
    };
    // In the order of the tree, neighbours on the surface are neighbours in the list.
    surface
        .bvh()
        .each_in_box(&surface.bounds(), |number, triangle| {
            if let Some(normal) = triangle.normal()
                && !target.buries(triangle, normal)
            {
                sampler.sampling.outer.push(number);
                sampler.visit(*triangle, normal);
            }
        });
    let mut sampling = sampler.sampling;
    if sampling.samples.is_empty() {
        // The outer surface is less than what a sample stands for.
        let first = sampling.outer.first().copied().unwrap_or(0);
        sampling.samples.push(Sample {
            position: surface.mesh().triangle(first).middle(),
            radius: 0.0,
        });
    }
    Ok(sampling)
}

/// About how many spheres a packing takes.
pub(super) fn estimated_spheres(target: &Target) -> f64 {
    let demand = Demand::of(target);
    demand.bent.min(demand.flat)
}

/// About how many balls it takes to cover a surface.
struct Demand {
    /// If each covered no more than it does of a plane.
    flat: f64,
    /// By what each covers in truth: fewer where the surface bends like the balls.
    bent: f64,
}

impl Demand {
    /// From every eighth triangle; of many triangles from some 4,000.
    fn of(target: &Target) -> Self {
        let mesh = target.surface.mesh();
        let every = (mesh.n_triangles() / 4096).max(8);
        let mut sizes = Sizes::new(target);
        let (mut tried, mut all) = (Vec::new(), 0.0);
        for number in 0..mesh.n_triangles() {
            let triangle = mesh.triangle(number);
            let Some(normal) = triangle.normal() else {
                continue;
            };
            all += triangle.area();
            if number % every == 0 {
                let share = sizes.share(triangle.middle(), normal);
                let ball = sizes.ball(triangle.middle(), normal);
                tried.push((triangle, share, ball.center, ball.reach(target.e).powi(2)));
            }
        }
        let area: f64 = tried.iter().map(|(triangle, ..)| triangle.area()).sum();
        let scale = all / area.max(f64::MIN_POSITIVE);
        let flat = tried.iter().map(|(t, share, ..)| t.area() / share);
        let bent = tried.iter().map(|(triangle, share, center, reach2)| {
            let covered = tried
                .iter()
                .filter(|(other, ..)| other.middle().distance_squared(*center) <= *reach2);
            let covered: f64 = covered.map(|(other, ..)| scale * other.area()).sum();
            triangle.area() / covered.max(*share)
        });
        Self {
            flat: scale * flat.sum::<f64>(),
            bent: scale * bent.sum::<f64>(),
        }
    }
}

struct Sampler<'a> {
    sizes: Sizes<'a>,
    effort: Effort,
    /// A sample is placed whenever this passes one: evenly, however the surface is cut into triangles.
    due_samples: f64,
    due_feet: f64,
    sampling: Sampling,
}

/// How much of the surface a ball has to itself, here and there.
struct Sizes<'a> {
    target: &'a Target<'a>,
    /// Where they were last computed: the normal, and the largest ball that covers the place, its foot.
    known: Option<(DVec3, Ball)>,
}

impl Sampler<'_> {
    fn visit(&mut self, triangle: Triangle, normal: DVec3) {
        let Effort {
            samples_a_ball,
            feet_a_ball,
            ..
        } = self.effort;
        let mut waiting = vec![triangle];
        while let Some(triangle) = waiting.pop() {
            let foot = triangle.middle();
            let share = self.sizes.share(foot, normal);
            let balls = triangle.area() / share;
            // Compact pieces only: a long one reaches to places that its middle knows nothing of.
            let is_long = triangle.longest_edge_squared() * samples_a_ball > 8.0 * share;
            if balls * samples_a_ball > 1.0 || is_long {
                let [first, second] = triangle.bisected();
                waiting.extend([second, first]);
                continue;
            }
            if self.sizes.target.is_buried(foot, normal) {
                continue;
            }
            self.due_samples += balls * samples_a_ball;
            if self.due_samples >= 1.0 {
                self.due_samples -= 1.0;
                self.sampling.samples.push(Sample {
                    position: foot,
                    radius: (share / (HEXAGON * samples_a_ball)).sqrt(),
                });
            }
            self.due_feet += balls * feet_a_ball;
            if self.due_feet >= 1.0 {
                self.due_feet -= 1.0;
                self.sampling
                    .balls
                    .push(Ball::at(self.sizes.target, foot, normal));
            }
        }
    }
}

impl<'a> Sizes<'a> {
    fn new(target: &'a Target<'a>) -> Self {
        Self {
            target,
            known: None,
        }
    }

    /// What the ball of a point of the surface has to itself, m².
    fn share(&mut self, foot: DVec3, normal: DVec3) -> f64 {
        HEXAGON * self.ball(foot, normal).half_width(self.target.e).powi(2)
    }

    /// The largest ball that covers a point of the surface, or a point nearby.
    fn ball(&mut self, foot: DVec3, normal: DVec3) -> Ball {
        let e = self.target.e;
        if let Some((known_normal, ball)) = &self.known
            && foot.distance(ball.foot) < NEAR * ball.half_width(e)
            && normal.dot(*known_normal) > 0.95
        {
            return *ball;
        }
        let limit = self.target.largest_radius();
        let ball = Ball::largest(self.target, foot, -normal, relief(e), limit);
        let ball = ball.unwrap_or(Ball::on_surface(foot));
        self.known = Some((normal, ball));
        ball
    }
}

/// A tree over samples.
pub(super) struct SampleTree {
    tree: BoxTree,
}

/// How much of a sample's radius must be covered too, by the slope of the ball there. More: more spheres; less: more gaps
/// to mend, which takes more spheres in the end.
const MARGIN: f64 = 0.7;

impl SampleTree {
    /// There must be some.
    pub fn new(samples: &[Sample]) -> Self {
        let boxes = samples.iter().map(|sample| Aabb {
            min: sample.position,
            max: sample.position,
        });
        Self {
            tree: BoxTree::new(boxes.collect()).expect("there are samples"),
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
        self.tree.search(
            reach * reach,
            |bounds| bounds.distance_squared(ball.center),
            |places, limit| {
                for &number in &self.tree.order()[places] {
                    let Sample { position, radius } = samples[number as usize];
                    if position.distance(ball.center) <= reach - slope * radius {
                        visit(number as usize);
                    }
                }
                limit
            },
        );
    }
}
