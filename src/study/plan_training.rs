//! Which touches train and which test, and what is wrong with those that train: checks of `[recognition]`.

use super::check::{Check, positive};
use super::plan::{SplitKind, SplitPlan};
use super::pose_groups::KeepTogether;
use super::spec::{RecognitionSpec, StudySpec};
use crate::error::Result;

impl Check<'_> {
    pub fn train_touches(&self, spec: &StudySpec) -> Result<Vec<Option<usize>>> {
        let Some(axis) = &spec.recognition.train_touches else {
            return Ok(vec![None]);
        };
        let counts = self.counts("recognition.train_touches", axis)?;
        Ok(counts.into_iter().map(Some).collect())
    }

    pub fn mislabelled(&self, spec: &StudySpec) -> Result<Vec<Option<f64>>> {
        let Some(axis) = &spec.recognition.mislabelled_fraction else {
            return Ok(vec![None]);
        };
        let is_fraction = |f| (0.0..=1.0).contains(&f);
        let key = "recognition.mislabelled_fraction";
        let values = self.axis(key, axis, is_fraction, "a fraction, 0 to 1")?;
        Ok(values.into_iter().map(Some).collect())
    }

    /// The axis of class imbalance; with folds it has no rows of the rarest objects for them.
    pub fn class_imbalance(&self, spec: &StudySpec) -> Result<Vec<Option<f64>>> {
        let recognition = &spec.recognition;
        let Some(axis) = &recognition.class_imbalance else {
            return Ok(vec![None]);
        };
        let key = "recognition.class_imbalance";
        if recognition.choose_c.is_some() || recognition.choose_gamma.is_some() {
            let allowed = "a given c and gamma: folds need touches of every object";
            return Err(self.error(key, "given beside choose_c or choose_gamma", allowed));
        }
        let is_ratio = |ratio: f64| ratio.is_finite() && ratio >= 1.0;
        let values = self.axis(key, axis, is_ratio, "a number of at least 1")?;
        Ok(values.into_iter().map(Some).collect())
    }

    pub fn split(&self, spec: &StudySpec) -> Result<SplitPlan> {
        let recognition = &spec.recognition;
        let kind = match (recognition.test_fraction, recognition.folds) {
            (Some(_), Some(_)) => {
                return Err(self.error(
                    "recognition",
                    "both test_fraction and folds",
                    "one of them",
                ));
            }
            (fraction, None) => {
                let inside = |f: f64| f > 0.0 && f < 1.0;
                let fraction = self.value(
                    "recognition.test_fraction",
                    fraction.unwrap_or(0.25),
                    inside,
                    "between 0 and 1",
                )?;
                SplitKind::HoldOut(fraction)
            }
            (None, Some(k)) => {
                if k < 2 {
                    return Err(self.error("recognition.folds", k, "at least 2"));
                }
                if !spec.trials.is_multiple_of(k) {
                    return Err(self.error(
                        "trials",
                        spec.trials,
                        format!("a multiple of recognition.folds = {k}"),
                    ));
                }
                SplitKind::Folds(k)
            }
        };
        Ok(SplitPlan {
            kind,
            keep_together: self.keep_together(recognition)?,
        })
    }

    /// What stays together, and how near is together where values are drawn.
    fn keep_together(&self, recognition: &RecognitionSpec) -> Result<Option<KeepTogether>> {
        let distance = |key: &str, given: Option<f64>, unit: f64| {
            let Some(value) = given else {
                return Ok(None);
            };
            let key = format!("recognition.{key}");
            if recognition.keep_together.is_none() {
                let allowed = "no such key without recognition.keep_together";
                return Err(self.error(&key, value, allowed));
            }
            let value = self.value(&key, value, positive, "a positive number")?;
            Ok(Some(unit * value))
        };
        let metres = distance("keep_together_mm", recognition.keep_together_mm, 1e-3)?;
        let degree = std::f64::consts::PI / 180.0;
        let radians = distance("keep_together_deg", recognition.keep_together_deg, degree)?;
        Ok(recognition.keep_together.map(|kind| KeepTogether {
            kind,
            metres,
            radians,
        }))
    }
}
