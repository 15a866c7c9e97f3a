//! State of a dynamic system, and the interface of integrators.

use super::system::{Drive, System};

/// State of a dynamic system at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Time of the state, seconds.
    pub time: f64,
    /// Deflections of the taxels, metres, shape (n_taxels,); negative if a free taxel swings out.
    pub deflection: Vec<f64>,
    /// Velocities of the taxels, m/s, shape (n_taxels,).
    pub velocity: Vec<f64>,
    /// Forces of the object on each taxel, newtons, never negative, shape (n_taxels,).
    pub force: Vec<f64>,
    /// Travel of the object, metres.
    pub travel: f64,
    /// Speed of the object, m/s.
    pub speed: f64,
    /// Balls stacked on the object, from below.
    pub riders: Vec<Rider>,
}

/// Ball stacked on the object; two adjacent balls touch if they have equal travels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rider {
    /// Travel of the ball, metres.
    pub travel: f64,
    /// Speed of the ball, m/s.
    pub speed: f64,
}

impl State {
    /// Creates the start state of a system: undeflected taxels, and an object that touches no taxel.
    pub fn start(system: &System) -> Self {
        let zeros = vec![0.0; system.n_taxels()];
        let rider = Rider {
            travel: system.first_travel(),
            speed: 0.0,
        };
        Self {
            time: 0.0,
            deflection: zeros.clone(),
            velocity: zeros.clone(),
            force: zeros,
            travel: rider.travel,
            speed: rider.speed,
            riders: vec![rider; system.riders().len()],
        }
    }

    /// Returns the energy of the system, joules. The energy is Σ ½ m δ̇² + Σ ½ k δ² over the taxels plus ½ M ẋ² − M g x of each free object. Energy stored in
    /// contacts and at the end of a stroke is not included.
    pub fn energy(&self, system: &System) -> f64 {
        let m = system.taxel_mass;
        let taxels = self.deflection.iter().zip(&self.velocity).enumerate();
        let skin: f64 = taxels
            .map(|(taxel, (d, v))| {
                0.5 * (m * v * v + system.patch.taxels().at(taxel).stiffness * d * d)
            })
            .sum();
        match system.drive {
            Drive::Free { mass, gravity, .. } => {
                let of = |mass: f64, speed: f64, travel: f64| {
                    mass * (0.5 * speed * speed - gravity * travel)
                };
                let riders = system.riders().iter().zip(&self.riders);
                let riders = riders.map(|(&mass, rider)| of(mass, rider.speed, rider.travel));
                skin + of(mass, self.speed, self.travel) + riders.sum::<f64>()
            }
            Drive::Imposed(_) => skin,
        }
    }

    /// Returns the sum of the object's forces on the taxels, newtons.
    pub fn support(&self) -> f64 {
        self.force.iter().sum()
    }
}

/// Time integrator of a dynamic system.
pub trait Integrator {
    /// Advances the system by one time step of `dt` seconds.
    fn step(&mut self, system: &System, dt: f64);
    /// Returns the present state, with the forces at the end of the last time step.
    fn state(&mut self, system: &System) -> &State;
}
