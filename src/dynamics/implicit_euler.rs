//! Implicit Euler with exact contact \[AP\].
//!
//! At the step's end, with `a = m/Δt² + c/Δt + k` (the stiffness that a step feels of a taxel) and `δ_f` where the taxel goes if nothing
//! pushes it,
//!
//! ```text
//! δ_f = (m/Δt² δ + m/Δt δ̇ + c/Δt δ) / a,   f = a max(0, x' − start − δ_f)
//! M (x' − x − Δt ẋ − Δt² g) / Δt² + Σ f(x') = 0,   x' ≤ the floor
//! ```
//!
//! which is one equation for x', increasing and convex: Newton's method from the right ends after a few steps, exactly. At the floor stops
//! carry the rest.

use super::state::{Integrator, State};
use super::system::{Drive, System};

/// The integrator and its state.
#[derive(Clone, Debug)]
pub struct ImplicitEuler {
    state: State,
    /// Where each taxel goes if nothing pushes it, metres.
    free: Vec<f64>,
    /// a of each taxel, N/m.
    stiffness: Vec<f64>,
}

/// Newton's method ends after a step for each taxel at the latest; a handful are usual.
const MOST_NEWTON_STEPS: usize = 100;

impl ImplicitEuler {
    /// At rest.
    pub fn new(system: &System) -> Self {
        Self::from_state(State::start(system))
    }

    /// From somewhere.
    pub fn from_state(state: State) -> Self {
        Self {
            free: vec![0.0; state.deflection.len()],
            stiffness: vec![0.0; state.deflection.len()],
            state,
        }
    }

    /// Where the taxels go if nothing pushes them.
    fn let_go(&mut self, system: &System, dt: f64) {
        let m = system.taxel_mass;
        let taxels = system.patch.taxels();
        for taxel in 0..system.n_taxels() {
            let properties = taxels.at(taxel);
            let (inertia, drag) = (m / (dt * dt), properties.damping / dt);
            let a = inertia + drag + properties.stiffness;
            let deflection = self.state.deflection[taxel];
            let kept = (inertia + drag) * deflection + inertia * dt * self.state.velocity[taxel];
            self.free[taxel] = (kept / a).min(properties.stroke);
            self.stiffness[taxel] = a;
        }
    }

    /// Where a free object goes, metres of travel.
    fn balance(&self, system: &System, mass: f64, gravity: f64, dt: f64) -> f64 {
        let state = &self.state;
        let inertia = mass / (dt * dt);
        let aim = state.travel + dt * (state.speed + dt * gravity);
        let mut travel = aim;
        for _ in 0..MOST_NEWTON_STEPS {
            let (mut slope, mut toward) = (inertia, inertia * aim);
            let taxels = system.starts().iter().zip(&self.free).zip(&self.stiffness);
            for ((start, free), a) in taxels {
                if travel > start + free {
                    slope += a;
                    toward += a * (start + free);
                }
            }
            let next = toward / slope;
            if next >= travel {
                break;
            }
            travel = next;
        }
        travel.min(system.floor())
    }

    /// What the stops carry, shared by the taxels at the floor.
    fn load_stops(&mut self, system: &System, rest: f64) {
        let floor = system.floor();
        let is_there = |taxel: usize| {
            let end = system.starts()[taxel] + system.patch.taxels().at(taxel).stroke;
            end <= floor * (1.0 + 1e-9)
        };
        let there: Vec<usize> = (0..system.n_taxels()).filter(|&t| is_there(t)).collect();
        for &taxel in &there {
            self.state.force[taxel] += rest / there.len() as f64;
        }
    }
}

impl Integrator for ImplicitEuler {
    fn step(&mut self, system: &System, dt: f64) {
        self.let_go(system, dt);
        let time = self.state.time + dt;
        let travel = match &system.drive {
            Drive::Free { mass, gravity, .. } => self.balance(system, *mass, *gravity, dt),
            Drive::Imposed(plan) => system.imposed(plan, time),
        };
        let taxels = system.patch.taxels();
        let mut support = 0.0;
        for taxel in 0..system.n_taxels() {
            let free = self.free[taxel];
            let pushed = travel - system.starts()[taxel];
            let force = self.stiffness[taxel] * (pushed - free).max(0.0);
            let deflection = free.max(pushed).min(taxels.at(taxel).stroke);
            let state = &mut self.state;
            state.velocity[taxel] = (deflection - state.deflection[taxel]) / dt;
            state.deflection[taxel] = deflection;
            state.force[taxel] = force;
            support += force;
        }
        let speed = (travel - self.state.travel) / dt;
        if let Drive::Free { mass, gravity, .. } = system.drive {
            let needed = mass * (gravity - (speed - self.state.speed) / dt);
            // Rounding of the balance is not the stops'.
            if travel >= system.floor() {
                self.load_stops(system, (needed - support).max(0.0));
            }
        }
        self.state.travel = travel;
        self.state.speed = speed;
        self.state.time = time;
    }

    fn state(&mut self, _system: &System) -> &State {
        &self.state
    }
}
