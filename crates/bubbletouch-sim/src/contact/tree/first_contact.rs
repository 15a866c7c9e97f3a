//! First contact of a patch with any layout that travels along a line.
//!
//! First contact depends on the taxels' spheres and the direction, not on the taxels' axes. The search therefore uses a copy of the taxels whose axes are the
//! direction and whose strokes are unlimited. The taxel whose copy has the largest deflection touches first.

use super::near_spheres::{PlacedUnion, needed_of_leaf};
use super::path::meeting;
use crate::contact::Press;
use crate::contact::instructions::{Instructions, for_instructions};
use crate::contact::mesh::skin_mesh::MeshAt;
use crate::contact::mesh::{LeafStops, SearchStack, stop_leaf};
use crate::geometry::Pose;
use crate::objects::{Model, Sphere, SphereUnion};
use crate::world::{Leaf, Node, Travelling};
use glam::DVec3;
use std::cell::Cell;

/// Returns the travel of the patch at which a taxel first meets an object, metres; negative if the patch is past this contact. Returns `None` if the path
/// misses all objects.
pub(super) fn first_contact(press: &Press, travelling: &Travelling) -> Option<f64> {
    let [_, end] = meeting(press)?;
    let front = Front {
        direction: press.along,
        travelling,
    };
    // At this travel the patch is past all objects on its path.
    let mut farthest = 0.0;
    for (object, pose) in press.objects.iter().zip(press.poses) {
        let pose = Pose {
            translation: pose.translation - end * press.along,
            ..*pose
        };
        farthest = front.farthest(object, &pose, farthest);
    }
    (farthest > 0.0).then_some(end - farthest)
}

/// Taxels whose axes are the direction of travel (unit vector, in the patch frame).
struct Front<'a> {
    direction: DVec3,
    travelling: &'a Travelling,
}

impl Front<'_> {
    /// Returns the larger of `others` and the largest deflection that an object requires of a taxel whose axis is the direction of travel, metres.
    fn farthest(&self, object: &Model, pose: &Pose, others: f64) -> f64 {
        match object {
            Model::Spheres(union) => self.farthest_sphere(union, pose, others),
            Model::Mesh(mesh) => self.farthest_of_mesh(&MeshAt::new(mesh, pose), others),
        }
    }

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

    /// Returns the larger of `others` and the largest deflection that a sphere union requires of a taxel, metres. The cluster with the largest bound is
    /// evaluated first, then those whose bound exceeds the deflection found.
    fn farthest_sphere(&self, union: &SphereUnion, pose: &Pose, others: f64) -> f64 {
        let (placed, travelling) = (PlacedUnion::new(union, pose), &self.travelling.taxels);
        let mut foremost = (others, None);
        for (cluster, ball) in placed.clusters() {
            let most = self.most(&ball);
            if most > foremost.0 && travelling.is_near(ball.center, ball.radius) {
                foremost = (most, Some(cluster));
            }
        }
        let Some(first) = foremost.1 else {
            return others;
        };
        let mut farthest = self.farthest_of(&placed, placed.cluster(first), others);
        for (cluster, ball) in placed.clusters() {
            if self.most(&ball) > farthest && travelling.is_near(ball.center, ball.radius) {
                farthest = self.farthest_of(&placed, placed.cluster(cluster), farthest);
            }
        }
        farthest
    }

    fn farthest_of(&self, placed: &PlacedUnion, numbers: &[u32], others: f64) -> f64 {
        farthest_of_each(Instructions::Best, self, placed, numbers, others)
    }

    /// Returns an upper bound of the deflection, metres, by a ball in the patch frame, for taxels whose axes are the direction of travel.
    #[inline(always)]
    fn most(&self, ball: &Sphere) -> f64 {
        self.travelling.front + ball.radius - ball.center.dot(self.direction)
    }

    /// Returns an upper bound of the deflections, metres, that a ball requires of the taxels in a tree node. All taxels are parallel, so the bound uses the
    /// distance from their axes.
    #[inline(always)]
    fn most_of(&self, node: &Node, ball: &Sphere) -> f64 {
        let room = node.margin(ball.center, ball.radius);
        match room >= 0.0 {
            true => room.sqrt() + node.front(self.direction) - ball.center.dot(self.direction),
            false => f64::NEG_INFINITY,
        }
    }
}

for_instructions! {
    /// Returns the larger of `others` and the largest deflection that any of the listed spheres requires of a taxel, metres.
    fn farthest_of_each(
        front: &Front,
        placed: &PlacedUnion,
        numbers: &[u32],
        others: f64,
    ) -> f64 = farthest_by_leaves
}

#[inline(always)]
fn farthest_by_leaves(front: &Front, placed: &PlacedUnion, numbers: &[u32], others: f64) -> f64 {
    let farthest = Cell::new(others);
    for &number in numbers {
        let sphere = placed.at(number);
        if front.most(&sphere) <= farthest.get() {
            continue;
        }
        front.travelling.taxels.each_leaf(
            |node| front.most_of(node, &sphere) > farthest.get(),
            |leaf| {
                let needed = needed_of_leaf(leaf, &sphere);
                farthest.set(needed.into_iter().fold(farthest.get(), f64::max));
            },
        );
    }
    farthest.get()
}
