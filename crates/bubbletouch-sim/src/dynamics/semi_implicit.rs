//! Semi-implicit Euler with penalty contact: the most common hand-written integrator.
//!
//! ```text
//! f = κ max(0, x − a − δ),  s = κ max(0, δ − stroke)
//! δ̇' = (δ̇ + Δt/m (f − s − k δ)) / (1 + Δt c/m),   δ' = δ + Δt δ̇'
//! ẋ' = ẋ + Δt (g − Σ f / M),                        x' = x + Δt ẋ'
//! ```
//!
//! The force f between stacked balls is computed in the same way: κ max(0, travel of the upper ball − travel of the lower ball).
//!
//! The damper is implicit, at no additional cost; an explicit damper would halve the largest stable step of a well-damped taxel. A free taxel
//! without a damper is stable exactly for Δt < 2 √(m / k).

use super::state::{Integrator, State};
use super::system::{Drive, System};

/// Semi-implicit Euler integrator with its state.
#[derive(Clone, Debug)]
pub struct SemiImplicit {
    state: State,
    /// Stiffness of contacts and of the limits at the end of the stroke, N/m. If larger, bodies penetrate less, but the largest stable time step is smaller.
    contact_stiffness: f64,
}

impl SemiImplicit {
    /// Creates the integrator with undeflected taxels and an object without contact; `contact_stiffness` is in N/m.
    pub fn new(system: &System, contact_stiffness: f64) -> Self {
        Self {
            state: State::start(system),
            contact_stiffness,
        }
    }

    /// Creates the integrator from a given state; `contact_stiffness` is in N/m.
    pub fn from_state(state: State, contact_stiffness: f64) -> Self {
        Self {
            state,
            contact_stiffness,
        }
    }

    /// Returns the largest stable contact stiffness, N/m, for time steps of `dt` seconds while `n_touched` equal taxels touch the object. The result is half
    /// the stability limit of a taxel (`κ + k < 4 m / Δt² + 2 c / Δt`) or of the object (`n κ < 4 M / Δt²`). The result is at least the stiffness of the
    /// taxel's own spring.
    pub fn stiffest(system: &System, dt: f64, n_touched: usize) -> f64 {
        let taxel = system.patch.taxels().at(0);
        let of_taxel = (4.0 * system.taxel_mass / dt + 2.0 * taxel.damping) / dt;
        let of_object = match system.drive {
            Drive::Free { mass, .. } => {
                let n_above = usize::from(!system.riders().is_empty());
                4.0 * mass / ((n_touched.max(1) + n_above) as f64 * dt * dt)
            }
            Drive::Imposed(_) => f64::INFINITY,
        };
        (0.5 * of_taxel.min(of_object) - taxel.stiffness).max(taxel.stiffness)
    }

    fn push(&self, system: &System, taxel: usize) -> f64 {
        let state = &self.state;
        let depth = state.travel - system.starts()[taxel] - state.deflection[taxel];
        self.contact_stiffness * depth.max(0.0)
    }
}

impl Integrator for SemiImplicit {
    fn step(&mut self, system: &System, dt: f64) {
        let m = system.taxel_mass;
        let taxels = system.patch.taxels();
        let mut support = 0.0;
        for taxel in 0..system.n_taxels() {
            let properties = taxels.at(taxel);
            let push = self.push(system, taxel);
            support += push;
            let deflection = &mut self.state.deflection[taxel];
            let velocity = &mut self.state.velocity[taxel];
            let stop = self.contact_stiffness * (*deflection - properties.stroke).max(0.0);
            let force = push - stop - properties.stiffness * *deflection;
            *velocity = (*velocity + dt / m * force) / (1.0 + dt * properties.damping / m);
            *deflection += dt * *velocity;
        }
        let state = &mut self.state;
        state.time += dt;
        match &system.drive {
            Drive::Free { mass, gravity, .. } => {
                // Force of each rider on the ball below it, from the positions before the step.
                let (mut below, mut lower) = (support, state.travel);
                let (mut mass, mut speed, mut travel) =
                    (*mass, &mut state.speed, &mut state.travel);
                for (rider, &of_rider) in state.riders.iter_mut().zip(system.riders()) {
                    let load = self.contact_stiffness * (rider.travel - lower).max(0.0);
                    lower = rider.travel;
                    *speed += dt * (gravity - (below - load) / mass);
                    *travel += dt * *speed;
                    (below, mass) = (load, of_rider);
                    (speed, travel) = (&mut rider.speed, &mut rider.travel);
                }
                *speed += dt * (gravity - below / mass);
                *travel += dt * *speed;
            }
            Drive::Imposed(plan) => state.travel = system.imposed(plan, state.time),
        }
    }

    fn state(&mut self, system: &System) -> &State {
        for taxel in 0..system.n_taxels() {
            self.state.force[taxel] = self.push(system, taxel);
        }
        &self.state
    }
}
