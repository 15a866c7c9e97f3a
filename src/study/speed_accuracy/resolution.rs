//! The part on what a study resolves: real studies of several sizes, and the intervals of what they say.

use super::cost;
use super::plan::{ResolutionPlan, SpeedAccuracyPlan, Tolerance};
use super::subject::Subject;
use super::table::{Resolved, SpeedAccuracyTables, StudySize, StudyTime};
use crate::error::Result;
use crate::objects::Object;
use crate::random::Seed;
use crate::recognition::comparison::{TrialSize, compare};
use crate::recognition::interval::Interval;
use crate::study::pieces::run_whole_study;
use crate::study::pieces::{NamedPiece, PiecesLeft};
use crate::study::progress::Silent;
use crate::study::spec::StudySpec;
use crate::study::table::{Tables, TrialScore};
use crate::study::{CONFIDENCE, Plan, RecognitionStudy, draw_touches};
use rayon::prelude::*;
use std::path::Path;

/// What every one of these studies is, but for what touches what.
const STUDY: &str = r#"
question = "What does a study of this size resolve?"
[skin]
pitch_mm = 2.0
taxels = 2
stroke_mm = 5.0
[signal]
steps = ["noise"]
noise_std_full_scale = 0.05
[sensing]
[recognition]
classifier = "linear_svm"
test_fraction = 0.25
"#;

/// Studies of several sizes; objects have the coarsest detail.
pub(super) struct ResolutionPart<'a> {
    plan: &'a SpeedAccuracyPlan,
    resolution: &'a ResolutionPlan,
    subjects: &'a [Subject],
    packings: Option<&'a Path>,
}

impl<'a> ResolutionPart<'a> {
    pub fn new(
        plan: &'a SpeedAccuracyPlan,
        resolution: &'a ResolutionPlan,
        (subjects, packings): (&'a [Subject], Option<&'a Path>),
    ) -> Self {
        Self {
            plan,
            resolution,
            subjects,
            packings,
        }
    }

    /// A study a number of touches; all numbers of trials are of the same.
    pub fn pieces(&self) -> Vec<NamedPiece> {
        let touches = self.resolution.spec.touches.iter();
        NamedPiece::each_alone(touches.map(|&touches| (name(touches), cost::study(touches))))
    }

    pub fn measure(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Result<()> {
        let all = self.resolution.spec.touches.iter();
        let wanted = left.of(all, |touches| name(**touches));
        if wanted.is_empty() {
            return Ok(());
        }
        left.progress.stage("studies", wanted.len() as u64);
        let names: Vec<String> = wanted.iter().map(|touches| name(**touches)).collect();
        let coarsest: Tolerance = self.plan.levels[0];
        let objects = left.prepare(&names, || {
            let subjects = self.subjects.par_iter();
            let objects = subjects.map(|subject| {
                let model = subject.packed(coarsest, self.packings)?;
                Ok(Object::of_one_part(subject.name(), model))
            });
            objects.collect::<Result<Vec<_>>>()
        })?;
        let Some(objects) = objects else {
            return Ok(());
        };
        wanted.into_iter().try_for_each(|&touches| {
            left.finish(&name(touches), || self.study(touches, objects.clone()))
        })
    }

    fn study(&self, touches: usize, objects: Vec<Object>) -> Result<SpeedAccuracyTables> {
        let (plan, spec) = (self.plan, &self.resolution.spec);
        let most = spec.trials.iter().copied().max().unwrap_or(2);
        let mut study = StudySpec::parse(&plan.place, STUDY)?;
        study.seed = plan.spec.seed;
        study.trials = most;
        study.objects = plan.spec.objects.clone();
        study.skin = plan.spec.skin.clone();
        study.touches = plan.spec.touches.clone();
        study.touches.per_object = Some(touches);
        study.sensing.ratio = Some(crate::study::Axis::Many(spec.ratio.to_vec()));
        let study = Plan::new(&plan.place, study)?;
        let touched = draw_touches(objects, &study.placement, &Seed::new(plan.spec.seed))?;
        let study = RecognitionStudy::new(study, Box::new(touched))?;
        let found = run_whole_study(&study, &Silent)?.tables;
        let mut tables = SpeedAccuracyTables::default();
        for &trials in &spec.trials {
            let size = StudySize { touches, trials };
            let cpu_s = cost(&found, trials, most);
            let resolved = resolved(&found, trials)?;
            tables.resolution.push((size.clone(), resolved));
            tables.resolution_timing.push((size, StudyTime { cpu_s }));
        }
        Ok(tables)
    }
}

fn name(touches: usize) -> String {
    format!("a study of {touches} touches an object")
}

/// What the leading trials of a study of two cells say.
fn resolved(found: &Tables, trials: usize) -> Result<Resolved> {
    let of_cell = |cell: usize| -> Vec<&TrialScore> {
        let rows = found.accuracy.iter().filter(|(row, _)| row.cell == cell);
        rows.map(|(_, score)| score).take(trials).collect()
    };
    let [first, second] = [0, 1].map(of_cell);
    let scores =
        |rows: &[&TrialScore]| -> Vec<f64> { rows.iter().map(|row| row.accuracy).collect() };
    let size = TrialSize {
        n_train: first[0].n_train,
        n_test: first[0].n_test,
    };
    let compared = compare(&scores(&first), &scores(&second), size, CONFIDENCE)?;
    let compared = compared.expect("at least two trials");
    let accuracy = scores(&first).iter().sum::<f64>() / trials as f64;
    let n_right = (accuracy * size.n_test as f64).round() as usize;
    let interval = Interval::wilson(n_right, size.n_test, CONFIDENCE)?;
    Ok(Resolved {
        n_test: size.n_test,
        accuracy,
        accuracy_half_width: 0.5 * (interval.high - interval.low),
        difference: compared.mean_difference,
        difference_half_width: 0.5 * (compared.interval.high - compared.interval.low),
    })
}

/// Processor-seconds of the leading trials: touches are made once, the rest is done in each trial.
fn cost(found: &Tables, trials: usize, most: usize) -> f64 {
    let share = trials as f64 / most as f64;
    let stages = found.stages.iter().map(|row| match row.stage.as_str() {
        "simulate" => row.cpu_s,
        _ => row.cpu_s * share,
    });
    let fits = found.timing.iter().filter(|(_, row)| row.trial < trials);
    stages.sum::<f64>() + fits.map(|(_, row)| row.fit_s + row.predict_s).sum::<f64>()
}
