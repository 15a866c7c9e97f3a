//! One group of cells in one trial: measured once, family by family evaluated.

use super::attempt::attempt;
use super::evaluation::Trial;
use super::finished::Finished;
use super::frames::Frames;
use super::measurement::{BlockTold, Measurements, measure_group_telling};
use super::runner::Run;
use super::sweep::Group;
use super::table::Cell;
use super::time_left::Piece;
use super::workload::LearningMeter;
use crate::error::Result;
use crate::recognition::fit_progress::FitProgress;
use rayon::prelude::*;

/// A group in a trial, and those of its families that are to be evaluated.
pub struct Job<'a> {
    /// What every job of a run shares.
    pub run: Run<'a>,
    /// The group.
    pub group: &'a Group,
    /// Number of the trial.
    pub trial: usize,
    /// Families in their order.
    pub families: Vec<&'a [Cell]>,
}

/// A cell, in which trial, and what came of it.
pub type FinishedCell<'a> = (&'a Cell, usize, Finished);

impl<'a> Job<'a> {
    /// Measures, then evaluates the families, and keeps each as soon as it is finished; with them the processor-seconds of
    /// measuring.
    ///
    /// # Errors
    /// The journal cannot be written; what a cell fails of, if the first to fail ends the run.
    pub fn run(&self, frames: &Frames) -> Result<(Vec<FinishedCell<'a>>, f64)> {
        let mut finished = Vec::new();
        let mut measure_s = 0.0;
        for (n_measurements, families) in self.batches() {
            let piece = self.measuring(n_measurements);
            let (measured, cpu_s) = match self.measure(frames, n_measurements, &piece) {
                Ok(measured) => {
                    let cpu_s = measured.cpu_s;
                    (Ok(measured), cpu_s)
                }
                Err(error) if self.run.manner.fail_fast => return Err(error),
                Err(error) => {
                    // Nobody waits for the rest of it.
                    self.run.progress.worked(&piece, 0.0);
                    (Err(error.to_string()), 0.0)
                }
            };
            measure_s += cpu_s;
            for families in families.chunks(self.run.manner.at_once.families) {
                let families = families.par_iter();
                let results = families.map(|family| self.finish(family, measured.as_ref()));
                finished.extend(results.collect::<Result<Vec<_>>>()?.into_iter().flatten());
            }
        }
        Ok((finished, measure_s))
    }

    /// What is measured once, and the families that it serves: a group of prefixes is projected once and serves all cells; else
    /// each m serves its own.
    pub fn batches(&self) -> Vec<(usize, Vec<&'a [Cell]>)> {
        let nested = self.group.ensemble.is_prefix_nested();
        let served = |n_measurements| {
            let serves = |family: &&&[Cell]| nested || family[0].measurements == n_measurements;
            let families: Vec<&[Cell]> = self.families.iter().filter(serves).copied().collect();
            (!families.is_empty()).then_some((n_measurements, families))
        };
        let projected = self.group.projected().into_iter();
        projected.filter_map(served).collect()
    }

    /// Measures, and tells of it bit by bit.
    fn measure(
        &self,
        frames: &Frames,
        n_measurements: usize,
        piece: &Piece,
    ) -> Result<Measurements> {
        let Run {
            plan,
            sweep,
            touched,
            progress,
            ..
        } = self.run;
        let touches = (touched, frames);
        let trial = (self.trial, &sweep.splits[self.trial]);
        let told = |share: f64, cpu_s: f64| progress.worked(&piece.share(share), cpu_s);
        let wanted = (n_measurements, &told as &BlockTold);
        measure_group_telling(plan, self.group, touches, trial, wanted)
    }

    fn finish(
        &self,
        family: &'a [Cell],
        measured: std::result::Result<&Measurements, &String>,
    ) -> Result<Vec<FinishedCell<'a>>> {
        let meter = LearningMeter::new(&self.run, family);
        let finished = match measured {
            Ok(measured) => self.evaluate(family, measured, &meter)?,
            Err(said) => vec![Finished::Failed(said.clone()); family.len()],
        };
        meter.finish();
        let Run { manner, plan, .. } = self.run;
        Finished::keep_all(&finished, manner.journal, plan, (family, self.trial))?;
        self.run.progress.advance(family.len() as u64);
        let cells = family.iter().zip(finished);
        Ok(cells
            .map(|(cell, finished)| (cell, self.trial, finished))
            .collect())
    }

    fn evaluate(
        &self,
        family: &[Cell],
        measurements: &Measurements,
        meter: &LearningMeter,
    ) -> Result<Vec<Finished>> {
        let Run {
            plan,
            sweep,
            manner,
            ..
        } = self.run;
        let trial = Trial {
            plan,
            sweep,
            measurements,
            tested: measurements,
            number: self.trial,
        };
        let told = |share: f64| meter.advance(share);
        let evaluate = || trial.evaluate_telling(family, FitProgress::to(&told));
        let result = attempt(manner.fail_fast, evaluate)?;
        Ok(match result {
            Ok(evaluations) => {
                let evaluations = evaluations.into_iter().map(Box::new);
                evaluations.map(Finished::Scored).collect()
            }
            Err(said) => vec![Finished::Failed(said); family.len()],
        })
    }
}
