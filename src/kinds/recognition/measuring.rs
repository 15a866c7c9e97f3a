//! Makes the touches of an array once, measures each group once a trial, evaluates every family that is left.

use super::rows::{CellRow, RecognitionRows, TouchRow};
use super::study::{RecognitionStudy, in_frames};
use crate::error::Result;
use crate::study::evaluation::Trial;
use crate::study::frames::{FrameWriter, Frames};
use crate::study::measurement::{Measurements, measure_group};
use crate::study::pieces::PiecesLeft;
use crate::study::progress::Progress;
use crate::study::simulation::describe;
use crate::study::sweep::Group;
use crate::world::Patch;
use rayon::prelude::*;

/// A group in a trial, and those of its families that are left.
pub(super) struct Job<'a> {
    study: &'a RecognitionStudy,
    pub group: &'a Group,
    trial: usize,
    families: Vec<usize>,
}

impl RecognitionStudy {
    pub(super) fn measure_all(&self, left: &PiecesLeft<RecognitionRows>) -> Result<()> {
        self.touched.prepare();
        for array in 0..self.plan.arrays.len() {
            for frames in costliest_first(&self.plan.frames) {
                self.on_array(left, (array, frames))?;
            }
        }
        Ok(())
    }

    /// Groups in trials of which some families are left, on an array and with a number of frames.
    pub(super) fn jobs(
        &self,
        left: &PiecesLeft<RecognitionRows>,
        on: (usize, usize),
    ) -> Vec<Job<'_>> {
        let mut jobs = Vec::new();
        for trial in 0..self.plan.spec.trials {
            let groups = self.sweep.groups.iter().enumerate();
            for (place, group) in groups.filter(|(_, group)| self.on(group) == on) {
                let is_left = |&family: &usize| left.has_number(self.family_item(trial, family));
                let families: Vec<usize> = self.families_of(place).filter(is_left).collect();
                if !families.is_empty() {
                    jobs.push(Job {
                        study: self,
                        group,
                        trial,
                        families,
                    });
                }
            }
        }
        jobs
    }

    /// Does what is left on an array read in so many frames a touch.
    fn on_array(&self, left: &PiecesLeft<RecognitionRows>, on: (usize, usize)) -> Result<()> {
        let jobs = self.jobs(left, on);
        let touches = self.touches_item(on);
        if jobs.is_empty() && !left.has_number(touches) {
            return Ok(());
        }
        let (patch, n_frames) = (&self.plan.arrays[on.0], self.plan.frames[on.1]);
        let mut need: Vec<usize> = jobs.iter().flat_map(Job::items).collect();
        let n_families = need.len();
        need.push(touches);
        let stage = in_frames(&format!("touch {}", describe(patch)), n_frames);
        left.progress.stage(&stage, self.sweep.labels.len() as u64);
        let make = || {
            left.during(&self.touch_work(on), || {
                self.frames((patch, n_frames), left.progress)
            })
        };
        let Some(frames) = left.prepare_numbers(&need, make)? else {
            return Ok(());
        };
        let stage = in_frames(&format!("recognise {}", describe(patch)), n_frames);
        left.progress.stage(&stage, n_families as u64 + 1);
        left.finish_number(touches, || {
            let row = TouchRow {
                is_made: true,
                n_missed: frames.facts.n_missed,
                n_saturated: frames.facts.n_saturated,
                cpu_s: frames.facts.cpu_s,
                ..TouchRow::default()
            };
            Ok(RecognitionRows {
                touches: vec![row],
                ..RecognitionRows::default()
            })
        })?;
        jobs.par_iter().try_for_each(|job| job.run(left, &frames))
    }

    fn frames(&self, on: (&Patch, usize), progress: &dyn Progress) -> Result<Frames> {
        let writer = FrameWriter::new(on.0.grid.n_taxels(), &self.place)?;
        self.touched.simulate(on, writer, progress)
    }
}

impl Job<'_> {
    /// The numbers of its work items.
    fn items(&self) -> impl Iterator<Item = usize> + '_ {
        let families = self.families.iter();
        families.map(|&family| self.study.family_item(self.trial, family))
    }

    /// What is measured once, and the families that it serves: a group of prefixes is projected once and serves all cells; else
    /// each m serves its own.
    pub fn batches(&self) -> Vec<(usize, Vec<usize>)> {
        let nested = self.group.ensemble.is_prefix_nested();
        let served = |m| {
            let serves = |&family: &usize| nested || self.study.cells(family)[0].measurements == m;
            let families: Vec<usize> = self.families.iter().copied().filter(serves).collect();
            (!families.is_empty()).then_some((m, families))
        };
        self.group
            .projected()
            .into_iter()
            .filter_map(served)
            .collect()
    }

    /// Measures, then evaluates the families.
    fn run(&self, left: &PiecesLeft<RecognitionRows>, frames: &Frames) -> Result<()> {
        let item = |family| self.study.family_item(self.trial, family);
        for (n_measurements, families) in self.batches() {
            let need: Vec<usize> = families.iter().map(|&family| item(family)).collect();
            let measure = || self.measure(frames, n_measurements);
            let work = self.study.measure_work(self.group, n_measurements);
            let Some(measured) = left.prepare_numbers(&need, measure)? else {
                // Nobody waits for it.
                left.progress.worked(&work, 0.0);
                continue;
            };
            left.progress.worked(&work, measured.cpu_s);
            let families = families.par_iter().enumerate();
            families.try_for_each(|(place, &family)| {
                left.finish_number(item(family), || {
                    let mut rows = self.evaluate(family, &measured)?;
                    // It is told once.
                    if place == 0 {
                        rows.touches.push(TouchRow {
                            n_measured: self.study.sweep.labels.len(),
                            cpu_s: measured.cpu_s,
                            ..TouchRow::default()
                        });
                    }
                    Ok(rows)
                })
            })?;
        }
        Ok(())
    }

    fn measure(&self, frames: &Frames, n_measurements: usize) -> Result<Measurements> {
        let RecognitionStudy {
            plan,
            sweep,
            touched,
            ..
        } = self.study;
        let touches = (touched.as_ref() as _, frames);
        let trial = (self.trial, &sweep.splits[self.trial]);
        measure_group(plan, self.group, touches, trial, n_measurements)
    }

    fn evaluate(&self, family: usize, measurements: &Measurements) -> Result<RecognitionRows> {
        let trial = Trial {
            plan: &self.study.plan,
            sweep: &self.study.sweep,
            measurements,
            tested: measurements,
            number: self.trial,
        };
        let evaluations = trial.evaluate(self.study.cells(family))?.into_iter();
        let rows = evaluations.map(|evaluation| CellRow {
            at: (0, 0),
            evaluation,
        });
        Ok(RecognitionRows {
            cells: rows.collect(),
            ..RecognitionRows::default()
        })
    }
}

/// The places of numbers of frames, most frames first: what learns from them takes longest, and how much longer than planned is
/// then known early.
fn costliest_first(frames: &[usize]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..frames.len()).collect();
    places.sort_by_key(|&place| std::cmp::Reverse(frames[place]));
    places
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
