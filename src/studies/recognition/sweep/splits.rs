//! Splits into training and test touches for each trial, with checks that both sets have enough touches, and the training touches of each configuration.

use crate::learning::data::split::{
    Side, given_hold_out, group_hold_out, group_k_fold, stratified_hold_out, stratified_k_fold,
};
use crate::learning::data::spoiled::{mislabelled, with_imbalance};
use crate::studies::prelude::*;
use crate::studies::recognition::spec::PoseSplit;
use crate::studies::recognition::training::TrialInputs;
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

/// Settings that reduce or relabel the training touches of a split.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TrainingRows {
    /// Maximum number of training touches per object; `None` for all training touches of the split.
    pub train_touches: Option<usize>,
    /// Fraction of the training touches that are labelled as another object, 0 to 1; `None` if all labels are correct.
    pub mislabelled_fraction: Option<f64>,
    /// Ratio of the numbers of training touches of the most and the least frequent object, at least 1; `None` without imbalance.
    pub class_imbalance: Option<f64>,
}

impl TrainingRows {
    /// Returns the settings of a configuration.
    pub fn new(plan: &Plan, configuration: &Configuration) -> Self {
        let train_touches = plan.spec.recognition.train_touches.as_ref();
        Self {
            train_touches: train_touches.map(|_| configuration.train_touches),
            mislabelled_fraction: configuration.mislabelled_fraction,
            class_imbalance: configuration.class_imbalance,
        }
    }
}

impl TrialInputs<'_> {
    /// Returns the split of the trial with the training touches that remain, and the label of every touch with which a classifier trains.
    ///
    /// # Errors
    /// If an object has no training touches after the reduction, or the fraction of wrong labels is not between 0 and 1.
    pub fn training(&self, rows: &TrainingRows) -> Result<(Split, Array1<usize>)> {
        let mut labels = (**self.labels).clone();
        let mut split = match rows.train_touches {
            None => (**self.split).clone(),
            Some(n) => self.split.at_most(labels.view(), n)?,
        };
        let seed = self.stream("training rows");
        if let Some(ratio) = rows.class_imbalance {
            split = with_imbalance(&split, labels.view(), ratio, &seed)?;
        }
        if let Some(fraction) = rows.mislabelled_fraction {
            let right = labels.select(ndarray::Axis(0), &split.train);
            let wrong = mislabelled(right.view(), fraction, &seed)?;
            for (&row, label) in split.train.iter().zip(wrong) {
                labels[row] = label;
            }
        }
        Ok((split, labels))
    }
}

/// Returns the maximum number of training touches with `n_frames` frames each to which ensembles and image estimators are fitted.
pub(crate) fn learned_touches(n_frames: usize) -> usize {
    LEARNED_FRAMES.div_ceil(n_frames.max(1))
}

/// Maximum number of frames to which image estimators are fitted. With fewer frames than components, the estimate is underdetermined; with more frames, fitting
/// takes longer.
pub const LEARNED_FRAMES: usize = 4096;

/// Approximate number of frames, including shifted copies, to which image estimators are fitted if there are fewer than [`LEARNED_FRAMES`] frames. A copy adds
/// less information than a new frame. For example, 880 frames of a real skin and block averages at 16:1 give an accuracy of 0.930. With half as many copies,
/// the accuracy is 0.922. Twice as many copies give the same accuracy and take twice as long.
pub const WITH_COPIES: usize = 2 * LEARNED_FRAMES;
