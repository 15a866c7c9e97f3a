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
}

/// So many clusters are looked at together.
const LOOK: usize = 8;

for_instructions! {
    /// Finds the spheres that can press a taxel on the way to the goal, and returns the travel at which the first taxel is touched;
    /// infinite if none is, or if the goal is a travel.
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
    let (first, limit) = match goal {
        Goal::Travel(travel) => (f64::INFINITY, travel),
        Goal::Depth(depth) => {
            let first = search.first_touch(scene, lines);
            (first, first + depth)
        }
    };
    search.gather(scene, limit);
    first
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

    #[inline(always)]
    fn gather(&mut self, scene: &Scene, limit: f64) {
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        for (union, view, starts) in self.unions(scene) {
            for (look, starts) in starts.iter().enumerate() {
                for k in Below::of(starts, limit) {
                    let cluster = union.of(look * LOOK + k);
                    for sphere in Below::of(&view.starts(&cluster), limit) {
                        if let Some(placed) = view.place(&cluster.at(sphere), limit) {
                            found.push(placed);
                        }
                    }
                }
            }
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
