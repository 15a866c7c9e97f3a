//! The work of a run in planned processor-seconds: what a listener needs to say how long it still takes.

use super::estimate::{family_s, touch_s};
use super::plan::Plan;
use super::progress::{Progress, Silent};
use super::runner::{Manner, Run};
use super::sweep::Sweep;
use super::table::Cell;
use super::time_left::Work;
use super::touch_set::TouchSet;
use crate::world::Patch;
use std::sync::Mutex;
use std::time::Instant;

/// What [`run_with`](super::run_with) will do: for [`Progress::expect`]. What a journal has is not done again.
pub fn workload(
    plan: &Plan,
    sweep: &Sweep,
    touched: &dyn TouchSet,
    manner: Manner,
) -> Vec<(Work, f64)> {
    let run = Run {
        plan,
        sweep,
        touched,
        progress: &Silent,
        manner,
    };
    let n_touches = sweep.labels.len();
    let mut work = Vec::new();
    for (array, patch) in plan.arrays.iter().enumerate() {
        for &n_frames in &plan.frames {
            let jobs = run.jobs(array, n_frames);
            if jobs.is_empty() {
                continue;
            }
            work.push((Work::Touch, touch_s(patch, touched, n_touches, n_frames)));
            for job in &jobs {
                for (n_measurements, families) in job.batches() {
                    work.push((Work::Measure, job.measuring_s(n_measurements)));
                    work.extend(families.into_iter().map(|family| run.learning(family)));
                }
            }
        }
    }
    work
}

impl Run<'_> {
    /// A family in one trial, as work.
    pub fn learning(&self, family: &[Cell]) -> (Work, f64) {
        let n_objects = self.touched.class_names().len();
        let planned_s = family_s(self.plan, family, n_objects, self.sweep.labels.len());
        (Work::Learn(family[0].classifier), planned_s)
    }
}

/// Tells touches as they are made, and what they were planned to take and took: all threads make them.
pub struct TouchMeter<'a> {
    progress: &'a dyn Progress,
    planned_s: f64,
    told: Mutex<Instant>,
}

impl<'a> TouchMeter<'a> {
    /// For all touches on an array.
    pub fn new(run: &Run<'a>, patch: &Patch, n_frames: usize) -> Self {
        let n_touches = run.sweep.labels.len();
        let all_s = touch_s(patch, run.touched, n_touches, n_frames);
        Self {
            progress: run.progress,
            planned_s: all_s / n_touches.max(1) as f64,
            told: Mutex::new(Instant::now()),
        }
    }
}

impl Progress for TouchMeter<'_> {
    fn stage(&self, name: &str, total: u64) {
        self.progress.stage(name, total);
    }

    fn advance(&self, n: u64) {
        self.progress.advance(n);
        if let Ok(mut told) = self.told.lock() {
            let took_s = told.elapsed().as_secs_f64() * rayon::current_num_threads() as f64;
            *told = Instant::now();
            self.progress
                .worked(Work::Touch, n as f64 * self.planned_s, took_s);
        }
    }

    fn finish(&self, message: &str) {
        self.progress.finish(message);
    }
}
