//! Simulation of the time steps along an object's path, with measured computing times.

use crate::studies::prelude::*;
use crate::studies::whole_body::drive::{Drive, FORGOTTEN};
use crate::studies::whole_body::plan::*;
use crate::studies::whole_body::recognition::Compression;
use crate::studies::whole_body::rows::*;
use crate::whole_body::BodyContact;
use glam::DVec3;
use ndarray::ArrayView2;
use std::time::Instant;

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
