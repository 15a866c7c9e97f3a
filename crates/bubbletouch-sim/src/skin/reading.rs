//! Results of a read of a skin, and the memory that successive reads reuse.

use super::point_loads::{LoadWorkspace, PointLoad};
use crate::contact::{Workspace, Wrench};
use crate::geometry::Pose;
use crate::world::Patch;
use glam::DVec3;

/// Numbers of taxels of a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TouchCounts {
    /// Number of taxels with a deflection above zero.
    pub n_touched: usize,
    /// Number of taxels at their stroke.
    pub n_saturated: usize,
}

impl TouchCounts {
    pub(super) fn of(patch: &Patch, deflections: &[f64]) -> Self {
        let touched = deflections.iter().enumerate().filter(|(_, d)| **d > 0.0);
        touched.fold(Self::default(), |counts, (index, deflection)| Self {
            n_touched: counts.n_touched + 1,
            n_saturated: counts.n_saturated
                + usize::from(*deflection >= patch.taxels().at(index).stroke),
        })
    }
}

/// Results of a read, set of poses after set of poses. A reading is reused by further reads; results do not depend on its content.
#[derive(Clone, Debug, Default)]
pub struct SkinReading {
    /// Deflections of the taxels, metres, shape (n_sets, n_taxels).
    pub deflections: Vec<f64>,
    /// Tangential force on each taxel in the frame of its patch, newtons, shape (n_taxels,); empty without friction forces of a simulator.
    pub tangential: Vec<DVec3>,
    /// Force and torque of the normal forces on each patch, in its frame about its origin, shape (n_sets, n_patches). With a [`ShearState`](super::ShearState),
    /// the wrenches contain friction and the lateral forces of inclined contacts.
    pub wrenches: Vec<Wrench>,
    /// Numbers of touched taxels of each patch, shape (n_sets, n_patches).
    pub counts: Vec<TouchCounts>,
    /// Normal force of each pair of patch and object, newtons, shape (n_sets, n_patches, n_objects).
    pub pair_forces: Vec<f64>,
    /// Requested force minus normal force of each pair, newtons; 0 for pairs that are read at their poses. A load that acts on no patch of its carrier belongs
    /// to the nearest one, if it is nearer than the diameter of the patch.
    pub residuals: Vec<f64>,
    /// Travel of the patch of each pair from its pose, metres; NaN for pairs with force 0.
    pub travels: Vec<f64>,
    pub(super) workspace: Workspace,
    /// Poses of all bodies in the frame of one patch.
    pub(super) placed: Vec<Pose>,
    /// Poses of one object, and deflections under it.
    pub(super) object_poses: Vec<Pose>,
    pub(super) object_frame: Vec<f64>,
    pub(super) load_workspace: LoadWorkspace,
    /// Loads of one pair.
    pub(super) pair_loads: Vec<PointLoad>,
}

impl SkinReading {
    /// Sets the results of `n` sets of poses to zero; counts and tangential forces are empty.
    pub(super) fn clear(&mut self, [n, n_patches, n_objects, n_taxels]: [usize; 4]) {
        clear(&mut self.deflections, n * n_taxels);
        self.wrenches.clear();
        self.wrenches.resize(n * n_patches, Wrench::default());
        let Self {
            pair_forces,
            residuals,
            travels,
            ..
        } = self;
        for values in [pair_forces, residuals, travels] {
            clear(values, n * n_patches * n_objects);
        }
        self.counts.clear();
        self.tangential.clear();
    }

    /// Places all bodies in the frame of a patch.
    pub(super) fn place(&mut self, world_from_patch: &Pose, world_from_bodies: &[Pose]) {
        let patch_from_world = world_from_patch.inverse();
        self.placed.clear();
        let placed = world_from_bodies
            .iter()
            .map(|pose| patch_from_world.compose(pose));
        self.placed.extend(placed);
    }
}

/// Fills a vector with `n` zeros.
pub(super) fn clear(values: &mut Vec<f64>, n: usize) {
    values.clear();
    values.resize(n, 0.0);
}
