//! Settings of the rigid-body engine rapier.

use super::skin_sim;
use super::system::System;
use rapier3d_f64::prelude::{IntegrationParameters, SpringCoefficients};

/// Settings of rapier, the rigid-body engine that is used for comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RapierSettings {
    /// Number of solver iterations per step, at least 1. An iteration is a small time step of its own, because the solver is of the TGS kind.
    pub solver_iterations: usize,
    /// Number of sweeps over all constraints within each iteration, at least 1.
    pub sweeps: usize,
    /// Number of engine steps per time step of the integrator, at least 1.
    pub substeps: usize,
    /// Length scale of the engine, metres; the allowed penetration and the contact search distance are multiples of this length. The engine's default, 1 m,
    /// allows 5 mm of penetration.
    pub length_unit: f64,
    /// Stiffness of the contacts in the engine.
    pub contacts: RapierContacts,
    /// Representation of the taxels' springs and dampers in the engine.
    pub joints: RapierJoints,
}

/// Representation of the taxels' springs and dampers in the engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RapierJoints {
    /// Motors of joints to the world, which the solver integrates as stiff springs. Locked axes keep taxels on their lines,
    /// so that fewer constraints remain for the solver.
    Motors,
    /// Model of SkinSim \[SK\]: forces are computed before each time step and constant within the step. Only joints hold the taxels on a light base; a joint
    /// without range of motion holds the base in the world.
    SkinSim {
        /// Mass of the base, the body to which the taxels are attached, kg.
        base_mass: f64,
    },
}

/// Stiffness of the contacts in the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RapierContacts {
    /// Default contacts of the engine: springs of 30 Hz, and a penetration that is corrected at no more than 3 units of length per second.
    AsItComes,
    /// Contacts that are critically damped springs of 300 / Δt for a time step Δt, without a limit of the correction speed. A larger value brings no gain. If
    /// smaller, light taxels sink in under springs that are stiff for the time step.
    Hard,
    /// Contacts of SkinSim \[SK\]: rigid (CFM 0), with a fifth of the penetration corrected per step (ERP 0.2), at 100 m/s at most.
    Ode,
}

impl RapierSettings {
    /// Returns the engine's default settings, with the stroke as unit of length.
    pub fn with_engine_defaults(system: &System) -> Self {
        Self {
            solver_iterations: 4,
            sweeps: 1,
            substeps: 1,
            length_unit: system.patch.taxels().at(0).stroke,
            contacts: RapierContacts::AsItComes,
            joints: RapierJoints::Motors,
        }
    }

    /// Returns settings tuned for skin: hard contacts, and ten sweeps. With fewer sweeps, light taxels do not support the object.
    pub fn tuned(system: &System) -> Self {
        Self {
            sweeps: 10,
            contacts: RapierContacts::Hard,
            ..Self::with_engine_defaults(system)
        }
    }

    /// Returns the settings of SkinSim: one solver iteration per step with `sweeps` sweeps over all constraints.
    pub fn skin_sim(system: &System, sweeps: usize) -> Self {
        Self {
            solver_iterations: 1,
            sweeps,
            contacts: RapierContacts::Ode,
            joints: RapierJoints::SkinSim {
                base_mass: skin_sim::BASE_MASS,
            },
            ..Self::with_engine_defaults(system)
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
                // ω Δt = 2 ζ e / (1 − e) gives the ERP e; with this large ζ the CFM is 1e-4 of the mass at the contact.
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
