//! A patch on its way: where it is, what pushes it now, and what its dampers remember.

use super::frame::PatchReading;
use super::mount::Mount;
use super::plan_patch::PlannedPatch;
use crate::contact::equilibrium::{TangentialSpring, TangentialSpringState, TaxelLoad};
use crate::contact::{
    Contact, ContactModeCounts, DamperState, FrictionState, NormalForce, TaxelContact, Workspace,
    Wrench, axial_load, press_at_pose, press_with_contacts,
};
use crate::geometry::Pose;
use crate::objects::Model;
use glam::DVec3;

/// Where all objects are.
#[derive(Clone, Debug)]
pub(super) struct PlacedObjects {
    /// `world_from_object`, one an object; escaped ones are [out of reach](OUT_OF_REACH).
    pub poses: Vec<Pose>,
    /// Of a ball around each, in its own frame, metres.
    pub balls: Vec<(DVec3, f64)>,
}

/// Where an object is that touches nothing: farther away than any skin, and near enough that its square is a number.
pub(super) const OUT_OF_REACH: Pose = Pose {
    rotation: glam::DQuat::IDENTITY,
    translation: DVec3::new(0.0, 0.0, 1e100),
};

impl PlacedObjects {
    /// Where a patch sees them, `patch_from_object`: all but the one that carries it, which it does not feel.
    pub fn seen_by<'a>(
        &'a self,
        patch: &PlannedPatch,
        world_from_patch: &'a Pose,
    ) -> impl Iterator<Item = Pose> + 'a {
        let carrier = match patch.mount {
            Mount::Object { object, .. } => Some(object),
            Mount::World(_) | Mount::Link { .. } => None,
        };
        let poses = self.poses.iter().enumerate();
        poses.map(move |(number, pose)| match carrier == Some(number) {
            true => OUT_OF_REACH,
            false => pose.seen_from(world_from_patch),
        })
    }

    /// Whether any object may push a patch that is there: by a box around its taxels and balls around the objects.
    pub fn can_reach(&self, patch: &PlannedPatch, world_from_patch: &Pose) -> bool {
        let skin = &patch.skin;
        let Some(bounds) = skin.tree().bounds() else {
            return false;
        };
        self.seen_by(patch, world_from_patch)
            .zip(&self.balls)
            .any(|(pose, &(center, radius))| {
                let center = pose.transform_point(center);
                let reach = radius + skin.tree().largest_radius();
                // What rounding may add, far above 1e-16 and far below what is felt.
                bounds.distance_squared(center) <= reach * reach * (1.0 + 1e-9)
            })
    }
}

/// A patch at one time.
#[derive(Clone, Debug)]
pub(super) struct SkinState {
    /// `world_from_patch`.
    pub pose: Pose,
    damper: DamperState,
    /// Nothing pushes it, and all its taxels are out.
    is_idle: bool,
    workspace: Workspace,
    /// Of a patch with friction.
    friction: Option<FrictionState>,
    contact_modes: ContactModeCounts,
    /// `patch_from_object`, one an object.
    poses: Vec<Pose>,
    counts: Contact,
}

impl SkinState {
    /// Taxels that stand out.
    pub fn of(patch: &PlannedPatch) -> Self {
        let n_taxels = patch.skin.n_taxels();
        let friction = patch.shears.clone();
        let at_rest = |shears| {
            let state = FrictionState::at_rest(&patch.skin, shears);
            state.expect("the plan has checked that they fit")
        };
        Self {
            pose: Pose::IDENTITY,
            damper: DamperState::at_rest(n_taxels),
            is_idle: true,
            workspace: Workspace::new(),
            friction: friction.map(at_rest),
            contact_modes: ContactModeCounts::default(),
            poses: Vec::new(),
            counts: Contact::default(),
        }
    }

    /// From now on these parts of objects push their taxels behind the substrate too.
    pub fn hold<'a>(&mut self, contacts: impl IntoIterator<Item = &'a TaxelContact>) {
        self.workspace.hold(contacts);
    }

    /// Tangential springs that hold objects; the numbers of objects are those of the scene.
    pub fn tangential_springs(&self) -> impl Iterator<Item = TangentialSpring> {
        self.friction
            .iter()
            .flat_map(FrictionState::tangential_springs)
    }

    /// Its tips hold an object by what it touches where it is, as if it had just been put there; all others are out of reach.
    pub fn put(
        &mut self,
        patch: &PlannedPatch,
        models: &[Model],
        (object, only): (usize, &PlacedObjects),
        workspace: &mut Workspace,
    ) {
        if let Some(friction) = &mut self.friction {
            let poses: Vec<Pose> = only.seen_by(patch, &self.pose).collect();
            press_with_contacts(&patch.skin, models, &poses, workspace);
            friction.put(&patch.skin, workspace.contacts(), (object, &poses[object]));
        }
    }

    /// How far its taxels are in, metres.
    pub fn deflection(&self) -> &[f64] {
        &self.damper.deflection
    }

    /// [Feels](Self::feel), and reports; `loads` and `tips`: what its taxels carry of free objects, taxel by taxel.
    pub fn step_and_read(
        &mut self,
        patch: &PlannedPatch,
        models: &[Model],
        objects: &PlacedObjects,
        dt: f64,
        (loads, tips): (&[&TaxelLoad], &[TangentialSpringState]),
        reading: &mut PatchReading,
    ) {
        self.feel(patch, models, objects, (dt, tips), Detail::Contacts);
        let contacts = self.workspace.contacts();
        reading.pose = self.pose;
        reading.deflection.clone_from(&self.damper.deflection);
        reading.force.clone_from(&self.damper.force);
        reading.n_saturated = self.counts.n_saturated;
        reading.n_grazing = contacts
            .iter()
            .filter(|contact| contact.is_grazing())
            .count();
        add_stops(patch, contacts, loads, reading);
        let forces = &reading.force;
        reading.n_touched = forces.iter().filter(|&&force| force > 0.0).count();
        let load = axial_load(&patch.skin, contacts, |contact| forces[contact.taxel]);
        reading.center_of_pressure = load.center_of_pressure;
        let without_friction = on_objects(contacts, loads, forces, &mut reading.force3);
        reading.wrench = on_patch(without_friction);
        if let (Some(state), Some(friction)) = (&self.friction, &mut reading.friction) {
            let load = state.load(&patch.skin, contacts);
            reading.wrench = reading.wrench + on_patch(load.friction);
            friction.shear = on_patch(load.friction).force;
            friction.n_sticking = self.contact_modes.n_sticking;
            friction.n_slipping = self.contact_modes.n_slipping;
            for contact in contacts {
                let frame = patch.skin.layout().frame(contact.taxel);
                let force = state.friction(contact.taxel).extend(0.0);
                reading.force3[contact.taxel] += frame * force;
            }
        }
    }

    /// Feels for `dt` seconds what is there at their end; for an endless `dt`, as if it had been there for long. `tips`: what holds free objects.
    pub fn feel(
        &mut self,
        patch: &PlannedPatch,
        models: &[Model],
        objects: &PlacedObjects,
        (dt, tips): (f64, &[TangentialSpringState]),
        detail: Detail,
    ) {
        let is_reached = self.workspace.holds_any() || objects.can_reach(patch, &self.pose);
        if !is_reached && self.is_idle {
            return;
        }
        self.poses.clear();
        let models = match is_reached {
            true => models,
            false => &[],
        };
        let seen = objects.seen_by(patch, &self.pose);
        self.poses.extend(seen.take(models.len()));
        let workspace = &mut self.workspace;
        let press = match self.friction.is_some() || detail == Detail::Contacts {
            true => press_with_contacts,
            false => press_at_pose,
        };
        self.counts = press(&patch.skin, models, &self.poses, workspace);
        self.damper
            .step(patch.skin.taxels(), dt, workspace.deflections());
        if let Some(friction) = &mut self.friction {
            // Drags the tips along with what touches them.
            let normal = NormalForce::Dampers(&self.damper);
            let contacts = workspace.contacts();
            self.contact_modes =
                friction.step_with(&patch.skin, contacts, &self.poses, normal, tips);
        }
        let mut deflections = self.damper.deflection.iter();
        self.is_idle = !is_reached && deflections.all(|&deflection| deflection == 0.0);
    }
}

/// Adds to a reading what stops carry of free objects.
fn add_stops(
    patch: &PlannedPatch,
    contacts: &[TaxelContact],
    loads: &[&TaxelLoad],
    reading: &mut PatchReading,
) {
    reading.stop_force = loads.iter().map(|load| load.stop).sum();
    for of_taxel in loads.chunk_by(|a, b| a.taxel == b.taxel) {
        let taxel = of_taxel[0].taxel;
        let stop: f64 = of_taxel.iter().map(|load| load.stop).sum();
        if stop > 0.0 {
            reading.force[taxel] += stop;
            let contact = contacts.binary_search_by_key(&taxel, |contact| contact.taxel);
            let spring = patch.skin.taxels().at(taxel);
            let is_counted = contact.is_ok_and(|at| contacts[at].is_saturated(spring));
            reading.n_saturated += usize::from(!is_counted);
        }
    }
}

/// Returns the frictionless wrench of taxels with these forces on the objects, and writes each taxel's part to `force3`: the force of the objects
/// on the taxel. A contact has one direction, but several spheres of free objects may share a taxel: the loads contain the force of each sphere.
fn on_objects(
    contacts: &[TaxelContact],
    loads: &[&TaxelLoad],
    forces: &[f64],
    force3: &mut Vec<DVec3>,
) -> Wrench {
    let of_others = |contact: &TaxelContact| {
        let first = loads.partition_point(|load| load.taxel < contact.taxel);
        let own = loads[first..].iter();
        let own = own.take_while(|load| load.taxel == contact.taxel);
        forces[contact.taxel] - own.map(|load| load.force).sum::<f64>()
    };
    force3.clear();
    force3.resize(forces.len(), DVec3::ZERO);
    let mut sum = Wrench::default();
    let of_contacts = contacts.iter().map(|c| (c.taxel, c.push(of_others(c))));
    let of_loads = loads.iter().map(|load| (load.taxel, load.on_object));
    for (taxel, on_object) in of_contacts.chain(of_loads) {
        sum = sum + on_object;
        force3[taxel] -= on_object.force;
    }
    sum
}

/// What is asked of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Detail {
    Deflections,
    /// Also what touches what.
    Contacts,
}

/// What an object feels, felt by the patch; nothing has no sign.
fn on_patch(on_object: Wrench) -> Wrench {
    Wrench::default() + -on_object
}
