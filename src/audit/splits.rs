//! Splits by which an audit tests classifiers: at random, by blocks of time, by groups and by sessions.

use crate::random::Seed;
use rand::seq::SliceRandom;
use std::collections::{BTreeMap, BTreeSet};

/// Number of folds of each split.
const N_FOLDS: usize = 5;

/// Maximum number of units that are held out one at a time.
const MAX_LEFT_OUT: usize = 10;

/// Assignment of touches to folds, each of which is held out once.
#[derive(Clone, Debug)]
pub struct AuditSplit {
    /// Name of the split: `random`, `time`, `group`, `session` or `given`.
    pub name: &'static str,
    /// Fold of each touch; `None` if its class would have no training touches.
    pub folds: Vec<Option<usize>>,
    /// Number of folds that are tested, from fold 0. The test set of a given split is fold 0; its training touches are fold 1.
    pub n_folds: usize,
    /// Unit of each touch, such as its group, for intervals and tests. Units are assumed to be independent; touches of one unit are not.
    pub units: Option<Vec<usize>>,
}

impl AuditSplit {
    /// Creates a split of which each fold is held out once.
    fn of_folds(name: &'static str, folds: Vec<Option<usize>>, units: Option<Vec<usize>>) -> Self {
        Self {
            name,
            n_folds: folds.iter().flatten().max().map_or(0, |last| last + 1),
            folds,
            units,
        }
    }

    /// Returns whether the touch is tested.
    pub fn is_tested(&self, touch: usize) -> bool {
        self.folds[touch].is_some_and(|fold| fold < self.n_folds)
    }

    /// Returns the number of touches that are tested.
    pub fn n_tested(&self) -> usize {
        (0..self.folds.len())
            .filter(|&touch| self.is_tested(touch))
            .count()
    }
}

/// Returns all splits that the data allow; the random split comes first. `groups` and `sessions` contain one number per touch; `is_test` marks the touches of a
/// given test set.
pub fn splits(
    labels: &[usize],
    groups: Option<&[usize]>,
    sessions: Option<&[usize]>,
    is_test: Option<&[bool]>,
    seed: &Seed,
) -> Vec<AuditSplit> {
    let units = groups.or(sessions).map(<[usize]>::to_vec);
    let mut splits = vec![
        AuditSplit::of_folds("random", random(labels, seed), units.clone()),
        AuditSplit::of_folds("time", blocks(labels), units.clone()),
    ];
    for (name, units) in [("group", groups), ("session", sessions)] {
        if let Some(units) = units
            && let Some(folds) = whole_units(labels, units, &seed.named(name))
        {
            splits.push(AuditSplit::of_folds(name, folds, Some(units.to_vec())));
        }
    }
    if let Some(is_test) = is_test {
        let folds = is_test.iter().map(|&is_test| Some(usize::from(!is_test)));
        splits.push(AuditSplit {
            name: "given",
            folds: folds.collect(),
            n_folds: 1,
            units,
        });
    }
    splits
}

/// Returns the touches of each class.
pub fn touches_of_classes(labels: &[usize]) -> BTreeMap<usize, Vec<usize>> {
    let mut classes = BTreeMap::<usize, Vec<usize>>::new();
    for (touch, &label) in labels.iter().enumerate() {
        classes.entry(label).or_default().push(touch);
    }
    classes
}

/// Draws folds at random within each class.
fn random(labels: &[usize], seed: &Seed) -> Vec<Option<usize>> {
    let mut folds = vec![None; labels.len()];
    let mut next = 0;
    let mut rng = seed.named("random split").rng();
    for mut touches in touches_of_classes(labels).into_values() {
        touches.shuffle(&mut rng);
        if touches.len() < 2 {
            continue;
        }
        for touch in touches {
            folds[touch] = Some(next % N_FOLDS);
            next += 1;
        }
    }
    folds
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
    let mut strata = BTreeMap::<Vec<usize>, Vec<usize>>::new();
    for (unit, classes) in &classes {
        let classes: Vec<usize> = classes.iter().copied().collect();
        strata.entry(classes).or_default().push(*unit);
    }
    // If there are few units, folds of several units would have unequal sizes. Each unit is then a fold.
    let n_folds = match classes.len() {
        n @ ..=MAX_LEFT_OUT => n,
        _ => N_FOLDS,
    };
    let mut fold_of = BTreeMap::new();
    let mut rng = seed.rng();
    let mut next = 0;
    for mut units in strata.into_values() {
        units.shuffle(&mut rng);
        for unit in units {
            fold_of.insert(unit, next % n_folds);
            next += 1;
        }
    }
    let mut folds_of_class = BTreeMap::<usize, BTreeSet<usize>>::new();
    for (unit, label) in units.iter().zip(labels) {
        folds_of_class
            .entry(*label)
            .or_default()
            .insert(fold_of[unit]);
    }
    let is_tested = |label: &usize| folds_of_class[label].len() > 1;
    if folds_of_class
        .keys()
        .filter(|label| is_tested(label))
        .count()
        < 2
    {
        return None;
    }
    let folds = units.iter().zip(labels);
    let folds = folds.map(|(unit, label)| is_tested(label).then(|| fold_of[unit]));
    Some(folds.collect())
}
