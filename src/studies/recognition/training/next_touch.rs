//! Selection of the test touches that are combined into one decision, if the study selects touches by their poses. The robot touches an unknown object in a
//! known frame.

use crate::error::Result;
use crate::learning::evaluation::next_touch::{
    AnswerModel, NextTouch, PoseAnswers, most_informative, sequence,
};
use crate::studies::recognition::training::{
    Decision, FamilyInputs, Fitted, Training, TrialInputs,
};
use bubbletouch_svm::dataset::Dataset;
use bubbletouch_svm::split::Split;
use ndarray::{Array1, Array2};
use rayon::prelude::*;

/// Fits a model that predicts a classifier's decision on a touch from its pose. The decisions come from training touches, with classifiers that were trained
/// without these touches.
pub(super) fn answer_model<'a>(
    (trial, family): (&TrialInputs, &FamilyInputs<'a>),
    training: &Training,
    (fitted, split): (&Fitted, &Split),
) -> Result<Option<AnswerModel<'a>>> {
    let Some(poses) = family.poses else {
        return Ok(None);
    };
    let answers = training.held_out_answers(fitted)?.into_iter();
    let touches = split.train.iter().zip(&training.data.targets).zip(answers);
    let touches: Vec<_> = touches
        .map(|((touch, object), answer)| (*touch, *object, answer))
        .collect();
    Ok(Some(AnswerModel::new(poses, &touches, trial.n_objects())))
}

/// Returns groups of k test touches; each group is combined into one decision. A touch is given by its index among the test touches; groups are ordered by
/// class. All touches of a group are random, or the first one is random and the others are chosen among all test touches of the object.
pub(super) fn choose_touches(
    (family, configuration): (&FamilyInputs, &Decision),
    answered: &AnsweredTouches,
    groups: Vec<Vec<usize>>,
) -> Vec<Vec<usize>> {
    let (next, poses) = match (configuration.next_touch, family.poses) {
        (NextTouch::Random, _) | (_, None) => return groups,
        (next, Some(poses)) => (next, poses),
    };
    let (truth, touches) = (&answered.test.targets, answered.touches);
    let model = answered.model.as_ref();
    let singles: Vec<Vec<usize>> = (0..truth.len()).map(|place| vec![place]).collect();
    let answers = (answered.decide)(&singles);
    let of_object = |groups: &&[Vec<usize>]| -> Vec<Vec<usize>> {
        let object = truth[groups[0][0]];
        let places = (0..truth.len()).filter(|&place| truth[place] == object);
        let places: Vec<usize> = places.collect();
        let touches: Vec<usize> = places.iter().map(|&place| touches[place]).collect();
        let answers: Vec<usize> = places.iter().map(|&place| answers[place]).collect();
        let poses = poses.select(&touches);
        // All groups of an object choose among the same poses.
        let told: Vec<PoseAnswers> = match (next, model) {
            (NextTouch::MostInformative, Some(model)) => {
                touches.iter().map(|&touch| model.at(touch)).collect()
            }
            _ => Vec::new(),
        };
        let next = |made: &[usize], left: &[usize]| match told.is_empty() {
            true => poses.farthest(made, left),
            false => most_informative((&told, &answers), made, left),
        };
        let chosen = groups.iter().map(|group| {
            let first = places.partition_point(|&place| place < group[0]);
            let chosen = sequence((first, group.len()), places.len(), next);
            chosen.into_iter().map(|touch| places[touch]).collect()
        });
        chosen.collect()
    };
    let of_objects = groups.chunk_by(|a, b| truth[a[0]] == truth[b[0]]);
    let of_objects: Vec<&[Vec<usize>]> = of_objects.collect();
    let chosen: Vec<_> = of_objects.par_iter().map(of_object).collect();
    chosen.concat()
}

/// Test touches with a classifier's decision on each touch.
pub(super) struct AnsweredTouches<'a> {
    pub(super) fitted: &'a Fitted,
    pub(super) test: &'a Dataset,
    /// Number of the touch of each test row.
    pub(super) touches: &'a [usize],
    /// Group of each test touch; `None` if the split does not hold out whole groups.
    pub(super) groups: Option<&'a [usize]>,
    pub(super) decide: Decide<'a>,
    /// Additive scores of each test touch; `None` if neither predictions nor the log-loss are kept.
    pub(super) scores: Option<Array2<f64>>,
    pub(super) answer_s: f64,
    pub(super) n_train: usize,
    /// Model that predicts the classifier's decision from the pose of a touch; `None` if no configuration uses the model.
    pub(super) model: Option<AnswerModel<'a>>,
    pub(super) model_s: f64,
}

/// Function that returns a predicted label for each given group of test touches.
pub(crate) type Decide<'a> = Box<dyn Fn(&[Vec<usize>]) -> Array1<usize> + 'a>;
