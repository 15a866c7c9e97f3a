//! What a study will take: cells, touches, memory and time, told before it runs.

mod learning;
mod measuring;
mod touching;

pub(super) use learning::{Learning, family_s, learning};
pub(super) use measuring::measure_s;
pub(super) use touching::{PLACE_SPHERE_S, PLACE_TRIANGLE_S, touch_s};

use super::memory::{Bytes, MemoryPlan};
use super::plan::Plan;
use super::sweep::{Group, Sweep};
use super::touch_set::TouchSet;
use crate::spelling::counted;
use std::fmt;

/// Counts, and an estimate of memory and time.
///
/// Times come from rates measured on one core of a 2-core x86-64 server (see the constants of each part); another machine, or touches
/// that are hard to tell apart, can be a few times faster or slower.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Objects to tell apart.
    pub n_objects: usize,
    /// Touches, all objects.
    pub n_touches: usize,
    /// Arrays, each of which makes all touches.
    pub n_arrays: usize,
    /// Cells of the sweep.
    pub n_cells: usize,
    /// Repetitions of each cell.
    pub n_trials: usize,
    /// Fits of one trial, those of a choice of C and γ not counted; cells that differ in how many touches are fused share
    /// one.
    pub n_fits: usize,
    /// Most bytes held at once.
    pub memory_bytes: f64,
    /// Seconds to make all touches, one core.
    pub simulate_s: f64,
    /// Seconds to read and project all frames, one core.
    pub measure_s: f64,
    /// Seconds to fit and predict all cells, one core.
    pub recognise_s: f64,
    /// Threads that will share the work.
    pub n_threads: usize,
}

impl Estimate {
    /// Estimates a study that is laid out.
    pub fn new(plan: &Plan, touched: &dyn TouchSet, sweep: &Sweep, memory: &MemoryPlan) -> Self {
        let n_touches = sweep.labels.len();
        let n_threads = rayon::current_num_threads();
        let n_trials = plan.spec.trials;
        let frames = || plan.frames.iter();
        let arrays = plan.arrays.iter();
        let simulate_s =
            arrays.flat_map(|patch| frames().map(|&n| touch_s(patch, touched, n_touches, n)));
        let read_s = |g: &Group| -> f64 {
            let projected = g.projected().into_iter();
            projected.map(|m| measure_s(plan, g, n_touches, m)).sum()
        };
        let families = || sweep.groups.iter().flat_map(Group::families);
        let n_objects = touched.class_names().len();
        let recognise_s = families().map(|family| family_s(plan, family, n_objects, n_touches));
        Self {
            n_objects,
            n_touches,
            n_arrays: plan.arrays.len(),
            n_cells: sweep.n_cells(),
            n_trials,
            n_fits: families().flat_map(Group::fits).count(),
            memory_bytes: memory.most_bytes,
            simulate_s: simulate_s.sum(),
            measure_s: n_trials as f64 * sweep.groups.iter().map(read_s).sum::<f64>(),
            recognise_s: n_trials as f64 * recognise_s.sum::<f64>(),
            n_threads,
        }
    }

    /// Seconds until the study is done, with all its threads.
    pub fn wall_s(&self) -> f64 {
        (self.simulate_s + self.measure_s + self.recognise_s) / self.n_threads as f64
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "  objects  {}", self.n_objects)?;
        writeln!(
            f,
            "  touches  {} on {}",
            self.n_touches,
            match self.n_arrays {
                1 => "one array".to_owned(),
                n => format!("each of {n} arrays"),
            }
        )?;
        writeln!(
            f,
            "  cells    {} × {} = {}",
            self.n_cells,
            counted(self.n_trials, "trial"),
            match (self.n_cells * self.n_trials, self.n_fits * self.n_trials) {
                (results, fits) if results == fits => counted(fits, "fit"),
                (results, fits) =>
                    format!("{} of {}", counted(results, "result"), counted(fits, "fit")),
            }
        )?;
        writeln!(f, "  memory   at most {}", Bytes(self.memory_bytes))?;
        write!(
            f,
            "  time     about {} on {} (one core: touch {}, measure {}, recognise {})",
            Seconds(self.wall_s()),
            counted(self.n_threads, "thread"),
            Seconds(self.simulate_s),
            Seconds(self.measure_s),
            Seconds(self.recognise_s)
        )
    }
}

/// Seconds in words.
pub(super) struct Seconds(pub f64);

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.0 {
            s if s < 1.0 => write!(f, "1 s"),
            s if s < 100.0 => write!(f, "{s:.0} s"),
            s if s < 6000.0 => write!(f, "{:.0} min", s / 60.0),
            s => write!(f, "{:.1} h", s / 3600.0),
        }
    }
}
