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
use std::cell;
use std::sync::Mutex;
use std::time::{Duration, Instant};

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
    let jobs = run.jobs();
    let mut work = Vec::new();
    for (array, patch) in plan.arrays.iter().enumerate() {
        for &n_frames in &plan.frames {
            let Some(jobs) = jobs.get(&(array, n_frames)) else {
                continue;
            };
            work.push(run.touching(patch, n_frames));
            for job in jobs {
                for (n_measurements, families) in job.batches() {
                    work.push(job.measuring(n_measurements));
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
            planned_s: touch_s(patch, self.touched, n_touches, n_frames),
        }
    }

    /// A family in one trial.
    pub fn learning(&self, family: &[Cell]) -> Piece {
        let n_objects = self.touched.class_names().len();
        let n_touches = self.sweep.labels.len();
        Piece {
            kind: Work::Learn(family[0].classifier),
            planned_s: family_s(self.plan, family, n_objects, n_touches),
        }
    }
}

impl Job<'_> {
    /// To measure all touches once, for these families.
    pub fn measuring(&self, n_measurements: usize) -> Piece {
        let Run { plan, sweep, .. } = self.run;
        Piece {
            kind: Work::Measure,
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
            piece: all.share(1.0 / run.sweep.labels.len().max(1) as f64),
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
            self.progress.worked(&self.piece.share(n as f64), took_s);
        }
    }

    fn finish(&self, message: &str) {
        self.progress.finish(message);
    }
}

/// How often a family's fits are told of, at most. What they need first is no share of them, so that one that is told of early seems to
/// take long.
const LEARNING_TOLD_EVERY: Duration = Duration::from_secs(1);

/// Tells the fits of a family as they go on, in shares of what they were planned to take: of one thread.
pub struct LearningMeter<'a> {
    progress: &'a dyn Progress,
    /// The family in one trial.
    piece: Piece,
    /// When it was last told of.
    told: cell::Cell<Instant>,
    told_share: cell::Cell<f64>,
    done_share: cell::Cell<f64>,
}

impl<'a> LearningMeter<'a> {
    /// Of a family that begins.
    pub fn new(run: &Run<'a>, family: &[Cell]) -> Self {
        Self {
            progress: run.progress,
            piece: run.learning(family),
            told: cell::Cell::new(Instant::now()),
            told_share: cell::Cell::new(0.0),
            done_share: cell::Cell::new(0.0),
        }
    }

    /// A further share is done.
    pub fn advance(&self, share: f64) {
        self.done_share.set(self.done_share.get() + share);
        if self.told.get().elapsed() >= LEARNING_TOLD_EVERY {
            self.tell();
        }
    }

    /// All of it is done.
    pub fn finish(self) {
        self.done_share.set(1.0);
        self.tell();
    }

    fn tell(&self) {
        let took_s = self.told.replace(Instant::now()).elapsed().as_secs_f64();
        let done_share = self.done_share.get();
        let share = done_share - self.told_share.replace(done_share);
        self.progress.worked(&self.piece.share(share), took_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Planned and spent seconds, as they are told.
    #[derive(Default)]
    struct Listener(Mutex<Vec<[f64; 2]>>);

    impl Progress for Listener {
        fn stage(&self, _name: &str, _total: u64) {}
        fn advance(&self, _n: u64) {}
        fn finish(&self, _message: &str) {}
        fn worked(&self, piece: &Piece, took_s: f64) {
            self.0.lock().unwrap().push([piece.planned_s, took_s]);
        }
    }

    #[test]
    fn a_fit_is_told_of_now_and_then_and_in_the_end_as_a_whole() {
        let listener = Listener::default();
        let start = Instant::now();
        let meter = LearningMeter {
            progress: &listener,
            piece: Piece::of_stage(0, 8.0),
            told: cell::Cell::new(start),
            told_share: cell::Cell::new(0.0),
            done_share: cell::Cell::new(0.0),
        };
        std::thread::sleep(LEARNING_TOLD_EVERY);
        meter.advance(0.25);
        meter.advance(0.125);
        meter.finish();
        let told = listener.0.into_inner().unwrap();
        let planned_s: Vec<f64> = told.iter().map(|told| told[0]).collect();
        let took_s: f64 = told.iter().map(|told| told[1]).sum();
        assert_eq!(planned_s.iter().sum::<f64>(), 8.0);
        assert_eq!(planned_s[0], 2.0);
        assert!(took_s >= LEARNING_TOLD_EVERY.as_secs_f64());
        assert!(took_s <= start.elapsed().as_secs_f64());
    }
}
