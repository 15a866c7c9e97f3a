//! Shear springs with friction of all taxels of a skin, from one read to the next.

use super::parts::RigidObject;
use super::skin::Skin;
use crate::contact::{
    ContactMode, FrictionState, NormalForce, Press, TaxelContact, Until, Workspace, Wrench,
};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{Patch, Shear, Shears};
use glam::DVec3;
use std::ops::Range;

/// Shear springs with friction of all taxels of a skin. Each [`Skin::read`] advances the state by one step.
///
/// Between two reads, a body in contact drags the taxels sideways until they slip. The shear force is at most the friction coefficient times the normal
/// force.
#[derive(Clone, Debug)]
pub struct ShearState {
    /// State of each patch at rest, in the order of the skin.
    at_rest: Vec<FrictionState>,
    /// Indices of each patch's taxels in a frame of the skin.
    ranges: Vec<Range<usize>>,
    /// States of the patches, set after set of poses.
    states: Vec<FrictionState>,
    /// Forces on the taxels in the patch frames, newtons, set after set.
    forces: Vec<DVec3>,
}

impl ShearState {
    /// Creates the state of untouched patches for reads of `n_sets` sets of poses. `shear_of` returns the shear spring of a taxel, given its index in a frame
    /// of the skin.
    ///
    /// # Errors
    /// If a stiffness or a friction coefficient is out of its range.
    pub fn new(skin: &Skin, shear_of: impl Fn(usize) -> Shear, n_sets: usize) -> Result<Self> {
        let at_rest = skin.parts.iter().map(|part| {
            let shears = part.taxels().map(&shear_of).collect();
            FrictionState::at_rest(&part.patch, Shears::Each(shears))
        });
        let at_rest = at_rest.collect::<Result<Vec<_>>>()?;
        Ok(Self {
            states: (0..n_sets).flat_map(|_| at_rest.iter().cloned()).collect(),
            forces: vec![DVec3::ZERO; n_sets * skin.n_taxels()],
            at_rest,
            ranges: skin.ranges().collect(),
        })
    }

    /// Checks that the state has been created for a skin with the same patches and for the same number of sets.
    pub(super) fn check(&self, skin: &Skin, n_sets: usize) -> Result<()> {
        if !skin.ranges().eq(self.ranges.iter().cloned()) {
            let given = "a state of another skin";
            return Err(Error::input("shear", given, "a state of this skin"));
        }
        if self.n_sets() != n_sets {
            let given = format!("a state of {} sets of poses", self.n_sets());
            return Err(Error::input("shear", given, format!("{n_sets} sets")));
        }
        Ok(())
    }

    /// Returns the number of taxels of the skin.
    pub fn n_taxels(&self) -> usize {
        self.ranges.last().map_or(0, |last| last.end)
    }

    /// Returns the number of sets of poses.
    pub fn n_sets(&self) -> usize {
        self.states.len() / self.at_rest.len()
    }

    /// Returns the force of the bodies on each taxel after the last read in the frame of its patch, newtons, shape (n_sets, n_taxels). It is the sum of the
    /// normal force, the friction, and the lateral force of an inclined contact.
    pub fn forces(&self) -> &[DVec3] {
        &self.forces
    }

    /// Returns the mode of each taxel's contact during the last step, shape (n_sets, n_taxels).
    pub fn contact_modes(&self) -> impl Iterator<Item = ContactMode> {
        let modes = self.states.iter().flat_map(FrictionState::contact_modes);
        modes.copied()
    }

    /// Sets the shear forces of a set of poses to zero, as before the first read.
    ///
    /// # Panics
    /// If there is no such set.
    pub fn reset(&mut self, set: usize) {
        let (n_patches, n_taxels) = (self.ranges.len(), self.n_taxels());
        self.states[set * n_patches..][..n_patches].clone_from_slice(&self.at_rest);
        self.forces[set * n_taxels..][..n_taxels].fill(DVec3::ZERO);
    }

    /// Presses the patch `number` under all bodies at their poses in the patch frame, or under none if no body is near, and advances its shear springs by one
    /// step. The deflections are in the workspace. Returns the force and the torque on the patch. Bodies of one rigid object drag a taxel as one body.
    pub(super) fn step(
        &mut self,
        skin: &Skin,
        (set, number, is_near): (usize, usize, bool),
        placed: &[Pose],
        workspace: &mut Workspace,
    ) -> Wrench {
        let patch = &skin.parts[number].patch;
        type Bodies<'a> = (&'a [Model], &'a [Pose], &'a [RigidObject]);
        let (models, poses, objects): Bodies = match is_near {
            true => (&skin.models, placed, &skin.objects[number]),
            false => (&[], &[], &[]),
        };
        Press::new(patch, models, poses, Until::Pose)
            .with_contacts()
            .run(workspace)
            .expect("checked poses");
        // A rigid object moves with its first body.
        let object_of = |body: usize| {
            objects
                .iter()
                .position(|object| object.members.contains(&body))
        };
        let of_object = |contact: &TaxelContact| TaxelContact {
            object: object_of(contact.object).expect("each body that presses belongs to an object"),
            ..*contact
        };
        let contacts: Vec<TaxelContact> = workspace.contacts().iter().map(of_object).collect();
        let first = objects.iter().map(|object| {
            let body = object.members.first();
            body.and_then(|body| poses.get(*body)).copied()
        });
        let object_poses: Vec<Pose> = first.map(Option::unwrap_or_default).collect();
        let n_taxels = self.n_taxels();
        let state = &mut self.states[set * self.ranges.len() + number];
        state.step(patch, &contacts, &object_poses, NormalForce::Springs);
        let forces = &mut self.forces[set * n_taxels..][self.ranges[number].clone()];
        forces.fill(DVec3::ZERO);
        for contact in &contacts {
            forces[contact.taxel] = force_on_taxel(patch, state, contact);
        }
        -state.load(patch, &contacts).on_object
    }
}

/// Returns the force of the object on a taxel in the patch frame, newtons: frictionless force and friction.
fn force_on_taxel(patch: &Patch, state: &FrictionState, contact: &TaxelContact) -> DVec3 {
    let taxel = contact.taxel;
    let spring = patch.taxels().at(taxel).stiffness * contact.deflection;
    let friction = state.friction(taxel).extend(0.0);
    patch.layout().frame(taxel) * friction - contact.push(spring).force
}
