//! Descent of the energy to a pose at rest.

use super::body::Body;
use super::energy::{Energy, PairLoad, wrenches};
use super::fall::Loose;
use super::free_object::Ground;
use super::loads::{Multipliers, Smoothness};
use super::meshes::Depth;
use super::model::{Model, Step};
use super::pair::{Key, Part};
use super::rigid_shape::RigidShape;
use super::scene::Scene;
use super::shear_springs::{self, Spring};
use super::stagnation::{DescentGain, ResidualDecrease};
use super::symmetric::{Symmetric, norm};
use glam::DVec3;

/// Maximum number of poses evaluated per body. A body that rolls across a whole skin needs some hundreds. If larger, problems that do not converge take
/// longer; if smaller, long rolls do not converge.
const MAX_STEPS: usize = 4000;
/// Maximum number of updates of the Lagrange multipliers; three to six are usual.
const MAX_ROUNDS: usize = 40;
/// Imbalance (relative residual of force and torque) at which the iteration stops: a tenth of the largest accepted imbalance.
const TARGET_IMBALANCE: f64 = 1e-7;
/// Largest imbalance (relative residual of force and torque) of a pose that is reported as at rest. Near steep surfaces of objects, no pose has a smaller
/// imbalance.
const ACCEPTED_IMBALANCE: f64 = 1e-6;
/// Complementarity residual (relative violation of the contact constraints) at which the iteration stops.
const TARGET_RESIDUAL: f64 = 1e-7;
/// Largest complementarity residual of a pose that is reported as at rest. The value is needed if many taxels at the end of their stroke carry load and
/// rounding limits their stiffness.
const ACCEPTED_RESIDUAL: f64 = 1e-5;
/// Largest step of the bodies, relative to the longest allowed step, for which all possible contacts are collected. A larger value collects more pairs of
/// spheres and taxels; a smaller value needs more steps.
const NEARBY: f64 = 0.04;
/// Value of [`NEARBY`] if a mesh can touch a rigid shape. A mesh that rolls meets a new contact after a part of a triangle, and a step that meets an unknown one is rejected.
const NEARBY_MESH: f64 = 0.25;
/// Width of the smoothing of ties (taxels pushed equally far by several spheres). The width is relative to the largest deflection and to the deflection at
/// which one taxel carries all the weight.
const SMOOTHING: f64 = 1e-2;
/// Minimum smoothing of ties, in multiples of the rounding error of the object's size.
const LAST_BITS: f64 = 64.0;
/// Maximum number of times that the smoothing of ties is reduced. Each reduction makes the smoothed kinks of the energy steeper by a factor of 5; rounding
/// hides further reductions.
const MAX_TIGHTENINGS: usize = 12;
/// Longest step of meshes that can touch rigid shapes, relative to the smallest body. If larger, a step can pass through a thin wall; if smaller, long ways
/// need more steps.
const RIGID_STEP: f64 = 0.02;
/// Largest increase of the penetration of two meshes by a step, relative to its length: a point can move by two steps, by translation and by rotation.
const DEEP: f64 = 2.5;
/// Least penetration of rigid meshes that is searched, relative to the largest penetration of a descent. If larger, the contacts of nested shapes take longer; if smaller, a
/// contact that begins deep, where ridges pass each other, is missed.
const LEAST_DEPTH: f64 = 0.2;
/// Distance below which two positions count as equal, relative to the size and the travel of the object.
const SAME_PLACE: f64 = 1e-15;

/// Reusable memory of energy descents; the Lagrange multipliers of one descent initialise the next one.
#[derive(Clone, Debug, Default)]
pub(super) struct DescentWorkspace {
    /// Energy at the current poses of the bodies.
    pub now: Energy,
    /// Memory for the energy at the trial poses of the bodies.
    next: Energy,
    model: Model,
    pub multipliers: Multipliers,
    /// Rigid contacts at the current poses and at rejected ones, sorted. Contacts of meshes begin and end where a corner passes the border of a face. The energy
    /// has a jump there, which a step cannot see unless the contact is held.
    held: Vec<Key>,
}

/// State of an energy descent: bodies, step lengths and energies.
pub(super) struct Descent<'a, 'b> {
    pub workspace: &'b mut DescentWorkspace,
    /// Bodies, ground, and present Lagrange multipliers of the descent.
    pub scene: Scene<'a>,
    /// Length of the longest allowed step of the bodies, metres.
    pub farthest: f64,
    /// Trust-region radius of the next step, metres.
    pub reach: f64,
    pub n_steps: usize,
    /// Whether a mesh can touch a rigid shape.
    has_mesh: bool,
    /// Total decrease of the energy by steps and falls, less increases by contacts that are found only after a step, joules.
    descended: f64,
}

/// Result of an energy descent.
pub(super) enum End {
    /// All bodies are at rest.
    Rest,
    /// Some bodies fall without end; contains the indices of these bodies.
    Endless(Vec<usize>),
    /// The descent reached its maximum number of steps.
    Exhausted,
}

impl<'a, 'b> Descent<'a, 'b> {
    /// Creates the descent of at least one body on the ground.
    pub fn new(
        workspace: &'b mut DescentWorkspace,
        bodies: Vec<Body<'a>>,
        ground: &'a Ground<'a>,
    ) -> Self {
        let (mut stroke, mut stiffness) = (f64::INFINITY, 0.0_f64);
        for skin in &ground.skins {
            for (number, taxel) in skin.patch.taxels().all().iter().enumerate() {
                stroke = stroke.min(taxel.stroke);
                stiffness = stiffness.max(skin.stiffness(number));
            }
        }
        let smallest = bodies.iter().map(Body::arm).fold(f64::INFINITY, f64::min);
        let stroke = if stroke.is_finite() { stroke } else { smallest };
        let weight: f64 = bodies.iter().map(|body| body.weight.length()).sum();
        let size = bodies.iter().map(Body::arm).fold(0.0, f64::max);
        let is_mesh = |body: &Body| matches!(body.object.shape, RigidShape::Mesh(_));
        let may_touch = bodies.len() > 1 || !ground.obstacles.is_empty();
        let has_mesh = may_touch && bodies.iter().any(is_mesh);
        workspace.held.clear();
        let farthest = match has_mesh {
            true => (0.5 * stroke).min(RIGID_STEP * smallest),
            false => 0.5 * stroke,
        };
        Self {
            has_mesh,
            descended: 0.0,
            farthest,
            scene: Scene {
                ground,
                springs: Spring::all(&bodies, ground),
                bodies,
                multipliers: std::mem::take(&mut workspace.multipliers),
                smoothness: Smoothness {
                    smoothing: 1e-3 * stroke,
                    load: SMOOTHING,
                    least: LAST_BITS * f64::EPSILON * size,
                    stop_stiffness: (1e3 * stiffness).max(weight / (1e-3 * stroke)),
                },
            },
            reach: 0.25 * farthest,
            n_steps: 0,
            workspace,
        }
    }

    /// Repeats energy descents with updated Lagrange multipliers. If the residuals no longer decrease, the best pose within the accepted tolerances is
    /// returned.
    ///
    /// If `was_at_rest`, the poses are a solution of an earlier step. Bodies that are still at rest then do not move: smoothing would push them.
    pub fn run(&mut self, was_at_rest: bool) -> End {
        if was_at_rest && self.is_still_at_rest() {
            return End::Rest;
        }
        self.look(&[], self.farthest);
        let now = &self.workspace.now;
        if shear_springs::widen(&mut self.scene.springs, (&now.pairs, &now.loads)) {
            self.look_again();
        }
        let mut complementarity_residual = f64::INFINITY;
        let mut n_tightened = 0;
        let (mut best, mut least) = (None, f64::INFINITY);
        let mut decrease = self.has_mesh.then(ResidualDecrease::new);
        for _ in 0..MAX_ROUNDS {
            match self.descend() {
                End::Rest => {}
                end => return end,
            }
            let Scene {
                springs, bodies, ..
            } = &mut self.scene;
            let now = &self.workspace.now;
            let change = shear_springs::renew(springs, bodies, (&now.pairs, &now.loads));
            if change <= TARGET_IMBALANCE && self.is_at_rest(TARGET_IMBALANCE, TARGET_RESIDUAL) {
                return End::Rest;
            }
            let now = self.complementarity_residual();
            if now < least
                && change <= ACCEPTED_IMBALANCE
                && self.is_at_rest(ACCEPTED_IMBALANCE, ACCEPTED_RESIDUAL)
            {
                let held = self.workspace.held.clone();
                (best, least) = (Some((self.scene.clone(), held)), now);
            }
            if let Some(decrease) = &mut decrease {
                let imbalance = self.largest_imbalance().max(change);
                let residual = (imbalance / ACCEPTED_IMBALANCE).max(now / ACCEPTED_RESIDUAL);
                if decrease.is_stagnant(residual) {
                    break;
                }
            }
            let Some(deepest) = self.deepest() else {
                // The body floats by less than the last bit above taxels that are too stiff for its weight.
                return End::Exhausted;
            };
            let energy = &self.workspace.now;
            self.scene.multipliers = energy.loads.multipliers(&energy.pairs);
            let smoothness = &mut self.scene.smoothness;
            if deepest > 0.0 {
                smoothness.smoothing = smoothness.smoothing.min(SMOOTHING * deepest);
            }
            // If the energy is concave between ties, multipliers converge only with less smoothing.
            if now > TARGET_RESIDUAL.max(0.25 * complementarity_residual)
                && n_tightened < MAX_TIGHTENINGS
            {
                n_tightened += 1;
                smoothness.tighten(0.2);
                smoothness.stop_stiffness *= 5.0;
            }
            complementarity_residual = now;
            self.look_again();
        }
        let Some((scene, held)) = best else {
            return End::Exhausted;
        };
        self.scene = scene;
        self.workspace.held = held;
        self.look_again();
        match self.is_at_rest(ACCEPTED_IMBALANCE, ACCEPTED_RESIDUAL) || !self.has_mesh {
            true => End::Rest,
            false => End::Exhausted,
        }
    }

    /// Returns whether the bodies are at rest at their present poses, with the least smoothing.
    fn is_still_at_rest(&mut self) -> bool {
        let (smoothness, springs) = (self.scene.smoothness, self.scene.springs.clone());
        self.scene.smoothness.tighten(0.0);
        self.look(&[], self.farthest);
        let now = &self.workspace.now;
        let here = (&now.pairs, &now.loads);
        let change = shear_springs::renew(&mut self.scene.springs, &self.scene.bodies, here);
        // Taxels that are touched by rounding alone carry nothing, however they share it.
        let is_untouched = self
            .deepest()
            .is_some_and(|deepest| deepest <= smoothness.least);
        let residual = if is_untouched {
            f64::INFINITY
        } else {
            ACCEPTED_RESIDUAL
        };
        let is_still =
            change <= ACCEPTED_IMBALANCE && self.is_at_rest(ACCEPTED_IMBALANCE, residual);
        if !is_still {
            (self.scene.smoothness, self.scene.springs) = (smoothness, springs);
        }
        is_still
    }

    fn is_at_rest(&self, imbalance: f64, complementarity_residual: f64) -> bool {
        self.largest_imbalance() <= imbalance
            && self.complementarity_residual() <= complementarity_residual
    }

    /// Returns the largest imbalance of all bodies.
    fn largest_imbalance(&self) -> f64 {
        let imbalances = self.imbalances(&self.workspace.now.pair_loads());
        imbalances.into_iter().fold(0.0, f64::max)
    }

    /// Returns the largest complementarity residual of all islands, where an island is a group of bodies in contact.
    fn complementarity_residual(&self) -> f64 {
        let now = &self.workspace.now;
        let islands = now.pairs.islands(self.scene.bodies.len());
        now.complementarity_residual(&islands)
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// Returns the indices of the bodies in the island (group of bodies in contact) with the largest residual.
    pub fn most_restless(&self) -> Vec<usize> {
        let now = &self.workspace.now;
        let islands = now.pairs.islands(self.scene.bodies.len());
        let mut unrest = now.complementarity_residual(&islands);
        for (body, imbalance) in self.imbalances(&now.pair_loads()).into_iter().enumerate() {
            let unrest = &mut unrest[islands[body]];
            *unrest = unrest.max(imbalance);
        }
        let most = |one: &&usize, other: &&usize| unrest[**one].total_cmp(&unrest[**other]);
        let worst = islands.iter().max_by(most).copied();
        let all = 0..islands.len();
        all.filter(|&body| Some(islands[body]) == worst).collect()
    }

    /// Moves the bodies to a stationary point of the smoothed energy that is not a saddle.
    fn descend(&mut self) -> End {
        let bodies = self.scene.bodies.iter();
        let size: f64 = bodies.map(|body| body.weight.length() * body.arm()).sum();
        let start = (self.n_steps, self.descended);
        let mut gain = self.has_mesh.then(|| DescentGain::new(start, size));
        while self.n_steps < MAX_STEPS * self.scene.bodies.len() {
            let now = (self.n_steps, self.descended);
            if gain.as_mut().is_some_and(|gain| gain.is_stagnant(now)) {
                return End::Rest;
            }
            if let Some((loose, way, room)) = self.loose() {
                match room.is_finite() {
                    true => self.fall(&loose, room * way),
                    false => {
                        self.shift(&loose, self.farthest * way);
                        return End::Endless(loose.bodies);
                    }
                }
                continue;
            }
            let (slope, step) = match self.best() {
                Some(found) => found,
                None => return End::Rest,
            };
            let length = norm(&step.motion);
            if length <= self.same_place() {
                // If the trust region has shrunk to nothing too early, the next round gathers contacts in a wider range.
                if slope > TARGET_IMBALANCE {
                    self.reach = self.nearby();
                }
                return End::Rest;
            }
            match self.try_step(&step, slope) {
                Some(ratio) if ratio > 0.75 && length > 0.8 * self.reach => {
                    self.reach = (2.0 * self.reach).min(self.farthest);
                }
                Some(ratio) if ratio < 0.25 => self.reach = 0.5 * length,
                Some(_) => {}
                None => self.reach = 0.25 * length,
            }
        }
        End::Exhausted
    }

    /// Returns the slope of the energy (relative to the weights) and the best step; `None` at a stationary point that is not a saddle.
    fn best(&mut self) -> Option<(f64, Step)> {
        let (gradient, hessian) = self.derivatives();
        let slope = self.scene.slope(&gradient);
        if slope <= 0.1 * TARGET_IMBALANCE && hessian.is_convex() {
            return None;
        }
        let DescentWorkspace { now, model, .. } = &mut *self.workspace;
        let limit = (self.reach, self.has_mesh);
        let step = model.best(&self.scene, now, (gradient, hessian), limit);
        Some((slope, step))
    }

    /// Sets up the quadratic model of the energy at the current poses. Returns the gradient (N) and the Hessian (N/m) of the energy.
    fn derivatives(&mut self) -> (Vec<f64>, Symmetric) {
        let DescentWorkspace { now, model, .. } = &mut *self.workspace;
        model.lay(&self.scene, now)
    }

    /// Takes a step if the energy decreases. Returns the ratio of actual to predicted decrease, or `None` if the step was rejected.
    fn try_step(&mut self, step: &Step, slope: f64) -> Option<f64> {
        let bodies = self.scene.bodies.clone();
        let fallen = self.go(&step.motion);
        let before = self.workspace.now.loads.elastic;
        std::mem::swap(&mut self.workspace.now, &mut self.workspace.next);
        let behind = std::mem::take(&mut self.workspace.next.pairs.behind);
        self.look(&behind, self.reach);
        self.workspace.next.pairs.behind = behind;
        let after = self.workspace.now.loads.elastic;
        let gain = before - after + fallen;
        // If the difference of the energies is below rounding, the slope decides.
        let noise = 1e-14 * (before.abs() + after.abs() + fallen.abs());
        let is_noise = step.gain <= 100.0 * noise;
        let is_better = match is_noise {
            true => {
                let (gradient, _) = self.derivatives();
                self.scene.slope(&gradient) < slope
            }
            false => gain >= 1e-4 * step.gain,
        };
        if self.has_mesh {
            self.hold_contacts(is_better);
        }
        if is_better {
            self.descended += gain;
            return Some(if is_noise { 1.0 } else { gain / step.gain });
        }
        std::mem::swap(&mut self.workspace.now, &mut self.workspace.next);
        self.scene.bodies = bodies;
        if !self.has_mesh {
            return None;
        }
        // The next step knows the contacts of the rejected one.
        let n_pairs = self.workspace.now.pairs.all.len();
        self.look_again();
        // Contacts of the rejected pose can raise the energy. Without this, a cycle of such poses would count as a descent.
        self.descended -= self.workspace.now.loads.elastic - before;
        (self.workspace.now.pairs.all.len() > n_pairs).then_some(0.5)
    }

    /// Adds the rigid contacts of the step to the held ones, or replaces them if the step was accepted (`is_better`).
    fn hold_contacts(&mut self, is_better: bool) {
        let DescentWorkspace { now, held, .. } = &mut *self.workspace;
        if is_better {
            held.clear();
        }
        held.extend(now.pairs.rigid());
        held.sort_unstable();
        held.dedup();
    }

    /// Moves the bodies by a motion; returns the work of their weights, joules.
    fn go(&mut self, motion: &[f64]) -> f64 {
        let bodies = self.scene.bodies.iter_mut().zip(motion.chunks(6));
        bodies
            .map(|(body, motion)| body.weight.dot(body.go(motion)))
            .sum()
    }

    /// Returns a group of unsupported bodies, the direction of its motion (unit vector), and the distance that the group may move, metres. Returns `None` if
    /// all bodies are supported.
    fn loose(&self) -> Option<(Loose, DVec3, f64)> {
        let down = self.scene.bodies[0].weight.normalize();
        let all = Loose::all(&self.workspace.now.pairs, self.scene.bodies.len());
        all.into_iter().find_map(|loose| {
            let way = loose.direction(self.scene.ground, down)?;
            let room = match loose.clearance(&self.scene.bodies, self.scene.ground, way) {
                // Ordinary steps find the direction along a plane, together with nearby contacts.
                None if loose.slides() => return None,
                room => room.unwrap_or(0.0).max(self.farthest),
            };
            Some((loose, way, room))
        })
    }

    /// Moves a group of unsupported bodies together by `way` (metres), or by a smaller distance (halved repeatedly) for which the energy decreases.
    fn fall(&mut self, loose: &Loose, mut way: DVec3) {
        let weights = loose
            .bodies
            .iter()
            .map(|&body| self.scene.bodies[body].weight);
        let weight: DVec3 = weights.sum();
        let before = self.workspace.now.loads.elastic;
        let behind = std::mem::take(&mut self.workspace.now.pairs.behind);
        self.shift(loose, way);
        loop {
            self.look(&behind, self.farthest);
            let gain = before - self.workspace.now.loads.elastic + 0.5 * weight.dot(way);
            if gain >= 0.0 || way.length() <= self.same_place() {
                self.descended += gain + 0.5 * weight.dot(way);
                return;
            }
            way *= 0.5;
            self.shift(loose, -way);
        }
    }

    fn shift(&mut self, loose: &Loose, by: DVec3) {
        let bodies = loose.bodies.iter();
        bodies.for_each(|&body| self.scene.bodies[body].center += by);
    }

    /// Returns the distance, metres, below which two positions of the bodies count as equal.
    fn same_place(&self) -> f64 {
        let bodies = self.scene.bodies.iter();
        let sizes = bodies.map(|body| body.arm() + body.center.length());
        SAME_PLACE * sizes.fold(f64::INFINITY, f64::min)
    }

    /// Evaluates the energy at the current poses, which the last step of at most `moved` metres reached. `behind` lists the spheres that were behind a taxel's substrate
    /// at the previous poses.
    fn look(&mut self, behind: &[(Key, Part)], moved: f64) {
        self.n_steps += 1;
        // For a long step not all contacts are gathered: the list would contain most spheres.
        let step = self.reach.min(self.nearby());
        let largest = DEEP * self.farthest;
        let DescentWorkspace {
            now, next, held, ..
        } = &mut *self.workspace;
        let before = now.pairs.penetration().max(next.pairs.penetration());
        let searched = 2.0 * before + DEEP * moved;
        let depth = Depth {
            searched: searched.clamp(LEAST_DEPTH * largest, largest),
            largest,
        };
        now.look(&self.scene, (step, depth), (behind, held));
    }

    /// Re-evaluates the energy at the current poses. Spheres that are now behind the substrate of a taxel continue to exert no force on this taxel.
    fn look_again(&mut self) {
        let behind = std::mem::take(&mut self.workspace.now.pairs.behind);
        self.look(&behind, 0.0);
    }

    /// Returns the largest step, metres, for which all possible contacts are gathered.
    fn nearby(&self) -> f64 {
        let nearby = if self.has_mesh { NEARBY_MESH } else { NEARBY };
        nearby * self.farthest
    }

    /// Returns the largest deflection of any taxel, metres; 0 if only rigid contacts carry load, `None` if nothing carries load.
    fn deepest(&self) -> Option<f64> {
        let now = &self.workspace.now;
        let carrying = now.loads.carrying(&now.pairs.groups);
        carrying
            .map(|(group, load)| match group.key {
                Key::Taxel(..) => load.deepest,
                Key::Rigid(..) => 0.0,
            })
            .reduce(f64::max)
    }

    /// Returns the imbalance of each body under the given loads, dimensionless.
    fn imbalances(&self, loads: &[PairLoad]) -> Vec<f64> {
        let pairs = &self.workspace.now.pairs.all;
        let Scene {
            springs,
            bodies,
            ground,
            ..
        } = &self.scene;
        let wrenches = wrenches((loads, pairs), springs, bodies, &ground.skins);
        let each = bodies.iter().zip(wrenches);
        each.map(|(body, wrench)| body.imbalance_of(wrench))
            .collect()
    }
}
