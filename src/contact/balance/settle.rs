//! The balance of free objects, and who finds it.

use super::body::Body;
use super::descent::{Descent, End};
use super::energy::{Energy, PairLoad, wrenches};
use super::free_object::{FreeObject, Ground, HalfSpace, Obstacle, PlacedSkin};
use super::loads::Multipliers;
use super::model::Model;
use super::pairs::{Key, OTHERS};
use super::reports::{TaxelLoad, Touch};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use glam::DVec3;

/// How an object ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// At rest: forces and torques balance, and every small motion costs energy or nothing.
    Settled,
    /// It rolled or slid off the skins, or there is none below it.
    Escaped {
        /// Where to from where it started: unit, in the world; across gravity, unless it fell straight down.
        direction: DVec3,
    },
    /// Neither it, nor what it touches, within the largest number of steps.
    Unsettled,
}

/// Where an object is in the end, and what holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// `world_from_object`.
    pub pose: Pose,
    /// Whether it rests there.
    pub outcome: Outcome,
    /// What all that it touches puts on it, newtons, in the world: k δ of each taxel, and its stop's force; and what is rigid.
    pub force: DVec3,
    /// About the centre of mass, N·m.
    pub torque: DVec3,
    /// What is left of force and weight together, as a share of the weight; of the torque, as a share of the weight times
    /// the object's radius: the larger of both.
    pub imbalance: f64,
    /// Taxels that carry it.
    pub n_touched: usize,
    /// Taxels whose stops carry it.
    pub n_saturated: usize,
    /// Taxels pushed along a flank as good as parallel to their axis: see [`GRAZING`](crate::contact::GRAZING).
    pub n_grazing: usize,
    /// Poses that were looked at, of all objects together.
    pub n_steps: usize,
}

impl Balance {
    /// Whether it did not escape.
    pub fn is_there(&self) -> bool {
        !matches!(self.outcome, Outcome::Escaped { .. })
    }
}

/// Finds resting poses, and remembers what it needs to find the next one nearby sooner.
#[derive(Clone, Debug, Default)]
pub struct Balancer {
    pub(super) now: Energy,
    pub(super) next: Energy,
    pub(super) model: Model,
    pub(super) multipliers: Multipliers,
    loads: Vec<TaxelLoad>,
    touches: Vec<Touch>,
    /// Of the objects that it put to rest last, those that did not escape.
    there: Vec<usize>,
}

impl Balancer {
    /// A balancer that knows nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// What taxels carry of the objects that were put to rest last, in the order of skins and taxels; nothing of those that escaped.
    /// Its forces are those of the last [`Balance`]s, with the [touches](Self::touches)'.
    pub fn loads(&self) -> &[TaxelLoad] {
        &self.loads
    }

    /// What rigid things put on them.
    pub fn touches(&self) -> &[Touch] {
        &self.touches
    }

    /// Puts one object to rest on skins, from a pose (`world_from_object`), under `gravity` (m/s², in the world).
    ///
    /// # Errors
    /// Those of [`settle_all`](Self::settle_all).
    pub fn settle(
        &mut self,
        object: &FreeObject,
        skins: &[PlacedSkin],
        gravity: DVec3,
        start: &Pose,
    ) -> Result<Balance> {
        let ground = Ground {
            skins,
            ..Ground::default()
        };
        let balances = self.settle_all(&[*object], &ground, gravity, &[*start])?;
        Ok(balances[0])
    }

    /// Puts objects to rest together, from their poses (`world_from_object`, one an object), under `gravity` (m/s², in the world).
    ///
    /// They go to the rest that lies downhill; from poses at rest they do not move. The ground does not move meanwhile.
    ///
    /// # Errors
    /// The error names a gravity that is zero or not finite, and a pose that is not finite.
    ///
    /// # Panics
    /// If there are not as many poses as objects.
    pub fn settle_all(
        &mut self,
        objects: &[FreeObject],
        ground: &Ground,
        gravity: DVec3,
        starts: &[Pose],
    ) -> Result<Vec<Balance>> {
        assert_eq!(objects.len(), starts.len());
        check(gravity, starts)?;
        // Where the objects are, is the origin: far from the world's, places have too few digits to balance stiff springs.
        let origin = starts.first().map_or(DVec3::ZERO, |pose| pose.translation);
        let near = Near::of(ground, origin);
        let ground = Ground {
            skins: &near.skins,
            planes: &near.planes,
            obstacles: &near.obstacles,
        };
        let from_there = |pose: &Pose| Pose::new(pose.rotation, pose.translation - origin);
        let bodies = objects.iter().zip(starts);
        let bodies = bodies.map(|(object, start)| Body::new(*object, gravity, &from_there(start)));
        let mut balances = self.settle_bodies(bodies.collect(), &ground);
        for balance in &mut balances {
            balance.pose.translation += origin;
        }
        for touch in &mut self.touches {
            touch.point += origin;
        }
        Ok(balances)
    }

    fn settle_bodies<'s>(
        &mut self,
        mut bodies: Vec<Body<'s>>,
        ground: &'s Ground<'s>,
    ) -> Vec<Balance> {
        let mut there: Vec<usize> = (0..bodies.len()).collect();
        let mut balances = vec![None; bodies.len()];
        let mut n_steps = 0;
        self.loads.clear();
        self.touches.clear();
        if self.there != there {
            self.multipliers = Multipliers::default();
        }
        while !bodies.is_empty() {
            let mut descent = Descent::new(self, bodies, ground);
            let end = descent.run();
            let (settled, loads) = match end {
                End::Endless(gone) => {
                    n_steps += descent.n_steps;
                    bodies = descent.bodies;
                    self.multipliers = Multipliers::default();
                    for slot in gone.into_iter().rev() {
                        let number = there.remove(slot);
                        balances[number] = Some(escaped(&bodies.remove(slot), n_steps));
                    }
                    continue;
                }
                End::Rest => (vec![true; there.len()], descent.balancer.now.pair_loads()),
                End::Exhausted => match descent.finish() {
                    Some(loads) => (vec![true; there.len()], loads),
                    None => (descent.settled(), descent.balancer.now.pair_loads()),
                },
            };
            n_steps += descent.n_steps;
            let multipliers = std::mem::take(&mut descent.multipliers);
            bodies = std::mem::take(&mut descent.bodies);
            self.multipliers = multipliers;
            self.report(&bodies, &loads, &there, ground.skins);
            let found = self.balances(&bodies, &loads, ground.skins, (&settled, n_steps));
            for (number, balance) in there.iter().zip(found) {
                balances[*number] = Some(balance);
            }
            break;
        }
        self.there = there;
        balances
            .into_iter()
            .map(|balance| balance.expect("each is there or has escaped"))
            .collect()
    }

    fn balances(
        &self,
        bodies: &[Body],
        loads: &[PairLoad],
        skins: &[PlacedSkin],
        (settled, n_steps): (&[bool], usize),
    ) -> Vec<Balance> {
        let pairs = &self.now.pairs.all;
        let wrenches = wrenches(loads, pairs, bodies, skins);
        let of_body = |(slot, (body, wrench)): (usize, (&Body, (DVec3, DVec3)))| {
            let own = loads.iter().filter(|load| {
                let pair = &pairs[load.pair];
                matches!(pair.key, Key::Taxel(..)) && pair.part.0 as usize == slot
            });
            let own: Vec<&PairLoad> = own.collect();
            let taxels = own.chunk_by(|a, b| pairs[a.pair].key == pairs[b.pair].key);
            let is_stopped = |of: &&[&PairLoad]| of.iter().any(|load| load.stop > 0.0);
            Balance {
                pose: body.pose(),
                outcome: if settled[slot] {
                    Outcome::Settled
                } else {
                    Outcome::Unsettled
                },
                force: wrench.0,
                torque: wrench.1,
                imbalance: body.imbalance_of(wrench),
                n_touched: taxels.clone().count(),
                n_saturated: taxels.filter(is_stopped).count(),
                n_grazing: own
                    .iter()
                    .filter(|load| pairs[load.pair].is_grazing())
                    .count(),
                n_steps,
            }
        };
        bodies
            .iter()
            .zip(wrenches)
            .enumerate()
            .map(of_body)
            .collect()
    }

    /// What carries, by the numbers of the objects.
    fn report(
        &mut self,
        bodies: &[Body],
        loads: &[PairLoad],
        there: &[usize],
        skins: &[PlacedSkin],
    ) {
        let number = |slot: u32| there[slot as usize];
        for load in loads {
            let pair = &self.now.pairs.all[load.pair];
            if pair.part == OTHERS {
                continue;
            }
            let body = &bodies[pair.part.0 as usize];
            match pair.key {
                Key::Taxel(skin, taxel) => {
                    let taxel = (skin as usize, taxel as usize);
                    let object = number(pair.part.0);
                    let found = TaxelLoad::new(taxel, object, pair, load, body, skins);
                    self.loads.push(found);
                }
                Key::Rigid(_, rigid) => {
                    self.touches
                        .push(Touch::new(pair, rigid, load, body, number));
                }
            }
        }
    }
}

fn escaped(body: &Body, n_steps: usize) -> Balance {
    Balance {
        pose: body.pose(),
        outcome: Outcome::Escaped {
            direction: body.way_out(),
        },
        force: DVec3::ZERO,
        torque: DVec3::ZERO,
        imbalance: 1.0,
        n_touched: 0,
        n_saturated: 0,
        n_grazing: 0,
        n_steps,
    }
}

fn check(gravity: DVec3, starts: &[Pose]) -> Result<()> {
    if !(gravity.is_finite() && gravity != DVec3::ZERO) {
        return Err(Error::input(
            "gravity",
            format!("{gravity} m/s²"),
            "finite, and not zero for a free object",
        ));
    }
    let is_odd = |pose: &&Pose| !(pose.translation.is_finite() && pose.rotation.is_finite());
    match starts.iter().find(is_odd) {
        Some(odd) => Err(Error::input(
            "object pose",
            odd.translation,
            "finite numbers",
        )),
        None => Ok(()),
    }
}

/// The ground, seen from another origin.
struct Near<'a> {
    skins: Vec<PlacedSkin<'a>>,
    planes: Vec<HalfSpace>,
    obstacles: Vec<Obstacle<'a>>,
}

impl<'a> Near<'a> {
    fn of(ground: &Ground<'a>, origin: DVec3) -> Self {
        let from_there = |pose: &Pose| Pose::new(pose.rotation, pose.translation - origin);
        let skins = ground.skins.iter().map(|skin| PlacedSkin {
            world_from_patch: from_there(&skin.world_from_patch),
            ..*skin
        });
        let planes = ground.planes.iter().map(|plane| HalfSpace {
            height: plane.height - plane.normal.dot(origin),
            ..*plane
        });
        let obstacles = ground.obstacles.iter().map(|obstacle| Obstacle {
            pose: from_there(&obstacle.pose),
            ..*obstacle
        });
        Self {
            skins: skins.collect(),
            planes: planes.collect(),
            obstacles: obstacles.collect(),
        }
    }
}
