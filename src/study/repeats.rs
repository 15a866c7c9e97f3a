//! What a trial draws anew: a split and a projection of its own, or every split with every projection.

use super::check::Check;
use super::evaluation::CONFIDENCE;
use super::spec::StudySpec;
use super::table::{Cell, PStatus, TrialScore};
use crate::error::Result;
use crate::recognition::comparison::{
    Comparison, TrialSize, compare, compare_crossed, trials_needed,
};
use crate::recognition::interval::Interval;
use ndarray::Array2;
use std::collections::BTreeSet;

/// How the trials of a study are made. Noise and what else is drawn is drawn anew in each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeats {
    /// Trial t: split t, projection t.
    Own,
    /// Trial t: split t / P and projection t mod P, so that each split meets each of P projections.
    Crossed(usize),
}

impl Repeats {
    /// The number of a trial's split.
    pub fn split(self, trial: usize) -> usize {
        match self {
            Self::Own => trial,
            Self::Crossed(n_projections) => trial / n_projections,
        }
    }

    /// The number of a trial's projection.
    pub fn projection(self, trial: usize) -> usize {
        match self {
            Self::Own => trial,
            Self::Crossed(n_projections) => trial % n_projections,
        }
    }

    /// The numbers as the accuracy table has them: only where they say more than the trial's own.
    pub fn numbers(self, trial: usize) -> (Option<usize>, Option<usize>) {
        match self {
            Self::Own => (None, None),
            Self::Crossed(_) => (Some(self.split(trial)), Some(self.projection(trial))),
        }
    }
}

impl Check<'_> {
    /// `projections_per_split`, and whether trials come out even.
    pub fn repeats(&self, spec: &StudySpec) -> Result<Repeats> {
        const KEY: &str = "projections_per_split";
        let Some(n_projections) = spec.projections_per_split else {
            return Ok(Repeats::Own);
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
            _ => Ok(Repeats::Crossed(n_projections)),
        }
    }
}

/// Accuracies of a cell's trials: one row a trial; or splits × projections where they are crossed, `None` if some of those
/// are missing.
pub fn accuracies(trials: &[&TrialScore]) -> Option<Array2<f64>> {
    let mut numbers = trials.iter().map(|trial| (trial.split, trial.projection));
    if numbers.any(|(split, projection)| split.is_none() || projection.is_none()) {
        let column = trials.iter().map(|trial| trial.accuracy).collect();
        return Array2::from_shape_vec((trials.len(), 1), column).ok();
    }
    let different = |number: fn(&TrialScore) -> Option<usize>| -> BTreeSet<usize> {
        trials.iter().filter_map(|trial| number(trial)).collect()
    };
    let n_splits = different(|trial| trial.split).len();
    let n_projections = different(|trial| trial.projection).len();
    let mut ordered = trials.to_vec();
    ordered.sort_by_key(|trial| (trial.split, trial.projection));
    let places = ordered.iter().map(|trial| (trial.split, trial.projection));
    if places.collect::<BTreeSet<_>>().len() != trials.len() {
        return None;
    }
    let values = ordered.iter().map(|trial| trial.accuracy).collect();
    Array2::from_shape_vec((n_splits, n_projections), values).ok()
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

/// Scores of two cells, in the trials that both have.
pub struct Paired<'a> {
    ours: Vec<&'a TrialScore>,
    theirs: Vec<&'a TrialScore>,
    size: TrialSize,
}

impl<'a> Paired<'a> {
    /// The trials of two cells by their numbers.
    pub fn of(ours: &'a [(Cell, TrialScore)], theirs: &'a [(Cell, TrialScore)]) -> Self {
        let pairs = ours.iter().filter_map(|(_, ours)| {
            let mut theirs = theirs.iter().map(|(_, theirs)| theirs);
            Some((ours, theirs.find(|theirs| theirs.trial == ours.trial)?))
        });
        let (cell, first) = &ours[0];
        let (ours, theirs) = pairs.unzip();
        Self {
            ours,
            theirs,
            // How much the trials overlap is a matter of touches, however many of them one decision takes.
            size: TrialSize {
                n_train: first.n_train,
                n_test: first.n_test * cell.fused_touches,
            },
        }
    }

    /// How many trials both have.
    pub fn n_trials(&self) -> usize {
        self.ours.len()
    }

    /// Mean accuracies in these trials, ours and theirs; NaN if there are none.
    pub fn means(&self) -> (f64, f64) {
        let mean = |trials: &[&TrialScore]| {
            trials.iter().map(|t| t.accuracy).sum::<f64>() / trials.len() as f64
        };
        (mean(&self.ours), mean(&self.theirs))
    }

    /// The test of no difference, if there are trials enough for one.
    pub fn tested(&self) -> Result<Tested> {
        let n_needed = trials_needed(self.size, CONFIDENCE)?;
        let mut splits: Vec<usize> = self
            .ours
            .iter()
            .map(|t| t.split.unwrap_or(t.trial))
            .collect();
        splits.sort_unstable();
        splits.dedup();
        let is_enough = n_needed.is_some_and(|needed| splits.len() >= needed);
        let n_projections = self
            .ours
            .len()
            .checked_div(splits.len())
            .unwrap_or(1)
            .max(1);
        let test = self.test()?;
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
    fn test(&self) -> Result<Option<Comparison>> {
        let scores = (accuracies(&self.ours), accuracies(&self.theirs));
        let (Some(ours), Some(theirs)) = scores else {
            return Ok(None);
        };
        match (ours.ncols(), theirs.ncols()) {
            (1, 1) => {
                let (ours, theirs) = (ours.column(0).to_vec(), theirs.column(0).to_vec());
                compare(&ours, &theirs, self.size, CONFIDENCE)
            }
            _ => compare_crossed(ours.view(), theirs.view(), self.size, CONFIDENCE),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(trial: usize, repeats: Repeats, accuracy: f64) -> TrialScore {
        let (split, projection) = repeats.numbers(trial);
        TrialScore {
            trial,
            split,
            projection,
            n_train: 300,
            n_test: 100,
            n_left_out: 0,
            n_correct: (100.0 * accuracy) as usize,
            accuracy,
            accuracy_low: 0.0,
            accuracy_high: 1.0,
            macro_f1: accuracy,
            c_used: None,
            gamma_used: None,
            n_capped: 0,
        }
    }

    #[test]
    fn crossed_trials_meet_every_projection_with_every_split_once() {
        let crossed = Repeats::Crossed(3);
        let met: BTreeSet<_> = (0..12)
            .map(|t| (crossed.split(t), crossed.projection(t)))
            .collect();
        assert_eq!(met.len(), 12);
        assert!(
            met.iter()
                .all(|&(split, projection)| split < 4 && projection < 3)
        );
        assert_eq!((Repeats::Own.split(7), Repeats::Own.projection(7)), (7, 7));
        assert_eq!(Repeats::Own.numbers(7), (None, None));
    }

    #[test]
    fn scores_stand_in_the_place_of_their_split_and_projection_whatever_their_order() {
        let crossed = Repeats::Crossed(2);
        let trials: Vec<TrialScore> = [5, 0, 3, 1, 4, 2]
            .map(|t| trial(t, crossed, t as f64 / 10.0))
            .to_vec();
        let all: Vec<&TrialScore> = trials.iter().collect();
        let expected = ndarray::array![[0.0, 0.1], [0.2, 0.3], [0.4, 0.5]];
        assert_eq!(accuracies(&all), Some(expected));
        assert_eq!(accuracies(&all[1..]), None, "one is missing");
        let twice = [all[0], all[1], all[1], all[3]];
        assert_eq!(accuracies(&twice), None);
        let own: Vec<TrialScore> = (0..3).map(|t| trial(t, Repeats::Own, 0.5)).collect();
        let own: Vec<&TrialScore> = own.iter().collect();
        assert_eq!(accuracies(&own), Some(Array2::from_elem((3, 1), 0.5)));
    }
}
