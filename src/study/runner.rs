//! Runs a plan: simulate each array once, measure each group once a trial, evaluate every cell.

use super::evaluation::{Evaluation, Trial};
use super::measurement::{Measurements, Reading, measure, touch_seeds};
use super::plan::{Plan, millimetres};
use super::progress::Progress;
use super::simulation::{Frames, TouchedObject, simulate_array};
use super::spec::StepSpec;
use super::summary::{compare_with_best, summarise};
use super::sweep::{Group, Sweep};
use super::table::{Cell, Confusion, StageTime, Tables};
use crate::error::Result;
use crate::random::Seed;
use crate::sensing::Projection;
use crate::signal::{Chain, Noise, SignalStep};
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
    touched: &[TouchedObject],
    progress: &dyn Progress,
) -> Result<Outcome> {
    let mut tables = Tables::default();
    let mut arrays = Vec::new();
    let mut scored = Vec::new();
    for (array, patch) in plan.arrays.iter().enumerate() {
        let n_touches = sweep.labels.len();
        progress.stage(&format!("touch {}", describe(patch)), n_touches as u64);
        let frames = simulate_array(touched, patch, progress);
        let simulate = stage_time("simulate", patch, n_touches, frames.cpu_s);
        arrays.push(ArrayOutcome {
            patch: *patch,
            n_touches,
            n_missed: frames.n_missed,
            n_saturated: frames.n_saturated,
        });
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
    fill(&mut tables, scored, touched)?;
    Ok(Outcome { tables, arrays })
}

/// What every job of a run shares.
#[derive(Clone, Copy)]
struct Study<'a> {
    plan: &'a Plan,
    sweep: &'a Sweep,
    touched: &'a [TouchedObject],
    progress: &'a dyn Progress,
}

impl Study<'_> {
    /// All groups and trials of an array, and what measuring them cost.
    fn recognise(&self, array: usize, frames: &Frames) -> Result<(Vec<Scored>, StageTime)> {
        let patch = &self.plan.arrays[array];
        let n_trials = self.plan.spec.trials;
        let groups: Vec<&Group> = self
            .sweep
            .groups
            .iter()
            .filter(|group| group.array == array)
            .collect();
        let n_fits: usize = groups.iter().map(|g| g.cells.len() * n_trials).sum();
        let stage = format!("recognise {}", describe(patch));
        self.progress.stage(&stage, n_fits as u64);
        let jobs: Vec<Job> = (0..n_trials)
            .flat_map(|trial| {
                groups.iter().map(move |group| Job {
                    study: *self,
                    patch,
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
        Ok((scored, stage_time("measure", patch, n_measured, cpu_s)))
    }
}

/// One group of cells in one trial.
struct Job<'a> {
    study: Study<'a>,
    patch: &'a Patch,
    frames: &'a Frames,
    group: &'a Group,
    trial: usize,
}

impl Job<'_> {
    /// Measures, then evaluates the cells; with it the processor-seconds of measuring.
    fn run(&self) -> Result<(Vec<Scored>, f64)> {
        let chain = Chain::new(&signal_steps(self.study.plan, self.group), self.patch)?;
        let mut scored = Vec::new();
        let mut measure_s = 0.0;
        for n_measurements in self.group.projected() {
            let measured = self.measure(&chain, n_measurements)?;
            measure_s += measured.cpu_s;
            // A group of prefixes is projected once and serves all cells; else each m serves its own.
            let nested = self.group.ensemble.is_prefix_nested();
            let cells: Vec<&Cell> = self
                .group
                .cells
                .iter()
                .filter(|cell| nested || cell.measurements == n_measurements)
                .collect();
            let trial = Trial {
                recognition: &self.study.plan.spec.recognition,
                sweep: self.study.sweep,
                measurements: measured.values.view(),
                number: self.trial,
                seed: Seed::new(self.study.plan.spec.seed),
            };
            let results = cells
                .into_par_iter()
                .map(|cell| {
                    let evaluation = trial.evaluate(cell)?;
                    self.study.progress.advance(1);
                    Ok(Scored {
                        cell: cell.clone(),
                        evaluation,
                    })
                })
                .collect::<Result<Vec<_>>>()?;
            scored.extend(results);
        }
        Ok((scored, measure_s))
    }

    fn measure(&self, chain: &Chain, n_measurements: usize) -> Result<Measurements> {
        let seed = Seed::new(self.study.plan.spec.seed);
        let trial = self.trial as u64;
        let projection = Projection::new(
            self.group.ensemble,
            (self.patch.grid.ny, self.patch.grid.nx),
            n_measurements,
            &seed.named("projection").numbered(trial),
        )?;
        let reading = Reading {
            chain,
            projection: &projection,
            taxel: self.patch.taxel,
            speed: self.study.plan.speed,
        };
        let seeds = touch_seeds(self.study.touched, &seed.named("signal").numbered(trial));
        Ok(measure(reading, self.frames.deflection.view(), &seeds))
    }
}

/// The study's steps with this group's levels.
pub fn signal_steps(plan: &Plan, group: &Group) -> Vec<SignalStep> {
    plan.steps
        .iter()
        .map(|step| match step {
            StepSpec::Force => SignalStep::Force,
            StepSpec::Noise => SignalStep::Noise(Noise {
                std: group.noise,
                unit: plan.noise_unit,
            }),
            StepSpec::Smoothing => SignalStep::Smoothing {
                width: group.smoothing,
            },
        })
        .collect()
}

/// An array in words: `64×64 at 2 mm`.
pub fn describe(patch: &Patch) -> String {
    let grid = &patch.grid;
    format!("{}×{} at {} mm", grid.nx, grid.ny, millimetres(grid.pitch))
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
fn fill(tables: &mut Tables, mut scored: Vec<Scored>, touched: &[TouchedObject]) -> Result<()> {
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
    let name = |label: usize| touched[label].object.name.clone();
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
    Ok(())
}
