//! Makes the touches of an array once, measures each group once a trial, evaluates every family that is left.

use super::rows::{CellRow, RecognitionRows, TouchRow};
use super::study::{RecognitionStudy, in_frames};
use crate::error::Result;
use crate::study::evaluation::Trial;
use crate::study::frames::Frames;
use crate::study::measurement::{Measurements, measure_group};
use crate::study::pieces::PiecesLeft;
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::describe;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// A group in a trial, and those of its families that are left.
pub(super) struct Job<'a> {
    study: &'a RecognitionStudy,
    /// The first of the groups that are measured together.
    pub group: usize,
    trial: usize,
    families: Vec<usize>,
}

impl RecognitionStudy {
    pub(super) fn measure_all(&self, left: &PiecesLeft<RecognitionRows>) -> Result<()> {
        for part in self.parts() {
            part.touched.prepare();
        }
        let all: Vec<_> = self.touch_sets.iter().collect();
        let mut order: Vec<usize> = (0..all.len()).collect();
        // Most frames first: what learns from them takes longest, and how much longer than planned is then known early.
        order.sort_by_key(|&t| (all[t].part, all[t].array, Reverse(all[t].n_frames)));
        let jobs = order
            .into_iter()
            .map(|touches| (touches, self.jobs(left, touches)));
        let is_left = |(touches, jobs): &(usize, Vec<Job>)| {
            !jobs.is_empty() || left.has_number(self.touches_item(*touches))
        };
        let jobs: Vec<(usize, Vec<Job>)> = jobs.filter(is_left).collect();
        if self.has_axes() {
            // A line for the touches of each combination would hide the others.
            let n_items =
                |(_, jobs): &(usize, Vec<Job>)| 1 + jobs.iter().flat_map(Job::items).count();
            let n_items: usize = jobs.iter().map(n_items).sum();
            left.progress.stage("work items", n_items as u64);
        }
        jobs.into_iter()
            .try_for_each(|(touches, jobs)| self.on_touches(left, touches, jobs))
    }

    /// Whether the study has axes of its own.
    fn has_axes(&self) -> bool {
        self.parts().len() > 1
    }

    /// Groups in trials of which some families are left, of some touches; those that are measured alike together.
    pub(super) fn jobs(&self, left: &PiecesLeft<RecognitionRows>, touches: usize) -> Vec<Job<'_>> {
        let mut alike: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for group in self.groups.iter().filter(|group| group.touches == touches) {
            let families = alike.entry(group.measured_as).or_default();
            families.extend(group.families.clone());
        }
        let mut jobs = Vec::new();
        for trial in 0..self.n_trials() {
            for (&group, families) in &alike {
                let is_left = |&family: &usize| left.has_number(self.family_item(trial, family));
                let families: Vec<usize> = families.iter().copied().filter(is_left).collect();
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

    /// Does what is left of some touches.
    fn on_touches(
        &self,
        left: &PiecesLeft<RecognitionRows>,
        on: usize,
        jobs: Vec<Job>,
    ) -> Result<()> {
        let touches = self.touches_item(on);
        let (part, patch, n_frames) = self.on(on);
        let mut need: Vec<usize> = jobs.iter().flat_map(Job::items).collect();
        let n_families = need.len();
        need.push(touches);
        let stage = |name: &str, total: usize| {
            let stage = in_frames(&format!("{name} {}", describe(patch)), n_frames);
            left.progress.stage(&stage, total as u64);
        };
        let mut touched: &dyn Progress = &Silent;
        if !self.has_axes() {
            stage("touch", part.sweep.labels.len());
            touched = left.progress;
        }
        let make = || {
            left.during(&self.touch_work(on), || {
                let on = (patch, n_frames);
                part.touched.simulate(on, &self.place, touched)
            })
        };
        let Some(frames) = left.prepare_numbers(&need, make)? else {
            return Ok(());
        };
        if !self.has_axes() {
            stage("recognise", n_families + 1);
        }
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
        let (_, group) = self.study.group(self.group);
        let nested = group.ensemble.is_prefix_nested();
        let served = |m| {
            let serves =
                |&family: &usize| nested || self.study.family(family).1[0].measurements == m;
            let families: Vec<usize> = self.families.iter().copied().filter(serves).collect();
            (!families.is_empty()).then_some((m, families))
        };
        group.projected().into_iter().filter_map(served).collect()
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
                            n_measured: self.study.group(self.group).0.sweep.labels.len(),
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
        let (part, group) = self.study.group(self.group);
        let touches = (part.touched.as_ref() as _, frames);
        let trial = (self.trial, &part.sweep.splits[self.trial]);
        measure_group(&part.plan, group, touches, trial, n_measurements)
    }

    fn evaluate(&self, family: usize, measurements: &Measurements) -> Result<RecognitionRows> {
        let (part, cells) = self.study.family(family);
        let trial = Trial {
            plan: &part.plan,
            sweep: &part.sweep,
            measurements,
            tested: measurements,
            number: self.trial,
        };
        let evaluations = trial.evaluate(cells)?.into_iter();
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
