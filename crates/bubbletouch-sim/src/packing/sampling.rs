//! Samples of the outer surface, denser where balls are small, and candidate balls that touch the surface.

use super::ball::{Ball, relief};
use super::target::Target;
use crate::error::{Error, Result};
use crate::geometry::Aabb;
use crate::mesh::{BoxTree, Triangle};
use crate::objects::MAX_SPHERES;
use crate::text::numbers::short_number;
use glam::DVec3;

/// Surface point that some ball must cover, as a representative of the surface around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub position: DVec3,
    /// Radius of the piece of surface that the sample represents, metres.
    pub radius: f64,
}

/// Surface samples to be covered, and candidate balls that cover them.
pub(super) struct Sampling {
    pub effort: Effort,
    /// Indices of the triangles that are not proved to lie inside the solid and may therefore be part of the outer surface.
    pub outer: Vec<usize>,
    pub samples: Vec<Sample>,
    pub balls: Vec<Ball>,
}

/// Distance up to which the size of a computed ball is reused, relative to the radius that the ball covers. If larger, edges and thin ends have too few
/// samples; if smaller, sampling is slower.
const NEAR: f64 = 0.3;
/// Area per disc in the best covering of a plane by discs of radius 1: 3·√3/2, the area of a hexagon.
const HEXAGON: f64 = 2.598_076_211_353_316;

/// Numbers of samples, candidates and search steps of a packing, which determine its computing time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Number of samples per ball, on the area that one ball covers in the best covering of a plane. If larger, sampling is slower and leaves fewer gaps to
    /// repair; if smaller, the local search overlooks gaps.
    pub samples_a_ball: f64,
    /// Number of candidate balls per required ball, on the area that one ball covers in the best covering of a plane. A larger number reduces the number of
    /// spheres and takes longer.
    pub feet_a_ball: f64,
    /// Number of exchanges of the local search per chosen ball.
    pub steps_a_ball: f64,
    /// Number of shifted copies per chosen ball that the next local search may choose instead.
    pub moves_a_ball: f64,
    /// Number of optimisation passes over all cells of the surface.
    pub n_passes: usize,
}

impl Effort {
    /// Returns the numbers for a packing of the expected size. The numbers per sphere are largest up to 2,000 spheres and then decrease, so that the time
    /// grows more slowly than the number of spheres. From 30,000 spheres on, there are also fewer candidate balls. Candidates are reduced further, to no
    /// fewer than about 1,000, where a ball covers much more than on a plane. An example is the mesh of a sphere, whose centre is equally far from its whole
    /// surface. On such a mesh, a ball takes longest to compute.
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

/// Samples the outer surface of the target and computes candidate balls. Equal meshes give equal samples.
///
/// Returns an error if the tolerance needs more than about [`MAX_SPHERES`] spheres.
pub(super) fn sample(target: &Target) -> Result<Sampling> {
    let surface = target.surface;
    let demand = Demand::new(target);
    let n_spheres = demand.bent.min(demand.flat);
    if n_spheres > MAX_SPHERES as f64 {
        let given = format!(
            "{:.3e} mm, which takes about {} spheres for {:.1} cm² of surface",
            1e3 * target.e,
            short_number(n_spheres),
            1e4 * surface.mesh().area()
        );
        let allowed = format!("a larger one, of at most {MAX_SPHERES} spheres");
        return Err(Error::input("tolerance", given, allowed));
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
        // The outer surface is smaller than the area of one sample.
        let first = sampling.outer.first().copied().unwrap_or(0);
        sampling.samples.push(Sample {
            position: surface.mesh().triangle(first).middle(),
            radius: 0.0,
        });
    }
    Ok(sampling)
}

/// Returns the estimated number of spheres that a packing of the target needs.
pub(super) fn estimated_spheres(target: &Target) -> f64 {
    let demand = Demand::new(target);
    demand.bent.min(demand.flat)
}

/// Estimated number of balls that are needed to cover a surface.
struct Demand {
    /// Number of balls if each ball covers as much surface as on a plane.
    flat: f64,
    /// Number of balls if each ball covers its actual area. This number is lower than `flat` where the surface is curved as much as the balls.
    bent: f64,
}

impl Demand {
    /// Estimates the number of balls from every eighth triangle of the target; in large meshes from about 4,000 triangles.
    fn new(target: &Target) -> Self {
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
    /// Accumulated fraction of the next sample. A sample is placed whenever this value reaches one, so samples are uniform for any triangulation.
    due_samples: f64,
    due_feet: f64,
    sampling: Sampling,
}

/// Area of the surface that one ball covers, computed as a function of position.
struct Sizes<'a> {
    target: &'a Target<'a>,
    /// Surface normal and largest covering ball at the last position for which a ball was computed.
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
            // Only compact pieces are sampled: the middle of a long piece does not represent its ends.
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

    /// Returns the area that one ball covers at a surface point, m².
    fn share(&mut self, foot: DVec3, normal: DVec3) -> f64 {
        HEXAGON * self.ball(foot, normal).half_width(self.target.e).powi(2)
    }

    /// Returns the largest ball that covers a surface point, or the ball of a previous point if it is near enough.
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

/// Samples with a search tree.
pub(super) struct SampleTree {
    pub samples: Vec<Sample>,
    tree: BoxTree,
    /// Tolerance with which balls cover samples, metres.
    e: f64,
}

/// Factor of the margin around a sample that a ball must also cover. The margin is this factor times the sample's radius times the slope of the ball's
/// surface. If larger, more spheres are needed; if smaller, more gaps must be repaired, which needs more spheres in the end.
const MARGIN: f64 = 0.7;

impl SampleTree {
    /// Builds the search tree over the samples; there must be at least one. `e` is the tolerance, metres.
    pub fn new(samples: Vec<Sample>, e: f64) -> Self {
        let boxes = samples.iter().map(|sample| Aabb {
            min: sample.position,
            max: sample.position,
        });
        let tree = BoxTree::new(boxes.collect()).expect("there are samples");
        Self { samples, tree, e }
    }

    /// Calls `visit` with the index of each sample that a ball covers.
    pub fn each_covered(&self, ball: &Ball, mut visit: impl FnMut(usize)) {
        let reach = ball.reach(self.e);
        let slope = MARGIN * ball.half_width(self.e) / reach;
        let bound = |bounds: &Aabb| bounds.distance_squared(ball.center);
        self.tree.search(reach * reach, bound, |places, limit| {
            for &number in &self.tree.order()[places] {
                let Sample { position, radius } = self.samples[number as usize];
                if position.distance(ball.center) <= reach - slope * radius {
                    visit(number as usize);
                }
            }
            limit
        });
    }
}
