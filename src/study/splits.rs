//! Which touches train and which test, trial by trial, and whether they are enough for what is asked of them.

use super::plan::{Plan, SplitKind};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::recognition::split::{
    Split, group_hold_out, group_k_fold, stratified_hold_out, stratified_k_fold,
};
use ndarray::Array1;

/// The split of all touches in a trial.
pub fn draw_split(
    plan: &Plan,
    labels: &Array1<usize>,
    keys: Option<&Array1<usize>>,
    trial: usize,
) -> Result<Split> {
    let trial = plan.repeats.split(trial);
    let seed = Seed::new(plan.spec.seed).named("split");
    match plan.split.kind {
        SplitKind::HoldOut(fraction) => {
            let seed = seed.numbered(trial as u64);
            match keys {
                None => stratified_hold_out(labels.view(), fraction, &seed),
                Some(keys) => group_hold_out(labels.view(), keys.view(), fraction, &seed),
            }
        }
        SplitKind::Folds(k) => {
            let seed = seed.numbered((trial / k) as u64);
            let mut folds = match keys {
                None => stratified_k_fold(labels.view(), k, &seed)?,
                Some(keys) => group_k_fold(labels.view(), keys.view(), k, &seed)?,
            };
            Ok(folds.swap_remove(trial % k))
        }
    }
}

/// The training-touches axis: what is asked for, or all that the smallest training split has for every object.
pub fn train_touches(plan: &Plan, splits: &[Split], labels: &Array1<usize>) -> Result<Vec<usize>> {
    let fewest = fewest_per_object(splits.iter().map(|split| &split.train), labels);
    plan.train_touches
        .iter()
        .map(|asked| match *asked {
            None => Ok(fewest),
            Some(count) if count <= fewest => Ok(count),
            Some(count) => Err(Error::input(
                "key recognition.train_touches",
                count,
                format!("at most {fewest}, the training touches of every object in every trial"),
            )),
        })
        .collect()
}

/// Every object has test touches for at least one group in every trial.
pub fn check_fused_touches(plan: &Plan, splits: &[Split], labels: &Array1<usize>) -> Result<()> {
    let fewest = fewest_per_object(splits.iter().map(|split| &split.test), labels);
    match plan.fused_touches.iter().find(|&&k| k > fewest) {
        None => Ok(()),
        Some(k) => Err(Error::input(
            "key recognition.fused_touches",
            k,
            format!("at most {fewest}, the test touches of every object in every trial"),
        )),
    }
}

/// Where C or γ is chosen, every object has a training touch for each fold.
pub fn check_folds(plan: &Plan, train_touches: &[usize]) -> Result<()> {
    let choice = &plan.choice;
    let fewest = train_touches.iter().min().copied().unwrap_or(0);
    let fewest = choice.touches.map_or(fewest, |most| fewest.min(most));
    let is_open = !(choice.c.is_empty() && choice.gamma_multiples.is_empty());
    if is_open && choice.folds > fewest {
        return Err(Error::input(
            "key recognition.choose_folds",
            choice.folds,
            format!("at most {fewest}, the training touches of every object that take part"),
        ));
    }
    Ok(())
}

/// No imbalance leaves an object without a training touch.
pub fn check_imbalance(plan: &Plan, train_touches: &[usize]) -> Result<()> {
    let most = 2.0 * train_touches.iter().min().copied().unwrap_or(0) as f64;
    let ratios = plan.class_imbalance.iter().flatten();
    match ratios.copied().find(|&ratio| ratio > most) {
        None => Ok(()),
        Some(ratio) => Err(Error::input(
            "key recognition.class_imbalance",
            ratio,
            format!("at most {most}, twice the training touches of every object"),
        )),
    }
}

/// The touches of the object that has fewest among any of some rows.
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
