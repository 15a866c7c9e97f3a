//! One cell in one trial: fit on training rows, predict test rows, score.

use super::spec::RecognitionSpec;
use super::sweep::Sweep;
use super::table::{Cell, TrialScore, TrialTime};
use crate::error::Result;
use crate::random::Seed;
use crate::recognition::classifier::{Classifier, Cost, TrainedClassifier};
use crate::recognition::dataset::{Dataset, dataset};
use crate::recognition::interval::Interval;
use crate::recognition::kernel::Gamma;
use crate::recognition::metrics::ConfusionMatrix;
use crate::recognition::split::{Split, group_hold_out, stratified_hold_out};
use ndarray::{ArrayView2, Axis, s};
use std::time::Instant;

/// Confidence of every interval in the tables.
pub const CONFIDENCE: f64 = 0.95;
/// Share of the training rows that validates a choice of C.
pub const VALIDATION_FRACTION: f64 = 0.25;

/// What a cell scored in a trial.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Row of the accuracy table.
    pub score: TrialScore,
    /// Row of the timing table.
    pub time: TrialTime,
    /// Non-zero counts: (object, predicted, how many).
    pub confusion: Vec<(usize, usize, usize)>,
}

/// What the evaluations of a group share in a trial.
#[derive(Clone, Copy)]
pub struct Trial<'a> {
    /// The study's keys.
    pub recognition: &'a RecognitionSpec,
    /// Labels, splits and groups.
    pub sweep: &'a Sweep,
    /// Measurements of all touches: n_touches × at least the cell's m.
    pub measurements: ArrayView2<'a, f64>,
    /// Number of the trial.
    pub number: usize,
    /// The study's root of randomness.
    pub seed: Seed,
}

impl Trial<'_> {
    /// Fits and scores one cell on its leading measurements.
    pub fn evaluate(&self, cell: &Cell) -> Result<Evaluation> {
        let split = self.split(cell)?;
        let fit_start = Instant::now();
        let training = self.rows(cell, &split.train)?;
        let trained = self.fit(cell, &training, &split)?;
        let fit_s = fit_start.elapsed().as_secs_f64();
        let test = self.rows(cell, &split.test)?;
        let predict_start = Instant::now();
        let predicted = trained.labels(test.records.view())?;
        let predict_s = predict_start.elapsed().as_secs_f64();
        let n_objects = self.sweep.labels.iter().max().map_or(0, |last| last + 1);
        let matrix = ConfusionMatrix::new(test.targets.view(), predicted.view(), n_objects)?;
        let interval = Interval::wilson(matrix.n_correct(), matrix.n_rows(), CONFIDENCE)?;
        Ok(Evaluation {
            score: TrialScore {
                trial: self.number,
                n_train: split.train.len(),
                n_test: split.test.len(),
                n_correct: matrix.n_correct(),
                accuracy: matrix.accuracy(),
                accuracy_low: interval.low,
                accuracy_high: interval.high,
                macro_f1: matrix.macro_f1(),
                c_used: trained.c(),
                n_capped: trained.n_capped(),
            },
            time: TrialTime {
                trial: self.number,
                fit_s,
                predict_s,
                predict_us_per_touch: 1e6 * predict_s / split.test.len() as f64,
            },
            confusion: matrix
                .counts
                .indexed_iter()
                .filter(|(_, count)| **count > 0)
                .map(|((object, predicted), &count)| (object, predicted, count))
                .collect(),
        })
    }

    /// The trial's split, with no more training touches an object than the cell allows.
    fn split(&self, cell: &Cell) -> Result<Split> {
        let split = &self.sweep.splits[self.number];
        match self.recognition.train_touches {
            None => Ok(split.clone()),
            Some(_) => split.at_most(self.sweep.labels.view(), cell.train_touches),
        }
    }

    fn rows(&self, cell: &Cell, rows: &[usize]) -> Result<Dataset> {
        let leading = self.measurements.slice(s![.., ..cell.measurements]);
        dataset(
            leading.select(Axis(0), rows),
            self.sweep.labels.select(Axis(0), rows),
        )
    }

    fn fit(&self, cell: &Cell, training: &Dataset, split: &Split) -> Result<TrainedClassifier> {
        let classifier = self.classifier(cell);
        let seed = self.seed.named("validation").numbered(self.number as u64);
        if cell.c.is_some() {
            return classifier.train(training, &seed);
        }
        let labels = training.targets.view();
        let validation = match &self.sweep.group_keys {
            None => stratified_hold_out(labels, VALIDATION_FRACTION, &seed)?,
            // What stays together in the split stays together in the validation split inside it.
            Some(keys) => {
                let keys = keys.select(Axis(0), &split.train);
                group_hold_out(labels, keys.view(), VALIDATION_FRACTION, &seed)?
            }
        };
        classifier.train_validated(training, &validation, &seed)
    }

    fn classifier(&self, cell: &Cell) -> Classifier {
        let recognition = self.recognition;
        Classifier {
            scaling: recognition.scaling,
            multiclass: recognition.multiclass,
            c: match cell.c {
                Some(c) => Cost::Fixed(c),
                None => Cost::Chosen {
                    candidates: recognition.choose_c.clone().unwrap_or_default(),
                    validation_fraction: VALIDATION_FRACTION,
                },
            },
            gamma: recognition.gamma.map_or(Gamma::Scale, Gamma::Value),
            coef0: recognition.coef0,
            degree: recognition.degree,
            ..Classifier::new(cell.classifier)
        }
    }
}
