//! Spheres of an object near a skin of any layout, and the deflections that they require.

use crate::contact::lanes::SelectedLanes;
use crate::contact::law;
use crate::contact::object_at::{ClusterSearch, LOOK, ObjectAt, PlacedSphere, Region};
use crate::objects::SphereClusters;
use crate::world::{LEAF, Leaf, Node, TaxelTree};
use glam::DVec3;

/// The bound of a sphere is negative if the sphere may push a taxel of the node.
impl Region for Node {
    #[inline(always)]
    fn sphere_bound(&self, sphere: &PlacedSphere) -> f64 {
        -self.margin(sphere.center, sphere.reach)
    }
}

/// Collects the indices of the spheres of an object that may push a taxel, ascending.
#[inline(always)]
pub(crate) fn gather(
    taxels: &TaxelTree,
    (object, clusters): (ObjectAt, &SphereClusters),
    search: &mut ClusterSearch,
    numbers: &mut Vec<u32>,
) {
    numbers.clear();
    let Some(root) = taxels.root() else {
        return;
    };
    if clusters.bounds().len() == 1 {
        // The press compares each of these few spheres with the root.
        numbers.extend(0..clusters.n_spheres() as u32);
        return;
    }
    search.lay(object, clusters, root);
    for (look, bounds) in search.looks().iter().enumerate() {
        for k in SelectedLanes::below(bounds, 0.0) {
            let number = look * LOOK + k;
            let (cluster, of_cluster) = (clusters.cluster(number), clusters.numbers(number));
            let near = object.spheres_below(&cluster, root, 0.0);
            numbers.extend(near.map(|k| of_cluster[k]));
        }
    }
    numbers.sort_unstable();
}

/// Returns the deflection that contact with a sphere requires, metres; at most 0 if the sphere misses the taxel or lies behind its substrate. `from` is the
/// vector from the sphere's centre to the taxel's centre. `frame` contains two unit vectors perpendicular to the axis, and the axis. `reach` is the sum of
/// both radii, metres, and `behind` the substrate's height along the axis.
///
/// The operations have the order of the grid kernel, so that the two kernels return equal bits on a grid.
#[inline(always)]
pub(crate) fn needed_along(from: DVec3, frame: [DVec3; 3], reach: f64, behind: f64) -> f64 {
    let [across_x, across_y, axis] = frame;
    let (dx, dy, height) = (from.dot(across_x), from.dot(across_y), -from.dot(axis));
    let q = reach * reach - dy * dy - dx * dx;
    law::needed(q, height, behind)
}

/// Returns the deflections that contact with a sphere (in the patch frame) requires of the taxels in a leaf of the taxel tree, metres.
#[inline(always)]
pub(crate) fn needed_of_leaf(leaf: &Leaf, sphere: &PlacedSphere) -> [f64; LEAF] {
    let mut needed = [0.0; LEAF];
    for (k, needed) in needed.iter_mut().enumerate() {
        let from = leaf.vector(&leaf.centers, k) - sphere.center;
        let frame = [
            leaf.vector(&leaf.across[0], k),
            leaf.vector(&leaf.across[1], k),
            leaf.vector(&leaf.axes, k),
        ];
        let reach = leaf.radii[k] + sphere.reach;
        *needed = needed_along(from, frame, reach, leaf.behind[k]);
    }
    needed
}
