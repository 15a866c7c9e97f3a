//! Evaluation of a family of configurations in one trial: training for each C, prediction of all test touches, and decisions on several touches.

use crate::error::Result;
use crate::learning::evaluation::fusion::{fuse_rows, fuse_scores};
use crate::learning::evaluation::metrics::ConfusionMatrix;
use crate::statistics::grouped::{GroupCount, GroupedTest, count_groups, interval_of};
use crate::statistics::p_status::CONFIDENCE;
use crate::studies::recognition::measurements::Measurements;
use crate::studies::recognition::rows::{RowInputs, TrialScore, TrialTime};
use crate::studies::recognition::training::{
    AnsweredTouches, Decide, Decision, FamilyInputs, Fitted, Training, TrialInputs, answer_model,
    choose_touches,
};
use bubbletouch_svm::dataset::{Dataset, dataset};
use bubbletouch_svm::split::Split;
use ndarray::{Array1, Array2, Axis};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::time::Instant;

/// Smallest probability that the log-loss uses, as in scikit-learn. With a smaller value, single certain errors dominate the mean.
const LEAST_PROBABILITY: f64 = f64::EPSILON;

/// Result of one configuration in one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Score of the configuration in the trial, for the table `accuracy.csv`.
    pub score: TrialScore,
    /// Computing times of the configuration in the trial, for the table `timing.csv`.
    pub time: TrialTime,
    /// Non-zero counts of the confusion matrix: (object, predicted object, number of test rows).
    pub confusion: Vec<(usize, usize, usize)>,
    /// Decision counts of each group of test touches; empty if no groups are held out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<GroupCount>,
    /// Mean negative logarithm of the probability of the true class over all decisions; `None` if it is not kept, or the classifier has no probabilities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub log_loss: Option<f64>,
    /// Decisions in the order of the test touches; empty unless the study keeps them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub decided: Vec<Decided>,
    /// Indices of the selected taxels, in the order of their selection. Only the first family of configurations with these measurements has them, in the first
    /// trial.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub selected: Vec<usize>,
}

/// One decision on test touches of one object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decided {
    /// Numbers of the touches.
    pub touches: Vec<usize>,
    /// Distinct groups of the touches; empty if no groups are held out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<usize>,
    /// Label of the touched object.
    pub truth: usize,
    /// Predicted label.
    pub answer: usize,
    /// Score of each label from 0, as [`TrainedClassifier::class_scores`](bubbletouch_svm::classifiers::trained_classifier::TrainedClassifier::class_scores)
    /// gives it; `None` for a label without training touches.
    pub scores: Vec<Option<f64>>,
}

/// Data of a trial that the evaluations of all families in a group share.
#[derive(Clone, Copy)]
pub struct Trial<'a> {
    /// Inputs of the trial: its labels, split and groups.
    pub inputs: TrialInputs<'a>,
    /// Measurements of all touches in the trial. Each frame has at least as many measurements as any configuration needs.
    pub measurements: &'a Measurements,
}

/// Returns the function by which a trained classifier decides on groups of test touches. All groups of a call have the same size. A group of one touch gets the
/// predicted label of the touch; for a larger group, the scores of its touches are added.
fn decider<'a>(
    fitted: &'a Fitted,
    test: &Dataset,
    configurations: &[Decision],
) -> Result<Decide<'a>> {
    let (classifier, features) = (&fitted.classifier, test.records.view());
    let mut counts = configurations.iter().map(|one| one.touches_per_decision);
    // If each decision uses one touch, labels suffice and are faster to compute.
    let scores = match counts.any(|k| k > 1) {
        true => Some(classifier.scores(features)?),
        false => None,
    };
    let labels = match &scores {
        Some(scores) if !classifier.has_own_labels() => classifier.labels_of_scores(scores.view()),
        _ => classifier.labels(features)?,
    };
    Ok(Box::new(move |groups| match &scores {
        Some(scores) if groups.iter().any(|group| group.len() > 1) => {
            classifier.labels_of_scores(fuse_scores(scores.view(), groups).view())
        }
        _ => groups.iter().map(|group| labels[group[0]]).collect(),
    }))
}

impl Trial<'_> {
    /// Trains and tests all configurations of a family, in order. Configurations use the first m measurements of each frame.
    ///
    /// # Errors
    /// If rows of the family cannot be computed, or the training fails.
    pub fn evaluate(&self, family: &FamilyInputs) -> Result<Vec<Evaluation>> {
        let (split, learned_labels) = self.inputs.training(&family.training_rows)?;
        let training = self.training(family, (&split, &learned_labels))?;
        let groups = self.inputs.test_groups(&split.test);
        let penalties: Vec<Option<f64>> = family.fits().map(|decisions| decisions[0].c).collect();
        let fitted = training.train_all(&penalties)?;
        // The rows of the test are not in memory together with the kernel values of the training.
        let test = dataset(
            self.measurements.features(&family.rows, &split.test)?,
            self.inputs.labels.select(Axis(0), &split.test),
        )?;
        let mut evaluations = Vec::with_capacity(family.decisions.len());
        for (fitted, configurations) in fitted.iter().zip(family.fits()) {
            let start = Instant::now();
            let mut answered = AnsweredTouches {
                fitted,
                test: &test,
                groups: groups.as_deref(),
                decide: decider(fitted, &test, configurations)?,
                answer_s: start.elapsed().as_secs_f64(),
                scores: match family.keeps_predictions || family.keeps_log_loss {
                    true => Some(fitted.classifier.scores(test.records.view())?),
                    false => None,
                },
                n_train: split.train.len(),
                touches: &split.test,
                model: None,
                model_s: 0.0,
            };
            if configurations.iter().any(Decision::is_informed) {
                let start = Instant::now();
                answered.model = answer_model((&self.inputs, family), &training, (fitted, &split))?;
                answered.model_s = start.elapsed().as_secs_f64();
            }
            for configuration in configurations {
                evaluations.push(self.decide((family, configuration), &answered)?);
            }
        }
        Ok(evaluations)
    }

    /// Computes the results of decisions, each of which combines k test touches.
    fn decide(
        &self,
        (family, configuration): (&FamilyInputs, &Decision),
        answered: &AnsweredTouches,
    ) -> Result<Evaluation> {
        let truth = &answered.test.targets;
        let seed = self.inputs.stream("fused_touches"); // The name is part of every published number.
        let start = Instant::now();
        let mut rows = fuse_rows(truth.view(), configuration.touches_per_decision, &seed);
        rows.groups = choose_touches((family, configuration), answered, rows.groups);
        let predicted = (answered.decide)(&rows.groups);
        let predict_s = answered.answer_s + start.elapsed().as_secs_f64();
        let truth = rows.groups.iter().map(|group| truth[group[0]]).collect();
        let truth: Array1<usize> = truth;
        let n_objects = self.inputs.n_objects();
        let matrix = ConfusionMatrix::new(truth.view(), predicted.view(), n_objects)?;
        let counts = matrix.counts.indexed_iter();
        let counts = counts.filter(|(_, count)| **count > 0);
        let groups_of = |touches: &[usize]| -> BTreeSet<usize> {
            let groups = answered.groups.unwrap_or_default();
            let groups = touches.iter().filter_map(|&touch| groups.get(touch));
            groups.copied().collect()
        };
        let classifier = &answered.fitted.classifier;
        let scores = answered.scores.as_ref();
        let scores = scores
            .map(|scores| classifier.class_scores(fuse_scores(scores.view(), &rows.groups).view()));
        let place = |label: usize| classifier.classes().binary_search(&label).ok();
        let log_loss = scores.as_ref().filter(|_| family.keeps_log_loss);
        let log_loss = log_loss.filter(|_| classifier.is_probabilistic());
        let log_loss = log_loss.map(|scores| {
            let losses = scores.outer_iter().zip(&truth);
            let losses = losses.map(|(row, &label)| {
                let log = place(label).map_or(f64::NEG_INFINITY, |place| row[place]);
                -log.max(LEAST_PROBABILITY.ln())
            });
            losses.sum::<f64>() / truth.len() as f64
        });
        let decided = |scores: &Array2<f64>| -> Vec<Decided> {
            let decisions = rows.groups.iter().zip(scores.outer_iter()).enumerate();
            let decided = decisions.map(|(row, (touches, scores))| Decided {
                touches: touches.iter().map(|&t| answered.touches[t]).collect(),
                groups: groups_of(touches).into_iter().collect(),
                truth: truth[row],
                answer: predicted[row],
                scores: (0..n_objects)
                    .map(|label| Some(scores[place(label)?]))
                    .collect(),
            });
            decided.collect()
        };
        let decided = scores
            .as_ref()
            .filter(|_| family.keeps_predictions)
            .map(decided);
        let groups = answered.groups.map_or_else(Vec::new, |_| {
            let decisions = rows.groups.iter().enumerate();
            // A decision on touches of several groups counts as a row of each of these groups.
            count_groups(decisions.flat_map(|(row, touches)| {
                let of = groups_of(touches);
                let is_correct = predicted[row] == truth[row];
                of.into_iter().map(move |group| (group, is_correct))
            }))
        });
        let mut fit_s = answered.fitted.fit_s;
        if configuration.is_informed() {
            fit_s += answered.model_s;
        }
        if classifier.trains_in_predictions() {
            fit_s += predict_s;
        }
        let (n_rows, n_correct) = (matrix.n_rows(), matrix.n_correct());
        let tested = answered.groups.map(|_| GroupedTest {
            n_rows,
            n_correct,
            groups: &groups,
        });
        let (interval, n_groups) = interval_of([n_correct, n_rows], tested.as_slice(), CONFIDENCE)?;
        Ok(Evaluation {
            score: TrialScore {
                trial: self.inputs.number,
                split: self.inputs.crossed.map(|(split, _)| split),
                projection: self.inputs.crossed.map(|(_, projection)| projection),
                distinct_split: self.inputs.distinct_split,
                n_train: answered.n_train,
                n_test: n_rows,
                n_left_out: rows.n_left_out,
                n_correct,
                accuracy: matrix.accuracy(),
                accuracy_low: interval.low,
                accuracy_high: interval.high,
                n_groups,
                macro_f1: matrix.macro_f1(),
                balanced_accuracy: None,
                log_loss: None,
                c_used: answered.fitted.c,
                gamma_used: answered.fitted.gamma,
                n_capped: answered.fitted.classifier.n_capped(),
            },
            time: TrialTime {
                trial: self.inputs.number,
                fit_s,
                predict_s,
                predict_us_per_touch: 1e6 * predict_s / answered.test.targets.len() as f64,
            },
            confusion: counts
                .map(|((object, predicted), &count)| (object, predicted, count))
                .collect(),
            groups,
            log_loss,
            decided: decided.unwrap_or_default(),
            selected: Vec::new(),
        })
    }

    fn training<'f>(
        &self,
        family: &'f FamilyInputs,
        (split, labels): (&Split, &Array1<usize>),
    ) -> Result<Training<'f>> {
        let keys = self.inputs.group_keys;
        let (rows, labels) = learned_rows(self.measurements, &family.rows, &split.train, labels);
        Ok(Training {
            inputs: &family.training,
            data: dataset(self.measurements.features(&family.rows, &rows)?, labels)?,
            n_first: split.train.len(),
            group_keys: keys.map(|keys| keys.select(Axis(0), &split.train)),
            seed: self.inputs.stream("validation"),
        })
    }
}

/// Returns the training rows and their labels: all readings of the training touches, then their tilted copies.
pub(crate) fn learned_rows(
    measurements: &Measurements,
    inputs: &RowInputs,
    train: &[usize],
    labels: &Array1<usize>,
) -> (Vec<usize>, Array1<usize>) {
    let mut rows = measurements.readings(train);
    rows.extend(measurements.copies(inputs, train));
    // Readings and copies repeat the order of the touches.
    let touches = train.iter().cycle().take(rows.len());
    let labels = touches.map(|&touch| labels[touch]).collect();
    (rows, labels)
}
