//! Cheap classifiers, tested on held-out touches of each split.

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
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

/// Number of touches whose distances to all others are computed together.
const BLOCK: usize = 256;
/// Number of nearest touches of each touch.
pub const N_NEAREST: usize = 17;

/// Display names of the classifiers of an audit.
pub const METHODS: &[(&str, &str)] = &[
    ("nearest_centroid", "nearest centroid"),
    ("linear_svm", "linear SVM"),
    ("nearest_row", "nearest neighbour"),
    (
        "nearest_row_invariant",
        "nearest neighbour, shift-invariant",
    ),
    ("linear_svm_invariant", "linear SVM, shift-invariant"),
];

/// Features of all touches: means of blocks, and features that do not depend on the place of the contact.
pub struct Features {
    /// Means of blocks of taxels and frames, shape (n, m).
    pub blocks: Array2<f64>,
    /// Shift-invariant features of the mean frame, shape (n, m); `None` without a grid.
    pub invariant: Option<Array2<f64>>,
    /// Numbers of rows and columns of the image from which the shift-invariant features are computed.
    pub image: (usize, usize),
}

/// Predictions of one classifier by one split.
pub struct Tested {
    /// Name of the classifier.
    pub method: &'static str,
    /// Index of the split.
    pub split: usize,
    /// Whether the touch was recognised; `None` if it was not tested.
    pub is_correct: Vec<Option<bool>>,
    /// Scores of all classes for each touch, NaN if it was not tested; `None` for nearest neighbours.
    pub scores: Option<Array2<f64>>,
}

/// Predictions of all classifiers by all splits, and nearest touches.
pub struct Scores {
    /// Predictions, ordered by split and method.
    pub tested: Vec<Tested>,
    /// Indices of the nearest touches of each touch by blocks.
    pub neighbours: Vec<Vec<usize>>,
    /// Distances of the nearest touches of each touch by blocks.
    pub distances: Vec<Vec<f64>>,
    /// Indices of the nearest touches of each touch by shift-invariant features; `None` without a grid.
    pub invariant_neighbours: Option<Vec<Vec<usize>>>,
    /// Nearest touch in another fold of the random split, by blocks.
    pub nearest_outside: Vec<Option<usize>>,
}

impl Tested {
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

/// Trains and tests all classifiers by all splits.
///
/// # Errors
/// If a feature is not finite.
pub fn scores(
    features: &Features,
    (labels, n_classes): (&[usize], usize),
    splits: &[AuditSplit],
    seed: &Seed,
) -> Result<Scores> {
    let folds: Vec<Vec<Option<usize>>> = splits.iter().map(|split| split.folds.clone()).collect();
    let near = nearest(features.blocks.view(), N_NEAREST, &folds);
    let near_invariant = features
        .invariant
        .as_ref()
        .map(|rows| nearest(rows.view(), N_NEAREST, &folds));
    let mut tested = Vec::new();
    let mut held = vec![
        (
            "nearest_centroid",
            HeldOutMethod::NearestCentroid,
            &features.blocks,
        ),
        ("linear_svm", HeldOutMethod::LinearSvm, &features.blocks),
    ];
    if let Some(invariant) = &features.invariant {
        held.push(("linear_svm_invariant", HeldOutMethod::LinearSvm, invariant));
    }
    for (index, split) in splits.iter().enumerate() {
        for &(name, method, rows) in &held {
            let held_out = HeldOut {
                features: rows.view(),
                labels,
                n_classes,
                folds: &split.folds,
            };
            let folds = (0..split.n_folds).into_par_iter();
            let folds = folds.map(|fold| held_out.scores(method, fold, seed));
            let folds: Vec<_> = folds.collect::<std::result::Result<_, _>>()?;
            let mut scores = Array2::from_elem((labels.len(), n_classes), f64::NAN);
            let mut is_correct = vec![None; labels.len()];
            for (rows, found) in folds {
                for (row, found) in rows.into_iter().zip(found.rows()) {
                    let best = (0..n_classes).fold(0, |best, class| {
                        if found[class] > found[best] {
                            class
                        } else {
                            best
                        }
                    });
                    is_correct[row] = Some(best == labels[row]);
                    scores.row_mut(row).assign(&found);
                }
            }
            tested.push(Tested {
                method: name,
                split: index,
                is_correct,
                scores: Some(scores),
            });
        }
        let near = [
            ("nearest_row", Some(&near)),
            ("nearest_row_invariant", near_invariant.as_ref()),
        ];
        for (method, near) in near {
            let Some(near) = near else { continue };
            let outside = near.outside[index].iter().enumerate();
            let is_correct = outside.map(|(row, other)| {
                let other = other.filter(|_| split.is_tested(row))?;
                Some(labels[other] == labels[row])
            });
            tested.push(Tested {
                method,
                split: index,
                is_correct: is_correct.collect(),
                scores: None,
            });
        }
    }
    Ok(Scores {
        tested,
        invariant_neighbours: near_invariant.map(|near| near.neighbours),
        nearest_outside: near.outside.into_iter().next().unwrap_or_default(),
        neighbours: near.neighbours,
        distances: near.distances,
    })
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
        neighbours: Vec::new(),
        distances: Vec::new(),
        outside: vec![Vec::new(); folds.len()],
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

/// Mean difference between two lists of results of the same touches, and its test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairedDifference {
    /// Fraction recognised by the first minus fraction recognised by the second.
    pub mean: f64,
    /// p-value of the hypothesis that the first recognises no more than the second.
    pub p_value: f64,
}

/// Compares two lists of results of the same touches by a t-test over units, or over touches if there are no units.
///
/// The mean difference is a ratio of sums. Its standard error follows from the deviation of each unit: the sum of the unit's differences, minus its number of
/// touches times the mean difference. Returns `None` for fewer than five units.
pub fn paired_difference(
    first: &[Option<bool>],
    second: &[Option<bool>],
    units: Option<&[usize]>,
) -> Option<PairedDifference> {
    let mut sums = BTreeMap::<usize, (f64, f64)>::new();
    let mut n_different = 0.0;
    for (row, pair) in first.iter().zip(second).enumerate() {
        if let (Some(first), Some(second)) = pair {
            let unit = units.map_or(row, |units| units[row]);
            let (sum, n) = sums.entry(unit).or_default();
            *sum += f64::from(u8::from(*first)) - f64::from(u8::from(*second));
            *n += 1.0;
            n_different += f64::from(u8::from(first != second));
        }
    }
    let n_units = sums.len() as f64;
    if n_units < 5.0 {
        return None;
    }
    let (sum, n) = sums
        .values()
        .fold((0.0, 0.0), |(s, n), of| (s + of.0, n + of.1));
    let mean = sum / n;
    let squares: f64 = sums.values().map(|(sum, n)| (sum - mean * n).powi(2)).sum();
    // At least the variance of independent touches (McNemar's test); few units may agree by chance.
    let variance = (squares * n_units / (n_units - 1.0))
        .max(n_different)
        .max(1.0);
    let student = StudentsT::new(0.0, 1.0, n_units - 1.0).ok()?;
    Some(PairedDifference {
        mean,
        p_value: student.sf(sum / variance.sqrt()),
    })
}
