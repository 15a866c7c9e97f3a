//! Reads of a skin at poses or to requested normal forces.

use super::assigned_loads::BodyLoad;
use super::force_match::{WantedForce, press_pair};
use super::parts::take_maximum;
use super::point_loads::LoadPart;
use super::reading::{SkinReading, TouchCounts, clear};
use super::shear_state::ShearState;
use super::skin::Skin;
use crate::contact::OUT_OF_REACH;
use crate::error::{Error, Result};
use crate::geometry::{Pose, check_poses};
use glam::DVec3;

/// Poses of patches and bodies in the world: one set or several, set after set.
#[derive(Clone, Copy, Debug)]
pub struct SkinPoses<'a> {
    /// Poses `world_from_patch`, shape (n_sets, n_patches).
    pub patches: &'a [Pose],
    /// Poses `world_from_body`, shape (n_sets, n_bodies).
    pub bodies: &'a [Pose],
}

/// Quantity that decides how far each patch presses each object.
#[derive(Clone, Copy, Debug)]
pub enum Pressed<'a> {
    /// The poses of patches and bodies.
    AtPoses,
    /// Requested normal forces. The normal force of a pair of patch and object is the sum of the forces of the patch's taxels along their axes under this object
    /// alone. The patch travels from its pose until it has the requested force.
    ToForces {
        /// Normal force of each pair, newtons, shape (n_sets, n_patches, n_objects), zero or more. A pair with force 0 has no contact, even if patch and object
        /// overlap. A pair with NaN is read at its pose.
        forces: &'a [f64],
        /// Direction of the travel of each pair in the patch frame, unit vectors, as many as forces; `None` for the z axes.
        directions: Option<&'a [DVec3]>,
    },
    /// Contact forces of a simulator, for one set of poses. A contact acts on the nearest patch of the carrier that faces it: the normal force is within 60° of
    /// the nearest taxel's reversed axis, and the point within one spacing (or the radius) of the taxel's axis and within reach along it. Other contacts act
    /// on no patch. The taxels of a flat patch have the sum and the moment of the normal forces, those of a curved patch the sum along their axes.
    ByLoads {
        /// Contact forces on the carriers of patches.
        loads: &'a [BodyLoad],
        /// Part of the forces that the taxels carry. [`LoadPart::Whole`] excludes a [`ShearState`].
        part: LoadPart,
    },
}

/// Options of a read.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions {
    /// Largest travel towards an object, metres, positive; `None` for the patch's largest stroke plus its largest taxel diameter. If a force is not reached, the
    /// press ends at this travel, or before the object is behind the substrate.
    pub reach: Option<f64>,
    /// Whether the results of pairs are needed even if a [`ShearState`] makes them unnecessary otherwise.
    pub wants_pairs: bool,
}

/// Requested forces and directions of pairs; empty if every pair is read at its pose, or all directions are z.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    pub forces: &'a [f64],
    pub directions: &'a [DVec3],
}

impl Skin {
    /// Reads all patches under all bodies into `reading`. A state of shear springs is advanced by one step.
    ///
    /// # Errors
    /// If a number of poses, forces or directions is wrong, or one of them is out of its range. If a load has an index that does not exist, or
    /// excludes the state of shear springs. If the state belongs to another skin or another number of sets.
    pub fn read(
        &self,
        poses: SkinPoses,
        pressed: Pressed,
        options: ReadOptions,
        shear: Option<&mut ShearState>,
        reading: &mut SkinReading,
    ) -> Result<()> {
        let n_sets = self.n_sets(poses)?;
        if let Some(reach) = options.reach
            && !(reach.is_finite() && reach > 0.0)
        {
            return Err(Error::input("reach", reach, "a positive number of metres"));
        }
        if let Some(shear) = &shear {
            shear.check(self, n_sets)?;
        }
        match pressed {
            Pressed::AtPoses => {
                let wanted = Wanted {
                    forces: &[],
                    directions: &[],
                };
                self.compute(poses, n_sets, wanted, options, shear, reading);
            }
            Pressed::ToForces { forces, directions } => {
                let directions = directions.unwrap_or_default();
                self.check_pairs(n_sets, forces, directions)?;
                let wanted = Wanted { forces, directions };
                self.compute(poses, n_sets, wanted, options, shear, reading);
            }
            Pressed::ByLoads { loads, part } => {
                self.check_loads(n_sets, loads)?;
                self.read_loads(poses, (loads, part), options, shear, reading)?;
            }
        }
        Ok(())
    }

    /// Returns the force on each taxel in the frame of its patch, newtons, shape (n_sets, n_taxels): along its axis and, with friction forces of a simulator,
    /// tangential.
    pub fn forces_on_taxels(&self, reading: &SkinReading) -> impl Iterator<Item = DVec3> {
        let n_sets = reading.deflections.len() / self.n_taxels();
        let parts = (0..n_sets).flat_map(|set| self.parts.iter().map(move |part| (set, part)));
        parts.flat_map(move |(set, part)| {
            let first = set * self.n_taxels() + part.first;
            let (axes, taxels) = (part.patch.layout().axes(), part.patch.taxels());
            axes.iter().enumerate().map(move |(taxel, axis)| {
                let tangential = reading.tangential.get(first + taxel).copied();
                let deflection = reading.deflections[first + taxel];
                let axial = -taxels.at(taxel).stiffness * deflection * *axis;
                tangential.unwrap_or_default() + axial
            })
        })
    }

    /// Checks the poses and returns the number of sets.
    fn n_sets(&self, poses: SkinPoses) -> Result<usize> {
        let n_sets = poses.patches.len() / self.parts.len();
        check_poses("patch", n_sets * self.parts.len(), poses.patches)?;
        check_poses("body", n_sets * self.bodies.len(), poses.bodies)?;
        Ok(n_sets)
    }

    /// Checks wanted forces, which may be NaN, and directions of all pairs.
    fn check_pairs(&self, n_sets: usize, forces: &[f64], directions: &[DVec3]) -> Result<()> {
        let n_pairs = n_sets * self.parts.len() * self.n_objects();
        for (place, n) in [("forces", forces.len()), ("directions", directions.len())] {
            if n != n_pairs && (place == "forces" || n > 0) {
                let allowed = format!("one for each of {n_pairs} pairs of patch and object");
                return Err(Error::input(place, n, allowed));
            }
        }
        let is_force = |force: f64| force.is_nan() || (force.is_finite() && force >= 0.0);
        if let Some(at) = forces.iter().position(|force| !is_force(*force)) {
            let allowed = "newtons, zero or more; NaN for a pair that is read at its pose";
            return Err(Error::input(
                format!("forces, pair {at}"),
                forces[at],
                allowed,
            ));
        }
        let is_unit = |vector: &DVec3| (vector.length() - 1.0).abs() < 1e-9;
        match directions.iter().position(|vector| !is_unit(vector)) {
            Some(at) => Err(Error::input(
                format!("directions, pair {at}"),
                directions[at],
                "a vector of length one",
            )),
            None => Ok(()),
        }
    }

    /// Computes all results of `n` sets of poses.
    pub(super) fn compute(
        &self,
        poses: SkinPoses,
        n: usize,
        wanted: Wanted,
        options: ReadOptions,
        mut shear: Option<&mut ShearState>,
        reading: &mut SkinReading,
    ) {
        let n_patches = self.parts.len();
        reading.clear([n, n_patches, self.n_objects(), self.n_taxels()]);
        for index in 0..n * n_patches {
            let (set, number) = (index / n_patches, index % n_patches);
            let part = &self.parts[number];
            let has_shear = shear.is_some();
            let is_near =
                self.press_pairs(poses, (index, number), wanted, options, has_shear, reading);
            let frame = &mut reading.deflections[set * self.n_taxels()..][part.taxels()];
            let wrench = &mut reading.wrenches[index];
            if let Some(shear) = &mut shear {
                let patch = (set, number, is_near);
                *wrench =
                    *wrench + shear.step(self, patch, &reading.placed, &mut reading.workspace);
                frame.copy_from_slice(reading.workspace.deflections());
            } else if is_near {
                *wrench = part.with_normal_forces(*wrench, frame);
            }
            reading.counts.push(match is_near {
                true => TouchCounts::of(&part.patch, frame),
                false => TouchCounts::default(),
            });
        }
    }

    /// Presses one patch under each object within reach, and writes the largest deflections into the frame of zeros. The poses of the bodies in the frame
    /// of the patch, after the travel, are in `placed` afterwards. Returns whether a body is within reach.
    ///
    /// If the read has a state of shear springs, the frame comes from a press under all bodies together. Only requested results of pairs are then computed.
    fn press_pairs(
        &self,
        poses: SkinPoses,
        (index, number): (usize, usize),
        wanted: Wanted,
        options: ReadOptions,
        has_shear: bool,
        reading: &mut SkinReading,
    ) -> bool {
        let part = &self.parts[number];
        let set = index / self.parts.len();
        let n_bodies = self.bodies.len();
        let bodies = &poses.bodies[set * n_bodies..][..n_bodies];
        reading.place(&poses.patches[index], bodies);
        for body in &self.excluded[number] {
            reading.placed[*body] = OUT_OF_REACH;
        }
        let objects = &self.objects[number];
        let frame = &mut reading.deflections[set * self.n_taxels()..][part.taxels()];
        let reads_pairs = !has_shear || !wanted.forces.is_empty() || options.wants_pairs;
        let reach = options.reach.unwrap_or(part.range.reach);
        let mut any_near = false;
        for (at, object) in (index * objects.len()..).zip(&objects[..]) {
            let force = wanted.forces.get(at).copied().unwrap_or(f64::NAN);
            let margin = if force.is_nan() { 0.0 } else { reach };
            let is_near = |placed: &[Pose], member: usize| {
                part.is_near(&self.bodies[member], &placed[member], margin)
            };
            let members = object.members.iter().copied();
            if force == 0.0 {
                for member in members {
                    reading.placed[member] = OUT_OF_REACH;
                }
                reading.travels[at] = f64::NAN;
                continue;
            }
            let first = members
                .clone()
                .position(|member| is_near(&reading.placed, member));
            let Some(first) = first else {
                if !force.is_nan() {
                    reading.travels[at] = reach;
                    reading.residuals[at] = force;
                }
                continue;
            };
            any_near = true;
            if !reads_pairs {
                continue;
            }
            let workspace = &mut reading.workspace;
            if force.is_nan() {
                let of_object = &mut reading.object_frame;
                clear(of_object, frame.len());
                for member in members.skip(first) {
                    if is_near(&reading.placed, member) {
                        let pose = reading.placed[member];
                        part.press(&self.bodies[member], pose, of_object, workspace);
                    }
                }
                reading.pair_forces[at] = part.total_force(of_object);
                take_maximum(frame, of_object);
                continue;
            }
            let direction = wanted.directions.get(at).copied().unwrap_or(DVec3::Z);
            let wanted = WantedForce {
                force,
                direction,
                reach,
            };
            let poses = (&reading.placed[..], &mut reading.object_poses);
            let held = press_pair(part, object, poses, wanted, workspace);
            take_maximum(frame, workspace.deflections());
            for member in members {
                reading.placed[member].translation -= held.travel * direction;
            }
            reading.pair_forces[at] = held.force;
            reading.travels[at] = held.travel;
            reading.residuals[at] = force - held.force;
        }
        any_near
    }
}
