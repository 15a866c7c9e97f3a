//! Splits by which an audit tests fast classifiers: whole groups, sessions, blocks of time or a given test set, each beside a random split of equal sizes.

use crate::audit::data::AuditData;
use crate::audit::finding::percent;
use crate::error::Result;
use crate::random::Seed;
use crate::statistics::grouped::{GroupedTest, count_groups, interval_of};
use crate::statistics::interval::Interval;
use crate::statistics::p_status::CONFIDENCE;
use bubbletouch_svm::audit::held_out::{HeldOut, HeldOutMethod};
use bubbletouch_svm::audit::{NearestRows, exchange_within, nearest_rows};
use ndarray::{Array2, ArrayView2};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Number of folds of each split.
const N_FOLDS: usize = 5;
/// Maximum number of units with which the held-out accuracy is a note without a test: two days or sensors cannot show how the accuracy varies.
const FEW_UNITS: usize = 4;

/// Assignment of touches to folds, each of which is held out once.
#[derive(Clone, Debug)]
pub struct AuditSplit {
    /// Name of the split: `group`, `session`, `time` or `given`.
    pub name: &'static str,
    /// Fold of each touch; `None` if its class would have no training touches.
    pub folds: Vec<Option<usize>>,
    /// The same folds, exchanged at random among the touches of each class.
    pub random: Vec<Option<usize>>,
    /// Number of folds that are tested, from fold 0. The test set of a given split is fold 0; its training touches are fold 1.
    pub n_folds: usize,
    /// Unit of each touch, such as its group, for intervals. Units are assumed to be independent; touches of one unit are not.
    pub units: Option<Vec<usize>>,
    /// Number of units that are held out, such as groups.
    pub n_units: usize,
}

impl AuditSplit {
    fn new(
        name: &'static str,
        folds: Vec<Option<usize>>,
        (labels, units): (&[usize], Option<&[usize]>),
        seed: &Seed,
    ) -> Self {
        let known = (0..folds.len()).filter(|&touch| folds[touch].is_some());
        let known: Vec<usize> = known.collect();
        let of = known.iter().map(|&touch| labels[touch]);
        let mut values: Vec<usize> = known.iter().filter_map(|&touch| folds[touch]).collect();
        let n_folds = values.iter().max().map_or(0, |last| last + 1);
        exchange_within(
            &of.collect::<Vec<_>>(),
            &mut values,
            &mut seed.named(name).rng(),
        );
        let mut random = vec![None; folds.len()];
        for (touch, value) in known.into_iter().zip(values) {
            random[touch] = Some(value);
        }
        let count = |units: &[usize]| units.iter().collect::<BTreeSet<_>>().len();
        Self {
            name,
            random,
            n_folds: if name == "given" { 1 } else { n_folds },
            n_units: units.map_or(n_folds, count),
            units: units.map(<[usize]>::to_vec),
            folds,
        }
    }

    /// Returns whether so few groups or sessions are held out that their accuracy is a note without a test.
    pub fn has_few_units(&self) -> bool {
        matches!(self.name, "group" | "session") && self.n_units <= FEW_UNITS
    }

    /// Returns whether the touch is tested by these folds.
    pub fn is_tested(&self, fold: Option<usize>) -> bool {
        fold.is_some_and(|fold| fold < self.n_folds)
    }
}

/// Returns the split `named`, or all splits that the data allow: first groups, then sessions, the given test set, and blocks of time. Blocks of time are used if
/// times are given, or nothing else is. If the data do not allow the split `named`, all others are returned.
pub fn splits(
    data: &AuditData,
    labels: &[usize],
    named: Option<&str>,
    seed: &Seed,
) -> Vec<AuditSplit> {
    let (groups, sessions) = (data.groups.as_deref(), data.sessions.as_deref());
    let mut splits = Vec::new();
    let mut add = |name, folds, units| {
        splits.push(AuditSplit::new(name, folds, (labels, units), seed));
    };
    // Sessions that are the groups give the same split.
    let is_own = |sessions: &&[usize]| !groups.is_some_and(|groups| is_same(groups, sessions));
    let own_sessions = sessions.filter(|own| named == Some("session") || is_own(own));
    for (name, units) in [("group", groups), ("session", own_sessions)] {
        let folds = units.and_then(|units| whole_units(labels, units, &seed.named(name)));
        if let Some(folds) = folds {
            add(name, folds, units);
        }
    }
    if let Some(is_test) = &data.is_test {
        let folds = is_test.iter().map(|&is_test| Some(usize::from(!is_test)));
        add("given", folds.collect(), groups.or(sessions));
    }
    if data.is_in_order_of_time || named == Some("time") || splits.is_empty() {
        splits.push(AuditSplit::new(
            "time",
            blocks(labels),
            (labels, None),
            seed,
        ));
    }
    let is_named = |split: &AuditSplit| named.is_none_or(|name| split.name == name);
    if splits.iter().any(is_named) {
        splits.retain(is_named);
    }
    splits
}

/// Returns whether two lists divide the touches in the same way.
pub fn is_same(a: &[usize], b: &[usize]) -> bool {
    let count = |list: &[usize]| list.iter().collect::<BTreeSet<_>>().len();
    let n_pairs = a.iter().zip(b).collect::<BTreeSet<_>>().len();
    count(a) == n_pairs && count(b) == n_pairs
}

/// Returns the touches of each class.
pub fn touches_of_classes(labels: &[usize]) -> BTreeMap<usize, Vec<usize>> {
    let mut classes = BTreeMap::<usize, Vec<usize>>::new();
    for (touch, &label) in labels.iter().enumerate() {
        classes.entry(label).or_default().push(touch);
    }
    classes
}

/// Divides the touches of each class into blocks that follow each other in time.
fn blocks(labels: &[usize]) -> Vec<Option<usize>> {
    let mut folds = vec![None; labels.len()];
    for touches in touches_of_classes(labels).into_values() {
        if touches.len() < 2 {
            continue;
        }
        for (place, &touch) in touches.iter().enumerate() {
            folds[touch] = Some(place * N_FOLDS.min(touches.len()) / touches.len());
        }
    }
    folds
}

/// Draws folds of whole units. Units with the same classes are divided evenly. Returns `None` if fewer than two classes are in two units or more.
fn whole_units(labels: &[usize], units: &[usize], seed: &Seed) -> Option<Vec<Option<usize>>> {
    let mut classes = BTreeMap::<usize, BTreeSet<usize>>::new();
    for (&unit, &label) in units.iter().zip(labels) {
        classes.entry(unit).or_default().insert(label);
    }
    let n_folds = match classes.len() {
        // Folds of one or two units have unequal sizes, so that few units are held out one at a time.
        n if n <= 2 * N_FOLDS => n,
        _ => N_FOLDS,
    };
    let mut order: Vec<usize> = classes.keys().copied().collect();
    order.shuffle(&mut seed.rng());
    order.sort_by(|a, b| classes[a].cmp(&classes[b]));
    let folds = order.into_iter().enumerate();
    let fold_of: BTreeMap<usize, usize> = folds.map(|(k, unit)| (unit, k % n_folds)).collect();
    let mut folds_of_class = BTreeMap::<usize, BTreeSet<usize>>::new();
    for (unit, label) in units.iter().zip(labels) {
        let folds = folds_of_class.entry(*label).or_default();
        folds.insert(fold_of[unit]);
    }
    folds_of_class.retain(|_, folds| folds.len() > 1);
    let folds = units.iter().zip(labels);
    let folds =
        folds.map(|(unit, label)| folds_of_class.contains_key(label).then(|| fold_of[unit]));
    (folds_of_class.len() > 1).then(|| folds.collect())
}

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
