//! Touches on which a configuration trains, and to which its ensemble and its image estimators are fitted.

use crate::error::Result;
use crate::learning::data::spoiled::{mislabelled, with_imbalance};
use crate::studies::recognition::plan::Plan;
use crate::studies::recognition::rows::Configuration;
use crate::studies::recognition::training::TrialInputs;
use bubbletouch_svm::split::Split;
use ndarray::{Array1, Axis};
use serde::Serialize;

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
            let right = labels.select(Axis(0), &split.train);
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
