//! Runs a plan: simulate each array once, measure each group once a trial, evaluate every cell.

use super::evaluation::{Evaluation, Trial};
use super::measurement::measure_group;
use super::plan::{Plan, millimetres};
use super::progress::Progress;
use super::published::compare_with_published;
use super::simulation::Frames;
use super::spec::StepSpec;
use super::summary::{compare_with_best, most_confused, pareto, summarise};
use super::sweep::{Group, Sweep};
use super::table::{Cell, Confusion, StageTime, Tables};
use super::touch_set::TouchSet;
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

/// A cell's result in one trial.
struct Scored {
    cell: Cell,
    evaluation: Evaluation,
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
    let mut tables = Tables::default();
    let mut arrays = Vec::new();
    let mut scored = Vec::new();
    for (array, patch) in plan.arrays.iter().enumerate() {
        let n_touches = sweep.labels.len();
        for (place, &n_frames) in plan.frames.iter().enumerate() {
            let stage = in_frames(&format!("touch {}", describe(patch)), n_frames);
            progress.stage(&stage, n_touches as u64);
            let frames = touched.simulate(patch, n_frames, progress);
            let stage = in_frames("simulate", n_frames);
            let simulate = stage_time(&stage, patch, n_touches, frames.cpu_s);
            // The deepest frame is the same however many come before it.
            if place == 0 {
                arrays.push(ArrayOutcome {
                    patch: *patch,
                    n_touches,
                    n_missed: frames.n_missed,
                    n_saturated: frames.n_saturated,
                });
            }
            let study = Study {
                plan,
                sweep,
                touched,
                progress,
            };
            let (array_scored, measure) = study.recognise(array, &frames)?;
            scored.extend(array_scored);
            tables.stages.extend([simulate, measure]);
        }
    }
    fill(&mut tables, scored, &touched.class_names())?;
    let published = &plan.spec.report.published;
    tables.published = compare_with_published(published, &tables.summary);
    Ok(Outcome { tables, arrays })
}

/// What every job of a run shares.
#[derive(Clone, Copy)]
struct Study<'a> {
    plan: &'a Plan,
    sweep: &'a Sweep,
    touched: &'a dyn TouchSet,
    progress: &'a dyn Progress,
}

impl Study<'_> {
    /// All groups and trials of an array read in so many frames a touch, and what measuring them cost.
    fn recognise(&self, array: usize, frames: &Frames) -> Result<(Vec<Scored>, StageTime)> {
        let patch = &self.plan.arrays[array];
        let n_trials = self.plan.spec.trials;
        let groups: Vec<&Group> = self
            .sweep
            .groups
            .iter()
            .filter(|group| group.array == array && group.frames == frames.n_frames)
            .collect();
        let n_fits: usize = groups.iter().map(|g| g.cells.len() * n_trials).sum();
        let stage = in_frames(&format!("recognise {}", describe(patch)), frames.n_frames);
        self.progress.stage(&stage, n_fits as u64);
        let jobs: Vec<Job> = (0..n_trials)
            .flat_map(|trial| {
                groups.iter().map(move |group| Job {
                    study: *self,
                    frames,
                    group,
                    trial,
                })
            })
            .collect();
        let results = jobs.par_iter().map(Job::run).collect::<Result<Vec<_>>>()?;
        let n_measured = results.len() * self.sweep.labels.len();
        let cpu_s = results.iter().map(|(_, seconds)| seconds).sum();
        let scored = results.into_iter().flat_map(|(scored, _)| scored).collect();
        let stage = in_frames("measure", frames.n_frames);
        Ok((scored, stage_time(&stage, patch, n_measured, cpu_s)))
    }
}

/// One group of cells in one trial.
struct Job<'a> {
    study: Study<'a>,
    frames: &'a Frames,
    group: &'a Group,
    trial: usize,
}

impl Job<'_> {
    /// Measures, then evaluates the cells; with it the processor-seconds of measuring.
    fn run(&self) -> Result<(Vec<Scored>, f64)> {
        let Study { plan, sweep, .. } = self.study;
        let mut scored = Vec::new();
        let mut measure_s = 0.0;
        for n_measurements in self.group.projected() {
            let touches = (self.study.touched, self.frames);
            let trial = (self.trial, &sweep.splits[self.trial]);
            let measured = measure_group(plan, self.group, touches, trial, n_measurements)?;
            measure_s += measured.cpu_s;
            // A group of prefixes is projected once and serves all cells; else each m serves its own.
            let nested = self.group.ensemble.is_prefix_nested();
            let families: Vec<&[Cell]> = self
                .group
                .families()
                .filter(|family| nested || family[0].measurements == n_measurements)
                .collect();
            let trial = Trial {
                plan,
                sweep,
                measurements: &measured,
                number: self.trial,
            };
            let results = families
                .into_par_iter()
                .map(|family| self.evaluate(&trial, family))
                .collect::<Result<Vec<_>>>()?;
            scored.extend(results.into_iter().flatten());
        }
        Ok((scored, measure_s))
    }

    fn evaluate(&self, trial: &Trial, family: &[Cell]) -> Result<Vec<Scored>> {
        let evaluations = trial.evaluate(family)?;
        self.study.progress.advance(family.len() as u64);
        let cells = family.iter().cloned().zip(evaluations);
        Ok(cells
            .map(|(cell, evaluation)| Scored { cell, evaluation })
            .collect())
    }
}

/// The study's steps in this group's condition, on a skin.
pub fn signal_steps(plan: &Plan, group: &Group, skin: &Seed) -> Vec<SignalStep> {
    let condition = &group.condition;
    let step = |&step: &StepSpec| match step {
        StepSpec::Force => Some(SignalStep::Force),
        StepSpec::Noise => Some(SignalStep::Noise(Noise {
            std: condition.noise,
            unit: plan.noise_unit,
        })),
        StepSpec::Smoothing => Some(SignalStep::Smoothing {
            width: condition.smoothing,
        }),
        imperfection => condition.strengths.signal_step(imperfection, skin),
    };
    plan.steps.iter().filter_map(step).collect()
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
        us_per_touch: 1e6 * cpu_s / n_touches as f64,
    }
}

/// Sorts results into the tables: by cell, then by trial.
fn fill(tables: &mut Tables, mut scored: Vec<Scored>, names: &[&str]) -> Result<()> {
    scored.sort_by_key(|s| (s.cell.cell, s.evaluation.score.trial));
    let mut confusions: BTreeMap<(usize, usize, usize), usize> = BTreeMap::new();
    for Scored { cell, evaluation } in scored {
        for &(object, predicted, count) in &evaluation.confusion {
            *confusions
                .entry((cell.cell, object, predicted))
                .or_default() += count;
        }
        tables.accuracy.push((cell.clone(), evaluation.score));
        tables.timing.push((cell, evaluation.time));
    }
    let name = |label: usize| names[label].to_owned();
    tables.confusion = confusions
        .into_iter()
        .map(|((cell, object, predicted), count)| Confusion {
            cell,
            object: name(object),
            predicted: name(predicted),
            count,
        })
        .collect();
    tables.summary = summarise(&tables.accuracy)?;
    tables.comparison = compare_with_best(&tables.accuracy)?;
    if let Some(row) = tables.comparison.first() {
        tables.confused = most_confused(&tables.confusion, row.best_cell);
    }
    tables.pareto = pareto(&tables.accuracy, &tables.timing);
    Ok(())
}
