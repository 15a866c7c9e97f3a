//! Scene of one configuration: the array, the ball, the dampers, the duration, and the exact result.

use crate::contact::equilibrium::HalfSpace;
use crate::dynamics::{Drive, Rest, System, rest, skin_sim};
use crate::objects::{Sphere, SphereUnion};
use crate::studies::prelude::*;
use crate::studies::stability::rows::*;
use crate::studies::stability::spec::*;
use crate::world::{Grid, Layout, Patch, Phase, Taxels, VelocityPlan};
use glam::DVec3;

/// Gravity g, m/s².
pub(super) const GRAVITY: f64 = 9.81;
/// Speed of a ball with imposed motion, m/s.
const SPEED: f64 = 0.5;
/// Distance between the start of a ball with imposed motion and its first contact, metres.
const APPROACH: f64 = 2e-3;
/// Minimum duration for which a ball with imposed motion rests at its deepest point, seconds.
const LEAST_HOLD: f64 = 0.2;
/// Exponent of decay at the end of a pause or run: the slowest motion has then decayed by the factor e^−10 = 5e-5.
const DECAY: f64 = 10.0;
/// Minimum number of time steps for which a ball with imposed motion stays at its deepest point.
const LEAST_HOLD_STEPS: f64 = 5.0;
/// Travel of the ball within which it may touch taxels, as a multiple of the stroke. The ball reaches all taxels within 1.25 strokes. If the value is much
/// larger, the ball could be behind the substrate.
const REACH: f64 = 1.5;
/// Minimum simulated time for a ball that moves freely, seconds.
const LEAST_TIME: f64 = 0.5;

/// Array of taxels below a ball that touches all taxels nearly at the same time.
#[derive(Clone, Debug)]
pub(super) struct TestBed<'a> {
    pub configuration: &'a StabilityConfiguration,
    pub taxel: Taxel,
    pub patch: Patch,
    pub ball: Model,
    /// Radius of the ball, metres.
    radius: f64,
    /// Pose of the ball at first contact, `patch_from_object`.
    pub pose: Pose,
}

/// Scene of a configuration; it does not depend on the simulation method.
#[derive(Clone, Debug)]
pub(super) struct ConfigurationScene<'a> {
    pub test_bed: TestBed<'a>,
    /// Motion of the ball: an imposed motion, or free motion under gravity.
    pub drive: Drive,
    /// Exact solution at the time of evaluation: the travel of the ball and the deflections.
    pub truth: Rest,
    /// Exact total force Σ f at the time of evaluation, newtons.
    pub force: f64,
    /// Time at which the result is evaluated, seconds: the end of the pause at the deepest point, or of the simulation.
    judged: f64,
    /// Time at which the simulation ends, seconds.
    end: f64,
    /// Energy above which the simulation counts as unstable, joules.
    pub energy_limit: f64,
}

impl<'a> TestBed<'a> {
    /// Creates the square array of a configuration, and above it a ball whose radius is the side length of the array. The taxels have no dampers.
    fn new(configuration: &'a StabilityConfiguration, taxel: Taxel) -> Result<Self> {
        let side = configuration.taxels;
        let grid = Grid {
            nx: side,
            ny: side,
            pitch: 2.0 * taxel.radius,
        };
        let radius = side as f64 * grid.pitch;
        let reach = radius + taxel.radius;
        let corner = grid.x(0).powi(2) + grid.y(0).powi(2);
        let places = (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
        let center = |(column, row)| {
            let (x, y) = (grid.x(column), grid.y(row));
            let across = x * x + y * y;
            let under_ball = reach - (reach * reach - across).sqrt();
            DVec3::new(x, y, under_ball - 0.25 * taxel.stroke * across / corner)
        };
        let layout = Layout::new(places.map(center).collect(), vec![DVec3::Z; side * side])?;
        let center = DVec3::ZERO;
        let ball = SphereUnion::new(vec![Sphere { center, radius }])?;
        // The ball touches the innermost taxels first.
        let innermost = DVec3::new(0.5 * grid.pitch, 0.5 * grid.pitch, 0.0).length_squared();
        let lift = reach - 0.25 * taxel.stroke * innermost / corner;
        Ok(Self {
            configuration,
            taxel,
            patch: Patch::new("test_bed", layout, Taxels::Equal(taxel))?,
            ball: ball.into(),
            radius,
            pose: Pose::from_translation(lift * DVec3::Z),
        })
    }

    /// Returns the same array with dampers, N·s/m.
    fn damped(self, damping: f64) -> Result<Self> {
        let taxel = Taxel {
            damping,
            ..self.taxel
        };
        let layout = self.patch.layout().clone();
        let patch = Patch::new("test_bed", layout, Taxels::Equal(taxel))?;
        Ok(Self {
            taxel,
            patch,
            ..self
        })
    }

    /// Returns the initial pose of a ball with imposed motion.
    fn above(&self) -> Pose {
        Pose::from_translation(self.pose.translation + APPROACH * DVec3::Z)
    }

    /// Returns the poses of a stack of balls at first contact, from bottom to top, `patch_from_object`.
    pub fn stack(&self, n_balls: usize) -> impl Iterator<Item = Pose> {
        let above = |number| 2.0 * number as f64 * self.radius * DVec3::Z;
        let place = move |number| self.pose.translation + above(number);
        (0..n_balls).map(move |number| Pose::from_translation(place(number)))
    }

    /// Returns the walls of a tube that keeps a stack of balls upright, as half-spaces that touch the balls without force.
    pub fn tube(&self) -> Vec<HalfSpace> {
        let inwards = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y];
        let height = -self.radius;
        let wall = |normal| HalfSpace { normal, height };
        inwards.map(wall).into()
    }

    /// Returns the dynamic system for methods that step through time: taxels and balls. The system contains the taxels within `reach` metres below the first
    /// ball, and the balls that are stacked on it.
    fn system(&self, drive: &Drive, reach: f64) -> Result<System<'_>> {
        let pose = match drive {
            Drive::Free { .. } => self.pose,
            Drive::Imposed(_) => self.above(),
        };
        let mass = self.configuration.taxel_mass_kg;
        let system = System::new(&self.patch, mass, &self.ball, pose, drive.clone(), reach)?;
        match (drive, self.configuration.scene.n_balls()) {
            (&Drive::Free { mass, .. }, n_balls @ 2..) => system.stacked(&vec![mass; n_balls - 1]),
            _ => Ok(system),
        }
    }
}

impl<'a> ConfigurationScene<'a> {
    /// Creates the scene of a configuration, given the taxel parameters without a damper.
    pub fn new(configuration: &'a StabilityConfiguration, undamped: Taxel) -> Result<Self> {
        let test_bed = TestBed::new(configuration, undamped)?;
        match configuration.object_mass_kg {
            Some(mass) => Self::of_free(test_bed, mass),
            None => Self::of_imposed(test_bed),
        }
    }

    /// Returns the dynamic system for methods that step through time.
    pub fn system(&self) -> Result<System<'_>> {
        let reach = APPROACH + REACH * self.test_bed.taxel.stroke;
        self.test_bed.system(&self.drive, reach)
    }

    /// Returns the step numbers (from 1) after which the state is evaluated: at the evaluation time and at a later end.
    pub fn frames(&self) -> Vec<usize> {
        let dt = self.test_bed.configuration.dt_s;
        let end = (self.end / dt).ceil() as usize;
        match self.judged < self.end {
            true => vec![(self.judged / dt).floor() as usize, end],
            false => vec![end],
        }
    }

    fn of_free(test_bed: TestBed<'a>, mass: f64) -> Result<Self> {
        let (configuration, taxel) = (test_bed.configuration, test_bed.taxel);
        let drive = Drive::Free {
            mass,
            gravity: GRAVITY,
            travel: 0.0,
        };
        let (k, m) = (taxel.stiffness, configuration.taxel_mass_kg);
        let system = test_bed.system(&drive, REACH * taxel.stroke)?;
        let truth = rest(&system).expect("a free ball over taxels comes to rest");
        let n_touched = truth.deflection.iter().filter(|d| **d > 0.0).count();
        let all = configuration.scene.n_balls() as f64 * mass;
        // Mass that each taxel moves, including its own.
        let share = all / n_touched as f64 + m;
        let damping = match configuration.scene {
            StabilityScene::Plunger => k * skin_sim::DAMPING / skin_sim::STIFFNESS,
            _ => 2.0 * (k * share).sqrt(),
        };
        let end = LEAST_TIME
            .max(DECAY / slowest(k, damping, share))
            .max(LEAST_STEPS * configuration.dt_s);
        Ok(Self {
            test_bed: test_bed.damped(damping)?,
            truth,
            force: all * GRAVITY,
            judged: end,
            end,
            // The scene starts without kinetic energy. All potential energy of the fall goes into springs and dampers.
            energy_limit: all * GRAVITY * taxel.stroke,
            drive,
        })
    }

    fn of_imposed(test_bed: TestBed<'a>) -> Result<Self> {
        let (configuration, taxel) = (test_bed.configuration, test_bed.taxel);
        let (k, m) = (taxel.stiffness, configuration.taxel_mass_kg);
        let ratio = skin_sim::DAMPING / (2.0 * (skin_sim::STIFFNESS * skin_sim::TAXEL_MASS).sqrt());
        let damping = 2.0 * ratio * (k * m).sqrt();
        let hold = LEAST_HOLD
            .max(DECAY / slowest(k, damping, m))
            .max(LEAST_HOLD_STEPS * configuration.dt_s);
        let depth = 0.5 * taxel.stroke;
        let way = (APPROACH + depth) / SPEED;
        let phase = |duration, speed| Phase {
            duration,
            linear: speed * DVec3::Z,
            angular: DVec3::ZERO,
        };
        let phases = vec![phase(way, -SPEED), phase(hold, 0.0), phase(way, SPEED)];
        let drive = Drive::Imposed(VelocityPlan::new(test_bed.above(), phases)?);
        let system = test_bed.system(&drive, APPROACH + REACH * taxel.stroke)?;
        let travel = APPROACH + depth;
        let starts = system.starts().iter();
        let deflection: Vec<f64> = starts.map(|start| (travel - start).max(0.0)).collect();
        // Upper bound: the energy of the springs at full depth, and of taxels hit at twice the speed.
        let n_taxels = deflection.len() as f64;
        let most = 0.5 * n_taxels * (k * depth * depth + m * (2.0 * SPEED).powi(2));
        Ok(Self {
            force: k * deflection.iter().sum::<f64>(),
            truth: Rest {
                travel,
                deflection,
                stops: 0.0,
            },
            judged: way + hold,
            end: way + hold + way + hold,
            energy_limit: 4.0 * most,
            test_bed: test_bed.damped(damping)?,
            drive,
        })
    }
}

/// Returns the decay rate of the slowest motion of `m ẍ + c ẋ + k x = 0`, per second.
fn slowest(k: f64, c: f64, m: f64) -> f64 {
    let half = 0.5 * c / m;
    let inside = half * half - k / m;
    if inside > 0.0 {
        // k/m divided by the faster rate avoids cancellation.
        (k / m) / (half + inside.sqrt())
    } else {
        half
    }
}

/// Minimum number of time steps in the simulation of a ball that moves freely.
pub const LEAST_STEPS: f64 = 50.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::stability::spec::ContactMethod;

    #[test]
    fn the_ball_meets_the_innermost_taxels_where_it_starts_and_all_within_a_quarter_of_the_stroke()
    {
        for taxels in [2, 8, 16] {
            let configuration = StabilityConfiguration {
                part: 1,
                scene: StabilityScene::Rest,
                method: ContactMethod::QuasiStatic,
                solver_iterations: None,
                taxels,
                stiffness_n_per_m: 100.0,
                taxel_mass_kg: 1e-3,
                object_mass_kg: Some(1.0),
                dt_s: 1e-3,
            };
            let undamped = Taxel {
                radius: 2e-3,
                stiffness: 100.0,
                damping: 0.0,
                stroke: 2e-3,
            };
            let scene = ConfigurationScene::new(&configuration, undamped).unwrap();
            let system = scene.system().unwrap();
            let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
            for &start in system.starts() {
                low = low.min(start);
                high = high.max(start);
            }
            assert!(low.abs() < 1e-15 && high < 0.5e-3 + 1e-12, "{low} {high}");
        }
    }

    #[test]
    fn the_slowest_rate_is_that_of_the_closed_form() {
        assert!((slowest(4.0, 4.0, 1.0) - 2.0).abs() < 1e-12, "critical");
        assert!((slowest(4.0, 0.4, 1.0) - 0.2).abs() < 1e-15, "ringing");
        let overdamped = 2.5 - (6.25_f64 - 4.0).sqrt();
        assert!((slowest(4.0, 5.0, 1.0) - overdamped).abs() < 1e-12);
    }
}
