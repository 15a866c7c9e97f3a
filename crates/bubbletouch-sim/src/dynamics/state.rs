//! Where everything is, and who takes it a step further.

use super::system::{Drive, System};

/// A system at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Seconds.
    pub time: f64,
    /// δ, n_taxels, metres; negative where a free taxel swings out.
    pub deflection: Vec<f64>,
    /// δ̇, n_taxels, m/s.
    pub velocity: Vec<f64>,
    /// f, n_taxels, newtons: what the object puts on each taxel, never negative.
    pub force: Vec<f64>,
    /// x, metres.
    pub travel: f64,
    /// ẋ, m/s.
    pub speed: f64,
    /// The balls stacked on the object, from below.
    pub riders: Vec<Rider>,
}

/// A ball that may lie on what is below it: it does where both have travelled as far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rider {
    /// Metres.
    pub travel: f64,
    /// m/s.
    pub speed: f64,
}

impl State {
    /// Taxels that stand out, and an object that nothing has touched.
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

    /// Σ ½ m δ̇² + Σ ½ k δ², and of each free object ½ M ẋ² − M g x; joules. What contacts and stops store does not count.
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

    /// Σ f, newtons.
    pub fn support(&self) -> f64 {
        self.force.iter().sum()
    }
}

/// Takes a system from step to step.
pub trait Integrator {
    /// One step of `dt` seconds.
    fn step(&mut self, system: &System, dt: f64);
    /// Where everything is now. Forces are those of the step's end as the integrator sees them.
    fn state(&mut self, system: &System) -> &State;
}
