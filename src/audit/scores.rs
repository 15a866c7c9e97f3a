//! Fast classifiers, tested on held-out touches of each split and of the random split of equal sizes.

use crate::audit::finding::percent;
use crate::audit::splits::AuditSplit;
use crate::error::Result;
use crate::random::Seed;
use crate::statistics::grouped::{GroupedTest, count_groups, interval_of};
use crate::statistics::interval::Interval;
use crate::statistics::p_status::CONFIDENCE;
use bubbletouch_svm::audit::held_out::{HeldOut, HeldOutMethod};
use bubbletouch_svm::audit::{NearestRows, nearest_rows};
use ndarray::{Array2, ArrayView2};
use rayon::prelude::*;

/// Number of touches whose distances to all others are computed together.
const BLOCK: usize = 256;

/// Display names of the classifiers of an audit. The names with `_spectrum` are those of classifiers of logarithmic spectra.
pub const METHODS: &[(&str, &str)] = &[
    ("nearest_centroid", "nearest centroid"),
    ("linear_svm", "linear SVM"),
    ("nearest_row", "nearest neighbour"),
    ("nearest_centroid_spectrum", "nearest centroid, spectrum"),
    ("linear_svm_spectrum", "linear SVM, spectrum"),
    ("nearest_row_spectrum", "nearest neighbour, spectrum"),
];

/// Predictions of one classifier by one split.
pub struct Tested {
    /// Name of the classifier.
    pub method: &'static str,
    /// Index of the representation: 0 means of frames, 1 spectra.
    pub representation: usize,
    /// Index of the split.
    pub split: usize,
    /// Whether whole units are held out; otherwise the random split of equal sizes.
    pub is_held_out: bool,
    /// Class that the classifier gives each touch; `None` if it was not tested.
    pub predicted: Vec<Option<usize>>,
    /// Whether the touch was recognised; `None` if it was not tested.
    pub is_correct: Vec<Option<bool>>,
}

impl Tested {
    /// Returns the name of the classifier and its accuracy in words.
    pub fn words(&self) -> String {
        let found = METHODS.iter().find(|method| method.0 == self.method);
        let title = found.map_or(self.method, |method| method.1);
        format!("{title} recognises {}", percent(self.accuracy()))
    }

    /// Returns the fraction of tested touches that were recognised.
    pub fn accuracy(&self) -> f64 {
        let tested = self.is_correct.iter().flatten();
        let n_correct = tested.clone().filter(|&&is_correct| is_correct).count();
        n_correct as f64 / tested.count().max(1) as f64
    }

    /// Returns the 95 % interval of the accuracy, over the units of the split.
    ///
    /// # Errors
    /// If no touch was tested.
    pub fn interval(&self, split: &AuditSplit) -> Result<Interval> {
        let tested = self.is_correct.iter().flatten();
        let n = tested.clone().count();
        let n_correct = tested.filter(|&&is_correct| is_correct).count();
        let groups = split.units.as_ref().map(|units| {
            let rows = units.iter().zip(&self.is_correct);
            count_groups(rows.filter_map(|(&unit, is_correct)| Some((unit, (*is_correct)?))))
        });
        let tested = groups.as_ref().map(|groups| GroupedTest {
            n_rows: n,
            n_correct,
            groups,
        });
        Ok(interval_of([n_correct, n], tested.as_slice(), CONFIDENCE)?.0)
    }
}

/// Trains and tests all classifiers by all splits, of each representation of the touches. Also returns the nearest touches by the first representation.
///
/// # Errors
/// If a feature is not finite.
pub fn scores(
    representations: &[Array2<f64>],
    labels: &[usize],
    splits: &[AuditSplit],
    (n_nearest, seed): (usize, &Seed),
) -> Result<(Vec<Tested>, NearestRows)> {
    let arms = splits.iter().enumerate();
    let arms = arms.flat_map(|(index, split)| {
        [(false, &split.random), (true, &split.folds)]
            .map(|(is_held, folds)| (index, is_held, folds))
    });
    let arms: Vec<_> = arms.collect();
    let folds: Vec<Vec<Option<usize>>> = arms.iter().map(|arm| arm.2.clone()).collect();
    let mut all = Vec::new();
    let mut nearest_of_means = None;
    for (representation, rows) in representations.iter().enumerate() {
        let near = nearest(rows.view(), n_nearest, &folds);
        let names = METHODS.iter().skip(3 * representation).take(3);
        for (arm, &(index, is_held_out, folds)) in arms.iter().enumerate() {
            let split = &splits[index];
            let held_out = HeldOut {
                features: rows.view(),
                labels,
                folds,
            };
            for (place, &(method, _)) in names.clone().enumerate() {
                let predicted =
                    match [HeldOutMethod::NearestCentroid, HeldOutMethod::LinearSvm].get(place) {
                        Some(method) => predictions(&held_out, *method, split.n_folds, seed)?,
                        None => {
                            let outside = near.outside[arm].iter().zip(folds);
                            let own = outside.map(|(other, fold)| {
                                let other = other.filter(|_| split.is_tested(*fold));
                                other.map(|other| labels[other])
                            });
                            own.collect()
                        }
                    };
                let is_correct = predicted.iter().zip(labels);
                let is_correct = is_correct.map(|(class, own)| class.map(|class| class == *own));
                all.push(Tested {
                    method,
                    representation,
                    split: index,
                    is_held_out,
                    is_correct: is_correct.collect(),
                    predicted,
                });
            }
        }
        nearest_of_means.get_or_insert(near);
    }
    Ok((all, nearest_of_means.unwrap_or_default()))
}

/// Returns the class that a classifier gives each touch of the tested folds.
fn predictions(
    held_out: &HeldOut,
    method: HeldOutMethod,
    n_folds: usize,
    seed: &Seed,
) -> Result<Vec<Option<usize>>> {
    let folds = (0..n_folds).into_par_iter();
    let folds = folds.map(|fold| held_out.predicted(method, fold, seed));
    let folds: Vec<_> = folds.collect::<std::result::Result<_, _>>()?;
    let mut predicted = vec![None; held_out.labels.len()];
    for (row, class) in folds.into_iter().flatten() {
        predicted[row] = Some(class);
    }
    Ok(predicted)
}

/// Finds the nearest rows of all rows, block by block on all threads.
pub fn nearest(rows: ArrayView2<f64>, k: usize, folds: &[Vec<Option<usize>>]) -> NearestRows {
    let n = rows.nrows();
    let starts = (0..n.div_ceil(BLOCK)).into_par_iter();
    let blocks = starts.map(|block| {
        let block = block * BLOCK..((block + 1) * BLOCK).min(n);
        nearest_rows(rows, k, folds, block)
    });
    let mut all = NearestRows {
        outside: vec![Vec::new(); folds.len()],
        ..NearestRows::default()
    };
    for block in blocks.collect::<Vec<_>>() {
        all.neighbours.extend(block.neighbours);
        all.distances.extend(block.distances);
        for (all, block) in all.outside.iter_mut().zip(block.outside) {
            all.extend(block);
        }
    }
    all
}
