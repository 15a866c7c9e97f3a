//! Implicit Euler integrator with exact contact \[AP\].
//!
//! Let `a = m/Δt² + c/Δt + k` be the effective stiffness of a taxel within a step, and `δ_f` the deflection of a free taxel at the step's end:
//!
//! ```text
//! δ_f = (m/Δt² δ + m/Δt δ̇ + c/Δt δ) / a,   f = a max(0, x' − start − δ_f)
//! M (x' − x − Δt ẋ − Δt² g) / Δt² + Σ f(x') = 0,   x' ≤ the floor
//! ```
//!
//! The second line is one equation for x', increasing and convex. Newton's method, started at a larger x', ends after a few steps, exactly. When the first
//! taxel reaches the end of its stroke, hard limits carry the remaining force. Stacked balls that would otherwise penetrate the balls below are merged into a
//! group with one motion. The x' of a chain of balls is an isotonic regression of their free motions.

use super::state::{Integrator, Rider, State};
use super::system::{Drive, System};

/// Implicit Euler integrator with its state.
#[derive(Clone, Debug)]
pub struct ImplicitEuler {
    state: State,
    /// Deflection that each taxel would have at the end of the time step if it were free, metres.
    free: Vec<f64>,
    /// Effective stiffness of each taxel within a time step, N/m, including the effects of damper and mass.
    stiffness: Vec<f64>,
    /// Groups of stacked balls, from below: first the group that contains the object, then the groups on it.
    groups: Vec<Group>,
}

/// Group of stacked balls that touch one another and move together.
#[derive(Clone, Copy, Debug)]
struct Group {
    n_balls: usize,
    mass: f64,
    /// Travel that the group would have after the time step without contact with the taxels, metres.
    aim: f64,
}

impl Group {
    /// Returns the union of this group and the group on top of it.
    fn with(self, upper: Self) -> Self {
        let mass = self.mass + upper.mass;
        Self {
            n_balls: self.n_balls + upper.n_balls,
            aim: (self.mass * self.aim + upper.mass * upper.aim) / mass,
            mass,
        }
    }
}

/// Maximum number of Newton steps per time step; about five are usual. The method ends after at most one step per taxel.
const MAX_NEWTON_STEPS: usize = 100;

impl ImplicitEuler {
    /// Creates the integrator with undeflected taxels and an object without contact.
    pub fn new(system: &System) -> Self {
        Self::from_state(State::start(system))
    }

    /// Creates the integrator from a given state.
    pub fn from_state(state: State) -> Self {
        Self {
            free: vec![0.0; state.deflection.len()],
            stiffness: vec![0.0; state.deflection.len()],
            groups: Vec::new(),
            state,
        }
    }

    /// Computes the deflections that the taxels would have at the end of the time step if they were free.
    fn compute_free_deflections(&mut self, system: &System, dt: f64) {
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

    /// Returns the travel of a free object after the time step, metres. Afterwards the first group contains the balls that move with the object.
    fn balance(&mut self, system: &System, mass: f64, gravity: f64, dt: f64) -> f64 {
        let state = &self.state;
        let alone = |mass, travel: f64, speed: f64| Group {
            n_balls: 1,
            mass,
            aim: travel + dt * (speed + dt * gravity),
        };
        self.groups.clear();
        for (&mass, rider) in system.riders().iter().zip(&state.riders) {
            let mut group = alone(mass, rider.travel, rider.speed);
            while let Some(lower) = self.groups.pop_if(|lower| lower.aim < group.aim) {
                group = lower.with(group);
            }
            self.groups.push(group);
        }
        let mut lowest = alone(mass, state.travel, state.speed);
        let mut n_joined = 0;
        let mut travel = self.push_in(system, &lowest, dt);
        while let Some(&next) = self.groups.get(n_joined).filter(|next| next.aim > travel) {
            lowest = lowest.with(next);
            n_joined += 1;
            travel = self.push_in(system, &lowest, dt);
        }
        self.groups.splice(..n_joined, [lowest]);
        travel
    }

    /// Returns the travel, after the time step, of balls that lie on the taxels, metres.
    fn push_in(&self, system: &System, balls: &Group, dt: f64) -> f64 {
        let inertia = balls.mass / (dt * dt);
        let aim = balls.aim;
        let mut travel = aim;
        for _ in 0..MAX_NEWTON_STEPS {
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

    /// Moves the balls stacked on the object. Returns the force, newtons, with which the taxels must additionally support the balls that move with the
    /// object.
    fn move_riders(&mut self, system: &System, lowest: f64, gravity: f64, dt: f64) -> f64 {
        let mut needed = 0.0;
        let travels = self.groups.iter().enumerate().flat_map(|(number, group)| {
            let travel = if number == 0 { lowest } else { group.aim };
            std::iter::repeat_n((number == 0, travel), group.n_balls)
        });
        let riders = self.state.riders.iter_mut().zip(system.riders());
        for ((rider, mass), (is_along, travel)) in riders.zip(travels.skip(1)) {
            let speed = (travel - rider.travel) / dt;
            if is_along {
                needed += mass * (gravity - (speed - rider.speed) / dt);
            }
            *rider = Rider { travel, speed };
        }
        needed
    }

    /// Distributes the remaining force `rest` (newtons) over the taxels that have reached the end of their stroke.
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
        self.compute_free_deflections(system, dt);
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
            let mut needed = mass * (gravity - (speed - self.state.speed) / dt);
            needed += self.move_riders(system, travel, gravity, dt);
            // Rounding of the balance must not load the stops.
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
