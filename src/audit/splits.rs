//! Splits by which an audit tests classifiers: whole groups, sessions, blocks of time or a given test set, each beside a random split of equal sizes.

use crate::audit::data::AuditData;
use crate::random::Seed;
use bubbletouch_svm::audit::exchange_within;
use rand::seq::SliceRandom;
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
