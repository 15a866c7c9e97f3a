//! Search for the spheres that can press a flat grid: first by clusters of neighbouring spheres, then sphere by sphere in nearby clusters.

use super::placed_objects::PlacedObjects;
use super::placed_sphere::{PlacedSphere, View};
use crate::contact::Until;
use crate::contact::instructions::for_instructions;
use crate::contact::lanes::SelectedLanes;
use crate::contact::law;
use crate::objects::{Model, SphereClusters};

/// Scratch memory of a search for the spheres that can press a grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct SphereSearch {
    /// Transforms of the sphere unions to the patch frame, in the order of the unions.
    views: Vec<View>,
    /// Travel before which no sphere of a cluster presses a taxel, metres, for each cluster. The travel is infinite if the cluster passes beside the patch.
    starts: Vec<f64>,
    /// Spheres that can press a taxel, in the patch frame at a travel of 0.
    pub found: Vec<PlacedSphere>,
}

/// Number of clusters of spheres that are tested together.
const LOOK: usize = 8;

for_instructions! {
    /// Finds the spheres that can press a taxel before the goal of the press. Returns the travel at first contact, metres; infinite if no taxel is touched or
    /// if the goal is not a depth.
    ///
    /// For a depth, the nearest cluster is evaluated first, so that most other clusters can be excluded by their bounds.
    pub(crate) fn search(search: &mut SphereSearch, placed: &PlacedObjects, until: Until) -> f64 = run
}

#[inline(always)]
fn run(search: &mut SphereSearch, placed: &PlacedObjects, until: Until) -> f64 {
    search.lay(placed);
    let first = match until {
        Until::Depth(_) => search.first_touch(placed),
        _ => f64::INFINITY,
    };
    search.gather(placed.objects, until.limit(first), |sphere| {
        law::is_in_front(sphere.reach * sphere.reach, sphere.center.z, placed.behind)
    });
    first
}

impl SphereSearch {
    #[inline(always)]
    fn lay(&mut self, placed: &PlacedObjects) {
        self.views.clear();
        self.starts.clear();
        for (object, pose) in placed.objects.iter().zip(placed.patch_from_objects) {
            if let Some(union) = object.spheres() {
                let view = View::new(placed.radius, placed.lines, pose);
                let bounds = union.clusters().bounds();
                let before = self.starts.len();
                let n = bounds.len().next_multiple_of(LOOK);
                self.starts.resize(before + n, f64::INFINITY);
                view.lay_starts(bounds, &mut self.starts[before..before + bounds.len()]);
                self.views.push(view);
            }
        }
    }

    /// Returns the travel at which the first sphere meets a taxel, metres.
    #[inline(always)]
    fn first_touch(&self, placed: &PlacedObjects) -> f64 {
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
        // The first pass evaluates the nearest cluster alone; the second pass evaluates clusters that may be nearer than its first contact.
        for limit in [lowest.next_up(), f64::INFINITY] {
            for (union, view, starts) in self.unions(placed.objects) {
                for (look, starts) in starts.iter().enumerate() {
                    for k in SelectedLanes::below(starts, limit.min(first)) {
                        let cluster = union.cluster(look * LOOK + k);
                        for sphere in SelectedLanes::below(&view.starts(&cluster), first) {
                            if let Some(sphere) = view.place(&cluster.at(sphere), first) {
                                first = first.min(sphere.first_touch(placed.lines));
                            }
                        }
                    }
                }
            }
        }
        first
    }

    /// Collects the spheres that press a taxel before the travel `limit` and for which `counts` returns true.
    #[inline(always)]
    fn gather(&mut self, objects: &[Model], limit: f64, counts: impl Fn(&PlacedSphere) -> bool) {
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        for (union, view, starts) in self.unions(objects) {
            for (look, starts) in starts.iter().enumerate() {
                for k in SelectedLanes::below(starts, limit) {
                    let cluster = union.cluster(look * LOOK + k);
                    for sphere in SelectedLanes::below(&view.starts(&cluster), limit) {
                        let placed = view.place(&cluster.at(sphere), limit);
                        found.extend(placed.filter(&counts));
                    }
                }
            }
        }
        self.found = found;
    }

    /// Returns the sphere unions with their transforms to the patch frame and the travels of their clusters.
    #[inline(always)]
    fn unions<'a>(
        &'a self,
        objects: &'a [Model],
    ) -> impl Iterator<Item = (&'a SphereClusters, &'a View, &'a [[f64; LOOK]])> {
        let unions = objects.iter().filter_map(|object| object.spheres());
        let mut rest = self.starts.as_chunks().0;
        unions.zip(&self.views).map(move |(union, view)| {
            let clusters = union.clusters();
            let (starts, behind) = rest.split_at(clusters.bounds().len().div_ceil(LOOK));
            rest = behind;
            (clusters, view, starts)
        })
    }
}
