//! A family of cells in one trial: fit on training rows once for each C, answer to test touches once, decide for each k.

use crate::error::Result;
use crate::learning::evaluation::fusion::{fuse_rows, fuse_scores};
use crate::learning::evaluation::metrics::ConfusionMatrix;
use crate::learning::evaluation::next_touch::{AnswerModel, NextTouch};
use crate::random::Seed;
use crate::statistics::grouped::{GroupCount, GroupedTest, count_groups, interval_of};
use crate::statistics::p_status::CONFIDENCE;
use crate::studies::recognition::measurements::measurement::Measurements;
use crate::studies::recognition::plan::group::Group;
use crate::studies::recognition::plan::plan::Plan;
use crate::studies::recognition::rows::cell::Cell;
use crate::studies::recognition::rows::table_rows::{TrialScore, TrialTime};
use crate::studies::recognition::sweep::sweep::Sweep;
use crate::studies::recognition::training::training::{Fitted, Training};
use bubbletouch_svm::dataset::{Dataset, dataset};
use bubbletouch_svm::split::Split;
use ndarray::{Array1, Axis};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::time::Instant;

/// What a cell scored in a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Row of the accuracy table.
    pub score: TrialScore,
    /// Row of the timing table.
    pub time: TrialTime,
    /// Non-zero counts: (object, predicted, how many).
    pub confusion: Vec<(usize, usize, usize)>,
    /// Test rows group by group; none where rows are held out one by one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<GroupCount>,
}

/// What the evaluations of a group share in a trial.
#[derive(Clone, Copy)]
pub struct Trial<'a> {
    /// The study.
    pub plan: &'a Plan,
    /// Labels, splits and groups.
    pub sweep: &'a Sweep,
    /// Measurements of all touches, at least the cell's m a frame.
    pub measurements: &'a Measurements,
    /// The same of what test touches are: the measurements themselves, unless something has changed since they were learned from.
    pub tested: &'a Measurements,
    /// Number of the trial.
    pub number: usize,
}

/// Test touches, answered by one fit.
pub(crate) struct AnsweredTouches<'a> {
    fitted: &'a Fitted,
    pub test: &'a Dataset,
    /// Their numbers.
    pub touches: &'a [usize],
    /// The group of each of them.
    groups: Option<&'a [usize]>,
    pub decide: Decide<'a>,
    answer_s: f64,
    n_train: usize,
    /// What touches are expected to be answered, where any cell goes by that, and the seconds to learn it.
    pub model: Option<AnswerModel<'a>>,
    model_s: f64,
}

/// One label for each group of touches.
pub(crate) type Decide<'a> = Box<dyn Fn(&[Vec<usize>]) -> Array1<usize> + 'a>;

fn is_informed(cell: &Cell) -> bool {
    cell.next_touch == Some(NextTouch::MostInformative)
}

/// How a fit decides on test touches of its cells.
fn decider<'a>(fitted: &'a Fitted, test: &Dataset, cells: &[Cell]) -> Result<Decide<'a>> {
    let (classifier, features) = (&fitted.classifier, test.records.view());
    // Labels are all that is needed where touches are decided on one by one, and less work.
    if cells.iter().all(|cell| cell.fused_touches == 1) {
        let labels = classifier.labels(features)?;
        let label = move |group: &Vec<usize>| labels[group[0]];
        return Ok(Box::new(move |groups| groups.iter().map(&label).collect()));
    }
    let scores = classifier.scores(features)?;
    Ok(Box::new(move |groups| {
        classifier.labels_of_scores(fuse_scores(scores.view(), groups).view())
    }))
}

impl Trial<'_> {
    /// Fits and tests the cells of a [family](crate::studies::recognition::plan::group::Group::families) on their leading measurements, in their order.
    pub fn evaluate(&self, family: &[Cell]) -> Result<Vec<Evaluation>> {
        let split = self.sweep.split(self.plan, &family[0], self.number)?;
        let training = self.training(&family[0], &split)?;
        let labels = self.sweep.labels.select(Axis(0), &split.test);
        let test = dataset(self.tested.features(&family[0], &split.test), labels)?;
        let groups = self.sweep.test_groups(self.plan, self.number, &split.test);
        let same_fit: Vec<&[Cell]> = Group::fits(family).collect();
        let penalties: Vec<Option<f64>> = same_fit.iter().map(|cells| cells[0].c).collect();
        let fitted = training.train_all(&penalties)?;
        let mut evaluations = Vec::with_capacity(family.len());
        for (fitted, cells) in fitted.iter().zip(same_fit) {
            let start = Instant::now();
            let mut answered = AnsweredTouches {
                fitted,
                test: &test,
                groups: groups.as_deref(),
                decide: decider(fitted, &test, cells)?,
                answer_s: start.elapsed().as_secs_f64(),
                n_train: split.train.len(),
                touches: &split.test,
                model: None,
                model_s: 0.0,
            };
            if cells.iter().any(is_informed) {
                let start = Instant::now();
                answered.model = self.answer_model(&training, fitted, &split)?;
                answered.model_s = start.elapsed().as_secs_f64();
            }
            for cell in cells {
                evaluations.push(self.decide(cell, &answered)?);
            }
        }
        Ok(evaluations)
    }

    /// One label for each group of the cell's k test touches.
    fn decide(&self, cell: &Cell, answered: &AnsweredTouches) -> Result<Evaluation> {
        let truth = &answered.test.targets;
        let seed = self.seed("fused_touches");
        let start = Instant::now();
        let mut rows = fuse_rows(truth.view(), cell.fused_touches, &seed);
        rows.groups = self.choose_touches(cell, answered, rows.groups);
        let predicted = (answered.decide)(&rows.groups);
        let predict_s = answered.answer_s + start.elapsed().as_secs_f64();
        let truth = rows.groups.iter().map(|group| truth[group[0]]).collect();
        let truth: Array1<usize> = truth;
        let n_objects = self.sweep.labels.iter().max().map_or(0, |last| last + 1);
        let matrix = ConfusionMatrix::new(truth.view(), predicted.view(), n_objects)?;
        let spec = &self.plan.spec;
        // Only where they say more than the trial's number.
        let is_crossed = spec.projections_per_split.is_some();
        let counts = matrix.counts.indexed_iter();
        let counts = counts.filter(|(_, count)| **count > 0);
        let groups = answered.groups.map_or_else(Vec::new, |groups| {
            let decisions = rows.groups.iter().enumerate();
            // A decision on touches of several groups is a row of each.
            count_groups(decisions.flat_map(|(row, touches)| {
                let of: BTreeSet<usize> = touches.iter().map(|&touch| groups[touch]).collect();
                let is_correct = predicted[row] == truth[row];
                of.into_iter().map(move |group| (group, is_correct))
            }))
        });
        let (n_rows, n_correct) = (matrix.n_rows(), matrix.n_correct());
        let tested = answered.groups.map(|_| GroupedTest {
            n_rows,
            n_correct,
            groups: &groups,
        });
        let (interval, n_groups) = interval_of([n_correct, n_rows], tested.as_slice(), CONFIDENCE)?;
        Ok(Evaluation {
            score: TrialScore {
                trial: self.number,
                split: is_crossed.then(|| spec.split_of(self.number)),
                projection: is_crossed.then(|| spec.projection_of(self.number)),
                distinct_split: self.sweep.repeated_split(self.plan, self.number),
                n_train: answered.n_train,
                n_test: n_rows,
                n_left_out: rows.n_left_out,
                n_correct,
                accuracy: matrix.accuracy(),
                accuracy_low: interval.low,
                accuracy_high: interval.high,
                n_groups,
                macro_f1: matrix.macro_f1(),
                c_used: answered.fitted.c,
                gamma_used: answered.fitted.gamma,
                n_capped: answered.fitted.classifier.n_capped(),
            },
            time: TrialTime {
                trial: self.number,
                fit_s: answered.fitted.fit_s
                    + if is_informed(cell) {
                        answered.model_s
                    } else {
                        0.0
                    },
                predict_s,
                predict_us_per_touch: 1e6 * predict_s / answered.test.targets.len() as f64,
            },
            confusion: counts
                .map(|((object, predicted), &count)| (object, predicted, count))
                .collect(),
            groups,
        })
    }

    fn training(&self, cell: &Cell, split: &Split) -> Result<Training<'_>> {
        let keys = self.sweep.group_keys.as_ref();
        let of = (cell, self.number);
        let labels = self.sweep.learned_labels(self.plan, of, split)?;
        let (rows, labels) = learned_rows(self.measurements, cell, &split.train, &labels);
        Ok(Training {
            recognition: &self.plan.spec.recognition,
            kind: cell.classifier,
            data: dataset(self.measurements.features(cell, &rows), labels)?,
            n_first: split.train.len(),
            group_keys: keys.map(|keys| keys.select(Axis(0), &split.train)),
            seed: self.seed("validation"),
        })
    }

    fn seed(&self, name: &str) -> Seed {
        let seed = Seed::new(self.plan.spec.seed).named(name);
        seed.numbered(self.number as u64)
    }
}

/// What a cell learns from: all readings of these training touches, then their tilted copies, and the labels of all.
pub(crate) fn learned_rows(
    measurements: &Measurements,
    cell: &Cell,
    train: &[usize],
    labels: &Array1<usize>,
) -> (Vec<usize>, Array1<usize>) {
    let mut rows = measurements.readings(train);
    rows.extend(measurements.copies(cell, train));
    // Readings and copies alike are of all touches in turn.
    let touches = train.iter().cycle().take(rows.len());
    let labels = touches.map(|&touch| labels[touch]).collect();
    (rows, labels)
}
