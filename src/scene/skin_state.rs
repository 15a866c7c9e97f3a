//! State of a patch during a simulation: pose, contacts, dampers and friction.

use super::frame::PatchReading;
use super::planned::{Carrier, PlannedPatch};
use crate::contact::equilibrium::{TangentialSpring, TangentialSpringState, TaxelLoad};
use crate::contact::{
    Contact, ContactModeCounts, DamperState, FrictionState, NormalForce, OUT_OF_REACH, Press,
    Record, TaxelContact, Until, Workspace, Wrench, axial_load,
};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::{Model, Sphere};
use glam::DVec3;

/// Poses, models and bounding balls of all objects of a scene.
#[derive(Clone, Debug)]
pub(super) struct PlacedObjects<'p> {
    /// Contact model of each object.
    pub models: &'p [Model],
    /// Pose of each object, `world_from_object`; escaped objects are placed far from all patches.
    pub poses: Vec<Pose>,
    /// Bounding ball of each object, object frame, metres.
    pub balls: Vec<Sphere>,
}

impl PlacedObjects<'_> {
    /// Returns the pose of each object in the patch frame, `patch_from_object`. An object that carries the patch does not touch it and gets a pose out of
    /// reach.
    pub fn seen_by<'a>(&'a self, skin: &SkinState) -> impl Iterator<Item = Pose> + use<'a> {
        let (carrier, world_from_patch) = (skin.patch.carrier, skin.pose);
        let poses = self.poses.iter().enumerate();
        poses.map(
            move |(number, pose)| match carrier == Carrier::Object(number) {
                true => OUT_OF_REACH,
                false => pose.seen_from(&world_from_patch),
            },
        )
    }

    /// Returns whether any object may touch the patch.
    pub fn can_reach(&self, skin: &SkinState) -> bool {
        let tree = skin.patch.skin.tree();
        let mut objects = self.seen_by(skin).zip(&self.balls);
        objects.any(|(pose, ball)| {
            let Sphere { center, radius } = ball.placed(&pose);
            tree.is_near(center, radius)
        })
    }
}

/// State of a patch of skin at one time.
#[derive(Clone, Debug)]
pub(super) struct SkinState<'p> {
    /// Plan of the patch.
    pub patch: &'p PlannedPatch,
    /// Current pose of the patch, `world_from_patch`.
    pub pose: Pose,
    damper: DamperState,
    /// Whether no object touches the patch and all deflections are zero.
    is_idle: bool,
    workspace: Workspace,
    /// State of the friction contacts of the patch; `None` if the patch has no friction.
    friction: Option<FrictionState>,
    contact_modes: ContactModeCounts,
    /// Pose of each object in the patch frame, `patch_from_object`.
    poses: Vec<Pose>,
    counts: Contact,
    /// Contacts of imposed objects with taxels at their stroke, in the last frame.
    stopped: Vec<TaxelContact>,
}

impl<'p> SkinState<'p> {
    /// Creates the state of a patch with zero deflections.
    pub fn new(patch: &'p PlannedPatch) -> Self {
        let n_taxels = patch.skin.n_taxels();
        let friction = patch.shears.clone();
        let at_rest = |shears| {
            let state = FrictionState::at_rest(&patch.skin, shears);
            state.expect("the plan has checked that they fit")
        };
        Self {
            patch,
            pose: Pose::IDENTITY,
            damper: DamperState::at_rest(n_taxels),
            is_idle: true,
            workspace: Workspace::new(),
            friction: friction.map(at_rest),
            contact_modes: ContactModeCounts::default(),
            poses: Vec::new(),
            counts: Contact::default(),
            stopped: Vec::new(),
        }
    }

    /// Keeps the given contacts, and the contacts that the last frame kept, for the next steps: an object part in contact continues to push its taxel, even
    /// from behind the substrate.
    pub fn hold<'a>(&'a mut self, contacts: impl IntoIterator<Item = &'a TaxelContact>) {
        self.workspace.hold(self.stopped.iter().chain(contacts));
    }

    /// Keeps the contacts of imposed objects with taxels at their stroke, so that an object that moves through the skin stays sensed behind it. `is_imposed`
    /// returns whether an object of the scene is imposed.
    pub fn keep_stopped(&mut self, is_imposed: impl Fn(usize) -> bool) {
        let taxels = self.patch.skin.taxels();
        let contacts = self.workspace.contacts().iter();
        let stopped = contacts.filter(|contact| {
            is_imposed(contact.object) && contact.is_saturated(taxels.at(contact.taxel))
        });
        self.stopped.clear();
        self.stopped.extend(stopped);
    }

    /// Returns the tangential springs of the patch that hold objects; each spring contains the number of its object in the scene.
    pub fn tangential_springs(&self) -> impl Iterator<Item = TangentialSpring> {
        self.friction
            .iter()
            .flat_map(FrictionState::tangential_springs)
    }

    /// Attaches tangential springs to the contacts of the object number `object`, in place of its present ones. In `only`, all other objects are too far away
    /// to touch the patch.
    pub fn put(
        &mut self,
        (object, only): (usize, &PlacedObjects),
        workspace: &mut Workspace,
    ) -> Result<()> {
        let poses: Vec<Pose> = only.seen_by(self).collect();
        let is_reached = only.can_reach(self);
        if let Some(friction) = &mut self.friction {
            let skin = &self.patch.skin;
            let contacts = match is_reached {
                true => {
                    Press::new(skin, only.models, &poses, Until::Pose)
                        .with_contacts()
                        .run(workspace)?;
                    workspace.contacts()
                }
                false => &[],
            };
            friction.put(skin, contacts, (object, &poses[object]));
        }
        Ok(())
    }

    /// Returns the deflections of the taxels, metres, shape (n_taxels,).
    pub fn deflection(&self) -> &[f64] {
        &self.damper.deflection
    }

    /// Makes a step and writes the reading of the patch. The forces of free objects are in `loads`, and the states of their tangential springs are in `tips`,
    /// in taxel order.
    pub fn step_and_read(
        &mut self,
        objects: &PlacedObjects,
        dt: f64,
        (loads, tips): (&[&TaxelLoad], &[TangentialSpringState]),
        reading: &mut PatchReading,
    ) -> Result<()> {
        self.update_deflections(objects, (dt, tips), Detail::Contacts)?;
        let patch = self.patch;
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
        Ok(())
    }

    /// Makes a time step of `dt` seconds to the current poses of the objects; an infinite `dt` gives the steady state. The tangential springs of free objects
    /// are in `tips`.
    pub fn update_deflections(
        &mut self,
        objects: &PlacedObjects,
        (dt, tips): (f64, &[TangentialSpringState]),
        detail: Detail,
    ) -> Result<()> {
        let is_reached = self.workspace.holds_any() || objects.can_reach(self);
        if !is_reached && self.is_idle {
            return Ok(());
        }
        let patch = self.patch;
        self.poses.clear();
        let models = match is_reached {
            true => objects.models,
            false => &[],
        };
        let seen = objects.seen_by(self);
        self.poses.extend(seen.take(models.len()));
        let workspace = &mut self.workspace;
        let record = match self.friction.is_some() || detail == Detail::Contacts {
            true => Record::Contacts,
            false => Record::Deflections,
        };
        let press = Press {
            record,
            ..Press::new(&patch.skin, models, &self.poses, Until::Pose)
        };
        self.counts = press.run(workspace)?.unwrap_or_default();
        self.damper
            .step(patch.skin.taxels(), dt, workspace.deflections());
        if let Some(friction) = &mut self.friction {
            // Moves the ends of the tangential springs with the contacting objects.
            let normal = NormalForce::Dampers(&self.damper);
            let contacts = workspace.contacts();
            self.contact_modes =
                friction.step_with(&patch.skin, contacts, &self.poses, normal, tips);
        }
        let mut deflections = self.damper.deflection.iter();
        self.is_idle = !is_reached && deflections.all(|&deflection| deflection == 0.0);
        Ok(())
    }
}

/// Adds to the reading of a patch the forces with which saturated taxels (at their stroke) support free objects.
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

/// Returns the frictionless force and torque of the taxels on each object, and writes the object's force on each taxel to `force3`. A contact has one
/// direction, but several spheres of free objects may touch one taxel; `loads` contains the force of each sphere.
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

/// Selection of the results that a time step of a patch computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Detail {
    Deflections,
    /// Deflections, and the contacts between objects and taxels.
    Contacts,
}

/// Returns the force and torque on the patch, opposite to the force and torque of the taxels on an object; negative zeros become positive.
fn on_patch(on_object: Wrench) -> Wrench {
    Wrench::default() + -on_object
}
