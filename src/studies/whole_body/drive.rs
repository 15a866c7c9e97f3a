//! Objects that move over the skin of a robot: their models, their paths, the search for the first contact, and the steps with their computing times.

use crate::inputs::objects_spec::ModelSpec;
use crate::objects::{Catalogue, Sphere, SphereUnion, pack};
use crate::scene::Reader;
use crate::studies::prelude::*;
use crate::studies::whole_body::plan::*;
use crate::studies::whole_body::recognition::Compression;
use crate::studies::whole_body::rows::*;
use crate::whole_body::{BodyContact, BodyState, SphereClusters, WholeBody};
use crate::world::Oscillation;
use glam::DVec3;
use ndarray::ArrayView2;
use std::time::Instant;

/// Duration of a time step that is long enough for a damped taxel without contact to return to its rest position, seconds. The value is longer than any
/// relaxation.
pub(super) const FORGOTTEN: f64 = 1e9;
/// Distance that the object moves between two tests for contact in the search for the first contact, metres. Bisection then refines the contact to
/// `SEARCH_END`.
const SEARCH_STEP: f64 = 1e-3;
/// Width of the bisection interval at which the search for the first contact ends, metres.
const SEARCH_END: f64 = 1e-7;
/// Distance between the target and the point at which the search for the first contact starts, metres. The size of the object is added to it.
const SEARCH_START: f64 = 0.05;

/// Robot that is covered with skin, in a given posture, with the poses of its patches and links.
pub(super) struct Posture<'a> {
    pub body: &'a WholeBody,
    /// Pose of each patch in the world, `world_from_patch`.
    pub patches: Vec<Pose>,
    /// Pose of each link in the world, `world_from_link`.
    pub links: Vec<Pose>,
}

/// Motion of an object over the skin, in the frame of a robot link.
#[derive(Clone, Copy)]
pub(super) struct Path {
    /// Pose of the link in the world, `world_from_link`.
    pub world_from_link: Pose,
    /// Motion of the object in the frame of the link.
    pub motion: Oscillation,
}

impl Path {
    /// Returns the pose `world_from_object` at a time, seconds.
    pub fn at(&self, time: f64) -> Pose {
        self.world_from_link.compose(&self.motion.pose_at(time))
    }

    /// Returns the path with its start shifted by the vector `by`, metres, in the frame of the link.
    pub fn shifted(&self, by: DVec3) -> Self {
        let start = self.motion.start;
        self.starting_at(Pose::new(start.rotation, start.translation + by))
    }

    /// Returns a copy of the path with a different initial pose of the object, `link_from_object`.
    pub fn starting_at(&self, start: Pose) -> Self {
        Self {
            motion: Oscillation {
                start,
                ..self.motion
            },
            ..*self
        }
    }
}

/// Object that moves along a path over the skin of a robot.
pub(super) struct Drive<'a> {
    pub body: &'a WholeBody,
    pub state: BodyState,
    pub object: [SphereClusters; 1],
    pub path: Path,
}

impl<'a> Drive<'a> {
    pub fn new(posture: &Posture<'a>, object: &SphereUnion, aim: &Aim) -> Result<Self> {
        let mut state = BodyState::at_rest(posture.body);
        state.place(posture.body, &posture.patches)?;
        Ok(Self {
            body: posture.body,
            state,
            object: [SphereClusters::new(object)],
            path: Path {
                world_from_link: posture.links[aim.link],
                motion: aim.motion,
            },
        })
    }

    /// Presses the object against the undeformed skin at the start of a path.
    pub fn probe(&mut self, path: Path) -> Result<BodyContact> {
        let pose = [path.at(0.0)];
        self.state.press(self.body, &self.object, &pose, FORGOTTEN)
    }

    /// Returns the numbers of the taxels that the last press touched, and their deflections in metres.
    pub fn touched(&self) -> impl Iterator<Item = (usize, f64)> {
        self.state.touched(self.body)
    }

    /// Moves the start of the path in the direction of the unit vector `from`, away from the skin. At the new start, the object is `depth` metres past the
    /// first contact.
    pub fn approach(&mut self, from: DVec3, depth: f64) -> Result<()> {
        let reach = self.object[0].ball().radius + self.object[0].ball().center.length();
        let path = self.path;
        let mut is_touched = |away: f64| -> Result<bool> {
            Ok(self.probe(path.shifted(away * from))?.n_touched > 0)
        };
        let mut outside = reach + SEARCH_START;
        while !is_touched(outside - SEARCH_STEP)? {
            outside -= SEARCH_STEP;
            if outside < -reach {
                let allowed = "a place and a direction from which the object meets the skin";
                return Err(Error::input("approach", "no contact", allowed));
            }
        }
        let mut inside = outside - SEARCH_STEP;
        while outside - inside > SEARCH_END {
            let middle = 0.5 * (outside + inside);
            match is_touched(middle)? {
                true => inside = middle,
                false => outside = middle,
            }
        }
        self.path = path.shifted((inside - depth) * from);
        Ok(())
    }
}

/// Returns the object of a scene as a union of spheres, metres, in the frame of the object.
pub(super) fn of_scene(plan: &WholeBodyPlan, scene: &ScenePlan) -> Result<SphereUnion> {
    let reader = Reader::new(&plan.place, &plan.folder);
    let mut spec = scene.spec.object.clone();
    let model = spec.model.unwrap_or(ModelSpec::Packed);
    let is_packed = spec.spheres.is_none() && (spec.mesh.is_none() || model == ModelSpec::Packed);
    if is_packed && spec.surface_error_mm.is_none() {
        spec.surface_error_mm = Some(plan.spec.whole_body.surface_error_mm);
    }
    let key = format!("objects.{}", spec.name);
    match reader.model(&key, &spec, millimetres(plan.pitch), model)? {
        Model::Spheres(spheres) => Ok(spheres),
        Model::Mesh(_) => {
            let given = "exact contact with triangles";
            let allowed = "model = \"packed\" or \"vertex_spheres\" on a whole body";
            Err(reader.check.error(&format!("{key}.model"), given, allowed))
        }
    }
}

/// Returns a built-in object as a union of spheres, metres; the centre of its bounding box is the origin. The spheres
/// deviate from the surface of the object by at most `surface_error` metres.
pub(super) fn built_in(name: &str, surface_error: f64) -> Result<SphereUnion> {
    let solid = Catalogue::builtin()?.object(name)?.solid.clone();
    let middle = solid.bounds().center();
    let solid = solid.moved(&Pose::from_translation(-middle));
    pack(&solid, surface_error)
}

/// Radius of the spheres that form a cushion (a square of spheres), divided by the distance between neighbouring spheres. With a larger radius, more spheres
/// touch each taxel.
const SPHERE_RADIUS: f64 = 3.0;
/// Golden ratio; its multiples modulo 1 spread any number of points evenly over a square.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Returns a cushion: a square of `n` spheres with side length `side`, metres, bent around a cylinder about z, with its centre at +x. One half of the spheres
/// touch the cylinder (radius `cylinder`, metres) from outside. The other half lie farther out by half a side length.
pub(super) fn cushion(n: usize, side: f64, cylinder: f64) -> Result<SphereUnion> {
    let n_inside = n.div_ceil(2);
    let radius = SPHERE_RADIUS * side / (n_inside as f64).sqrt();
    let sheet = |n: usize, away: f64| {
        (0..n).map(move |k| {
            let around = ((k as f64 * GOLDEN).fract() - 0.5) * side / cylinder;
            let along = ((k as f64 + 0.5) / n as f64 - 0.5) * side;
            let (sin, cos) = around.sin_cos();
            Sphere {
                center: DVec3::new(away * cos, away * sin, along),
                radius,
            }
        })
    };
    let inside = sheet(n_inside, cylinder + radius);
    let outside = sheet(n - n_inside, cylinder + radius + 0.5 * side);
    SphereUnion::new(inside.chain(outside).collect())
}

/// Number of steps that are simulated before times are measured, so that memory is allocated and caches are filled.
const WARM_UP: usize = 20;

/// Result of simulating one step of the skin.
struct Step {
    contact: BodyContact,
    n_visited: usize,
    /// Sum of the deflections of all taxels in a step, metres.
    deflection: f64,
    press_s: f64,
}

/// Measurements and decision of one step.
struct SensedStep {
    /// Sum of the absolute values of all measurements, metres.
    size: f64,
    label: usize,
    compress_s: f64,
    classify_s: f64,
}

impl Drive<'_> {
    /// Simulates the steps along a path and measures their times, after some untimed steps. If a step may use several threads, the path is simulated a second
    /// time on one thread.
    pub fn run(
        &mut self,
        plan: &WholeBodyPlan,
        (series, name): (Series, &str),
        compressions: &[Compression],
    ) -> Result<Driven> {
        let case = BodyCase {
            series,
            name: name.to_owned(),
            n_taxels: self.body.n_taxels(),
            n_patches: self.body.patches().len(),
            n_spheres: self.object[0].n_spheres(),
        };
        // Runs within the pool, so that steps are not transferred to it one by one.
        let mut driven = rayon::scope(|_| self.walk(plan, case.clone(), compressions))?;
        if rayon::current_num_threads() > 1 {
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
            let alone = alone.expect("a thread can be had");
            // All parts of a step are repeated, so that the caches are in the same state.
            let alone = alone.install(|| self.walk(plan, case, compressions))?;
            driven.times.push(alone.times[0].clone());
        }
        Ok(driven)
    }

    fn walk(
        &mut self,
        plan: &WholeBodyPlan,
        case: BodyCase,
        compressions: &[Compression],
    ) -> Result<Driven> {
        let n_steps = WARM_UP + plan.spec.whole_body.steps;
        let away = [Pose::from_translation(DVec3::splat(1e6))];
        self.state
            .press(self.body, &self.object, &away, FORGOTTEN)?;
        let n_bytes = self.body.n_bytes() + self.state.n_bytes();
        let mut steps = Vec::with_capacity(n_steps);
        let of_each = compressions.iter();
        let of_each = of_each.map(|of| {
            let row = vec![0.0; of.columns.n_measurements()];
            (row, Vec::with_capacity(n_steps))
        });
        let mut sensed: Vec<(Vec<f64>, Vec<SensedStep>)> = of_each.collect();
        for step in 0..n_steps {
            let pose = [self.path.at(step as f64 * plan.dt)];
            let start = Instant::now();
            let contact = self.state.press(self.body, &self.object, &pose, plan.dt)?;
            steps.push(Step {
                press_s: start.elapsed().as_secs_f64(),
                contact,
                n_visited: self.state.n_visited(),
                deflection: self.state.total_deflection(self.body),
            });
            for (compression, (row, sensed)) in compressions.iter().zip(&mut sensed) {
                sensed.push(compression.sense(self, row)?);
            }
        }
        let steps = &steps[WARM_UP..];
        let press = steps.iter().map(|step| step.press_s);
        let mut times = vec![time(StepPart::Press, "", press.clone())];
        let mut decided = Vec::new();
        for (compression, (_, sensed)) in compressions.iter().zip(&sensed) {
            let sensed = &sensed[WARM_UP..];
            let name = &compression.score.compression;
            let whole = press.clone().zip(sensed);
            let whole = whole.map(|(press_s, of)| press_s + of.compress_s + of.classify_s);
            let compress = sensed.iter().map(|of| of.compress_s);
            let classify = sensed.iter().map(|of| of.classify_s);
            times.push(time(StepPart::Compress, name, compress));
            times.push(time(StepPart::Classify, name, classify));
            times.push(time(StepPart::Whole, name, whole));
            decided.push(decision(plan, (&case.name, name), sensed));
        }
        Ok(Driven {
            case,
            count: count(steps, n_bytes as f64 / self.body.n_taxels() as f64),
            times,
            sensed: decided,
            n_touched: None,
        })
    }
}

impl Compression {
    /// Computes the measurements and the decision of a step, using `row` as memory for the measurements.
    fn sense(&self, drive: &Drive, row: &mut [f64]) -> Result<SensedStep> {
        let start = Instant::now();
        drive.state.measure(drive.body, &self.columns, row);
        let compress_s = start.elapsed().as_secs_f64();
        let rows = ArrayView2::from_shape((1, row.len()), row).expect("one row");
        let label = self.classifier.labels(rows)?[0];
        let classify_s = start.elapsed().as_secs_f64() - compress_s;
        Ok(SensedStep {
            size: row.iter().map(|y| y.abs()).sum(),
            label,
            compress_s,
            classify_s,
        })
    }
}

fn count(steps: &[Step], bytes_per_taxel: f64) -> BodyCount {
    let mean = |of: fn(&Step) -> usize| {
        let sum: usize = steps.iter().map(of).sum();
        sum as f64 / steps.len() as f64
    };
    let touched = || steps.iter().map(|step| step.contact.n_touched);
    BodyCount {
        n_steps: steps.len(),
        touched_mean: mean(|step| step.contact.n_touched),
        touched_min: touched().min().unwrap_or(0),
        touched_max: touched().max().unwrap_or(0),
        saturated_mean: mean(|step| step.contact.n_saturated),
        patches_visited_mean: mean(|step| step.n_visited),
        patches_touched_mean: mean(|step| step.contact.n_patches),
        spheres_evaluated_mean: mean(|step| step.contact.n_evaluated),
        spheres_rejected_mean: mean(|step| step.contact.n_rejected),
        // The sum starts at 0, because an empty sum would be −0.
        deflection_sum_mm: millimetres(steps.iter().fold(0.0, |sum, step| sum + step.deflection)),
        bytes_per_taxel,
    }
}

/// Returns the decision that is most frequent over the steps of a scene; if two are equally frequent, the object that comes first.
fn decision(
    plan: &WholeBodyPlan,
    (scene, compression): (&str, &str),
    steps: &[SensedStep],
) -> BodySensed {
    let objects = &plan.recognition().objects;
    let votes = |label: usize| steps.iter().filter(|step| step.label == label).count();
    // In a tie the first object wins.
    let most = (0..objects.len()).rev().max_by_key(|&label| votes(label));
    let label = most.unwrap_or(0);
    BodySensed {
        scene: scene.to_owned(),
        compression: compression.to_owned(),
        measurement_sum_mm: millimetres(steps.iter().map(|step| step.size).sum()),
        decision: objects[label].clone(),
        decision_fraction: votes(label) as f64 / steps.len() as f64,
    }
}

fn time(
    stage: StepPart,
    compression: &str,
    seconds: impl Iterator<Item = f64>,
) -> (BodyStage, StepTime) {
    let mut us: Vec<f64> = seconds.map(|seconds| 1e6 * seconds).collect();
    let [us_median, us_p05, us_p95] = [0.5, 0.05, 0.95].map(|part| quantile(&mut us, part));
    let stage = BodyStage {
        stage,
        compression: compression.to_owned(),
        n_threads: rayon::current_num_threads(),
    };
    let time = StepTime {
        us_median,
        us_p05,
        us_p95,
        steps_per_s: 1e6 / us_median,
    };
    (stage, time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_spheres_of_a_cushion_touch_the_cylinder_evenly() {
        let (side, cylinder) = (0.1, 0.08);
        let union = cushion(2000, side, cylinder).unwrap();
        assert_eq!(union.n_spheres(), 2000);
        let mut quarters = [0; 16];
        for sphere in &union.spheres()[..1000] {
            let away = sphere.center.truncate().length();
            assert!((away - sphere.radius - cylinder).abs() < 1e-12);
            let angle = sphere.center.y.atan2(sphere.center.x);
            let places =
                [angle * cylinder, sphere.center.z].map(|at| (4.0 * (at / side + 0.5)) as usize);
            quarters[4 * places[0] + places[1]] += 1;
        }
        assert!(
            quarters.iter().all(|n| (58..68).contains(n)),
            "{quarters:?}"
        );
    }
}
