//! The work of a run in planned processor-seconds: what a listener needs to say how long it still takes.

use super::estimate::{family_s, measure_s, touch_s};
use super::frames::KeyedTouches;
use super::job::Job;
use super::plan::Plan;
use super::progress::{Progress, Silent};
use super::runner::{Manner, Run};
use super::sweep::Sweep;
use super::table::Cell;
use super::time_left::{Piece, Work};
use super::touch_set::TouchSet;
use crate::world::Patch;
use std::sync::Mutex;
use std::time::Instant;

/// What [`run_with`](super::run_with) will do: for [`Progress::expect`]. What a journal has is not done again.
pub fn workload(plan: &Plan, sweep: &Sweep, touched: &dyn TouchSet, manner: Manner) -> Vec<Piece> {
    let run = Run {
        plan,
        sweep,
        touched,
        keyed: &KeyedTouches::new(touched),
        progress: &Silent,
        manner,
    };
    let mut work = Vec::new();
    for (array, patch) in plan.arrays.iter().enumerate() {
        for &n_frames in &plan.frames {
            let jobs = run.jobs(array, n_frames);
            if jobs.is_empty() {
                continue;
            }
            work.push(run.touching(patch, n_frames));
            for job in &jobs {
                for (n_measurements, families) in job.batches() {
                    work.push(job.measuring(n_measurements, &families));
                    work.extend(families.into_iter().map(|family| run.learning(family)));
                }
            }
        }
    }
    work
}

impl Run<'_> {
    /// All touches on an array.
    fn touching(&self, patch: &Patch, n_frames: usize) -> Piece {
        let n_touches = self.sweep.labels.len();
        Piece {
            kind: Work::Touch,
            place: n_frames * patch.grid.n_taxels(),
            planned_s: touch_s(patch, self.touched, n_touches, n_frames),
        }
    }

    /// A family in one trial.
    pub fn learning(&self, family: &[Cell]) -> Piece {
        let n_objects = self.touched.class_names().len();
        let n_touches = self.sweep.labels.len();
        Piece {
            kind: Work::Learn(family[0].classifier),
            place: family[0].cell,
            planned_s: family_s(self.plan, family, n_objects, n_touches),
        }
    }
}

impl Job<'_> {
    /// To measure all touches once, for these families.
    pub fn measuring(&self, n_measurements: usize, families: &[&[Cell]]) -> Piece {
        let Run { plan, sweep, .. } = self.run;
        Piece {
            kind: Work::Measure,
            place: families[0][0].cell,
            planned_s: measure_s(plan, self.group, sweep.labels.len(), n_measurements),
        }
    }
}

/// Tells touches as they are made, and what they were planned to take and took: all threads make them.
pub struct TouchMeter<'a> {
    progress: &'a dyn Progress,
    /// One touch.
    piece: Piece,
    told: Mutex<Instant>,
}

impl<'a> TouchMeter<'a> {
    /// For all touches on an array.
    pub fn new(run: &Run<'a>, patch: &Patch, n_frames: usize) -> Self {
        let all = run.touching(patch, n_frames);
        Self {
            progress: run.progress,
            piece: Piece {
                planned_s: all.planned_s / run.sweep.labels.len().max(1) as f64,
                ..all
            },
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
            let planned_s = n as f64 * self.piece.planned_s;
            let piece = Piece {
                planned_s,
                ..self.piece
            };
            self.progress.worked(&piece, took_s);
        }
    }

    fn finish(&self, message: &str) {
        self.progress.finish(message);
    }
}
