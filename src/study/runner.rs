//! Runs a plan: simulate each array once, measure each group once a trial, evaluate every cell that is not done yet.

use super::finished::{Finished, Measuring, Simulated};
use super::frames::{FrameStorage, Frames, KeyedTouches};
use super::job::{FinishedCell, Job};
use super::journal::Journal;
use super::memory::AtOnce;
use super::part::{Part, pieces, with_what_was_done_before};
use super::plan::{Plan, millimetres};
use super::progress::Progress;
use super::published::compare_with_published;
use super::spec::StepSpec;
use super::sweep::{Group, Sweep};
use super::table::{Cell, StageTime, Tables};
use super::tabulate::tabulate;
use super::touch_set::TouchSet;
use super::workload::TouchMeter;
use crate::error::Result;
use crate::random::Seed;
use crate::signal::{Noise, SignalStep};
use crate::world::Patch;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What a study found.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// All tables.
    pub tables: Tables,
    /// What happened while the touches of each array were made.
    pub arrays: Vec<ArrayOutcome>,
    /// Cells, counted once a trial, that nobody has evaluated: those of other shards.
    pub n_left: usize,
}

/// What happened while the touches of an array were made.
#[derive(Clone, Debug, PartialEq)]
pub struct ArrayOutcome {
    /// The array.
    pub patch: Patch,
    /// How many touches.
    pub n_touches: usize,
    /// Touches that met nothing.
    pub n_missed: usize,
    /// Touches with at least one taxel at its stroke.
    pub n_saturated: usize,
}

/// How a run goes about its cells.
#[derive(Clone, Copy)]
pub struct Manner<'a> {
    /// Where finished work is looked for and kept.
    pub journal: &'a Journal,
    /// Whether the first cell that fails ends the run. Else failures are recorded in a table of their own.
    pub fail_fast: bool,
    /// Whether cells that failed in an earlier run are tried again.
    pub retries: bool,
    /// The part of the work to do.
    pub part: Part<'a>,
    /// Where frames come from and are kept.
    pub storage: &'a FrameStorage,
    /// How much of the work is in memory at the same time.
    pub at_once: AtOnce,
}

/// Runs a study. The tables but for times are the same bytes at any number of threads.
///
/// # Errors
/// What a stage refuses: a signal step, a projection, a classifier's parameters.
pub fn run(
    plan: &Plan,
    sweep: &Sweep,
    touched: &dyn TouchSet,
    progress: &dyn Progress,
) -> Result<Outcome> {
    let manner = Manner {
        journal: &Journal::none(),
        fail_fast: true,
        retries: false,
        part: Part::All,
        storage: &FrameStorage::in_memory(),
        at_once: AtOnce::ALL,
    };
    run_with(plan, sweep, touched, progress, manner)
}

/// Runs what a journal has not yet of a study. The tables but for times are the same bytes as if it had run at once.
///
/// # Errors
/// The journal cannot be written; what a stage refuses, if the first cell that fails ends the run.
pub fn run_with(
    plan: &Plan,
    sweep: &Sweep,
    touched: &dyn TouchSet,
    progress: &dyn Progress,
    manner: Manner,
) -> Result<Outcome> {
    let run = Run {
        plan,
        sweep,
        touched,
        keyed: &KeyedTouches::new(touched),
        progress,
        manner,
    };
    let mut tables = Tables::default();
    let mut arrays = Vec::new();
    let mut new = Vec::new();
    let mut jobs = run.jobs();
    for array in 0..plan.arrays.len() {
        let mut on_array: Vec<Option<OnArray>> = plan.frames.iter().map(|_| None).collect();
        for place in costliest_first(&plan.frames) {
            let n_frames = plan.frames[place];
            let jobs = jobs.remove(&(array, n_frames)).unwrap_or_default();
            on_array[place] = run.on_array(&plan.arrays[array], n_frames, &jobs)?;
        }
        for (place, found) in on_array.into_iter().enumerate() {
            let Some((simulated, finished, stages)) = found else {
                continue;
            };
            new.extend(finished);
            tables.stages.extend(stages);
            // The deepest frame is the same however many come before it.
            if place == 0 {
                arrays.push(ArrayOutcome {
                    patch: plan.arrays[array],
                    n_touches: sweep.labels.len(),
                    n_missed: simulated.n_missed,
                    n_saturated: simulated.n_saturated,
                });
            }
        }
    }
    let (finished, n_left) = with_what_was_done_before(plan, sweep, manner.journal, new);
    tabulate(&mut tables, finished, &touched.class_names())?;
    let published = &plan.spec.report.published;
    tables.published = compare_with_published(published, &tables.summary);
    Ok(Outcome {
        tables,
        arrays,
        n_left,
    })
}

/// The places of numbers of frames, most frames first: what learns from them takes longest, and how much longer than planned is
/// then known early.
fn costliest_first(frames: &[usize]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..frames.len()).collect();
    places.sort_by_key(|&place| std::cmp::Reverse(frames[place]));
    places
}

/// What every job of a run shares.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    pub plan: &'a Plan,
    pub sweep: &'a Sweep,
    pub touched: &'a dyn TouchSet,
    /// The same with their key.
    pub keyed: &'a KeyedTouches<'a>,
    pub progress: &'a dyn Progress,
    pub manner: Manner<'a>,
}

/// What came of an array: its touches, its cells, and what they cost.
type OnArray<'a> = (Simulated, Vec<FinishedCell<'a>>, [StageTime; 2]);

impl<'a> Run<'a> {
    /// Does what is to be done on an array read in so many frames a touch; `None` if it is another shard's.
    fn on_array(
        &self,
        patch: &Patch,
        n_frames: usize,
        jobs: &[Job<'a>],
    ) -> Result<Option<OnArray<'a>>> {
        let journal = self.manner.journal;
        let known = Simulated::in_journal(journal, patch, n_frames);
        let is_all = matches!(self.manner.part, Part::All);
        if jobs.is_empty() && known.is_none() && !is_all {
            return Ok(None);
        }
        let (simulated, finished, measuring) = match known {
            Some(known) if jobs.is_empty() => (known, Vec::new(), Measuring::default()),
            _ => self.evaluate(patch, n_frames, jobs)?,
        };
        let measuring = measuring.kept_with_earlier(journal, patch, n_frames)?;
        let stages = [
            ("simulate", self.sweep.labels.len(), simulated.cpu_s),
            ("measure", measuring.n_measured, measuring.cpu_s),
        ];
        let stages = stages.map(|(name, n_touches, cpu_s)| {
            stage_time(&in_frames(name, n_frames), patch, n_touches, cpu_s)
        });
        Ok(Some((simulated, finished, stages)))
    }

    /// Makes the touches of an array and evaluates jobs on them.
    fn evaluate(
        &self,
        patch: &Patch,
        n_frames: usize,
        jobs: &[Job<'a>],
    ) -> Result<(Simulated, Vec<FinishedCell<'a>>, Measuring)> {
        let n_touches = self.sweep.labels.len();
        let name = in_frames(&format!("touch {}", describe(patch)), n_frames);
        self.progress.stage(&name, n_touches as u64);
        let storage = self.manner.storage;
        let meter = TouchMeter::new(self, patch, n_frames);
        let frames = storage.frames(self.keyed, (patch, n_frames), &meter)?;
        let simulated = Simulated {
            n_missed: frames.facts.n_missed,
            n_saturated: frames.facts.n_saturated,
            cpu_s: frames.facts.cpu_s,
        };
        simulated.keep(self.manner.journal, patch, n_frames)?;
        let (finished, cpu_s) = self.recognise(jobs, patch, &frames)?;
        let measuring = Measuring {
            n_measured: jobs.len() * n_touches,
            cpu_s,
        };
        Ok((simulated, finished, measuring))
    }

    /// Families that are to be done, by trial and group, of each array and number of frames.
    pub fn jobs(&self) -> BTreeMap<(usize, usize), Vec<Job<'a>>> {
        let mut jobs: BTreeMap<_, Vec<Job>> = BTreeMap::new();
        for (group, trial, families) in pieces(self.plan, self.sweep, self.manner.part) {
            let is_left = |family: &&[Cell]| {
                let work = (*family, trial);
                let before = Finished::in_journal(self.manner.journal, self.plan, work);
                before.iter().any(|before| match before {
                    None => true,
                    Some(Finished::Failed(_)) => self.manner.retries,
                    Some(Finished::Scored(_)) => false,
                })
            };
            let families: Vec<&[Cell]> = families.into_iter().filter(is_left).collect();
            if !families.is_empty() {
                let of_array = jobs.entry((group.array, group.frames)).or_default();
                of_array.push(Job {
                    run: *self,
                    group,
                    trial,
                    families,
                });
            }
        }
        jobs
    }

    /// Evaluates jobs; with what came of them the processor-seconds of measuring.
    fn recognise(
        &self,
        jobs: &[Job<'a>],
        patch: &Patch,
        frames: &Frames,
    ) -> Result<(Vec<FinishedCell<'a>>, f64)> {
        if jobs.is_empty() {
            return Ok((Vec::new(), 0.0));
        }
        let families = jobs.iter().flat_map(|job| &job.families);
        let n_fits: usize = families.map(|family| family.len()).sum();
        let stage = in_frames(
            &format!("recognise {}", describe(patch)),
            frames.facts.n_frames,
        );
        self.progress.stage(&stage, n_fits as u64);
        let mut results = Vec::with_capacity(jobs.len());
        for jobs in jobs.chunks(self.manner.at_once.jobs) {
            let jobs = jobs.par_iter().map(|job| job.run(frames));
            results.extend(jobs.collect::<Result<Vec<_>>>()?);
        }
        let measure_s = results.iter().map(|(_, seconds)| seconds).sum();
        Ok((
            results
                .into_iter()
                .flat_map(|(finished, _)| finished)
                .collect(),
            measure_s,
        ))
    }
}

/// The study's steps in this group's condition, on a skin.
pub fn signal_steps(plan: &Plan, group: &Group, skin: &Seed) -> Vec<SignalStep> {
    let condition = &group.condition;
    let step = |&step: &StepSpec| match step {
        StepSpec::Force => SignalStep::Force,
        StepSpec::Noise => SignalStep::Noise(Noise {
            std: condition.noise,
            unit: plan.noise_unit,
        }),
        StepSpec::Smoothing => SignalStep::Smoothing {
            width: condition.smoothing,
        },
        StepSpec::Error(error) => condition.strengths.step(error, skin),
    };
    plan.steps.iter().map(step).collect()
}

/// An array in words: `64×64 at 2 mm`.
pub fn describe(patch: &Patch) -> String {
    let grid = &patch.grid;
    format!("{}×{} at {} mm", grid.nx, grid.ny, millimetres(grid.pitch))
}

/// A stage's name, with the number of frames a touch where it is not one.
fn in_frames(stage: &str, n_frames: usize) -> String {
    match n_frames {
        1 => stage.to_owned(),
        n => format!("{stage}, {n} frames a touch"),
    }
}

fn stage_time(stage: &str, patch: &Patch, n_touches: usize, cpu_s: f64) -> StageTime {
    StageTime {
        stage: stage.to_owned(),
        pitch_mm: millimetres(patch.grid.pitch),
        nx: patch.grid.nx,
        ny: patch.grid.ny,
        n_touches,
        cpu_s,
        us_per_touch: 1e6 * cpu_s / n_touches.max(1) as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touches_of_most_frames_are_learned_from_first() {
        assert_eq!(costliest_first(&[1, 4, 2]), [1, 2, 0]);
        assert_eq!(costliest_first(&[]), [0; 0]);
    }
}
