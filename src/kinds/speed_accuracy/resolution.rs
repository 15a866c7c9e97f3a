//! The part on what a study resolves: recognition studies of several sizes, and the intervals of what they say.

use super::plan::SpeedAccuracyPlan;
use super::rows::{Resolved, StudySize, StudyTime};
use super::spec::ResolutionSpec;
use super::study::SpeedAccuracyRows;
use super::subject::Subject;
use crate::error::Result;
use crate::kinds::recognition::RecognitionStudy;
use crate::objects::Object;
use crate::random::Seed;
use crate::recognition::bootstrap::Bootstrap;
use crate::recognition::comparison::{TrialSize, compare};
use crate::study::pieces::{NamedPiece, PiecesLeft};
use crate::study::progress::Silent;
use crate::study::spec::StudySpec;
use crate::study::summary::score;
use crate::study::table::{Tables, TrialScore};
use crate::study::time_left::Piece;
use crate::study::{Axis, CONFIDENCE, Plan, draw_touches};
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

/// Seconds of a study of one touch an object, about: with more, what is learned grows with their square.
const STUDY_S: f64 = 1e-3;

/// Studies of several sizes; objects have the coarsest detail.
pub(super) struct ResolutionPart<'a> {
    pub plan: &'a SpeedAccuracyPlan,
    pub spec: &'a ResolutionSpec,
    pub subjects: &'a [Subject],
    pub packings: Option<&'a Path>,
}

impl ResolutionPart<'_> {
    /// A study a number of touches; all numbers of trials are of the same.
    pub fn pieces(&self) -> Vec<NamedPiece> {
        let work = |touches: usize| Piece::one_by_one(3, 1.0 + STUDY_S * (touches as f64).powi(2));
        let touches = self.spec.touches.iter();
        NamedPiece::each_alone(touches.map(|&touches| (name(touches), work(touches))))
    }

    pub fn measure(&self, left: &PiecesLeft<SpeedAccuracyRows>) -> Result<()> {
        let wanted = left.of(&self.spec.touches, |touches| name(**touches));
        if wanted.is_empty() {
            return Ok(());
        }
        left.progress.stage("studies", wanted.len() as u64);
        let names: Vec<String> = wanted.iter().map(|touches| name(**touches)).collect();
        let objects = left.prepare(&names, || {
            let objects = self.subjects.par_iter().map(|subject| {
                let model = subject.packed(self.plan.levels[0], self.packings)?;
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

    fn study(&self, touches: usize, objects: Vec<Object>) -> Result<SpeedAccuracyRows> {
        let of = &self.plan.spec;
        let most = self.spec.trials.iter().copied().max().unwrap_or(2);
        let mut study = StudySpec::parse(&self.plan.place, STUDY)?;
        study.seed = of.seed;
        study.trials = most;
        study.objects = of.objects.clone();
        study.skin = of.skin.clone();
        study.touches = of.touches.clone();
        study.touches.per_object = Some(touches);
        study.sensing.ratio = Some(Axis::Many(self.spec.ratio.to_vec()));
        let study = Plan::new(&self.plan.place, study)?;
        let touched = draw_touches(objects, &study.placement, &Seed::new(of.seed))?;
        let study = RecognitionStudy::new(study, Box::new(touched))?;
        let found = study.run(&Silent)?.tables;
        let sizes = self.spec.trials.iter().map(|&trials| {
            let cpu_s = cost(&found, trials, most);
            let size = StudySize { touches, trials };
            Ok((size, resolved(&found, trials)?, StudyTime { cpu_s }))
        });
        Ok(SpeedAccuracyRows {
            sizes: sizes.collect::<Result<_>>()?,
            ..SpeedAccuracyRows::default()
        })
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
    let accuracies =
        |rows: &[&TrialScore]| -> Vec<f64> { rows.iter().map(|row| row.accuracy).collect() };
    let size = TrialSize {
        n_train: first[0].n_train,
        n_test: first[0].n_test,
    };
    let compared = compare(&accuracies(&first), &accuracies(&second), size, CONFIDENCE)?;
    let compared = compared.expect("at least two trials");
    let of_first = score(&first, &mut Bootstrap::default())?;
    Ok(Resolved {
        n_test: size.n_test,
        accuracy: of_first.accuracy,
        accuracy_half_width: 0.5 * (of_first.accuracy_high - of_first.accuracy_low),
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
