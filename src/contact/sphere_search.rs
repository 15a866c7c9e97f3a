//! Which spheres of a scene can press a grid patch: clusters of neighbours first, then the spheres of those that are near.

use super::below::Below;
use super::grid_lines::GridLines;
use super::indentation::Goal;
use super::instructions::for_instructions;
use super::placed_sphere::{PlacedSphere, View};
use crate::geometry::Pose;
use crate::objects::SphereClusters;
use crate::world::Scene;

/// Scratch of a search, reused.
#[derive(Clone, Debug, Default)]
pub(super) struct SphereSearch {
    /// Of the scene's sphere unions, in their order.
    views: Vec<View>,
    /// For each of their clusters a travel before which none of its spheres presses any taxel, metres; infinite beside the patch.
    starts: Vec<f64>,
    /// Spheres that can press, in the patch frame before any travel.
    pub found: Vec<PlacedSphere>,
    counted: Counted,
}

/// Which spheres counted in the last step of a time loop.
#[derive(Clone, Debug, Default)]
struct Counted {
    /// Number of the step, from 1.
    step: u32,
    /// One a sphere, cluster by cluster, union by union: the last step in which it counted; 0 for none.
    last: Vec<u32>,
}

impl Counted {
    fn next_step(&mut self, n_spheres: usize) {
        self.step += 1;
        self.last.resize(n_spheres, 0);
    }

    /// Whether a sphere counts in this step, and takes it down.
    fn counts(&mut self, sphere: usize, is_in_front: bool) -> bool {
        let last = &mut self.last[sphere];
        let counts = is_in_front || (*last > 0 && *last + 1 == self.step);
        if counts {
            *last = self.step;
        }
        counts
    }
}

/// So many clusters are looked at together.
const LOOK: usize = 8;

for_instructions! {
    /// Finds the spheres that count and can press a taxel on the way to the goal, and returns the travel at which the first taxel is
    /// touched; infinite if none is, or if the goal is no depth.
    ///
    /// For a depth, the cluster that is nearest is looked at beforehand, so that most others need no look to know what is first.
    pub(super) fn search(
        search: &mut SphereSearch,
        scene: &Scene,
        patch_from_objects: &[Pose],
        lines: &GridLines,
        goal: Goal,
    ) -> f64 = run
}

#[inline(always)]
fn run(
    search: &mut SphereSearch,
    scene: &Scene,
    patch_from_objects: &[Pose],
    lines: &GridLines,
    goal: Goal,
) -> f64 {
    search.lay(scene, patch_from_objects, lines);
    let taxel = &scene.patch.taxel;
    let behind = -taxel.stroke - taxel.radius;
    match goal {
        Goal::Travel(travel) => {
            search.gather(scene, travel, |_, _| true);
            f64::INFINITY
        }
        Goal::Depth(depth) => {
            let first = search.first_touch(scene, lines);
            search.gather(scene, first + depth, |_, _| true);
            first
        }
        Goal::Pose => {
            search.gather(scene, 0.0, |_, sphere| sphere.center.z >= behind);
            f64::INFINITY
        }
        Goal::Step => {
            let mut counted = std::mem::take(&mut search.counted);
            let unions = scene.objects.iter().filter_map(|object| object.spheres());
            counted.next_step(unions.map(|union| union.clusters().n_spheres()).sum());
            search.gather(scene, 0.0, |number, sphere| {
                counted.counts(number, sphere.center.z >= behind)
            });
            search.counted = counted;
            f64::INFINITY
        }
    }
}

impl SphereSearch {
    #[inline(always)]
    fn lay(&mut self, scene: &Scene, patch_from_objects: &[Pose], lines: &GridLines) {
        self.views.clear();
        self.starts.clear();
        for (object, pose) in scene.objects.iter().zip(patch_from_objects) {
            if let Some(union) = object.spheres() {
                let view = View::new(scene.patch.taxel.radius, lines, pose);
                let bounds = union.clusters().bounds();
                let before = self.starts.len();
                let n = bounds.len().next_multiple_of(LOOK);
                self.starts.resize(before + n, f64::INFINITY);
                view.lay_starts(bounds, &mut self.starts[before..before + bounds.len()]);
                self.views.push(view);
            }
        }
    }

    /// The travel at which the first sphere meets its first taxel.
    #[inline(always)]
    fn first_touch(&self, scene: &Scene, lines: &GridLines) -> f64 {
        let mut lowest = [f64::INFINITY; LOOK];
        for starts in self.starts.as_chunks::<LOOK>().0 {
            for k in 0..LOOK {
                lowest[k] = if starts[k] < lowest[k] {
                    starts[k]
                } else {
                    lowest[k]
                };
            }
        }
        let lowest = lowest.into_iter().fold(f64::INFINITY, f64::min);
        let mut first = f64::INFINITY;
        // The nearest cluster by itself, then what may be before its first.
        for limit in [lowest.next_up(), f64::INFINITY] {
            for (union, view, starts) in self.unions(scene) {
                for (look, starts) in starts.iter().enumerate() {
                    for k in Below::of(starts, limit.min(first)) {
                        let cluster = union.of(look * LOOK + k);
                        for sphere in Below::of(&view.starts(&cluster), first) {
                            if let Some(placed) = view.place(&cluster.at(sphere), first) {
                                first = first.min(placed.first_touch(lines));
                            }
                        }
                    }
                }
            }
        }
        first
    }

    /// Keeps the spheres that press before a travel and count; `counts` is asked by a sphere's number among those of all unions,
    /// cluster by cluster.
    #[inline(always)]
    fn gather(
        &mut self,
        scene: &Scene,
        limit: f64,
        mut counts: impl FnMut(usize, &PlacedSphere) -> bool,
    ) {
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        let mut n_before = 0;
        for (union, view, starts) in self.unions(scene) {
            for (look, starts) in starts.iter().enumerate() {
                for k in Below::of(starts, limit) {
                    let cluster = union.of(look * LOOK + k);
                    for sphere in Below::of(&view.starts(&cluster), limit) {
                        if let Some(placed) = view.place(&cluster.at(sphere), limit)
                            && counts(n_before + cluster.first + sphere, &placed)
                        {
                            found.push(placed);
                        }
                    }
                }
            }
            n_before += union.n_spheres();
        }
        self.found = found;
    }

    /// The unions of the scene, from where each is seen, and the starts of its clusters.
    #[inline(always)]
    fn unions<'a>(
        &'a self,
        scene: &'a Scene,
    ) -> impl Iterator<Item = (&'a SphereClusters, &'a View, &'a [[f64; LOOK]])> {
        let unions = scene.objects.iter().filter_map(|object| object.spheres());
        let mut rest = self.starts.as_chunks().0;
        unions.zip(&self.views).map(move |(union, view)| {
            let clusters = union.clusters();
            let (starts, behind) = rest.split_at(clusters.bounds().len().div_ceil(LOOK));
            rest = behind;
            (clusters, view, starts)
        })
    }
}
