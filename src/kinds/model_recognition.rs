//! Classifiers that learn from touches of models and are tested on touches of the objects themselves.
//!
//! Every object has the same number of touches; the leading ones train, the others test.

use crate::error::Result;
use crate::recognition::classifier::TrainedClassifier;
use crate::recognition::dataset::{Dataset, dataset};
use crate::recognition::interval::Interval;
use crate::study::CONFIDENCE;
use ndarray::{Array1, ArrayView2, Axis, concatenate, s};
use std::ops::Range;

/// Some touches of every object (n_touches × m of each), with the object's number as their label.
pub(super) fn touches_of<'a>(
    objects: impl Iterator<Item = ArrayView2<'a, f64>>,
    touches: Range<usize>,
) -> Result<Dataset> {
    let chosen: Vec<_> = objects
        .map(|rows| rows.slice_move(s![touches.clone(), ..]))
        .collect();
    let features = concatenate(Axis(0), &chosen).expect("every object has as many columns");
    let labels = (0..chosen.len()).flat_map(|label| std::iter::repeat_n(label, touches.len()));
    dataset(features, Array1::from_iter(labels))
}

/// A share of right answers.
pub(super) struct Accuracy {
    /// 0 to 1.
    pub share: f64,
    /// Wilson's, 95 %.
    pub interval: Interval,
}

impl Accuracy {
    /// Of a classifier's answers to some touches.
    pub fn of(classifier: &TrainedClassifier, test: &Dataset) -> Result<Self> {
        let answers = classifier.labels(test.records.view())?;
        let pairs = answers.iter().zip(&test.targets);
        let n_right = pairs.filter(|(answer, truth)| answer == truth).count();
        let n_test = test.targets.len();
        Ok(Self {
            share: n_right as f64 / n_test as f64,
            interval: Interval::wilson(n_right, n_test, CONFIDENCE)?,
        })
    }
}
