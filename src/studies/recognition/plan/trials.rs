//! Numbers of the splits and projections that the trials of a study use.

use crate::error::Result;
use crate::inputs::check::Check;
use crate::studies::recognition::spec::study::StudySpec;

/// Methods that assign a split t and a projection (measurement matrix) t to each trial t. With P = `projections_per_split`, trial t has split t / P and
/// projection t mod P, so that each split is combined with P projections. All other random numbers are drawn anew in each trial.
impl StudySpec {
    /// Returns the number of the split into training and test touches that is used in a trial.
    pub fn split_of(&self, trial: usize) -> usize {
        trial / self.projections_per_split.unwrap_or(1)
    }

    /// Returns the number of the projection (measurement matrix) that is used in a trial.
    pub fn projection_of(&self, trial: usize) -> usize {
        projection_of(self.projections_per_split, trial)
    }
}

/// Returns the number of the projection (measurement matrix) that is used in a trial. Without `projections_per_split`, each trial has its own projection;
/// otherwise, all splits share that many projections.
pub(crate) fn projection_of(projections_per_split: Option<usize>, trial: usize) -> usize {
    projections_per_split.map_or(trial, |n| trial % n)
}

impl Check<'_> {
    /// Checks that the number of trials is a multiple of the key `projections_per_split`.
    pub(crate) fn repeats(&self, spec: &StudySpec) -> Result<()> {
        const KEY: &str = "projections_per_split";
        let Some(n_projections) = spec.projections_per_split else {
            return Ok(());
        };
        if n_projections < 2 {
            let allowed = "at least 2, or no such key: a projection of its own for each trial";
            return Err(self.error(KEY, n_projections, allowed));
        }
        let n_splits = spec.trials / n_projections;
        if !spec.trials.is_multiple_of(n_projections) || n_splits < 2 {
            let allowed = format!("a multiple of {KEY} = {n_projections}, for at least 2 splits");
            return Err(self.error("trials", spec.trials, allowed));
        }
        match spec.recognition.folds {
            Some(k) if !n_splits.is_multiple_of(k) => {
                let given = format!("{n_splits} splits of {n_projections} projections each");
                let allowed = format!("a multiple of recognition.folds = {k} splits");
                Err(self.error("trials", given, allowed))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn study(projections_per_split: Option<usize>) -> StudySpec {
        let text = "question = \"?\"\n[skin]\npitch_mm = 2.0\nstroke_mm = 5.0\n[sensing]\n[recognition]\nclassifier = \"linear_svm\"";
        StudySpec {
            projections_per_split,
            ..StudySpec::parse("study.toml", text).unwrap()
        }
    }

    #[test]
    fn crossed_trials_meet_every_projection_with_every_split_once() {
        let crossed = study(Some(3));
        let met: BTreeSet<_> = (0..12)
            .map(|t| (crossed.split_of(t), crossed.projection_of(t)))
            .collect();
        assert_eq!(met.len(), 12);
        assert!(
            met.iter()
                .all(|&(split, projection)| split < 4 && projection < 3)
        );
        let own = study(None);
        assert_eq!((own.split_of(7), own.projection_of(7)), (7, 7));
    }
}
