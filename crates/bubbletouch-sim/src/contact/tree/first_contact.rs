//! First contact of a patch with any layout that travels along a line.
//!
//! First contact depends on the taxels' spheres and the direction, not on the taxels' axes. The search therefore uses a copy of the taxels whose axes are the
//! direction and whose strokes are unlimited. The taxel whose copy has the largest deflection touches first.

use super::near_spheres::needed_of_leaf;
use super::path::meeting;
use crate::contact::instructions::{Instructions, for_instructions};
use crate::contact::lanes::SelectedLanes;
use crate::contact::mesh::skin_mesh::MeshAt;
use crate::contact::mesh::{LeafStops, SearchStack, stop_leaf};
use crate::contact::object_at::{ClusterSearch, LOOK, ObjectAt, PlacedSphere, Region};
use crate::contact::{Press, Workspace};
use crate::geometry::Pose;
use crate::objects::{Model, SphereUnion};
use crate::world::{Leaf, Node, Travelling};
use glam::DVec3;
use std::cell::Cell;

/// Returns the travel of the patch at which a taxel first meets an object, metres; negative if the patch is past this contact. Returns `None` if the path
/// misses all objects.
pub(super) fn first_contact(
    press: &Press,
    travelling: &Travelling,
    workspace: &mut Workspace,
) -> Option<f64> {
    let [_, end] = meeting(press)?;
    let front = Front {
        direction: press.along,
        travelling,
        root: travelling.taxels.root()?,
    };
    // At this travel the patch is past all objects on its path.
    let mut farthest = 0.0;
    for (object, pose) in press.objects.iter().zip(press.poses) {
        let pose = Pose {
            translation: pose.translation - end * press.along,
            ..*pose
        };
        farthest = match object {
            Model::Spheres(union) => {
                let (best, search) = (Instructions::Best, &mut workspace.clusters);
                farthest_sphere(best, &front, (union, &pose), farthest, search)
            }
            Model::Mesh(mesh) => front.farthest_of_mesh(&MeshAt::new(mesh, &pose), farthest),
        };
    }
    (farthest > 0.0).then_some(end - farthest)
}

/// Taxels whose axes are the direction of travel (unit vector, in the patch frame).
struct Front<'a> {
    direction: DVec3,
    travelling: &'a Travelling,
    root: &'a Node,
}

impl Front<'_> {
    /// Returns the larger of `others` and the largest deflection that a mesh requires of a taxel, metres. The taxels nearest to a low corner of the mesh are
    /// evaluated first, so that most triangles are excluded for the others.
    fn farthest_of_mesh(&self, mesh: &MeshAt, others: f64) -> f64 {
        let (taxels, direction) = (&self.travelling.taxels, self.direction);
        let mut farthest = others;
        let mut stack = SearchStack::new();
        let mut visit = |leaf: &Leaf| {
            let mut stops = LeafStops::lowest_below(-farthest);
            stop_leaf(Instructions::Best, mesh, leaf, &mut stops, &mut stack);
            let heights = stops.heights.iter();
            farthest = heights.fold(farthest, |farthest, height| farthest.max(-height));
        };
        if let Some(leaf) = taxels.leaf_beside(mesh.low_corner(direction), direction) {
            visit(leaf);
        }
        taxels.each_leaf(|node| mesh.is_near(node), visit);
        farthest
    }

    /// Returns an upper bound of the deflections, metres, that a ball requires of the taxels in a tree node. All taxels are parallel, so the bound uses the
    /// distance from their axes.
    #[inline(always)]
    fn most_of(&self, node: &Node, ball: &PlacedSphere) -> f64 {
        let room = node.margin(ball.center, ball.reach);
        match room >= 0.0 {
            true => room.sqrt() + node.front(self.direction) - ball.center.dot(self.direction),
            false => f64::NEG_INFINITY,
        }
    }
}

/// The bound of a sphere is minus an upper bound of the deflection that the sphere requires, metres.
impl Region for Front<'_> {
    #[inline(always)]
    fn sphere_bound(&self, sphere: &PlacedSphere) -> f64 {
        let most = self.travelling.front + sphere.reach - sphere.center.dot(self.direction);
        if self.root.margin(sphere.center, sphere.reach) >= 0.0 {
            -most
        } else {
            f64::INFINITY
        }
    }
}

for_instructions! {
    /// Returns the larger of `others` and the largest deflection that a sphere union at a pose requires of a taxel, metres. The clusters with the least bound are
    /// evaluated first, then those whose bound is less than minus the deflection found.
    fn farthest_sphere(
        front: &Front,
        union: (&SphereUnion, &Pose),
        others: f64,
        search: &mut ClusterSearch,
    ) -> f64 = farthest_by_clusters
}

#[inline(always)]
fn farthest_by_clusters(
    front: &Front,
    (union, pose): (&SphereUnion, &Pose),
    others: f64,
    search: &mut ClusterSearch,
) -> f64 {
    let object = ObjectAt::new(pose, 0.0);
    let clusters = union.clusters();
    search.lay(object, clusters, front);
    let farthest = Cell::new(others);
    for limit in [search.least().next_up(), f64::INFINITY] {
        for (look, bounds) in search.looks().iter().enumerate() {
            for k in SelectedLanes::below(bounds, limit.min(-farthest.get())) {
                let cluster = clusters.cluster(look * LOOK + k);
                for k in object.spheres_below(&cluster, front, -farthest.get()) {
                    let sphere = object.sphere(cluster.at(k));
                    front.travelling.taxels.each_leaf(
                        |node| front.most_of(node, &sphere) > farthest.get(),
                        |leaf| {
                            let needed = needed_of_leaf(leaf, &sphere);
                            farthest.set(needed.into_iter().fold(farthest.get(), f64::max));
                        },
                    );
                }
            }
        }
    }
    farthest.get()
}
