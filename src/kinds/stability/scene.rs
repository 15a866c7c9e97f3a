//! A cell's scene: cradle, ball, dampers, how long it takes, and the exact answer.

use super::cell::LEAST_STEPS;
use super::rows::StabilityCell;
use super::spec::StabilityScene;
use crate::dynamics::{Drive, Rest, System, rest, skin_sim};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::{Model, Sphere, SphereUnion};
use crate::world::{Grid, Layout, Phase, SkinPatch, Taxel, Taxels, VelocityPlan};
use glam::DVec3;

/// g, m/s².
pub(super) const GRAVITY: f64 = 9.81;
/// Of an imposed ball, m/s.
const SPEED: f64 = 0.5;
/// From where an imposed ball starts to first contact, metres.
const APPROACH: f64 = 2e-3;
/// A hold takes at least so long, seconds.
const LEAST_HOLD: f64 = 0.2;
/// What is left of the slowest motion at the end of a hold or of a run: e to the minus this, 5e-5.
const DECAY: f64 = 10.0;
/// A hold takes at least so many steps.
const LEAST_HOLD_STEPS: f64 = 5.0;
/// Travel within which taxels are met, in strokes: all are within 1.25 of them; much further, the ball would be behind the substrate.
const REACH: f64 = 1.5;
/// A free ball is watched at least so long, seconds.
const LEAST_TIME: f64 = 0.5;

/// All taxels of a cradle, metres and newtons per metre; see the module's title page.
#[derive(Clone, Debug)]
pub(super) struct Cradle {
    pub patch: SkinPatch,
    pub ball: Model,
    /// `patch_from_object` at first contact.
    pub pose: Pose,
}

/// What must be at the moment of judgement.
#[derive(Clone, Debug)]
pub(super) struct Truth {
    /// n_taxels, metres.
    pub deflection: Vec<f64>,
    /// Σ f, newtons.
    pub force: f64,
    /// Taxels that are touched.
    pub n_touched: usize,
    /// What the most loaded taxel carries, its stop included, newtons.
    pub heaviest: f64,
}

/// When things happen, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Times {
    /// The moment of judgement: the end of the hold, or the end.
    pub judged: f64,
    /// The end.
    pub end: f64,
}

impl Times {
    /// The steps of `dt` seconds after which something is looked at, from 1: the moment of judgement, and the end where that is another.
    pub fn frames(&self, dt: f64) -> Vec<usize> {
        let end = (self.end / dt).ceil() as usize;
        match self.judged < self.end {
            true => vec![(self.judged / dt).floor() as usize, end],
            false => vec![end],
        }
    }
}

/// A cell's scene, ready to be simulated in any way.
#[derive(Clone, Debug)]
pub(super) struct CellScene {
    pub cradle: Cradle,
    pub taxel: Taxel,
    /// Of the ball.
    pub drive: Drive,
    pub truth: Truth,
    pub times: Times,
    /// Joules that the scene never has.
    pub energy_limit: f64,
}

impl Cradle {
    /// A square of `side` taxels a side under a ball as large as it.
    fn new(side: usize, pitch: f64, taxel: Taxel) -> Result<Self> {
        let grid = Grid {
            nx: side,
            ny: side,
            pitch,
        };
        let radius = side as f64 * pitch;
        let reach = radius + taxel.radius;
        let corner = grid.x(0).powi(2) + grid.y(0).powi(2);
        let places = (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
        let centers = places.map(|(column, row)| {
            let (x, y) = (grid.x(column), grid.y(row));
            let across = x * x + y * y;
            let under_ball = reach - (reach * reach - across).sqrt();
            DVec3::new(x, y, under_ball - 0.25 * taxel.stroke * across / corner)
        });
        let centers: Vec<DVec3> = centers.collect();
        let axes = vec![DVec3::Z; centers.len()];
        let layout = Layout::new(centers, axes)?;
        let center = DVec3::ZERO;
        let ball = SphereUnion::new(vec![Sphere { center, radius }])?;
        // The innermost taxels are met first.
        let innermost = DVec3::new(0.5 * pitch, 0.5 * pitch, 0.0).length_squared();
        let lift = reach - 0.25 * taxel.stroke * innermost / corner;
        Ok(Self {
            patch: SkinPatch::new("cradle", layout, Taxels::Equal(taxel))?,
            ball: ball.into(),
            pose: Pose::from_translation(lift * DVec3::Z),
        })
    }
}

impl CellScene {
    /// Of a cell with this pitch and stroke, metres.
    pub fn new(cell: &StabilityCell, pitch: f64, stroke: f64) -> Result<Self> {
        let undamped = Taxel {
            radius: 0.5 * pitch,
            stiffness: cell.stiffness_n_per_m,
            damping: 0.0,
            stroke,
        };
        let cradle = Cradle::new(cell.taxels, pitch, undamped)?;
        match cell.object_mass_kg {
            Some(mass) => Self::of_free(cell, cradle, undamped, mass, pitch),
            None => Self::of_imposed(cell, cradle, undamped, pitch),
        }
    }

    /// Everything as the methods with mass see it.
    pub fn system(&self, cell: &StabilityCell) -> Result<System<'_>> {
        let Cradle { patch, ball, pose } = &self.cradle;
        let pose = match self.drive {
            Drive::Free { .. } => *pose,
            Drive::Imposed(_) => Pose::from_translation(pose.translation + APPROACH * DVec3::Z),
        };
        let reach = APPROACH + REACH * self.taxel.stroke;
        System::new(
            patch,
            cell.taxel_mass_kg,
            ball,
            pose,
            self.drive.clone(),
            reach,
        )
    }

    fn of_free(
        cell: &StabilityCell,
        cradle: Cradle,
        taxel: Taxel,
        mass: f64,
        pitch: f64,
    ) -> Result<Self> {
        let drive = Drive::Free {
            mass,
            gravity: GRAVITY,
            travel: 0.0,
        };
        let m = cell.taxel_mass_kg;
        let reach = REACH * taxel.stroke;
        let system = System::new(
            &cradle.patch,
            m,
            &cradle.ball,
            cradle.pose,
            drive.clone(),
            reach,
        )?;
        let rest = rest(&system).expect("a free ball over taxels comes to rest");
        let n_touched = rest.deflection.iter().filter(|d| **d > 0.0).count();
        // What each taxel has to move, itself included.
        let share = mass / n_touched as f64 + m;
        let (damping, end) = free(cell, share);
        let taxel = Taxel { damping, ..taxel };
        Ok(Self {
            cradle: Cradle::new(cell.taxels, pitch, taxel)?,
            truth: Truth {
                heaviest: heaviest(&taxel, &rest),
                deflection: rest.deflection,
                force: mass * GRAVITY,
                n_touched,
            },
            times: Times { judged: end, end },
            // It begins with none, and all that it gains by falling goes into springs and dampers.
            energy_limit: mass * GRAVITY * taxel.stroke,
            taxel,
            drive,
        })
    }

    fn of_imposed(cell: &StabilityCell, cradle: Cradle, taxel: Taxel, pitch: f64) -> Result<Self> {
        let (k, m) = (taxel.stiffness, cell.taxel_mass_kg);
        let (damping, hold) = imposed(cell, k, m);
        let depth = 0.5 * taxel.stroke;
        let way = (APPROACH + depth) / SPEED;
        let phase = |duration, speed| Phase {
            duration,
            linear: speed * DVec3::Z,
            angular: DVec3::ZERO,
        };
        let high = Pose::from_translation(cradle.pose.translation + APPROACH * DVec3::Z);
        let phases = vec![phase(way, -SPEED), phase(hold, 0.0), phase(way, SPEED)];
        let drive = Drive::Imposed(VelocityPlan::new(high, phases)?);
        let taxel = Taxel { damping, ..taxel };
        let cradle = Cradle::new(cell.taxels, pitch, taxel)?;
        let reach = APPROACH + REACH * taxel.stroke;
        let system = System::new(&cradle.patch, m, &cradle.ball, high, drive.clone(), reach)?;
        let deepest = APPROACH + depth;
        let deflection = system
            .starts()
            .iter()
            .map(|start| (deepest - start).max(0.0));
        let deflection: Vec<f64> = deflection.collect();
        let springs: f64 = deflection.iter().sum();
        // What springs hold at the deepest, and what taxels have that are hit at twice the speed: four times that.
        let n_taxels = deflection.len() as f64;
        let most = 0.5 * n_taxels * (k * depth * depth + m * (2.0 * SPEED).powi(2));
        Ok(Self {
            truth: Truth {
                force: k * springs,
                heaviest: k * depth,
                n_touched: deflection.iter().filter(|d| **d > 0.0).count(),
                deflection,
            },
            times: Times {
                judged: way + hold,
                end: way + hold + way + hold,
            },
            energy_limit: 4.0 * most,
            cradle,
            taxel,
            drive,
        })
    }
}

/// The damping of a taxel that has so much mass to move, and when its ball is at rest, N s/m and seconds.
fn free(cell: &StabilityCell, share: f64) -> (f64, f64) {
    let k = cell.stiffness_n_per_m;
    let damping = match cell.scene {
        StabilityScene::Plunger => k * skin_sim::DAMPING / skin_sim::STIFFNESS,
        _ => 2.0 * (k * share).sqrt(),
    };
    let end = LEAST_TIME
        .max(DECAY / slowest(k, damping, share))
        .max(LEAST_STEPS * cell.dt_s);
    (damping, end)
}

/// The damping of a taxel under an imposed ball, and how long that holds, N s/m and seconds.
fn imposed(cell: &StabilityCell, k: f64, m: f64) -> (f64, f64) {
    let ratio = skin_sim::DAMPING / (2.0 * (skin_sim::STIFFNESS * skin_sim::TAXEL_MASS).sqrt());
    let damping = 2.0 * ratio * (k * m).sqrt();
    let hold = LEAST_HOLD
        .max(DECAY / slowest(k, damping, m))
        .max(LEAST_HOLD_STEPS * cell.dt_s);
    (damping, hold)
}

/// The taxels that are in as far as any share what the stops carry.
fn heaviest(taxel: &Taxel, rest: &Rest) -> f64 {
    let deepest = rest.deflection.iter().copied().fold(0.0, f64::max);
    let are_there = rest
        .deflection
        .iter()
        .filter(|&&d| d >= deepest * (1.0 - 1e-9));
    taxel.stiffness * deepest + rest.stops / are_there.count() as f64
}

/// The rate of decay of the slower motion of `m ẍ + c ẋ + k x = 0`, per second.
fn slowest(k: f64, c: f64, m: f64) -> f64 {
    let half = 0.5 * c / m;
    let inside = half * half - k / m;
    if inside > 0.0 {
        // Without cancellation: k/m over the faster rate.
        (k / m) / (half + inside.sqrt())
    } else {
        half
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinds::stability::ContactMethod;

    #[test]
    fn the_ball_meets_the_innermost_taxels_where_it_starts_and_all_within_a_quarter_of_the_stroke()
    {
        for taxels in [2, 8, 16] {
            let cell = StabilityCell {
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
            let scene = CellScene::new(&cell, 4e-3, 2e-3).unwrap();
            let system = scene.system(&cell).unwrap();
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
