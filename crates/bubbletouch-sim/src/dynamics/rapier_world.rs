//! Scene in the rigid-body engine rapier, in f64.
//!
//! Each taxel is a ball on a prismatic joint whose limit is the stroke; [`RapierJoints`] selects the model of its spring and damper. The object
//! is one body with a ball for each sphere; taxels do not collide with each other. Joints in reduced coordinates, rapier's multibodies, are twenty
//! times slower and not more accurate.

use super::rapier_settings::{RapierJoints, RapierSettings};
use super::state::{Integrator, Rider, State};
use super::system::{Drive, System};
use crate::error::{Error, Result};
use glam::DVec3;
use rapier3d_f64::prelude::{
    ColliderBuilder, ColliderHandle, Group, InteractionGroups, InteractionTestMode, LockedAxes,
    MotorModel, PhysicsWorld, PrismaticJointBuilder, RigidBodyBuilder, RigidBodyHandle, Vector,
};

/// World of the rigid-body engine, with taxels and object as bodies.
pub struct RapierWorld {
    world: PhysicsWorld,
    settings: RapierSettings,
    taxels: Vec<RigidBodyHandle>,
    colliders: Vec<ColliderHandle>,
    object: RigidBodyHandle,
    /// Balls stacked on the object, from below.
    riders: Vec<RigidBodyHandle>,
    /// Body to which the taxels are attached.
    base: RigidBodyHandle,
    /// Position of the object at a travel of 0, metres.
    origin: DVec3,
    /// Duration of the last engine step, seconds.
    dt: f64,
    state: State,
}

const SKIN: Group = Group::GROUP_1;
const OBJECT: Group = Group::GROUP_2;

impl RapierWorld {
    /// Creates the bodies and joints of the engine. Returns an error if the object is not a union of spheres.
    pub fn new(system: &System, settings: RapierSettings) -> Result<Self> {
        let Some(spheres) = system.object.spheres() else {
            let allowed = "a union of spheres";
            return Err(Error::input(
                "object of a dynamics engine",
                "a mesh",
                allowed,
            ));
        };
        let mut world = PhysicsWorld::new();
        world.gravity = match system.drive {
            Drive::Free { gravity, .. } => Vector::new(0.0, 0.0, -gravity),
            Drive::Imposed(_) => Vector::ZERO,
        };
        let state = State::start(system);
        let origin = system.pose.translation;
        let body = match system.drive {
            Drive::Free { mass, .. } => RigidBodyBuilder::dynamic()
                .additional_mass(mass)
                .locked_axes(GUIDE),
            Drive::Imposed(_) => RigidBodyBuilder::kinematic_position_based(),
        };
        let at = engine(origin - state.travel * DVec3::Z);
        let object = world.insert_body(body.translation(at).can_sleep(false));
        for sphere in spheres.spheres() {
            let center = system.pose.transform_vector(sphere.center);
            let ball = ball(sphere.radius, OBJECT, SKIN | OBJECT).translation(engine(center));
            world.insert_collider(ball, Some(object));
        }
        let radius = spheres.spheres()[0].radius;
        let riders = system.riders().iter().enumerate();
        let riders = riders.map(|(number, &mass)| {
            let above = 2.0 * (number + 1) as f64 * radius - state.travel;
            let body = RigidBodyBuilder::dynamic()
                .additional_mass(mass)
                .locked_axes(GUIDE)
                .translation(engine(origin + above * DVec3::Z))
                .can_sleep(false);
            world.insert(body, ball(radius, OBJECT, OBJECT)).0
        });
        let riders = riders.collect();
        let base = insert_base(&mut world, settings.joints);
        let mut made = Self {
            world,
            settings,
            taxels: Vec::with_capacity(system.n_taxels()),
            colliders: Vec::with_capacity(system.n_taxels()),
            object,
            riders,
            base,
            origin,
            dt: 0.0,
            state,
        };
        for taxel in 0..system.n_taxels() {
            made.insert_taxel(system, taxel);
        }
        Ok(made)
    }

    fn insert_taxel(&mut self, system: &System, taxel: usize) {
        let properties = system.patch.taxels().at(taxel);
        let center = engine(system.patch.layout().centers()[taxel]);
        let (axes, springs) = match self.settings.joints {
            RapierJoints::Motors => (GUIDE, (properties.stiffness, properties.damping)),
            RapierJoints::SkinSim { .. } => (LockedAxes::ROTATION_LOCKED, (0.0, 0.0)),
        };
        let body = RigidBodyBuilder::dynamic()
            .translation(center)
            .additional_mass(system.taxel_mass)
            .gravity_scale(0.0)
            .locked_axes(axes)
            .can_sleep(false);
        let (handle, collider) = self
            .world
            .insert(body, ball(properties.radius, SKIN, OBJECT));
        let joint = PrismaticJointBuilder::new(Vector::Z)
            .local_anchor1(center)
            .limits([-properties.stroke, FAR]);
        let joint = match springs {
            (0.0, 0.0) => joint,
            (stiffness, damping) => joint
                .motor_model(MotorModel::ForceBased)
                .motor_position(0.0, stiffness, damping),
        };
        self.world.insert_impulse_joint(self.base, handle, joint);
        self.taxels.push(handle);
        self.colliders.push(collider);
    }

    /// Returns the displacement of a taxel along −z from its undeflected position on the base, metres, and its velocity, m/s.
    fn inwards(&self, system: &System, taxel: usize) -> (f64, f64) {
        let (body, base) = (
            &self.world.bodies[self.taxels[taxel]],
            &self.world.bodies[self.base],
        );
        let rest = system.patch.layout().centers()[taxel].z + base.translation().z;
        (
            rest - body.translation().z,
            base.linvel().z - body.linvel().z,
        )
    }

    /// Applies the forces of springs and dampers to the taxels and the base; the forces are constant within a time step.
    fn push(&mut self, system: &System) {
        let mut on_base = 0.0;
        for taxel in 0..self.taxels.len() {
            let (deflection, velocity) = self.inwards(system, taxel);
            let properties = system.patch.taxels().at(taxel);
            let outwards = properties.stiffness * deflection + properties.damping * velocity;
            on_base -= outwards;
            self.set_force(self.taxels[taxel], outwards);
        }
        self.set_force(self.base, on_base);
    }

    /// Replaces the force on a body by a force along z, newtons.
    fn set_force(&mut self, handle: RigidBodyHandle, force: f64) {
        let body = &mut self.world.bodies[handle];
        body.reset_forces(false);
        body.add_force(Vector::new(0.0, 0.0, force), true);
    }
}

/// Creates the base to which the taxels are attached. The base is the world itself, or a light body that is held in the world by a joint without range of
/// motion.
fn insert_base(world: &mut PhysicsWorld, joints: RapierJoints) -> RigidBodyHandle {
    let ground = world.insert_body(RigidBodyBuilder::fixed());
    let RapierJoints::SkinSim { base_mass } = joints else {
        return ground;
    };
    let base = RigidBodyBuilder::dynamic()
        .additional_mass(base_mass)
        .gravity_scale(0.0)
        .locked_axes(LockedAxes::ROTATION_LOCKED)
        .can_sleep(false);
    let base = world.insert_body(base);
    let joint = PrismaticJointBuilder::new(Vector::Z).limits([0.0, 0.0]);
    world.insert_impulse_joint(ground, base, joint);
    base
}

/// Locked axes of a body that can move only along z.
const GUIDE: LockedAxes = LockedAxes::ROTATION_LOCKED
    .union(LockedAxes::TRANSLATION_LOCKED_X)
    .union(LockedAxes::TRANSLATION_LOCKED_Y);

/// Limit of the joint in the direction away from the object, metres, which is never reached.
const FAR: f64 = 1.0;

impl Integrator for RapierWorld {
    fn step(&mut self, system: &System, dt: f64) {
        let before = self.state.time;
        let n = self.settings.substeps;
        self.dt = dt / n as f64;
        self.world.integration_parameters = self.settings.parameters(self.dt);
        for substep in 1..=n {
            self.state.time = before + self.dt * substep as f64;
            if let Drive::Imposed(plan) = &system.drive {
                let travel = system.imposed(plan, self.state.time);
                let next = engine(self.origin - travel * DVec3::Z);
                let object = &mut self.world.bodies[self.object];
                object.set_next_kinematic_translation(next);
            }
            if let RapierJoints::SkinSim { .. } = self.settings.joints {
                self.push(system);
            }
            self.world.step();
        }
    }

    fn state(&mut self, system: &System) -> &State {
        for taxel in 0..self.taxels.len() {
            let (deflection, velocity) = self.inwards(system, taxel);
            let pairs = self.world.contact_pairs_with(self.colliders[taxel]);
            let impulse: f64 = pairs.map(|pair| pair.total_impulse().z.abs()).sum();
            self.state.deflection[taxel] = deflection;
            self.state.velocity[taxel] = velocity;
            self.state.force[taxel] = impulse / self.dt;
        }
        let object = &self.world.bodies[self.object];
        self.state.travel = self.origin.z - object.translation().z;
        self.state.speed = -object.linvel().z;
        let radius = system
            .object
            .spheres()
            .map_or(0.0, |all| all.spheres()[0].radius);
        for (number, &handle) in self.riders.iter().enumerate() {
            let (body, above) = (
                &self.world.bodies[handle],
                2.0 * (number + 1) as f64 * radius,
            );
            self.state.riders[number] = Rider {
                travel: self.origin.z + above - body.translation().z,
                speed: -body.linvel().z,
            };
        }
        &self.state
    }
}

fn ball(radius: f64, of: Group, with: Group) -> ColliderBuilder {
    ColliderBuilder::ball(radius)
        .density(0.0)
        .friction(0.0)
        .restitution(0.0)
        .collision_groups(InteractionGroups::new(of, with, InteractionTestMode::And))
}

/// Converts a vector to the engine's version of glam.
fn engine(vector: DVec3) -> Vector {
    Vector::new(vector.x, vector.y, vector.z)
}
