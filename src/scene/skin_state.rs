//! A patch on its way: where it is, what pushes it now, and what its dampers remember.

use super::frame::PatchReading;
use super::plan_patch::{Mount, PlannedPatch};
use super::robot_state::RobotState;
use crate::contact::{
    DamperState, SkinContact, SkinWorkspace, TaxelContact, Workspace, Wrench, press_skin,
    press_to_travel,
};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{Patch, Scene, SkinPatch};
use glam::DVec3;

/// Where all objects are.
#[derive(Clone, Debug)]
pub(super) struct PlacedObjects {
    /// `world_from_object`, one an object; escaped ones are [out of reach](OUT_OF_REACH).
    pub poses: Vec<Pose>,
    /// Of a ball around each, in its own frame, metres.
    pub balls: Vec<(DVec3, f64)>,
}

/// Where an object is that touches nothing: farther away than any skin, and near enough that distances stay exact.
pub(super) const OUT_OF_REACH: Pose = Pose {
    rotation: glam::DQuat::IDENTITY,
    translation: DVec3::new(0.0, 0.0, 1e6),
};

impl PlacedObjects {
    /// Whether any object may push a patch that is there: by a box around its taxels and balls around the objects.
    pub fn can_reach(&self, skin: &SkinPatch, world_from_patch: &Pose) -> bool {
        let Some(bounds) = skin.tree().bounds() else {
            return false;
        };
        let patch_from_world = world_from_patch.inverse();
        self.poses
            .iter()
            .zip(&self.balls)
            .any(|(pose, &(center, radius))| {
                let center = patch_from_world.transform_point(pose.transform_point(center));
                let reach = radius + skin.tree().largest_radius();
                // What rounding may add, far above 1e-16 and far below what is felt.
                bounds.distance_squared(center) <= reach * reach * (1.0 + 1e-9)
            })
    }
}

/// The fast kernel of flat grids, for steps of which nobody wants to know what touches what.
#[derive(Clone, Debug)]
struct GridKernel {
    scene: Scene,
    workspace: Workspace,
}

/// A patch at one time.
#[derive(Clone, Debug)]
pub(super) struct SkinState {
    /// `world_from_patch`.
    pub pose: Pose,
    damper: DamperState,
    /// Nothing pushes it, and all its taxels are out.
    is_idle: bool,
    workspace: SkinWorkspace,
    grid: Option<Box<GridKernel>>,
    /// `patch_from_object`, one an object.
    poses: Vec<Pose>,
    /// One a taxel: what nothing pushes.
    untouched: Vec<f64>,
    counts: SkinContact,
}

impl SkinState {
    /// Taxels that stand out. The grid kernel is for damped grids among spheres, where it agrees to the bit with the other.
    pub fn of(patch: &PlannedPatch, models: &[Model]) -> Self {
        let n_taxels = patch.skin.n_taxels();
        let are_spheres = models.iter().all(|model| model.spheres().is_some());
        let is_stepped = patch.taxel.damping > 0.0 && are_spheres;
        let kernel = |patch: Patch| {
            let objects = models.to_vec();
            Box::new(GridKernel {
                scene: Scene { patch, objects },
                workspace: Workspace::new(),
            })
        };
        Self {
            pose: Pose::IDENTITY,
            damper: DamperState::at_rest(n_taxels),
            is_idle: true,
            workspace: SkinWorkspace::new(),
            grid: patch.grid().filter(|_| is_stepped).map(kernel),
            poses: Vec::with_capacity(models.len()),
            untouched: vec![0.0; n_taxels],
            counts: SkinContact::default(),
        }
    }

    /// Goes to where what carries it is.
    pub fn place(&mut self, patch: &PlannedPatch, robots: &[RobotState]) {
        self.pose = match patch.mount {
            Mount::World(pose) => pose,
            Mount::Link {
                robot,
                link,
                link_from_patch,
            } => robots[robot].world_from_link[link].compose(&link_from_patch),
        };
    }

    /// Feels for `dt` seconds what is there at their end; for an endless `dt`, as if it had been there for long.
    pub fn step(
        &mut self,
        patch: &PlannedPatch,
        models: &[Model],
        objects: &PlacedObjects,
        dt: f64,
    ) {
        self.feel(patch, models, objects, dt, Detail::Deflections);
    }

    /// The same, and reports.
    pub fn step_and_read(
        &mut self,
        patch: &PlannedPatch,
        models: &[Model],
        objects: &PlacedObjects,
        dt: f64,
        reading: &mut PatchReading,
    ) {
        self.feel(patch, models, objects, dt, Detail::Contacts);
        reading.pose = self.pose;
        reading.deflection.clone_from(&self.damper.deflection);
        reading.force.clone_from(&self.damper.force);
        reading.n_touched = self
            .damper
            .force
            .iter()
            .filter(|&&force| force > 0.0)
            .count();
        reading.n_saturated = self.counts.n_saturated;
        reading.n_grazing = self.counts.n_grazing;
        // Out of reach, the workspace still has what touched it last.
        let contacts = match self.counts.n_touched {
            0 => &[],
            _ => self.workspace.contacts(),
        };
        let (wrench, center) = load(&patch.skin, contacts, &self.damper.force);
        reading.wrench = wrench;
        reading.center_of_pressure = center;
    }

    fn feel(
        &mut self,
        patch: &PlannedPatch,
        models: &[Model],
        objects: &PlacedObjects,
        dt: f64,
        detail: Detail,
    ) {
        if !objects.can_reach(&patch.skin, &self.pose) {
            self.counts = SkinContact::default();
            if !self.is_idle {
                self.damper.step(patch.skin.taxels(), dt, &self.untouched);
                self.is_idle = self
                    .damper
                    .deflection
                    .iter()
                    .all(|&deflection| deflection == 0.0);
            }
            return;
        }
        self.is_idle = false;
        let patch_from_world = self.pose.inverse();
        let seen = objects
            .poses
            .iter()
            .map(|pose| patch_from_world.compose(pose));
        self.poses.clear();
        self.poses.extend(seen);
        let pushed = match (&mut self.grid, detail) {
            (Some(grid), Detail::Deflections) => {
                press_to_travel(&grid.scene, &self.poses, 0.0, &mut grid.workspace);
                grid.workspace.deflections()
            }
            _ => {
                self.counts = press_skin(&patch.skin, models, &self.poses, &mut self.workspace);
                self.workspace.deflections()
            }
        };
        self.damper.step(patch.skin.taxels(), dt, pushed);
    }
}

/// What is asked of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Detail {
    Deflections,
    /// Also what touches what.
    Contacts,
}

/// What forces along the axes (n_taxels, newtons) at contacts put on a patch, and where they press.
fn load(patch: &SkinPatch, contacts: &[TaxelContact], forces: &[f64]) -> (Wrench, Option<DVec3>) {
    let mut wrench = Wrench::default();
    let (mut all, mut moment) = (0.0, DVec3::ZERO);
    for contact in contacts {
        let force = forces[contact.taxel];
        wrench = wrench + Wrench::at(contact.point, force * contact.gradient());
        all += force;
        moment += force * patch.layout().centers()[contact.taxel];
    }
    (wrench, (all > 0.0).then(|| moment / all))
}
