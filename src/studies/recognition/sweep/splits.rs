//! Splits into training and test touches for each trial, with checks that both sets have enough touches.

use crate::learning::data::split::{
    Side, given_hold_out, group_hold_out, group_k_fold, stratified_hold_out, stratified_k_fold,
};
use crate::studies::prelude::*;
use crate::studies::recognition::spec::PoseSplit;
use bubbletouch_svm::split::Split;
use ndarray::Array1;
use std::collections::{HashMap, HashSet};

/// Draws the split of all touches into training and test touches for a trial. The split is given by the data, or drawn by poses, by groups (`keys`), or by
/// single touches.
///
/// # Errors
/// If the split requires listed values but a pose is drawn, or if a class has no training or test rows.
pub fn draw_split(
    plan: &Plan,
    labels: &Array1<usize>,
    (poses, keys, given_sides): (&[&Touch], Option<&Array1<usize>>, Option<&[Side]>),
    trial: usize,
) -> Result<Split> {
    let trial = plan.spec.split_of(trial);
    let labels = labels.view();
    let recognition = &plan.spec.recognition;
    let fraction = recognition.test_share();
    let n_folds = recognition.folds.unwrap_or(1);
    let seed = Seed::new(plan.spec.seed).named("split");
    if let Some(sides) = given_sides {
        // Given sides may be equal in all trials; subsets of the training touches are drawn anew in each trial.
        let drawn = recognition.train_touches.as_ref().map_or(0, |_| trial);
        return Ok(given_hold_out(labels, sides, &seed.numbered(drawn as u64))?);
    }
    if recognition.split != PoseSplit::Random {
        let sides = recognition.split.sides(poses, trial)?;
        return Ok(given_hold_out(
            labels,
            &sides,
            &seed.numbered(trial as u64),
        )?);
    }
    let seed = seed.numbered((trial / n_folds) as u64);
    let mut folds = match (recognition.folds, keys) {
        (None, None) => return Ok(stratified_hold_out(labels, fraction, &seed)?),
        (None, Some(keys)) => return Ok(group_hold_out(labels, keys.view(), fraction, &seed)?),
        (Some(k), None) => stratified_k_fold(labels, k, &seed)?,
        (Some(k), Some(keys)) => {
            let folds = group_k_fold(labels, keys.view(), k, &seed);
            folds.map_err(|error| Error::from(error).under("key recognition.folds: "))?
        }
    };
    Ok(folds.swap_remove(trial % n_folds))
}

/// Returns the index of the first split with equal training touches and equal test touches, for each split, in any order.
pub fn first_equal(splits: &[Split]) -> Vec<usize> {
    let mut known: HashMap<&[usize], Vec<usize>> = HashMap::new();
    let trained = |place: usize| splits[place].train.iter().collect::<HashSet<_>>();
    let mut first = Vec::with_capacity(splits.len());
    for (place, split) in splits.iter().enumerate() {
        let alike = known.entry(&split.test[..]).or_default();
        let same = alike
            .iter()
            .find(|&&other| trained(other) == trained(place));
        let same = same.copied();
        if same.is_none() {
            alike.push(place);
        }
        first.push(same.unwrap_or(place));
    }
    first
}

/// Returns the values of the axis `train_touches`: the numbers of training touches per object. The default is the maximum number that every object has in
/// every training split. Also checks that every object has enough touches in every trial. Test touches must suffice for at least one group, and training
/// touches for each inner fold and each imbalance.
///
/// # Errors
/// If a split has fewer training touches of an object than the study requires.
pub fn train_touches(plan: &Plan, splits: &[Split], labels: &Array1<usize>) -> Result<Vec<usize>> {
    let recognition = &plan.spec.recognition;
    let at_most = |key: &str, given: f64, most: usize, what: &str| {
        if given <= most as f64 {
            return Ok(());
        }
        let allowed = format!("at most {most}, {what}");
        let key = format!("key recognition.{key}");
        Err(Error::input(key, given, allowed))
    };
    let fewest = fewest_per_object(splits.iter().map(|split| &split.train), labels);
    let asked = Axis::optional_values(&recognition.train_touches).into_iter();
    let train_touches: Vec<usize> = asked.map(|asked| asked.unwrap_or(fewest)).collect();
    for &count in &train_touches {
        let what = "the training touches of every object in every trial";
        at_most("train_touches", count as f64, fewest, what)?;
    }
    let fewest_tested = fewest_per_object(splits.iter().map(|split| &split.test), labels);
    for k in recognition.touches_per_decision.values() {
        let what = "the test touches of every object in every trial";
        at_most("touches_per_decision", k as f64, fewest_tested, what)?;
    }
    let least = train_touches.iter().min().copied().unwrap_or(0);
    let chooses = recognition.is_open();
    if chooses || recognition.is_informed() {
        let cv_touches = recognition.cv_touches.filter(|_| chooses);
        let of_folds = least.min(cv_touches.unwrap_or(least));
        let n_folds = recognition.n_choice_folds() as f64;
        let what = "the training touches of every object that take part";
        at_most("cv_folds", n_folds, of_folds, what)?;
    }
    for ratio in recognition.class_imbalance.iter().flat_map(Axis::values) {
        let what = "twice the training touches of every object";
        at_most("class_imbalance", ratio, 2 * least, what)?;
    }
    Ok(train_touches)
}

/// Returns the smallest number of touches per object, over all sets of touches and all objects.
fn fewest_per_object<'a>(
    sets: impl Iterator<Item = &'a Vec<usize>>,
    labels: &Array1<usize>,
) -> usize {
    let n_objects = labels.iter().max().map_or(0, |last| last + 1);
    let fewest = sets.map(|rows| {
        let mut counts = vec![0; n_objects];
        for &row in rows {
            counts[labels[row]] += 1;
        }
        counts.into_iter().min().unwrap_or(0)
    });
    fewest.min().unwrap_or(0)
}
