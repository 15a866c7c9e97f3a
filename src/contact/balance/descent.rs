//! Down the energy to a pose at rest.

use super::fall::{Fall, fall};
use super::finish::Held;
use super::free_object::{FreeObject, PlacedSkin};
use super::loads::{Multipliers, Smoothness};
use super::model::{Scene, Step};
use super::pairs::Key;
use super::settle::{Balance, Balancer, Outcome};
use super::six::{Six, SixBySix, eigen, norm};
use crate::geometry::Pose;
use glam::{DQuat, DVec3};

/// Poses looked at, at most: an object that rolls across a whole skin takes some hundreds.
const MAX_STEPS: usize = 4000;
/// Rounds of multipliers, at most; three to six are usual.
const MAX_ROUNDS: usize = 40;
/// Imbalance at which a pose is at rest; ten times less than is promised.
const AT_REST: f64 = 1e-7;
/// Imbalance that a pose at rest never has more of, even where flanks are so steep that nothing nearby is better.
const PROMISED: f64 = 1e-6;
/// Looseness of ties and stops at which a pose is at rest, in springs' forces, as a share of the largest of them.
const TIGHT: f64 = 1e-7;
/// Steps up to this share of the farthest are foreseen with all contacts that they make.
const NEARBY: f64 = 0.04;
/// Smoothing of ties as a share of the largest deflection, and of the one under which a taxel carries all the weight.
const SMOOTHING: f64 = 1e-2;
/// The least smoothing, in last bits of the object's size.
const LAST_BITS: f64 = 64.0;
/// Rounds in which ties and stops are made steeper, at most: five to the so many-th is what f64 has room for.
const MOST_TIGHTENED: usize = 12;
/// Places closer than this share of the object's size and way are the same.
const SAME_PLACE: f64 = 1e-15;

/// One object on its way down.
pub(super) struct Descent<'a> {
    pub balancer: &'a mut Balancer,
    object: &'a FreeObject<'a>,
    pub skins: &'a [PlacedSkin<'a>],
    /// m g, newtons.
    pub weight: DVec3,
    /// Rotations count by how far they move a point this far from the centre of mass, metres.
    pub arm: f64,
    /// No step is longer, metres.
    pub farthest: f64,
    start: DVec3,
    pub center: DVec3,
    pub rotation: DQuat,
    smoothness: Smoothness,
    /// What is known of the forces inside taxels; better from round to round.
    pub multipliers: Multipliers,
    /// The longest step that is trusted now, metres.
    pub reach: f64,
    n_steps: usize,
}

/// Why a descent stopped.
enum Stop {
    Rest,
    Endless,
    Exhausted,
}

impl<'a> Descent<'a> {
    pub fn new(
        balancer: &'a mut Balancer,
        object: &'a FreeObject,
        skins: &'a [PlacedSkin],
        gravity: DVec3,
        start: &Pose,
    ) -> Self {
        let taxels = || skins.iter().flat_map(|skin| skin.patch.taxels().all());
        let stroke = taxels().map(|t| t.stroke).fold(f64::INFINITY, f64::min);
        let stiffness = taxels().map(|t| t.stiffness).fold(0.0, f64::max);
        let weight = object.mass * gravity;
        let center = start.transform_point(object.center_of_mass);
        let stroke = if stroke.is_finite() {
            stroke
        } else {
            object.radius
        };
        Self {
            object,
            skins,
            weight,
            arm: object.radius,
            farthest: 0.5 * stroke,
            start: center,
            center,
            rotation: start.rotation,
            smoothness: Smoothness {
                smoothing: 1e-3 * stroke,
                load: SMOOTHING * weight.length(),
                least: LAST_BITS * f64::EPSILON * object.radius,
                stop_stiffness: (1e3 * stiffness).max(weight.length() / (1e-3 * stroke)),
            },
            multipliers: std::mem::take(&mut balancer.multipliers),
            reach: 0.125 * stroke,
            n_steps: 0,
            balancer,
        }
    }

    fn scene(&self) -> Scene<'_> {
        Scene {
            skins: self.skins,
            multipliers: &self.multipliers,
            smoothness: self.smoothness,
            weight: self.weight,
            arm: self.arm,
        }
    }

    /// Rounds of descents, each with better multipliers.
    pub fn run(&mut self) -> Outcome {
        self.look(&[]);
        let mut looseness = f64::INFINITY;
        let mut n_tightened = 0;
        for _ in 0..MAX_ROUNDS {
            match self.descend() {
                Stop::Rest => {}
                Stop::Endless => {
                    return Outcome::Escaped {
                        direction: self.way_out(),
                    };
                }
                Stop::Exhausted => return Outcome::Unsettled,
            }
            if self.imbalance() <= AT_REST && self.looseness() <= TIGHT {
                return Outcome::Settled;
            }
            let deepest = self.deepest();
            if deepest == 0.0 {
                // Less than the last bit above taxels that are too stiff to be pressed by it.
                return Outcome::Unsettled;
            }
            let now = &self.balancer.now;
            self.multipliers = now.loads.multipliers(&now.pairs.all);
            self.smoothness.smoothing = self.smoothness.smoothing.min(SMOOTHING * deepest);
            // Where the energy bends down between ties, multipliers need steeper sides to converge.
            let (before, now) = (looseness, self.looseness());
            if now > TIGHT.max(0.25 * before) && n_tightened < MOST_TIGHTENED {
                n_tightened += 1;
                self.smoothness.tighten(0.2);
                self.smoothness.stop_stiffness *= 5.0;
            }
            looseness = now;
            self.look_again();
        }
        let is_tight = self.looseness() <= 1e3 * TIGHT;
        match self.imbalance() <= PROMISED && is_tight {
            true => Outcome::Settled,
            false => Outcome::Unsettled,
        }
    }

    /// Down to a stationary point of the smooth energy that is no saddle.
    fn descend(&mut self) -> Stop {
        while self.n_steps < MAX_STEPS {
            if self.balancer.now.pairs.all.is_empty() {
                match self.fall() {
                    true => continue,
                    false => return Stop::Endless,
                }
            }
            let (slope, step) = match self.best() {
                Some(found) => found,
                None => return Stop::Rest,
            };
            let length = norm(&step.motion);
            if length <= self.same_place() {
                return Stop::Rest;
            }
            match self.attempt(&step, slope) {
                Some(ratio) if ratio > 0.75 && length > 0.8 * self.reach => {
                    self.reach = (2.0 * self.reach).min(self.farthest);
                }
                Some(ratio) if ratio < 0.25 => self.reach = 0.5 * length,
                Some(_) => {}
                None => self.reach = 0.25 * length,
            }
        }
        Stop::Exhausted
    }

    /// The length of the energy's gradient, N, and the best step; `None` at a stationary point that is no saddle.
    fn best(&mut self) -> Option<(f64, Step)> {
        let (gradient, hessian) = self.derivatives();
        let parts = eigen(&hessian);
        let lowest = parts.0.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = parts.0.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let slope = norm(&gradient);
        let is_rest = slope <= 0.1 * AT_REST * self.weight.length() && lowest >= -1e-9 * largest;
        if is_rest {
            return None;
        }
        let mut model = std::mem::take(&mut self.balancer.model);
        let (scene, now) = (self.scene(), &self.balancer.now);
        let step = model.best(&scene, &now.pairs.all, (&gradient, &parts), self.reach);
        self.balancer.model = model;
        Some((slope, step))
    }

    /// Lays the model at the pose that was looked at last; gradient (N) and Hessian (N/m) there.
    fn derivatives(&mut self) -> (Six, SixBySix) {
        let mut model = std::mem::take(&mut self.balancer.model);
        let (scene, now) = (self.scene(), &self.balancer.now);
        model.lay(&scene, &now.pairs.all, &now.loads);
        let found = model.at_pose(&scene, &now.pairs.all);
        self.balancer.model = model;
        found
    }

    /// Goes a step if it leads down; how much of the promised gain it brought, `None` if it was not gone.
    fn attempt(&mut self, step: &Step, slope: f64) -> Option<f64> {
        let (center, rotation) = (self.center, self.rotation);
        let shift = self.go(&step.motion);
        let before = self.balancer.now.loads.elastic;
        std::mem::swap(&mut self.balancer.now, &mut self.balancer.next);
        let behind = std::mem::take(&mut self.balancer.next.pairs.behind);
        self.look(&behind);
        self.balancer.next.pairs.behind = behind;
        let after = self.balancer.now.loads.elastic;
        let gain = before - after + self.weight.dot(shift);
        // So little that the energies' last digits decide: the slope then says whether this is the right way.
        let noise = 1e-14 * (before.abs() + after.abs() + self.weight.dot(shift).abs());
        let is_noise = step.gain <= 100.0 * noise;
        let is_better = match is_noise {
            true => norm(&self.derivatives().0) < slope,
            false => gain >= 1e-4 * step.gain,
        };
        if is_better {
            return Some(if is_noise { 1.0 } else { gain / step.gain });
        }
        std::mem::swap(&mut self.balancer.now, &mut self.balancer.next);
        (self.center, self.rotation) = (center, rotation);
        None
    }

    /// Moves the object; its way, metres.
    pub(super) fn go(&mut self, motion: &Six) -> DVec3 {
        let [x, y, z, turn_x, turn_y, turn_z] = *motion;
        let (shift, turn) = (
            DVec3::new(x, y, z),
            DVec3::new(turn_x, turn_y, turn_z) / self.arm,
        );
        self.center += shift;
        self.rotation = (DQuat::from_scaled_axis(turn) * self.rotation).normalize();
        shift
    }

    /// Falls towards the next skin, not deeper into it than to where it is no worse off; whether there is one.
    fn fall(&mut self) -> bool {
        let down = self.weight.normalize();
        let mut way = match fall(self.object, self.skins, self.center, down) {
            Fall::Endless => return false,
            Fall::Free(way) => way.max(self.farthest),
            Fall::Near => self.farthest,
        };
        let above = self.center;
        let behind = std::mem::take(&mut self.balancer.now.pairs.behind);
        loop {
            self.center = above + way * down;
            self.look(&behind);
            let is_no_worse = self.balancer.now.loads.elastic <= 0.5 * self.weight.length() * way;
            if is_no_worse || way <= self.same_place() {
                return true;
            }
            way *= 0.5;
        }
    }

    /// Metres that are none.
    fn same_place(&self) -> f64 {
        SAME_PLACE * (self.arm + self.center.length())
    }

    /// Looks at the pose; `behind`: the spheres that were behind taxels where it comes from.
    fn look(&mut self, behind: &[(Key, u32)]) {
        self.n_steps += 1;
        let pose = self.pose();
        let mut now = std::mem::take(&mut self.balancer.now);
        // Of far steps not all is foreseen: that would be most spheres.
        let step = self.reach.min(self.nearby());
        now.look(self.object, &self.scene(), &pose, step, behind);
        self.balancer.now = now;
    }

    /// Looks at the pose with what was behind taxels before.
    pub(super) fn look_again(&mut self) {
        let behind = std::mem::take(&mut self.balancer.now.pairs.behind);
        self.look(&behind);
    }

    /// Steps up to this, metres, are foreseen with all contacts that they make.
    pub(super) fn nearby(&self) -> f64 {
        NEARBY * self.farthest
    }

    fn pose(&self) -> Pose {
        let from_origin = self.rotation * self.object.center_of_mass;
        Pose::new(self.rotation, self.center - from_origin)
    }

    fn deepest(&self) -> f64 {
        let carrying = self.balancer.now.loads.carrying();
        carrying.map(|load| load.deepest).fold(0.0, f64::max)
    }

    fn looseness(&self) -> f64 {
        self.balancer.now.looseness(self.skins)
    }

    pub(super) fn imbalance(&self) -> f64 {
        let (force, torque) = self.balancer.now.wrench(self.skins);
        self.imbalance_of(force, torque)
    }

    /// What is left of a force (N) and a torque (N·m) with the weight: see [`Balance::imbalance`].
    pub(super) fn imbalance_of(&self, force: DVec3, torque: DVec3) -> f64 {
        let weight = self.weight.length();
        let of_force = (force + self.weight).length() / weight;
        of_force.max(torque.length() / (weight * self.object.radius))
    }

    fn way_out(&self) -> DVec3 {
        let down = self.weight.normalize();
        let way = self.center - self.start;
        let across = way - way.dot(down) * down;
        if across.length() > 1e-9 * way.length() {
            across.normalize()
        } else {
            down
        }
    }

    /// What there is to say of the pose that it has come to, and of what holds it there, if that is known better than by deflections.
    pub fn balance(&mut self, outcome: Outcome, held: Option<Held>) -> Balance {
        if let Outcome::Escaped { .. } = outcome {
            self.balancer.carried.clear();
        } else if held.is_none() {
            self.balancer.carried = self.balancer.now.carried(self.skins);
        }
        let now = &self.balancer.now;
        let by_deflections = || {
            let (force, torque) = now.wrench(self.skins);
            Held {
                force,
                torque,
                n_saturated: now.loads.carrying().filter(|load| load.stop > 0.0).count(),
            }
        };
        let Held {
            force,
            torque,
            n_saturated,
        } = held.unwrap_or_else(by_deflections);
        Balance {
            pose: self.pose(),
            outcome,
            force,
            torque,
            imbalance: self.imbalance_of(force, torque),
            n_touched: now.loads.carrying().count(),
            n_saturated,
            n_grazing: now.n_grazing(),
            n_steps: self.n_steps,
        }
    }
}
