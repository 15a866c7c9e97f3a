//! Solver for the equilibrium of free objects.

use super::body::Body;
use super::descent::{Descent, DescentWorkspace, End};
use super::energy::{PairLoad, wrenches};
use super::free_object::{FreeObject, Ground, PlacedSkin};
use super::loads::Multipliers;
use super::pair::Key;
use super::reports::{RigidContact, TaxelLoad};
use crate::contact::friction::TangentialSpringState;
use crate::error::{Error, Result};
use crate::geometry::{Pose, check_poses};
use glam::DVec3;

/// Outcome of the search for the equilibrium of one object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The object is at rest: forces and torques balance, and no small motion lowers the energy.
    AtRest,
    /// The object left all patches, or no patch supports it.
    Escaped {
        /// Direction of the motion from the start position, unit vector in the world; perpendicular to gravity unless the object fell straight down.
        direction: DVec3,
    },
    /// The solver reached its step limit for this object and the objects that touch it. The other objects are at rest without them.
    NotConverged,
}

/// Final pose of a free object, and the contact forces that act on the object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium {
    /// Final pose of the object in the world (`world_from_object`).
    pub pose: Pose,
    /// Outcome of the search for equilibrium.
    pub outcome: Outcome,
    /// Force of taxels and rigid contacts on the object, newtons, in the world.
    pub force: DVec3,
    /// Torque of the contact forces about the object's centre of mass, N·m, in the world.
    pub torque: DVec3,
    /// Larger of two ratios, dimensionless: force residual to weight, and torque residual to weight times radius of the object.
    pub imbalance: f64,
    /// Number of taxels that the object presses.
    pub n_touched: usize,
    /// Number of taxels that the object presses to the end of their stroke.
    pub n_saturated: usize,
    /// Number of grazing contacts, whose contact surface is nearly parallel to the taxel's axis (`GRAZING`).
    pub n_grazing: usize,
    /// Number of poses that the solver evaluated, in total over all objects.
    pub n_steps: usize,
}

impl Equilibrium {
    /// Returns whether the object is still in the scene, that is, at rest or not converged. Objects that fell off the skins are no longer in the scene.
    pub fn is_there(&self) -> bool {
        !matches!(self.outcome, Outcome::Escaped { .. })
    }
}

/// Solver for equilibrium poses of free objects; the Lagrange multipliers of one solution initialise the next one.
#[derive(Clone, Debug, Default)]
pub struct EquilibriumSolver {
    workspace: DescentWorkspace,
    loads: Vec<TaxelLoad>,
    touches: Vec<RigidContact>,
    tangential_springs: Vec<TangentialSpringState>,
    /// Indices of the objects to which the Lagrange multipliers belong.
    numbers: Vec<usize>,
}

impl EquilibriumSolver {
    /// Creates a solver without an earlier solution as starting point.
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the taxel loads of the last solution, ordered by skin and taxel. Loads of objects that fell off the skins ([`Outcome::Escaped`]) are omitted.
    /// Together with the rigid contacts (`touches`) the loads sum to the forces of each [`Equilibrium`].
    pub fn loads(&self) -> &[TaxelLoad] {
        &self.loads
    }

    /// Returns the states of the tangential springs in the last solution, ordered by skin and taxel.
    pub fn tangential_springs(&self) -> &[TangentialSpringState] {
        &self.tangential_springs
    }

    /// Returns the rigid contacts in the last solution.
    pub fn touches(&self) -> &[RigidContact] {
        &self.touches
    }

    /// Finds the equilibrium of one object on skins, starting from the pose `start` (`world_from_object`). `gravity` is in m/s², in the world.
    ///
    /// # Errors
    /// If `solve_all` fails.
    pub fn solve(
        &mut self,
        object: &FreeObject,
        skins: &[PlacedSkin],
        gravity: DVec3,
        start: &Pose,
    ) -> Result<Equilibrium> {
        let ground = Ground {
            skins: skins.to_vec(),
            ..Ground::default()
        };
        let solutions = self.solve_all(&[*object], &ground, gravity, &[*start])?;
        Ok(solutions[0])
    }

    /// Finds the equilibrium of several objects that may touch each other. `starts` contains one `world_from_object` per object; `gravity` is in m/s², in the
    /// world.
    ///
    /// The energy never increases from the start poses to the solution, and objects at rest do not move. The ground is fixed.
    ///
    /// # Errors
    /// If the gravity is zero or not finite, there is not one pose for each object, or a pose is not finite or has no unit quaternion.
    pub fn solve_all(
        &mut self,
        objects: &[FreeObject],
        ground: &Ground,
        gravity: DVec3,
        starts: &[Pose],
    ) -> Result<Vec<Equilibrium>> {
        check(objects, ground, gravity, starts)?;
        // The origin is at the first object. Far from the world's origin, coordinates have too few digits to balance stiff springs.
        let origin = starts.first().map_or(DVec3::ZERO, |pose| pose.translation);
        let ground = ground.seen_from(origin);
        let from_there = |pose: &Pose| Pose::new(pose.rotation, pose.translation - origin);
        let bodies = objects.iter().copied().enumerate().zip(starts);
        let bodies = bodies.map(|(object, start)| Body::new(object, gravity, &from_there(start)));
        let mut solutions = self.solve_bodies(bodies.collect(), &ground);
        for solution in &mut solutions {
            solution.pose.translation += origin;
        }
        for touch in &mut self.touches {
            touch.point += origin;
        }
        Ok(solutions)
    }

    /// Runs energy descents until all remaining objects are at rest. Objects that fall off the skins or do not converge are removed, and the others continue.
    /// If a descent does not converge, it is repeated once from its last poses without multipliers, because multipliers of a diverged iteration mislead the
    /// next one.
    fn solve_bodies<'s>(
        &mut self,
        mut bodies: Vec<Body<'s>>,
        ground: &'s Ground<'s>,
    ) -> Vec<Equilibrium> {
        let mut numbers: Vec<usize> = (0..bodies.len()).collect();
        let mut solutions = vec![None; bodies.len()];
        let (mut n_steps, mut is_again) = (0, false);
        self.loads.clear();
        self.touches.clear();
        self.tangential_springs.clear();
        while !bodies.is_empty() {
            let was_at_rest = !is_again && self.numbers == numbers;
            if !was_at_rest {
                self.workspace.multipliers = Multipliers::default();
                self.numbers.clone_from(&numbers);
            }
            let mut descent = Descent::new(&mut self.workspace, bodies, ground);
            let end = descent.run(was_at_rest);
            n_steps += descent.n_steps;
            let is_first = !std::mem::replace(&mut is_again, false);
            // The outcome of an object that leaves contains its own direction and is set below.
            let (done, outcome) = match end {
                End::Endless(gone) => (gone, None),
                End::Rest => ((0..numbers.len()).collect(), Some(Outcome::AtRest)),
                End::Exhausted => (descent.most_restless(), Some(Outcome::NotConverged)),
            };
            bodies = std::mem::take(&mut descent.scene.bodies);
            let springs = std::mem::take(&mut descent.scene.springs);
            self.workspace.multipliers = std::mem::take(&mut descent.scene.multipliers);
            if is_first && outcome == Some(Outcome::NotConverged) {
                is_again = true;
                continue;
            }
            let loads = match outcome {
                Some(_) => self.workspace.now.pair_loads(),
                None => Vec::new(),
            };
            self.report(&bodies, &loads, (&numbers, &done), &ground.skins);
            let wrenches = wrenches(
                (&loads, &self.workspace.now.pairs.all),
                &springs,
                &bodies,
                &ground.skins,
            );
            if outcome.is_some() {
                let held = springs.iter().filter(|spring| done.contains(&spring.body));
                let tips = held.map(|spring| spring.load(&bodies, &ground.skins));
                self.tangential_springs.extend(tips);
            }
            for slot in done.into_iter().rev() {
                let number = numbers.remove(slot);
                let body = bodies.remove(slot);
                let outcome = outcome.unwrap_or(Outcome::Escaped {
                    direction: body.way_out(),
                });
                solutions[number] =
                    Some(self.equilibrium((&body, number), wrenches[slot], outcome, n_steps));
            }
        }
        let own = |load: &TaxelLoad| (load.skin, load.taxel, load.object, load.sphere);
        self.loads.sort_by_key(own);
        self.tangential_springs
            .sort_by_key(|tip| (tip.skin, tip.taxel));
        solutions
            .into_iter()
            .map(|solution| solution.expect("each rests, has escaped, or does neither"))
            .collect()
    }

    /// Returns the equilibrium of a body, from the loads that were stored before.
    fn equilibrium(
        &self,
        (body, number): (&Body, usize),
        wrench: (DVec3, DVec3),
        outcome: Outcome,
        n_steps: usize,
    ) -> Equilibrium {
        let own = self.loads.iter().filter(|load| load.object == number);
        let own: Vec<&TaxelLoad> = own.collect();
        let taxels = own.chunk_by(|a, b| (a.skin, a.taxel) == (b.skin, b.taxel));
        let is_stopped = |of: &&[&TaxelLoad]| of.iter().any(|load| load.stop > 0.0);
        Equilibrium {
            pose: body.pose(),
            outcome,
            force: wrench.0,
            torque: wrench.1,
            imbalance: body.imbalance_of(wrench),
            n_touched: taxels.clone().count(),
            n_saturated: taxels.filter(is_stopped).count(),
            n_grazing: own.iter().filter(|load| load.is_grazing).count(),
            n_steps,
        }
    }

    /// Stores the loads on the bodies in `done` for the user, with the indices of their objects.
    fn report(
        &mut self,
        bodies: &[Body],
        loads: &[PairLoad],
        (numbers, done): (&[usize], &[usize]),
        skins: &[PlacedSkin],
    ) {
        let number = |slot: usize| numbers[slot];
        for load in loads {
            let pair = &self.workspace.now.pairs.all[load.pair];
            if !done.contains(&(pair.part.0 as usize)) {
                continue;
            }
            let body = &bodies[pair.part.0 as usize];
            match pair.key {
                Key::Taxel(skin, taxel) => {
                    let taxel = (skin as usize, taxel as usize);
                    let object = number(pair.part.0 as usize);
                    let found = TaxelLoad::new(taxel, object, pair, load, body, skins);
                    self.loads.push(found);
                }
                Key::Rigid(_, touched) => {
                    self.touches
                        .push(RigidContact::new(pair, touched, load, body, number));
                }
            }
        }
    }
}

fn check(objects: &[FreeObject], ground: &Ground, gravity: DVec3, starts: &[Pose]) -> Result<()> {
    if !(gravity.is_finite() && gravity != DVec3::ZERO) {
        return Err(Error::input(
            "gravity",
            format!("{gravity} m/s²"),
            "finite, and not zero for a free object",
        ));
    }
    let of_skins = ground.skins.iter().map(|skin| skin.world_from_patch);
    let of_obstacles = ground.obstacles.iter().map(|obstacle| obstacle.pose);
    check_poses("patch", ground.skins.len(), &of_skins.collect::<Vec<_>>())?;
    let of_obstacles: Vec<Pose> = of_obstacles.collect();
    check_poses("obstacle", ground.obstacles.len(), &of_obstacles)?;
    check_poses("object", objects.len(), starts)
}
