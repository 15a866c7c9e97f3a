//! Steps that several kinds of studies share: the check of touches of one array, groups of rows, medians of computing times, and recognition with classifiers
//! that are trained on touches of approximate object models.

use crate::inputs::params::Described;
use crate::learning::classifiers::trained_classifier::TrainedClassifier;
use crate::statistics::p_status::CONFIDENCE;
use crate::studies::prelude::*;
use crate::studies::recognition::spec::OneArray;
use crate::table::Columns;
use bubbletouch_sim::statistics::interval::Interval;
use bubbletouch_svm::dataset::{Dataset, dataset};
use ndarray::{Array1, ArrayView2, Axis, concatenate, s};
use std::ops::Range;
use std::time::Instant;

impl Check<'_> {
    /// Checks the objects, the array and the touches of a study in which one array touches all objects. Returns the array and the placement of its touches. The
    /// objects get the default surface error of the array if none is given.
    ///
    /// # Errors
    /// If a key is out of its range.
    pub fn touches_of_one_array(
        &self,
        objects: &mut ObjectsSpec,
        (skin, touches): (&SkinSpec, &TouchesSpec),
    ) -> Result<(TaxelArray, Placement)> {
        self.objects(objects)?;
        let array = self.grid(skin)?;
        objects.settle_surface_error(std::slice::from_ref(&array));
        Ok((array, self.placement(touches)?))
    }

    /// Checks that the given keys of a study in which one array touches all objects have an effect. `without_force` states what is allowed in place of keys of
    /// forces; it is `None` if the study reads forces.
    ///
    /// # Errors
    /// If a value other than the usual one has no effect.
    pub fn used_keys<S: Described + Serialize>(
        &self,
        spec: &S,
        (skin, touches): (&SkinSpec, &TouchesSpec),
        without_force: Option<&'static str>,
    ) -> Result<()> {
        let one_array = OneArray {
            skin: skin.clone(),
            touches: touches.clone(),
            without_force,
        };
        self.acting(spec, keys_of::<S>(), &[&one_array])
    }
}

/// Groups elements with equal keys; the order of the groups is the order in which the keys first occur.
pub(super) fn grouped<'a, T, K: PartialEq>(
    things: impl IntoIterator<Item = &'a T>,
    key: impl Fn(&T) -> K,
) -> Vec<(K, Vec<&'a T>)> {
    let mut groups: Vec<(K, Vec<&T>)> = Vec::new();
    for thing in things {
        let of_it = key(thing);
        match groups.iter_mut().find(|(known, _)| *known == of_it) {
            Some((_, group)) => group.push(thing),
            None => groups.push((of_it, vec![thing])),
        }
    }
    groups
}

/// Returns two tables for the rows of the same configurations: one with their results, one with their costs.
pub(super) fn found_and_cost<C, F, T>(
    found: &File<(C, F)>,
    cost: &File<(C, T)>,
    rows: &[(C, F, T)],
) -> Result<[Table; 2]>
where
    C: Columns + Serialize + Clone,
    F: Columns + Serialize + Clone,
    T: Columns + Serialize + Clone,
{
    let of_found = rows
        .iter()
        .map(|(of, found, _)| (of.clone(), found.clone()));
    let of_cost = rows.iter().map(|(of, _, cost)| (of.clone(), cost.clone()));
    Ok([
        found.table(&of_found.collect::<Vec<_>>())?,
        cost.table(&of_cost.collect::<Vec<_>>())?,
    ])
}

/// Calls `act` for each of `things` in sequence; returns the median wall-clock time of a call, seconds, or 0 without any call.
pub(super) fn median_s<T>(things: impl IntoIterator<Item = T>, mut act: impl FnMut(T)) -> f64 {
    let seconds = things.into_iter().map(|thing| {
        let start = Instant::now();
        act(thing);
        start.elapsed().as_secs_f64()
    });
    quantile(&mut seconds.collect::<Vec<_>>(), 0.5)
}

/// Returns a data set with the selected touches of every object; the labels are object numbers. Every object has the same number of touches. The measurements of each object have the shape (n_touches, m).
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
