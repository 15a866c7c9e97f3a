//! Splits of rows into training and test rows: random with a seed, stratified by class, or by whole groups.
//!
//! Every split contains rows of every class in both `train` and `test`. Every row is in exactly one of them, except rows left out by [`given_hold_out`]. Rows
//! are drawn from one named stream per class, so the split of a class does not depend on the rows of other classes.

use std::collections::BTreeMap;

use ndarray::ArrayView1;
use rand::seq::SliceRandom;

use crate::dataset::{check_labels, distinct, positions};
use crate::fold_search::{FoldSearch, NoDivision};
use crate::streams::Streams;
use crate::{Error, Result};

/// Training rows and test rows, by index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    /// Training rows in drawing order: the rows of each class are shuffled, and the classes alternate. A smaller training set is therefore the start of a
    /// larger one.
    pub train: Vec<usize>,
    /// Test rows, ascending.
    pub test: Vec<usize>,
}

impl Split {
    /// Returns a copy of the split with only the first `per_class` training rows of each class; the test rows are unchanged.
    ///
    /// The training rows of all sizes are nested, as a learning curve requires. `labels` contains the label of every row of the data set.
    ///
    /// # Errors
    /// If `per_class` is 0 or exceeds the number of training rows of some class.
    pub fn at_most(&self, labels: ArrayView1<usize>, per_class: usize) -> Result<Split> {
        let mut counts = BTreeMap::<usize, usize>::new();
        for &row in &self.train {
            *counts.entry(labels[row]).or_default() += 1;
        }
        let fewest = counts.values().copied().min().unwrap_or(0);
        if per_class == 0 || per_class > fewest {
            return Err(Error::input(
                "training touches per object",
                per_class,
                format!("1 to {fewest} is allowed, the fewest training rows of a class"),
            ));
        }
        let n_train = per_class * counts.len();
        Ok(Split {
            train: self.train[..n_train].to_vec(),
            test: self.test.clone(),
        })
    }

    /// Converts an inner split of the training rows (such as a validation split) from positions within `train` to rows of the whole data set.
    ///
    /// # Panics
    /// If `inner` contains a position beyond the training rows.
    pub fn within_train(&self, inner: &Split) -> Split {
        let whole = |positions: &[usize]| positions.iter().map(|&i| self.train[i]).collect();
        let mut test: Vec<usize> = whole(&inner.test);
        test.sort_unstable();
        Split {
            train: whole(&inner.train),
            test,
        }
    }
}

/// Assignment of a row to the training rows, the test rows or neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The row is a training row.
    Train,
    /// The row is a test row.
    Test,
    /// The row is not used.
    LeftOut,
}

/// Stratified hold-out: among the n rows of each class, `test_fraction · n` rows (rounded, 1 to n − 1) become test rows.
///
/// # Errors
/// If the fraction is outside 0 < f < 1, or a class has a single row.
pub fn stratified_hold_out(
    labels: ArrayView1<usize>,
    test_fraction: f64,
    seed: &dyn Streams,
) -> Result<Split> {
    check_fraction(test_fraction)?;
    let mut sides = vec![Side::Train; labels.len()];
    let drawn = draw_rows(labels, seed);
    for (class, rows) in &drawn {
        check_class_size(*class, rows.len(), 2)?;
        for &row in &rows[..share(rows.len(), test_fraction)] {
            sides[row] = Side::Test;
        }
    }
    split(labels, &drawn, &sides)
}

/// Hold-out split with a given side for each row; only the order of the training rows is random.
///
/// # Errors
/// If the numbers of sides and labels differ, or a class has no training or no test row.
pub fn given_hold_out(
    labels: ArrayView1<usize>,
    sides: &[Side],
    seed: &dyn Streams,
) -> Result<Split> {
    if sides.len() != labels.len() {
        let allowed = format!("{}, one a label", labels.len());
        return Err(Error::input("sides of a split", sides.len(), allowed));
    }
    split(labels, &draw_rows(labels, seed), sides)
}

/// Stratified k-fold: k splits whose disjoint sets of test rows together contain all rows. The rows of each class, and all rows, are distributed as evenly as
/// possible: counts differ by at most 1.
///
/// # Errors
/// If k is below 2, or a class has fewer than k rows.
pub fn stratified_k_fold(
    labels: ArrayView1<usize>,
    k: usize,
    seed: &dyn Streams,
) -> Result<Vec<Split>> {
    check_folds(k)?;
    let drawn = draw_rows(labels, seed);
    let mut fold_of = vec![0; labels.len()];
    let mut next = 0;
    for (class, rows) in &drawn {
        check_class_size(*class, rows.len(), k)?;
        for &row in rows {
            fold_of[row] = next % k;
            next += 1;
        }
    }
    folds(labels, &drawn, &fold_of, k)
}

/// Group hold-out: whole groups (for example all touches of one pose) are held out as test rows.
///
/// Groups with equal sets of classes form a stratum. In a stratum of n groups, `test_fraction · n` (rounded, 1 to n − 1) are test groups. Strata of a single
/// group are pooled. Groups change sides if a class would otherwise have no training or no test row. `groups` contains one group number per row.
///
/// # Errors
/// If the fraction is outside 0 < f < 1, or the numbers of groups and labels differ. If no division of the groups has training and test rows of every class.
pub fn group_hold_out(
    labels: ArrayView1<usize>,
    groups: ArrayView1<usize>,
    test_fraction: f64,
    seed: &dyn Streams,
) -> Result<Split> {
    check_fraction(test_fraction)?;
    check_labels(labels.len(), groups)?;
    let of_groups = classes_of_groups(labels, groups);
    let (mut order, mut drawn) = (Vec::new(), Vec::new());
    for (stratum, mut members) in strata(&of_groups).into_iter().enumerate() {
        let stream = seed.named("groups").numbered(stratum as u64);
        members.shuffle(&mut stream.rng());
        let n_test = share(members.len(), test_fraction);
        drawn.extend((0..members.len()).map(|rank| usize::from(rank < n_test)));
        order.extend(members);
    }
    let classes_of: Vec<_> = order.iter().map(|group| of_groups[group].clone()).collect();
    let parts = ("parts (training and test)", 2);
    let is_drawn = |_: &FoldSearch, group: usize, part| drawn[group] != part;
    let is_test = divide((&distinct(labels), &classes_of), parts, is_drawn)?;
    let is_test: BTreeMap<usize, usize> = order.into_iter().zip(is_test).collect();
    let sides: Vec<Side> = groups
        .iter()
        .map(|group| side(is_test[group] == 1))
        .collect();
    split(labels, &draw_rows(labels, seed), &sides)
}

/// Group k-fold, stratified by class: k splits whose disjoint sets of test rows together contain all rows. A group is never divided, and every fold contains
/// test rows of every class.
///
/// Groups are assigned in random order, larger groups first. A group gets the fold in which the rows of its classes are rarest (relative to all rows of each
/// class), then the fold with the fewest rows, as in scikit-learn's `StratifiedGroupKFold`. Other folds are taken where the classes would otherwise not be in
/// every fold.
///
/// # Errors
/// If k is below 2, or the numbers of groups and labels differ. If no division of the groups puts every class into every fold.
pub fn group_k_fold(
    labels: ArrayView1<usize>,
    groups: ArrayView1<usize>,
    k: usize,
    seed: &dyn Streams,
) -> Result<Vec<Split>> {
    check_folds(k)?;
    check_labels(labels.len(), groups)?;
    let mut order: Vec<(usize, ClassCounts)> =
        classes_of_groups(labels, groups).into_iter().collect();
    order.shuffle(&mut seed.named("groups").rng());
    let size = |classes: &ClassCounts| classes.iter().map(|(_, n)| n).sum::<usize>();
    order.sort_by_key(|(_, classes)| std::cmp::Reverse(size(classes)));
    let (order, classes_of): (Vec<usize>, Vec<ClassCounts>) = order.into_iter().unzip();
    let n_rows = |class: usize| labels.iter().filter(|label| **label == class).count() as f64;
    let classes = distinct(labels);
    let n_rows: Vec<f64> = classes.iter().map(|&class| n_rows(class)).collect();
    let cost = |search: &FoldSearch, group: usize, fold: usize| {
        let in_fold = |class: usize| search.n_rows(class, fold);
        let classes = classes_of[group].iter();
        let excess =
            classes.map(|&(class, n)| n as f64 * in_fold(class) as f64 / n_rows[class].powi(2));
        let all: usize = (0..n_rows.len()).map(in_fold).sum();
        (excess.sum::<f64>(), all)
    };
    let fold_of = divide((&classes, &classes_of), ("folds", k), cost)?;
    let fold_of: BTreeMap<usize, usize> = order.into_iter().zip(fold_of).collect();
    let fold_of: Vec<usize> = groups.iter().map(|group| fold_of[group]).collect();
    folds(labels, &draw_rows(labels, seed), &fold_of, k)
}

/// Classes of a group, as ascending indices of the distinct labels, each with its number of rows in the group.
type ClassCounts = Vec<(usize, usize)>;

/// Returns the classes of each group.
fn classes_of_groups(
    labels: ArrayView1<usize>,
    groups: ArrayView1<usize>,
) -> BTreeMap<usize, ClassCounts> {
    let mut counts = BTreeMap::<usize, BTreeMap<usize, usize>>::new();
    for (class, &group) in positions(labels, &distinct(labels)).into_iter().zip(groups) {
        *counts.entry(group).or_default().entry(class).or_default() += 1;
    }
    let of_group =
        |(group, classes): (usize, BTreeMap<_, _>)| (group, classes.into_iter().collect());
    counts.into_iter().map(of_group).collect()
}

/// Divides groups into parts, so that every part contains every class. Returns the part of each group. `classes_of` contains the classes of each group, as
/// indices of `classes`, with their numbers of rows. `place` names the number of parts in errors.
///
/// # Errors
/// If no such division exists. The error contains the largest possible number of parts.
fn divide<C: PartialOrd>(
    (classes, classes_of): (&[usize], &[ClassCounts]),
    (place, n_parts): (&str, usize),
    cost: impl Fn(&FoldSearch, usize, usize) -> C,
) -> Result<Vec<usize>> {
    let search = |n_parts| FoldSearch::new(classes_of.to_vec(), classes.len(), n_parts);
    let found = search(n_parts).divide(cost);
    found.map_err(|reason| {
        let n_groups = |class: usize| {
            let groups = classes_of.iter();
            groups
                .filter(|of| of.iter().any(|(other, _)| *other == class))
                .count()
        };
        let fewest = (0..classes.len())
            .map(|class| (n_groups(class), classes[class]))
            .min();
        let why = match (fewest, reason) {
            (Some((n, class)), _) if n < n_parts => {
                let groups = if n == 1 { "group" } else { "groups" };
                format!("class {class} has rows in only {n} {groups}")
            }
            (_, NoDivision::Impossible) => {
                "no division of the groups has every class in each".to_owned()
            }
            (_, NoDivision::NotFound) => {
                "no division with every class in each was found".to_owned()
            }
        };
        let is_possible = |n: &usize| search(*n).divide(|_, _, _| 0).is_ok();
        let at_most = fewest.map_or(0, |(n, _)| n).min(n_parts - 1);
        let allowed = match (2..=at_most).rev().find(is_possible) {
            Some(most) => {
                format!("at most {most} with these groups: each needs a group of every class")
            }
            None => "groups of which each class has two or more that can be apart".to_owned(),
        };
        Error::input(place, format!("{n_parts}, but {why}"), allowed)
    })
}

/// Returns the rows of each class, shuffled by the random stream of the class.
fn draw_rows(labels: ArrayView1<usize>, seed: &dyn Streams) -> BTreeMap<usize, Vec<usize>> {
    let mut drawn = BTreeMap::<usize, Vec<usize>>::new();
    for (row, &class) in labels.iter().enumerate() {
        drawn.entry(class).or_default().push(row);
    }
    for (&class, rows) in &mut drawn {
        rows.shuffle(&mut seed.named("class").numbered(class as u64).rng());
    }
    drawn
}

/// Returns the groups of rows in each stratum; a stratum consists of groups that contain equal sets of classes. Strata of a single group are pooled into the
/// last stratum.
fn strata(of_groups: &BTreeMap<usize, ClassCounts>) -> Vec<Vec<usize>> {
    let mut by_classes = BTreeMap::<Vec<usize>, Vec<usize>>::new();
    for (&group, classes) in of_groups {
        let classes = classes.iter().map(|(class, _)| *class).collect();
        by_classes.entry(classes).or_default().push(group);
    }
    let (mut strata, single): (Vec<_>, Vec<_>) = by_classes
        .into_values()
        .partition(|members| members.len() > 1);
    let pooled: Vec<usize> = single.into_iter().flatten().collect();
    if !pooled.is_empty() {
        strata.push(pooled);
    }
    strata
}

/// Returns the number of test elements among `n` elements: `n · fraction`, rounded, at least 1 and at most n − 1.
fn share(n: usize, fraction: f64) -> usize {
    ((n as f64 * fraction).round() as usize).clamp(1.min(n - 1), n - 1)
}

fn folds(
    labels: ArrayView1<usize>,
    drawn: &BTreeMap<usize, Vec<usize>>,
    fold_of: &[usize],
    k: usize,
) -> Result<Vec<Split>> {
    (0..k)
        .map(|fold| {
            let sides: Vec<Side> = fold_of.iter().map(|&f| side(f == fold)).collect();
            split(labels, drawn, &sides)
        })
        .collect()
}

fn side(is_test: bool) -> Side {
    match is_test {
        true => Side::Test,
        false => Side::Train,
    }
}

/// Creates a split whose training rows alternate between the classes and whose test rows are sorted. Returns an error if a class has no training or no test
/// row.
fn split(
    labels: ArrayView1<usize>,
    drawn: &BTreeMap<usize, Vec<usize>>,
    sides: &[Side],
) -> Result<Split> {
    let mut ranked = Vec::new();
    for (&class, rows) in drawn {
        let on = |side: Side| rows.iter().copied().filter(move |&row| sides[row] == side);
        let train: Vec<usize> = on(Side::Train).collect();
        let n_test = on(Side::Test).count();
        if train.is_empty() || n_test == 0 {
            return Err(Error::input(
                format!("split, class {class}"),
                format!("{} training and {n_test} test rows", train.len()),
                "every class needs at least one of each: more rows, more groups or another fraction",
            ));
        }
        ranked.extend(train.into_iter().enumerate());
    }
    // The sort is stable: within a rank, the classes stay ascending.
    ranked.sort_by_key(|&(rank, _)| rank);
    if ranked.is_empty() {
        return Err(Error::input(
            "labels",
            "no rows",
            "at least two rows are needed",
        ));
    }
    Ok(Split {
        train: ranked.into_iter().map(|(_, row)| row).collect(),
        test: (0..labels.len())
            .filter(|&row| sides[row] == Side::Test)
            .collect(),
    })
}

fn check_fraction(test_fraction: f64) -> Result<()> {
    if test_fraction > 0.0 && test_fraction < 1.0 {
        return Ok(());
    }
    Err(Error::input(
        "test fraction",
        test_fraction,
        "a number between 0 and 1, both excluded, is allowed",
    ))
}

fn check_folds(k: usize) -> Result<()> {
    if k >= 2 {
        return Ok(());
    }
    Err(Error::input("folds", k, "2 or more are allowed"))
}

fn check_class_size(class: usize, n_rows: usize, at_least: usize) -> Result<()> {
    if n_rows >= at_least {
        return Ok(());
    }
    Err(Error::input(
        format!("labels, class {class}"),
        format!("{n_rows} rows"),
        format!("at least {at_least} rows are needed for this split"),
    ))
}
