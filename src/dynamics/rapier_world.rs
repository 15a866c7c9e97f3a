//! The same scene in a rigid-body engine: rapier, in f64.
//!
//! Each taxel is a ball on a prismatic joint: its motor is the spring and the damper, its limit the stroke. The object is one body with a
//! ball for each sphere. Both are held on their lines by locked axes as well, so that the solver's iterations are left for what
//! matters; taxels pass through each other. (Joints by coordinates, rapier's multibodies, are twenty times slower and no more exact.)

use super::state::{Integrator, State};
use super::system::{Drive, System};
use crate::error::{Error, Result};
use glam::DVec3;
use rapier3d_f64::prelude::{
    ColliderBuilder, ColliderHandle, Group, IntegrationParameters, InteractionGroups,
    InteractionTestMode, LockedAxes, MotorModel, PhysicsWorld, PrismaticJointBuilder,
    RigidBodyBuilder, RigidBodyHandle, SpringCoefficients, Vector,
};

/// What the engine is told beside the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RapierSettings {
    /// Iterations of the solver a step, at least 1. (Each is a small step of its own: the solver is of the TGS kind.)
    pub solver_iterations: usize,
    /// Sweeps over all constraints within each iteration, at least 1.
    pub sweeps: usize,
    /// Engine steps within each of ours, at least 1.
    pub substeps: usize,
    /// What counts as small, metres: penetration that is allowed, and how near pairs are looked at, are multiples of it. (The engine's
    /// own, 1 m, allows 5 mm of penetration.)
    pub length_unit: f64,
    /// How hard contacts are.
    pub contacts: RapierContacts,
}

/// How hard the engine's contacts are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RapierContacts {
    /// As the engine comes: springs of 30 Hz, and penetration taken back at 3 units of length a second at most.
    AsItComes,
    /// Critically damped springs of 300 / Δt, and penetration taken back as fast as they say. Harder ones gain nothing; softer ones let
    /// light taxels sink in under springs that are stiff for the step.
    Hard,
}

impl RapierSettings {
    /// As the engine comes, but for the unit of length: the stroke.
    pub fn as_it_comes(system: &System) -> Self {
        Self {
            solver_iterations: 4,
            sweeps: 1,
            substeps: 1,
            length_unit: system.patch.taxels().at(0).stroke,
            contacts: RapierContacts::AsItComes,
        }
    }

    /// Tuned for skin: hard contacts, and ten sweeps, without which light taxels do not carry.
    pub fn tuned(system: &System) -> Self {
        Self {
            sweeps: 10,
            contacts: RapierContacts::Hard,
            ..Self::as_it_comes(system)
        }
    }

    fn parameters(&self, dt: f64) -> IntegrationParameters {
        let plain = IntegrationParameters {
            dt,
            num_solver_iterations: self.solver_iterations,
            num_internal_pgs_iterations: self.sweeps,
            length_unit: self.length_unit,
            ..IntegrationParameters::default()
        };
        match self.contacts {
            RapierContacts::AsItComes => plain,
            RapierContacts::Hard => {
                let softness = SpringCoefficients::new(300.0 / dt, 1.0);
                IntegrationParameters {
                    contact_softness: softness,
                    static_contact_softness: softness,
                    normalized_max_corrective_velocity: 1e6,
                    warmstart_joints: true,
                    ..plain
                }
            }
        }
    }
}

/// A scene in the engine.
pub struct RapierWorld {
    world: PhysicsWorld,
    settings: RapierSettings,
    taxels: Vec<RigidBodyHandle>,
    colliders: Vec<ColliderHandle>,
    object: RigidBodyHandle,
    /// The object at a travel of 0.
    origin: DVec3,
    /// Of the last engine step, seconds.
    dt: f64,
    state: State,
}

const SKIN: Group = Group::GROUP_1;
const OBJECT: Group = Group::GROUP_2;

impl RapierWorld {
    /// Builds the scene; the error names an object that is no union of spheres.
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
        let guide = LockedAxes::ROTATION_LOCKED
            | LockedAxes::TRANSLATION_LOCKED_X
            | LockedAxes::TRANSLATION_LOCKED_Y;
        let body = match system.drive {
            Drive::Free { mass, .. } => RigidBodyBuilder::dynamic()
                .additional_mass(mass)
                .locked_axes(guide),
            Drive::Imposed(_) => RigidBodyBuilder::kinematic_position_based(),
        };
        let at = engine(origin - state.travel * DVec3::Z);
        let object = world.insert_body(body.translation(at).can_sleep(false));
        for sphere in spheres.spheres() {
            let center = system.pose.transform_vector(sphere.center);
            let ball = ball(sphere.radius, OBJECT, SKIN).translation(engine(center));
            world.insert_collider(ball, Some(object));
        }
        let ground = world.insert_body(RigidBodyBuilder::fixed());
        let mut made = Self {
            world,
            settings,
            taxels: Vec::with_capacity(system.n_taxels()),
            colliders: Vec::with_capacity(system.n_taxels()),
            object,
            origin,
            dt: 0.0,
            state,
        };
        for taxel in 0..system.n_taxels() {
            made.insert_taxel(system, taxel, ground, guide);
        }
        Ok(made)
    }

    fn insert_taxel(
        &mut self,
        system: &System,
        taxel: usize,
        ground: RigidBodyHandle,
        guide: LockedAxes,
    ) {
        let properties = system.patch.taxels().at(taxel);
        let center = engine(system.patch.layout().centers()[taxel]);
        let body = RigidBodyBuilder::dynamic()
            .translation(center)
            .additional_mass(system.taxel_mass)
            .gravity_scale(0.0)
            .locked_axes(guide)
            .can_sleep(false);
        let (handle, collider) = self
            .world
            .insert(body, ball(properties.radius, SKIN, OBJECT));
        let joint = PrismaticJointBuilder::new(Vector::Z)
            .local_anchor1(center)
            .motor_model(MotorModel::ForceBased)
            .motor_position(0.0, properties.stiffness, properties.damping)
            .limits([-properties.stroke, FAR]);
        self.world.insert_impulse_joint(ground, handle, joint);
        self.taxels.push(handle);
        self.colliders.push(collider);
    }
}

/// No taxel swings out so far, metres.
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
            self.world.step();
        }
    }

    fn state(&mut self, system: &System) -> &State {
        let state = &mut self.state;
        let object = &self.world.bodies[self.object];
        state.travel = self.origin.z - object.translation().z;
        state.speed = -object.linvel().z;
        for (taxel, handle) in self.taxels.iter().enumerate() {
            let body = &self.world.bodies[*handle];
            let rest = system.patch.layout().centers()[taxel].z;
            state.deflection[taxel] = rest - body.translation().z;
            state.velocity[taxel] = -body.linvel().z;
            let pairs = self.world.contact_pairs_with(self.colliders[taxel]);
            let impulse: f64 = pairs.map(|pair| pair.total_impulse().z.abs()).sum();
            state.force[taxel] = impulse / self.dt;
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

/// The engine has a glam of its own.
fn engine(vector: DVec3) -> Vector {
    Vector::new(vector.x, vector.y, vector.z)
}
