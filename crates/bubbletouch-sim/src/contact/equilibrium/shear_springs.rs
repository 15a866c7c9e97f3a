//! Friction of taxels: shear springs that act on free objects.
//!
//! The object's material point a, which touched the taxel at the beginning of the step, drags the end of the taxel's shear spring. Let v = u + P (a − a₀)
//! perpendicular to the taxel's axis, k_t the stiffness of the shear spring, and r = μ f / k_t. The energy of the spring is
//!
//! ```text
//! ½ k_t |v|²               |v| ≤ r        it sticks
//! k_t r (|v| − ½ r)        |v| > r        it slips
//! ```
//!
//! The derivative is the force k_t v, limited to the friction cone. The radius r depends on the force f in equilibrium. Each round of a descent therefore takes
//! r from the solution of the previous round, until both agree: a fixed-point iteration of Tresca's friction \[NJ\].

use super::body::{Body, along, unit_motions};
use super::free_object::{Ground, PlacedSkin};
use super::loads::Loads;
use super::pair::Key;
use super::pairs::Pairs;
use super::slopes::add_turning;
use super::symmetric::{Six, Symmetric, dot};
use crate::contact::friction::{TangentialSpring, TangentialSpringState};
use glam::{DVec2, DVec3};

/// Factor by which rounding may exceed the friction cone without counting as slip.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Shear spring between a taxel and a body.
#[derive(Clone, Debug)]
pub(super) struct Spring {
    skin: usize,
    tip: TangentialSpring,
    /// Index of the body among the bodies of the solver.
    pub body: usize,
    /// Axes x and y of the taxel's frame, in the world.
    axes: [DVec3; 2],
    /// Position of the contact point at the beginning of the time step, moved with the patch; in the world, metres.
    start: DVec3,
    /// Largest shear displacement without slip, metres: the friction coefficient times the normal force, divided by the spring's stiffness.
    reach: f64,
}

impl Spring {
    /// Returns all shear springs that act on the given bodies.
    pub fn all(bodies: &[Body], ground: &Ground) -> Vec<Self> {
        let skins = ground.skins.iter().enumerate();
        let tips = skins.flat_map(|skin| {
            let springs = skin.1.tangential_springs.iter();
            springs.map(move |tip| (skin, tip))
        });
        let springs = tips.filter_map(|((number, skin), tip)| {
            let body = bodies.iter().position(|body| body.number == tip.object)?;
            let frame = skin.patch.layout().frame(tip.taxel);
            let to_world = |axis: DVec3| skin.world_from_patch.transform_vector(axis);
            Some(Self {
                skin: number,
                tip: *tip,
                body,
                axes: [to_world(frame.x_axis), to_world(frame.y_axis)],
                start: skin.world_from_patch.transform_point(tip.place),
                reach: tip.shear.reach(tip.force),
            })
        });
        springs.collect()
    }

    /// Returns the vector from the body's centre of mass to the contact point of the spring, in the world, metres.
    fn arm(&self, bodies: &[Body]) -> DVec3 {
        let body = &bodies[self.body];
        body.rotation * (self.tip.point - body.object.center_of_mass)
    }

    /// Returns the shear displacement of the spring, metres.
    fn stretch(&self, bodies: &[Body]) -> DVec2 {
        let way = bodies[self.body].center + self.arm(bodies) - self.start;
        let [x, y] = self.axes;
        self.tip.displacement + DVec2::new(way.dot(x), way.dot(y))
    }

    /// Returns the energy of the spring at the shear displacement `v`, joules.
    fn energy(&self, v: DVec2) -> f64 {
        let (k, r, length) = (self.tip.shear.stiffness, self.reach, v.length());
        match length <= r {
            true => 0.5 * k * length * length,
            false => k * r * (length - 0.5 * r),
        }
    }

    /// Returns the derivative of the spring's energy with respect to its shear displacement `v`, newtons.
    fn slope(&self, v: DVec2) -> DVec2 {
        self.tip.shear.stiffness * v.clamp_length_max(self.reach)
    }

    /// Returns the second derivative of the spring's energy at the shear displacement `v`, N/m: the isotropic part, and the amount subtracted along `v`.
    fn bend(&self, v: DVec2) -> (f64, f64) {
        let (k, length) = (self.tip.shear.stiffness, v.length());
        if self.reach > 0.0 && length <= self.reach {
            return (k, 0.0);
        }
        let slipping = k * self.reach / length.max(f64::MIN_POSITIVE);
        (slipping, slipping)
    }

    /// Returns the force of the spring on the body at the shear displacement `v`, in the world, newtons.
    fn force(&self, v: DVec2) -> DVec3 {
        let DVec2 { x, y } = -self.slope(v);
        x * self.axes[0] + y * self.axes[1]
    }

    /// Returns the force with which the taxel's spring presses the body, newtons, without the force at the end of the stroke. The deflection is increased by
    /// `slack` times the width of the smoothing.
    fn pressing(&self, (pairs, loads): (&Pairs, &Loads), slack: f64) -> f64 {
        let key = Key::Taxel(self.skin as u32, self.tip.taxel as u32);
        let Ok(at) = pairs.groups.binary_search_by_key(&key, |group| group.key) else {
            return 0.0;
        };
        let group = &pairs.groups[at];
        let is_own = |&pair: &usize| {
            pairs.all[pair].part.0 as usize == self.body && loads.shares[pair] > 0.0
        };
        let load = &loads.all[at];
        let deflection = load.deepest + slack * load.smoothing;
        match group.pairs.clone().any(|pair| is_own(&pair)) {
            true => group.stiffness * deflection.clamp(0.0, group.stroke),
            false => 0.0,
        }
    }

    /// Returns the state of the shear spring in equilibrium, with the index of its object.
    pub fn load(&self, bodies: &[Body], skins: &[PlacedSkin]) -> TangentialSpringState {
        let v = self.stretch(bodies);
        let place = bodies[self.body].center + self.arm(bodies);
        TangentialSpringState {
            skin: self.skin,
            taxel: self.tip.taxel,
            object: self.tip.object,
            place: skins[self.skin]
                .world_from_patch
                .inverse()
                .transform_point(place),
            displacement: v.clamp_length_max(self.reach),
            has_slipped: v.length() > self.reach * ROUNDING,
        }
    }
}

/// Returns the total energy of all shear springs, joules.
pub(super) fn energy(springs: &[Spring], bodies: &[Body]) -> f64 {
    let each = springs.iter();
    each.map(|spring| spring.energy(spring.stretch(bodies)))
        .sum()
}

/// Adds the loads of the shear springs to the force (N) and the torque about the centre of mass (N·m) of each body, in the world.
pub(super) fn add_wrenches(springs: &[Spring], bodies: &[Body], to: &mut [(DVec3, DVec3)]) {
    for spring in springs {
        let force = spring.force(spring.stretch(bodies));
        to[spring.body].0 += force;
        to[spring.body].1 += spring.arm(bodies).cross(force);
    }
}

/// Raises the friction limits of the shear springs to those of the present normal forces, including the forces that the smoothing adds. At the beginning of a
/// step, a taxel that the skin's motion presses into a body thereby holds the body, although it carried nothing before. Returns whether a limit changed.
pub(super) fn widen(springs: &mut [Spring], here: (&Pairs, &Loads)) -> bool {
    let mut is_wider = false;
    for spring in springs {
        let reach = spring.tip.shear.reach(spring.pressing(here, 1.0));
        is_wider |= reach > spring.reach;
        spring.reach = spring.reach.max(reach);
    }
    is_wider
}

/// Updates the friction limits of the shear springs from the present normal forces. Returns the largest change of a friction force, relative to the body's
/// weight.
pub(super) fn renew(springs: &mut [Spring], bodies: &[Body], here: (&Pairs, &Loads)) -> f64 {
    let mut most = 0.0_f64;
    for spring in springs {
        let reach = spring.tip.shear.reach(spring.pressing(here, 0.0));
        let before = spring.slope(spring.stretch(bodies));
        spring.reach = reach;
        let change = before - spring.slope(spring.stretch(bodies));
        most = most.max(change.length() / bodies[spring.body].weight.length());
    }
    most
}

/// Shear springs in the quadratic model of the energy: their displacements are linear functions of the motion.
#[derive(Clone, Debug, Default)]
pub(super) struct ShearSpringModel {
    /// Each spring with its shear displacement at the current pose, and the derivative of this displacement with respect to the motion of its body.
    all: Vec<(Spring, DVec2, [Six; 2])>,
}

impl ShearSpringModel {
    /// Sets up the model of the shear springs at the current poses, and adds to `curvature` the second derivative of the energy due to rotations.
    pub fn lay(&mut self, springs: &[Spring], bodies: &[Body], curvature: &mut Symmetric) {
        self.all.clear();
        for spring in springs {
            let (body, arm) = (&bodies[spring.body], spring.arm(bodies));
            let ways = unit_motions(&DVec3::AXES, arm, body.arm());
            let v = spring.stretch(bodies);
            let slopes = spring.axes.map(|axis| along(&ways, axis));
            let turning = body.arm().powi(-2);
            let gradient = -spring.force(v);
            add_turning(
                curvature,
                spring.body,
                turning,
                &DVec3::AXES,
                [arm, gradient],
            );
            self.all.push((spring.clone(), v, slopes));
        }
    }

    fn after<'a>(
        &'a self,
        motion: &'a [f64],
    ) -> impl Iterator<Item = (&'a Spring, DVec2, &'a [Six; 2])> {
        self.all.iter().map(|(spring, v, slopes)| {
            let own = &motion[6 * spring.body..];
            let [x, y] = slopes.each_ref().map(|slope| dot(slope, own));
            (spring, *v + DVec2::new(x, y), slopes)
        })
    }

    /// Returns the energy of the shear springs after a motion, joules.
    pub fn energy_after(&self, motion: &[f64]) -> f64 {
        self.after(motion)
            .map(|(spring, v, _)| spring.energy(v))
            .sum()
    }

    /// Adds the contribution of the shear springs to the gradient (N) and the Hessian (N/m) of the energy after a motion.
    pub fn add_derivatives(&self, motion: &[f64], gradient: &mut [f64], hessian: &mut Symmetric) {
        for (spring, v, slopes) in self.after(motion) {
            let slope = spring.slope(v).to_array();
            let (all, less) = spring.bend(v);
            let along = v.normalize_or_zero().to_array();
            let mut along_v = [0.0; 6];
            let own = &mut gradient[6 * spring.body..];
            for (way, (slope, along)) in slopes.iter().zip(slope.into_iter().zip(along)) {
                for k in 0..6 {
                    own[k] += slope * way[k];
                    along_v[k] += along * way[k];
                }
                hessian.add_block([spring.body; 2], all, way, way);
            }
            hessian.add_block([spring.body; 2], -less, &along_v, &along_v);
        }
    }
}
