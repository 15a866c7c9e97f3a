//! Recognition with classifiers that are trained on touches of approximate object models and tested on touches of the exact objects.
//!
//! Every object has the same number of touches. The first touches are for training, the others for testing.

use crate::error::{Error, Result};
use crate::learning::classifiers::trained_classifier::TrainedClassifier;
use crate::statistics::p_status::CONFIDENCE;
use bubbletouch_sim::statistics::interval::Interval;
use bubbletouch_svm::dataset::{Dataset, dataset};
use ndarray::{Array1, ArrayView2, Axis, concatenate, s};
use std::ops::Range;

/// Returns an error that names `place` (the study file) if the study has fewer than two objects.
pub(super) fn check_apart(place: &str, n_objects: usize) -> Result<()> {
    match n_objects {
        0 | 1 => {
            let given = format!("{n_objects} objects to recognise");
            Err(Error::input(place, given, "at least 2 to tell apart"))
        }
        _ => Ok(()),
    }
}

/// Returns a data set with the selected touches of every object; the labels are object numbers. The measurements of each object have the shape (n_touches, m).
pub(super) fn touches_of<'a>(
    objects: impl Iterator<Item = ArrayView2<'a, f64>>,
    touches: Range<usize>,
) -> Result<Dataset> {
    let chosen: Vec<_> = objects
        .map(|rows| rows.slice_move(s![touches.clone(), ..]))
        .collect();
    let features = concatenate(Axis(0), &chosen).expect("every object has as many columns");
    let labels = (0..chosen.len()).flat_map(|label| std::iter::repeat_n(label, touches.len()));
    Ok(dataset(features, Array1::from_iter(labels))?)
}

/// Returns the accuracy of a classifier on the test rows, 0 to 1, with its 95 % Wilson interval.
pub(super) fn accuracy(classifier: &TrainedClassifier, test: &Dataset) -> Result<(f64, Interval)> {
    let answers = classifier.labels(test.records.view())?;
    let pairs = answers.iter().zip(&test.targets);
    let n_correct = pairs.filter(|(answer, truth)| answer == truth).count();
    let n_test = test.targets.len();
    let interval = Interval::wilson(n_correct, n_test, CONFIDENCE)?;
    Ok((n_correct as f64 / n_test as f64, interval))
}
