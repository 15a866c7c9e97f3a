//! Search for the spheres that can press a flat grid: first by clusters of neighbouring spheres, then sphere by sphere in nearby clusters.

use super::placed_objects::PlacedObjects;
use super::placed_sphere::GridRegion;
use crate::contact::Until;
use crate::contact::instructions::for_instructions;
use crate::contact::lanes::SelectedLanes;
use crate::contact::law;
use crate::contact::object_at::{ClusterSearch, LOOK, ObjectAt, PlacedSphere};
use crate::objects::{Model, SphereClusters};
use crate::world::RADIUS_ROUNDING;

/// Scratch memory of a search for the spheres that can press a grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct SphereSearch {
    /// Sphere unions at their poses, with their clusters. The bounds are travels before which no sphere of a cluster presses a taxel, metres.
    unions: Vec<(ObjectAt, ClusterSearch)>,
    /// Spheres that can press a taxel, in the patch frame at a travel of 0.
    pub found: Vec<PlacedSphere>,
}

for_instructions! {
    /// Finds the spheres that can press a taxel before the goal of the press. Returns the travel at first contact, metres; infinite if no taxel is touched or
    /// if the goal is not a depth.
    ///
    /// For a depth, the nearest cluster is evaluated first, so that most other clusters can be excluded by their bounds.
    pub(crate) fn search(search: &mut SphereSearch, placed: &PlacedObjects, until: Until) -> f64 = run
}

#[inline(always)]
fn run(search: &mut SphereSearch, placed: &PlacedObjects, until: Until) -> f64 {
    let region = GridRegion::new(placed.lines);
    search.lay(placed, &region);
    let first = match until {
        Until::Depth(_) => search.first_touch(placed, &region),
        _ => f64::INFINITY,
    };
    search.gather(placed, &region, until.limit(first));
    first
}

impl SphereSearch {
    #[inline(always)]
    fn lay(&mut self, placed: &PlacedObjects, region: &GridRegion) {
        let n_unions = sphere_unions(placed.objects).count();
        self.unions.resize_with(n_unions, Default::default);
        let poses = placed.objects.iter().zip(placed.patch_from_objects);
        let unions = poses.filter_map(|(object, pose)| Some((object.spheres()?, pose)));
        for ((object, search), (union, pose)) in self.unions.iter_mut().zip(unions) {
            *object = ObjectAt::new(pose, placed.radius);
            search.lay(*object, union.clusters(), region);
        }
    }

    /// Returns the travel at which the first sphere meets a taxel, metres.
    #[inline(always)]
    fn first_touch(&self, placed: &PlacedObjects, region: &GridRegion) -> f64 {
        let lowest = self.unions.iter().map(|(_, search)| search.least());
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        let mut first = f64::INFINITY;
        // The first pass evaluates the nearest cluster alone; the second pass evaluates clusters that may be nearer than its first contact.
        for limit in [lowest.next_up(), f64::INFINITY] {
            for ((object, search), clusters) in
                self.unions.iter().zip(sphere_unions(placed.objects))
            {
                for (look, starts) in search.looks().iter().enumerate() {
                    for k in SelectedLanes::below(starts, limit.min(first)) {
                        let cluster = clusters.cluster(look * LOOK + k);
                        for k in object.spheres_below(&cluster, region, first) {
                            let sphere = object.sphere(cluster.at(k));
                            first = first.min(sphere.first_touch(placed.lines));
                        }
                    }
                }
            }
        }
        first
    }

    /// Collects the spheres over the grid that press a taxel before the travel `limit` and are in front of the substrate.
    #[inline(always)]
    fn gather(&mut self, placed: &PlacedObjects, region: &GridRegion, limit: f64) {
        self.found.clear();
        for ((object, search), clusters) in self.unions.iter().zip(sphere_unions(placed.objects)) {
            for (look, starts) in search.looks().iter().enumerate() {
                for k in SelectedLanes::below(starts, limit) {
                    let cluster = clusters.cluster(look * LOOK + k);
                    for k in object.spheres_below(&cluster, region, limit) {
                        let sphere = object.sphere(cluster.at(k));
                        let q = sphere.reach * sphere.reach;
                        if law::is_in_front(q, sphere.center.z, placed.behind)
                            && !region.misses(sphere.center, sphere.reach * RADIUS_ROUNDING)
                        {
                            self.found.push(sphere);
                        }
                    }
                }
            }
        }
    }
}

/// Returns the clusters of all sphere unions among some objects.
fn sphere_unions(objects: &[Model]) -> impl Iterator<Item = &SphereClusters> {
    let unions = objects.iter().filter_map(Model::spheres);
    unions.map(|union| union.clusters())
}
