//! What a trial draws anew: a split and a projection of its own, or every split with every projection.

use super::check::Check;
use super::evaluation::CONFIDENCE;
use super::spec::StudySpec;
use super::table::{PStatus, TrialScore};
use crate::error::Result;
use crate::recognition::statistics::comparison::{
    Comparison, TrialSize, compare, compare_crossed, trials_needed,
};
use crate::recognition::statistics::interval::Interval;
use ndarray::Array2;
use std::collections::BTreeSet;

/// Trial t has split t and projection t; with P `projections_per_split`, split t / P and projection t mod P, so that each split meets each of
/// P projections. Noise and what else is drawn is drawn anew in each.
impl StudySpec {
    /// The number of a trial's split.
    pub fn split_of(&self, trial: usize) -> usize {
        trial / self.projections_per_split.unwrap_or(1)
    }

    /// The number of a trial's projection.
    pub fn projection_of(&self, trial: usize) -> usize {
        self.projections_per_split.map_or(trial, |n| trial % n)
    }
}

impl Check<'_> {
    /// `projections_per_split`, and whether trials come out even.
    pub fn repeats(&self, spec: &StudySpec) -> Result<()> {
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

/// A score of one trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeat {
    /// The trial, from 0.
    pub trial: usize,
    /// The numbers of its split and its projection, where trials are crossed.
    pub place: Option<(usize, usize)>,
    /// What it scored.
    pub score: f64,
}

impl Repeat {
    /// The accuracy of a trial.
    pub fn of(trial: &TrialScore) -> Self {
        Self {
            trial: trial.trial,
            place: trial.split.zip(trial.projection),
            score: trial.accuracy,
        }
    }
}

/// Scores of a configuration: one row a trial; or splits × projections where they are crossed, `None` if some of those are missing.
pub fn scores(trials: &[Repeat]) -> Option<Array2<f64>> {
    if trials.iter().any(|trial| trial.place.is_none()) {
        let column = trials.iter().map(|trial| trial.score).collect();
        return Array2::from_shape_vec((trials.len(), 1), column).ok();
    }
    let mut ordered = trials.to_vec();
    ordered.sort_by_key(|trial| trial.place);
    let places: BTreeSet<_> = trials.iter().filter_map(|trial| trial.place).collect();
    if places.len() != trials.len() {
        return None;
    }
    let splits: BTreeSet<usize> = places.iter().map(|place| place.0).collect();
    let projections: BTreeSet<usize> = places.iter().map(|place| place.1).collect();
    let values = ordered.iter().map(|trial| trial.score).collect();
    Array2::from_shape_vec((splits.len(), projections.len()), values).ok()
}

/// What a test of two cells says.
pub struct Tested {
    /// Whether there is a p-value.
    pub p_status: PStatus,
    /// It.
    pub p_value: Option<f64>,
    /// Of the difference.
    pub interval: Option<Interval>,
    /// Trials from which on there is one: where they are crossed, all projections of so many splits.
    pub n_needed: Option<usize>,
}

/// Scores of two configurations, in the trials that both have.
pub struct Paired {
    ours: Vec<Repeat>,
    theirs: Vec<Repeat>,
}

impl Paired {
    /// The trials of two configurations by their numbers.
    pub fn of(ours: &[Repeat], theirs: &[Repeat]) -> Self {
        let pairs = ours.iter().filter_map(|ours| {
            let theirs = theirs.iter().find(|theirs| theirs.trial == ours.trial);
            Some((*ours, *theirs?))
        });
        let (ours, theirs) = pairs.unzip();
        Self { ours, theirs }
    }

    /// How many trials both have.
    pub fn n_trials(&self) -> usize {
        self.ours.len()
    }

    /// Mean scores in these trials, ours and theirs; NaN if there are none.
    pub fn means(&self) -> (f64, f64) {
        let mean =
            |trials: &[Repeat]| trials.iter().map(|t| t.score).sum::<f64>() / trials.len() as f64;
        (mean(&self.ours), mean(&self.theirs))
    }

    /// The test of no difference, if there are trials enough for one, by how they split the touches.
    pub fn tested(&self, size: TrialSize) -> Result<Tested> {
        let n_needed = trials_needed(size, CONFIDENCE)?;
        let split = |trial: &Repeat| trial.place.map_or(trial.trial, |(split, _)| split);
        let splits: BTreeSet<usize> = self.ours.iter().map(split).collect();
        let is_enough = n_needed.is_some_and(|needed| splits.len() >= needed);
        let n_projections = (self.ours.len() / splits.len().max(1)).max(1);
        let test = self.test(size)?;
        Ok(Tested {
            p_status: match (&test, is_enough) {
                (_, false) => PStatus::TooFewTrials,
                (None, true) => PStatus::TrialsMissing,
                (Some(_), true) => PStatus::Tested,
            },
            p_value: test.filter(|_| is_enough).map(|test| test.p_value),
            interval: test.map(|test| test.interval),
            n_needed: n_needed.map(|n_splits| n_splits * n_projections),
        })
    }

    /// Ours less theirs; `None` for a single trial, and for crossed trials of which some are missing.
    fn test(&self, size: TrialSize) -> Result<Option<Comparison>> {
        let (Some(ours), Some(theirs)) = (scores(&self.ours), scores(&self.theirs)) else {
            return Ok(None);
        };
        match (ours.ncols(), theirs.ncols()) {
            (1, 1) => {
                let (ours, theirs) = (ours.column(0).to_vec(), theirs.column(0).to_vec());
                compare(&ours, &theirs, size, CONFIDENCE)
            }
            _ => compare_crossed(ours.view(), theirs.view(), size, CONFIDENCE),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn scores_stand_in_the_place_of_their_split_and_projection_whatever_their_order() {
        let trial = |trial: usize, place| Repeat {
            trial,
            place,
            score: trial as f64 / 10.0,
        };
        let all = [5, 0, 3, 1, 4, 2].map(|t| trial(t, Some((t / 2, t % 2))));
        let expected = ndarray::array![[0.0, 0.1], [0.2, 0.3], [0.4, 0.5]];
        assert_eq!(scores(&all), Some(expected));
        assert_eq!(scores(&all[1..]), None, "one is missing");
        let twice = [all[0], all[1], all[1], all[3]];
        assert_eq!(scores(&twice), None);
        let own = [0, 1, 2].map(|t| trial(t, None));
        let expected = ndarray::array![[0.0], [0.1], [0.2]];
        assert_eq!(scores(&own), Some(expected));
    }
}
