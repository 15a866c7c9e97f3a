//! Work items and their results: touches are simulated once per array, each group is measured once per trial, and each pending family is evaluated.

use crate::engine::at_once::run_at_once;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::Frames;
use crate::studies::recognition::measurements::Measurements;
use crate::studies::recognition::study::{Family, RecognitionStudy, in_frames};
use crate::studies::recognition::training::{Evaluation, FamilyInputs, Trial};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Results of all work items: rows of configurations, and rows of touches. Some items evaluate configurations in a trial; the others simulate or measure sets
/// of touches.
pub type RecognitionRows = (Vec<ConfigurationRow>, Vec<TouchRow>);

/// Result of one configuration in one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConfigurationRow {
    /// Position of the configuration in the current study: index of its family, and index within the family.
    #[serde(skip)]
    pub at: (usize, usize),
    /// Scores and times of the configuration in the trial.
    pub evaluation: Evaluation,
}

/// Result of simulating or measuring a set of touches on an array.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TouchRow {
    /// Index in the list of all sets of touches of the current study.
    #[serde(skip)]
    pub on: usize,
    /// Whether the row describes the simulation of touches; otherwise it describes the computation of measurements.
    pub is_made: bool,
    /// Number of touches that were simulated or measured.
    pub n_touches: usize,
    /// Number of simulated touches that deflected no taxel.
    pub n_missed: usize,
    /// Number of simulated touches with at least one taxel at its stroke.
    pub n_saturated: usize,
    /// Processor time of the simulation or measurement, summed over threads, s.
    pub cpu_s: f64,
}

/// Measurement to compute in one trial, and the pending families of configurations that are evaluated on it.
pub(crate) struct Job<'a> {
    pub study: &'a RecognitionStudy,
    trial: usize,
    /// Indices of the families, at least one.
    pub families: Vec<usize>,
}

impl RecognitionStudy {
    /// Returns an error if a pending work item needs a classifier or features that the running program does not provide. Errors about programs that other
    /// machines may have are returned as a list.
    pub(crate) fn check_all_provided(
        &self,
        left: &PendingItems<RecognitionRows>,
    ) -> Result<Vec<Error>> {
        let mut missing = BTreeMap::new();
        for family in 0..self.families.len() {
            let is_left = |trial| left.has(self.family_item(trial, family));
            if (0..self.n_trials()).any(is_left) {
                let configuration = &self.family(family).1[0];
                match (check_provided(configuration), configuration.classifier) {
                    (Err(error), ClassifierKind::Foreign(foreign))
                        if foreign.may_be_elsewhere() =>
                    {
                        missing.insert((foreign.name(), foreign.version()), error);
                    }
                    (checked, _) => checked?,
                }
            }
        }
        Ok(missing.into_values().collect())
    }

    pub(crate) fn measure_all(&self, left: &PendingItems<RecognitionRows>) -> Result<()> {
        for part in self.parts() {
            part.touched.prepare();
            part.tested.prepare();
        }
        let jobs = (0..self.touch_sets.len()).map(|touches| {
            let mut jobs = self.jobs(touches, 0..self.n_trials(), |item| left.has(item));
            // The largest measurements are in memory together, not at the end.
            jobs.sort_by_cached_key(|job| Reverse(job.bytes()[0] as u64));
            (touches, jobs)
        });
        let mut jobs: Vec<(usize, Vec<Job>)> = jobs.collect();
        jobs.retain(|(touches, jobs)| !jobs.is_empty() || left.has(self.touches_item(*touches)));
        // Separate test touches are simulated together with the training touches. Sets with most frames come first, because their items take longest.
        jobs.sort_by_key(|(touches, jobs)| {
            let set = &self.touch_sets[*touches];
            (jobs.is_empty(), set.part, Reverse(set.n_frames))
        });
        if self.has_axes() {
            // Progress lines for every combination would be too many.
            let items = jobs
                .iter()
                .flat_map(|(_, jobs)| jobs.iter().flat_map(Job::items));
            let n_items = jobs.len() + items.count();
            left.progress.stage("work items", n_items as u64);
        }
        let mut told = BTreeSet::new();
        for (touches, jobs) in jobs {
            if !jobs.is_empty() {
                self.on_touches(left, touches, jobs, &mut told)?;
            } else if !told.contains(&touches) {
                self.make(left, touches, &[], &mut told)?;
            }
        }
        Ok(())
    }

    /// Returns whether the study has a table `[axes]` with several values.
    fn has_axes(&self) -> bool {
        self.parts().len() > self.alike(0).len()
    }

    /// Returns the measurements of a set of touches that pending families of configurations need.
    pub(crate) fn jobs(
        &self,
        touches: usize,
        trials: Range<usize>,
        is_left: impl Fn(usize) -> bool,
    ) -> Vec<Job<'_>> {
        let of_touches = |&family: &usize| self.families[family].touches == touches;
        let own: Vec<usize> = (0..self.families.len()).filter(of_touches).collect();
        let mut jobs = Vec::new();
        for trial in trials {
            let mut measured: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
            for &family in &own {
                if is_left(self.family_item(trial, family)) {
                    let measurement = self.families[family].measurement;
                    measured.entry(measurement).or_default().push(family);
                }
            }
            jobs.extend(measured.into_values().map(|families| Job {
                study: self,
                trial,
                families,
            }));
        }
        jobs
    }

    /// Computes the pending work items that use one set of training touches, grouped by their test touches.
    fn on_touches(
        &self,
        left: &PendingItems<RecognitionRows>,
        on: usize,
        jobs: Vec<Job>,
        told: &mut BTreeSet<usize>,
    ) -> Result<()> {
        let Some(frames) = self.make(left, on, &jobs, told)? else {
            return Ok(());
        };
        let mut by_tested: BTreeMap<usize, Vec<Job>> = BTreeMap::new();
        for job in jobs {
            by_tested.entry(job.first().tested).or_default().push(job);
        }
        for (tested, jobs) in by_tested {
            let run = |tested: &Frames| {
                let frames = [&frames, tested];
                run_at_once(&jobs, |job| job.run(left, frames))
            };
            if tested == on {
                run(&frames)?;
            } else if let Some(tested) = self.make(left, tested, &jobs, told)? {
                run(&tested)?;
            }
        }
        Ok(())
    }

    /// Simulates a set of touches and computes the measurements of the given jobs. The first call for a set also finishes its work item. Returns `None` if the
    /// touches cannot be simulated; the jobs are then recorded as failed.
    fn make(
        &self,
        left: &PendingItems<RecognitionRows>,
        on: usize,
        jobs: &[Job],
        told: &mut BTreeSet<usize>,
    ) -> Result<Option<Frames>> {
        let touches = self.touches_item(on);
        let (touched, array, n_frames) = self.on(on);
        let n_touches = touched.labels().len();
        let mut need: Vec<usize> = jobs.iter().flat_map(Job::items).collect();
        let n_families = need.len();
        let is_new = told.insert(on);
        need.extend(is_new.then_some(touches));
        let stage = |name: &str, total: usize| {
            let stage = in_frames(&format!("{name} {}", array.describe()), n_frames);
            left.progress.stage(&stage, total as u64);
        };
        let mut progress: &dyn Progress = &Silent;
        if !self.has_axes() {
            stage("touch", n_touches);
            progress = left.progress;
        }
        let make = || Ok(touched.simulate((array, n_frames), progress));
        let Some(frames) = left.prepare(&need, make)? else {
            return Ok(None);
        };
        if !self.has_axes() {
            stage("recognise", n_families + usize::from(is_new));
        }
        if is_new {
            left.finish(touches, || {
                let row = TouchRow {
                    is_made: true,
                    n_touches,
                    n_missed: frames.facts.n_missed,
                    n_saturated: frames.facts.n_saturated,
                    cpu_s: frames.facts.cpu_s,
                    on: 0,
                };
                Ok((Vec::new(), vec![row]))
            })?;
        }
        Ok(Some(frames))
    }
}

impl Job<'_> {
    /// Returns the first family of the job. All families of a job have equal touches, numbers of measurements and training rows.
    pub(crate) fn first(&self) -> &Family {
        &self.study.families[self.families[0]]
    }

    /// Returns the numbers of the work items that are finished by this job.
    fn items(&self) -> impl Iterator<Item = usize> + '_ {
        let families = self.families.iter();
        families.map(|&family| self.study.family_item(self.trial, family))
    }

    /// Computes the measurements of a group of configurations, then evaluates the group's pending families.
    fn run(&self, left: &PendingItems<RecognitionRows>, frames: [&Frames; 2]) -> Result<()> {
        let need: Vec<usize> = self.items().collect();
        let Some(mut measured) = left.prepare(&need, || self.measure(frames))? else {
            return Ok(());
        };
        if !self.reads_values() {
            measured.drop_values();
        }
        let cpu_s = measured.cpu_s;
        let families = self.families.iter().zip(&need).enumerate();
        run_at_once(families, |(place, (&family, &item))| {
            left.finish(item, || {
                // The row of the measured touches is recorded only once.
                let touches = (place == 0).then(|| TouchRow {
                    n_touches: self.study.parts()[self.first().part].sweep.labels.len(),
                    cpu_s,
                    ..TouchRow::default()
                });
                Ok((
                    self.evaluate(family, &measured)?,
                    touches.into_iter().collect(),
                ))
            })
        })
    }

    /// Returns whether a family reads the measurements themselves, and not only features of images.
    pub(crate) fn reads_values(&self) -> bool {
        let mut configurations = self
            .families
            .iter()
            .map(|&one| &self.study.family(one).1[0]);
        configurations.any(|configuration| configuration.of_images().is_none())
    }

    fn measure(&self, frames: [&Frames; 2]) -> Result<Measurements> {
        let (part, group) = self.study.group(self.families[0]);
        let family = self.first();
        let trial = (self.trial, family.n_measurements);
        part.measure((group, family.rows), frames, trial)
    }

    /// Returns whether a family of configurations is the first of the study that uses the measurements of this job.
    fn is_first(&self, family: usize) -> bool {
        let m = |family: usize| self.study.family(family).1[0].measurements;
        let measurement = self.first().measurement;
        let mut earlier = self.study.families[..family].iter().enumerate();
        !earlier.any(|(number, one)| one.measurement == measurement && m(number) == m(family))
    }

    fn evaluate(
        &self,
        number: usize,
        measurements: &Measurements,
    ) -> Result<Vec<ConfigurationRow>> {
        let (part, configurations) = self.study.family(number);
        let trial = Trial {
            inputs: part.sweep.trial(&part.plan, self.trial)?,
            measurements,
        };
        let family = FamilyInputs::new(&part.plan, &part.sweep, configurations);
        let evaluations = trial.evaluate(&family);
        let mut evaluations =
            evaluations.map_err(|error| match of_foreign(&configurations[0]) {
                Some(words) => error.under(format!("{words}, trial {}, ", self.trial)),
                None => error,
            })?;
        if self.trial == 0 && !measurements.selected.is_empty() && self.is_first(number) {
            evaluations[0].selected.clone_from(&measurements.selected);
        }
        let evaluations = evaluations.into_iter();
        let rows = evaluations.map(|evaluation| ConfigurationRow {
            at: (0, 0),
            evaluation,
        });
        Ok(rows.collect())
    }
}

/// Returns the number and the names of a configuration whose classifier or features come from outside of this program; `None` for other configurations.
fn of_foreign(configuration: &Configuration) -> Option<String> {
    let (classifier, features) = (configuration.classifier, configuration.features);
    let is_foreign = matches!(classifier, ClassifierKind::Foreign(_));
    let (number, kind) = (configuration.configuration, classifier.about().words);
    let words = || {
        format!(
            "configuration {number} ({kind}, {})",
            String::from(features)
        )
    };
    (is_foreign || features.foreign().is_some()).then(words)
}

/// Returns an error if a configuration needs a classifier or features that the running program does not provide.
fn check_provided(configuration: &Configuration) -> Result<()> {
    if let ClassifierKind::Foreign(foreign) = configuration.classifier {
        foreign.check_provided()?;
    }
    configuration.check_features()
}
