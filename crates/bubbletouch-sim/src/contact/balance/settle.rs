//! The balance of free objects, and who finds it.

use super::body::Body;
use super::descent::{Descent, End};
use super::energy::{Energy, PairLoad, wrenches};
use super::free_object::{FreeObject, Ground, PlacedSkin};
use super::loads::Multipliers;
use super::model::Model;
use super::pairs::Key;
use super::reports::{TaxelLoad, Touch};
use super::tips::TipLoad;
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
    /// Neither within the largest number of steps: it and what it touches. The others are at rest as if these were not there.
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
    tips: Vec<TipLoad>,
    /// Of the objects that it put to rest last, those that its multipliers are of.
    numbers: Vec<usize>,
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

    /// What the tips of skins with friction hold of them, in the order of skins and taxels.
    pub fn tips(&self) -> &[TipLoad] {
        &self.tips
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
            skins: skins.to_vec(),
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
        let ground = ground.seen_from(origin);
        let from_there = |pose: &Pose| Pose::new(pose.rotation, pose.translation - origin);
        let bodies = objects.iter().copied().enumerate().zip(starts);
        let bodies = bodies.map(|(object, start)| Body::new(object, gravity, &from_there(start)));
        let mut balances = self.settle_bodies(bodies.collect(), &ground);
        for balance in &mut balances {
            balance.pose.translation += origin;
        }
        for touch in &mut self.touches {
            touch.point += origin;
        }
        Ok(balances)
    }

    /// Descent by descent: what leaves, and what finds no rest, is taken out, and the others go on. Where no rest is found, once more from there
    /// with forces known anew: those of a round that went astray lead the next ones astray, too.
    fn settle_bodies<'s>(
        &mut self,
        mut bodies: Vec<Body<'s>>,
        ground: &'s Ground<'s>,
    ) -> Vec<Balance> {
        let mut numbers: Vec<usize> = (0..bodies.len()).collect();
        let mut balances = vec![None; bodies.len()];
        let (mut n_steps, mut is_again) = (0, false);
        self.loads.clear();
        self.touches.clear();
        self.tips.clear();
        while !bodies.is_empty() {
            if is_again || self.numbers != numbers {
                self.multipliers = Multipliers::default();
                self.numbers.clone_from(&numbers);
            }
            let mut descent = Descent::new(self, bodies, ground);
            let end = descent.run();
            n_steps += descent.n_steps;
            let is_first = !std::mem::replace(&mut is_again, false);
            // What leaves has no outcome yet: its direction is its own.
            let (done, outcome) = match end {
                End::Endless(gone) => (gone, None),
                End::Rest => ((0..numbers.len()).collect(), Some(Outcome::Settled)),
                End::Exhausted => (descent.most_restless(), Some(Outcome::Unsettled)),
            };
            bodies = std::mem::take(&mut descent.scene.bodies);
            let springs = std::mem::take(&mut descent.scene.springs);
            self.multipliers = std::mem::take(&mut descent.scene.multipliers);
            if is_first && outcome == Some(Outcome::Unsettled) {
                is_again = true;
                continue;
            }
            let loads = match outcome {
                Some(_) => self.now.pair_loads(),
                None => Vec::new(),
            };
            self.report(&bodies, &loads, (&numbers, &done), &ground.skins);
            let wrenches = wrenches(
                (&loads, &self.now.pairs.all),
                &springs,
                &bodies,
                &ground.skins,
            );
            if outcome.is_some() {
                let held = springs.iter().filter(|spring| done.contains(&spring.body));
                let tips = held.map(|spring| spring.load(&bodies, &ground.skins));
                self.tips.extend(tips);
            }
            for slot in done.into_iter().rev() {
                let number = numbers.remove(slot);
                let body = bodies.remove(slot);
                let outcome = outcome.unwrap_or(Outcome::Escaped {
                    direction: body.way_out(),
                });
                balances[number] =
                    Some(self.balance((&body, number), wrenches[slot], outcome, n_steps));
            }
        }
        let own = |load: &TaxelLoad| (load.skin, load.taxel, load.object, load.sphere);
        self.loads.sort_by_key(own);
        self.tips.sort_by_key(|tip| (tip.skin, tip.taxel));
        balances
            .into_iter()
            .map(|balance| balance.expect("each rests, has escaped, or does neither"))
            .collect()
    }

    /// Of an object whose loads have been reported.
    fn balance(
        &self,
        (body, number): (&Body, usize),
        wrench: (DVec3, DVec3),
        outcome: Outcome,
        n_steps: usize,
    ) -> Balance {
        let own = self.loads.iter().filter(|load| load.object == number);
        let own: Vec<&TaxelLoad> = own.collect();
        let taxels = own.chunk_by(|a, b| (a.skin, a.taxel) == (b.skin, b.taxel));
        let is_stopped = |of: &&[&TaxelLoad]| of.iter().any(|load| load.stop > 0.0);
        Balance {
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

    /// What carries those bodies that are `done`, by the numbers of the objects.
    fn report(
        &mut self,
        bodies: &[Body],
        loads: &[PairLoad],
        (numbers, done): (&[usize], &[usize]),
        skins: &[PlacedSkin],
    ) {
        let number = |slot: usize| numbers[slot];
        for load in loads {
            let pair = &self.now.pairs.all[load.pair];
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
                        .push(Touch::new(pair, touched, load, body, number));
                }
            }
        }
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
