//! Reads of a skin under the contact forces of a simulator.

use super::assigned_loads::{AssignedLoads, BodyLoad, LoadRange, LoadedPatch, assign_loads};
use super::force_match::{WantedForce, press_pair};
use super::point_loads::{
    CarriedLoad, LoadPart, PointLoad, carry_loads, share_friction, travel_direction,
};
use super::read::{ReadOptions, SkinPoses, Wanted};
use super::reading::{SkinReading, TouchCounts};
use super::shear_state::ShearState;
use super::skin::Skin;
use crate::contact::{Press, Until, Wrench};
use crate::error::{Error, Result};
use glam::DVec3;

/// Largest relative difference between required and carried force that counts as rounding.
const CARRIED: f64 = 1e-9;

impl Skin {
    /// Checks the number of sets, the indices and the vectors of loads.
    pub(super) fn check_loads(&self, n_sets: usize, loads: &[BodyLoad]) -> Result<()> {
        if n_sets != 1 {
            let given = format!("{n_sets} sets of poses");
            return Err(Error::input("loads", given, "one set of poses"));
        }
        let (n_carriers, n_objects) = (self.n_carriers(), self.n_objects());
        for (row, load) in loads.iter().enumerate() {
            if load.carrier >= n_carriers || load.object >= n_objects {
                let given = format!("carrier {} and object {}", load.carrier, load.object);
                let allowed =
                    format!("a carrier below {n_carriers} and an object below {n_objects}");
                return Err(Error::input(format!("loads, row {row}"), given, allowed));
            }
            let PointLoad {
                point,
                normal,
                friction,
                torque,
            } = load.load;
            let vectors = [point, normal, friction, torque];
            if let Some(vector) = vectors.iter().find(|vector| !vector.is_finite()) {
                let given = format!("{vector} in row {row}");
                return Err(Error::input("loads", given, "finite numbers"));
            }
        }
        Ok(())
    }

    /// Reads one set of poses under contact forces. With shear springs, the forces and directions of the pairs follow from the loads.
    pub(super) fn read_loads(
        &self,
        poses: SkinPoses,
        (loads, part): (&[BodyLoad], LoadPart),
        options: ReadOptions,
        shear: Option<&mut ShearState>,
        reading: &mut SkinReading,
    ) -> Result<()> {
        let found = self.assigned(poses, loads, options.reach);
        if shear.is_none() {
            self.carry(poses, &found, part, options, reading);
        } else if part == LoadPart::Whole {
            let allowed = "normal forces only: friction forces of the engine and shear springs exclude each other";
            return Err(Error::input(
                "shear",
                "a state beside friction forces",
                allowed,
            ));
        } else {
            let n_pairs = self.parts.len() * self.n_objects();
            let mut forces = vec![0.0; n_pairs];
            let mut directions = vec![DVec3::Z; n_pairs];
            for pair in found.loads.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
                let (patch, object, _) = pair[0];
                let at = patch * self.n_objects() + object;
                let loads: Vec<PointLoad> = pair.iter().map(|(_, _, load)| *load).collect();
                forces[at] = loads.iter().map(|load| load.normal.length()).sum();
                if !self.parts[patch].is_flat {
                    directions[at] = travel_direction(&loads);
                }
            }
            let wanted = Wanted {
                forces: &forces,
                directions: &directions,
            };
            self.compute(poses, 1, wanted, options, shear, reading);
        }
        for (patch, object, force) in found.beside {
            reading.residuals[patch * self.n_objects() + object] += force;
        }
        Ok(())
    }

    /// Assigns contact forces to the patches of their carriers.
    fn assigned(&self, poses: SkinPoses, loads: &[BodyLoad], reach: Option<f64>) -> AssignedLoads {
        let patches = self.parts.iter().zip(&self.carriers).zip(poses.patches);
        let patches = patches.map(|((part, carrier), pose)| LoadedPatch {
            patch: &part.patch,
            range: LoadRange {
                reach: reach.unwrap_or(0.0).max(part.range.reach),
                ..part.range
            },
            carrier: *carrier,
            pose: *pose,
        });
        assign_loads(&patches.collect::<Vec<_>>(), loads)
    }

    /// Computes all results for one set of poses under contact loads. An object without loads does not press.
    fn carry(
        &self,
        poses: SkinPoses,
        loads: &AssignedLoads,
        part: LoadPart,
        options: ReadOptions,
        reading: &mut SkinReading,
    ) {
        reading.clear([1, self.parts.len(), self.n_objects(), self.n_taxels()]);
        reading.travels.fill(f64::NAN);
        reading.tangential.resize(self.n_taxels(), DVec3::ZERO);
        for pair in loads.loads.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (number, object, _) = pair[0];
            let part_of = &self.parts[number];
            let reach = options.reach.unwrap_or(part_of.range.reach);
            reading.pair_loads.clear();
            reading
                .pair_loads
                .extend(pair.iter().map(|(_, _, load)| *load));
            let object_of = &self.objects[number][object];
            reading.place(&poses.patches[number], poses.bodies);
            let frame = &mut reading.deflections[part_of.taxels()];
            let workspace = &mut reading.workspace;
            let of_pair = &mut reading.object_frame;
            of_pair.clear();
            of_pair.extend_from_slice(frame);
            let carried = if part_of.is_flat {
                reading.object_poses.clear();
                let deeper = |member: &usize| {
                    let mut pose = reading.placed[*member];
                    pose.translation.z -= reach;
                    pose
                };
                reading
                    .object_poses
                    .extend(object_of.members.iter().map(deeper));
                let deeper = &reading.object_poses;
                Press::new(&part_of.deep(reach), &object_of.models, deeper, Until::Pose)
                    .run(workspace)
                    .expect("checked poses");
                let deep = (workspace.deflections(), reach);
                carry_loads(
                    &part_of.patch,
                    deep,
                    (&reading.pair_loads, part),
                    frame,
                    &mut reading.load_workspace,
                )
            } else {
                let direction = travel_direction(&reading.pair_loads);
                let normals = reading.pair_loads.iter().map(|load| load.normal.length());
                let wanted = WantedForce {
                    force: normals.sum(),
                    direction,
                    reach,
                };
                let poses = (&reading.placed[..], &mut reading.object_poses);
                let held = press_pair(part_of, object_of, poses, wanted, workspace);
                for (taxel, deflection) in workspace.deflections().iter().enumerate() {
                    let stroke = part_of.patch.taxels().at(taxel).stroke;
                    frame[taxel] = (frame[taxel] + deflection).min(stroke);
                }
                CarriedLoad {
                    force: held.force,
                    required: wanted.force,
                    travel: held.travel,
                }
            };
            let at = number * self.n_objects() + object;
            reading.pair_forces[at] = carried.force;
            reading.residuals[at] = carried.required - carried.force;
            reading.travels[at] = carried.travel;
            of_pair
                .iter_mut()
                .zip(&*frame)
                .for_each(|(before, after)| *before = after - *before);
            let rest = share_friction(
                &part_of.patch,
                (&reading.pair_loads, part),
                of_pair,
                &mut reading.tangential[part_of.taxels()],
            );
            // The wrench of forces that the taxels carry contains the torque of contacts on the rim.
            let is_carried = (carried.required - carried.force).abs() <= CARRIED * carried.required;
            if is_carried && (part == LoadPart::Whole || part_of.is_flat) {
                let wrench = &mut reading.wrenches[number];
                wrench.torque += rest.torque;
            }
        }
        for (number, part) in self.parts.iter().enumerate() {
            let frame = &reading.deflections[part.taxels()];
            let axial = part.with_normal_forces(reading.wrenches[number], frame);
            let centers = part.patch.layout().centers();
            let tangential = centers.iter().zip(&reading.tangential[part.taxels()]);
            reading.wrenches[number] = tangential.fold(axial, |sum, (center, force)| {
                sum + Wrench::at(*center, *force)
            });
            reading.counts.push(TouchCounts::of(&part.patch, frame));
        }
    }
}
