//! What the rigid-body engine is told beside a scene.

use super::skin_sim;
use super::system::System;
use rapier3d_f64::prelude::{IntegrationParameters, SpringCoefficients};

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
    /// What springs and dampers are.
    pub joints: RapierJoints,
}

/// What the springs and dampers of taxels are in the engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RapierJoints {
    /// Motors of joints to the world, which the solver takes as springs that are stiff for its step. Locked axes hold taxels on their lines
    /// as well, so that the solver's iterations are left for what matters.
    Motors,
    /// As SkinSim has them \[SK\]: forces that are computed before each step and stay the same for it, and joints alone that hold taxels,
    /// on a light base which one more joint without room to move holds in the world.
    SkinSim {
        /// Of the base, kg.
        base_mass: f64,
    },
}

/// How hard the engine's contacts are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RapierContacts {
    /// As the engine comes: springs of 30 Hz, and penetration taken back at 3 units of length a second at most.
    AsItComes,
    /// Critically damped springs of 300 / Δt, and penetration taken back as fast as they say. Harder ones gain nothing; softer ones let
    /// light taxels sink in under springs that are stiff for the step.
    Hard,
    /// As SkinSim tells its engine \[SK\]: rigid (CFM 0), a fifth of penetration taken back a step (ERP 0.2), at 100 m/s at most.
    Ode,
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
            joints: RapierJoints::Motors,
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

    /// As SkinSim tells its engine: so many sweeps over all constraints in one solution a step.
    pub fn skin_sim(system: &System, sweeps: usize) -> Self {
        Self {
            solver_iterations: 1,
            sweeps,
            contacts: RapierContacts::Ode,
            joints: RapierJoints::SkinSim {
                base_mass: skin_sim::BASE_MASS,
            },
            ..Self::as_it_comes(system)
        }
    }

    pub(super) fn parameters(&self, dt: f64) -> IntegrationParameters {
        let plain = IntegrationParameters {
            dt,
            num_solver_iterations: self.solver_iterations,
            num_internal_pgs_iterations: self.sweeps,
            length_unit: self.length_unit,
            ..IntegrationParameters::default()
        };
        let (softness, corrective_velocity) = match self.contacts {
            RapierContacts::AsItComes => return plain,
            RapierContacts::Hard => (SpringCoefficients::new(300.0 / dt, 1.0), 1e6),
            RapierContacts::Ode => {
                // ω Δt = 2 ζ e / (1 − e) gives the ERP e; so large a ζ makes the CFM 1e-4 of the mass at the contact.
                let damping_ratio = 100.0;
                let turns = 0.25 * damping_ratio / std::f64::consts::PI;
                let softness = SpringCoefficients::new(turns / dt, damping_ratio);
                (softness, 100.0 / self.length_unit)
            }
        };
        IntegrationParameters {
            contact_softness: softness,
            static_contact_softness: softness,
            normalized_max_corrective_velocity: corrective_velocity,
            warmstart_joints: true,
            ..plain
        }
    }
}
