//! Scores of repeated trials. Each trial draws its own split and projection, or the trials combine every split with every projection.

use crate::error::Result;
use crate::statistics::comparison::{
    Comparison, TrialSize, compare, compare_crossed, trials_needed,
};
use crate::statistics::p_status::{CONFIDENCE, PStatus};
use bubbletouch_sim::statistics::interval::Interval;
use ndarray::Array2;
use std::collections::{BTreeSet, HashMap};

/// Score of one trial of a configuration, with the numbers of the trial's split and projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeat {
    /// Number of the trial, from 0.
    pub trial: usize,
    /// Number of the split into training and test touches; trials with equal splits have equal numbers.
    pub split: usize,
    /// Number of the random projection, if the trials combine every split with every projection; otherwise `None`.
    pub projection: Option<usize>,
    /// Score of the trial, for example its accuracy.
    pub score: f64,
    /// Numbers of training and test rows of the trial, if known.
    pub size: Option<TrialSize>,
}

impl Repeat {
    /// Returns the numbers of the split and the projection, which identify the trial.
    fn place(&self) -> (usize, Option<usize>) {
        (self.split, self.projection)
    }
}

/// Averages the scores of trials with equal split and projection, which `place` returns. A repeated split contains no new information, so it counts as one
/// trial.
fn merged(trials: &[Repeat], place: impl Fn(usize) -> (usize, Option<usize>)) -> Vec<Repeat> {
    let mut known: HashMap<_, usize> = HashMap::new();
    let mut groups: Vec<Vec<Repeat>> = Vec::new();
    for (number, trial) in trials.iter().enumerate() {
        let group = *known.entry(place(number)).or_insert(groups.len());
        match groups.get_mut(group) {
            Some(group) => group.push(*trial),
            None => groups.push(vec![*trial]),
        }
    }
    let groups = groups.into_iter().map(|group| {
        let first = group[0];
        // The mean of equal scores is exact, without rounding.
        let above: f64 = group.iter().map(|trial| trial.score - first.score).sum();
        Repeat {
            score: first.score + above / group.len() as f64,
            ..first
        }
    });
    groups.collect()
}

/// Returns the scores of a configuration as a matrix of splits (rows) and projections (columns). If the trials combine every split with every projection, the
/// shape is splits × projections; the result is `None` if some trials are missing. Otherwise, the shape is (n_splits, 1), and repeated splits are averaged.
pub fn scores(trials: &[Repeat]) -> Option<Array2<f64>> {
    let mut ordered = merged(trials, |number| trials[number].place());
    if ordered.iter().any(|trial| trial.projection.is_none()) {
        let column = ordered.iter().map(|trial| trial.score).collect();
        return Array2::from_shape_vec((ordered.len(), 1), column).ok();
    }
    ordered.sort_by_key(Repeat::place);
    let splits: BTreeSet<usize> = ordered.iter().map(|trial| trial.split).collect();
    let projections: BTreeSet<_> = ordered.iter().map(|trial| trial.projection).collect();
    let values = ordered.iter().map(|trial| trial.score).collect();
    Array2::from_shape_vec((splits.len(), projections.len()), values).ok()
}

/// Result of a significance test of the difference between two configurations.
pub struct Tested {
    /// Whether the test has a p-value, or why the p-value is missing.
    pub p_status: PStatus,
    /// p-value of the null hypothesis that there is no difference; `None` if the test is not possible.
    pub p_value: Option<f64>,
    /// Confidence interval of the difference of the scores; `None` for a single trial.
    pub interval: Option<Interval>,
    /// Number of trials that are needed for a p-value. For crossed trials, this is the required number of splits times the number of projections.
    pub n_needed: Option<usize>,
}

/// Scores of two configurations in the trials that both have; trials with equal split and projection are averaged.
pub struct Paired {
    ours: Vec<Repeat>,
    theirs: Vec<Repeat>,
    /// Numbers of rows in the paired trials of the first configuration, or in all its trials if none are paired; `None` if unknown.
    sizes: Option<Vec<TrialSize>>,
    /// Whether a configuration has several trials with equal splits.
    has_repeats: bool,
}

impl Paired {
    /// Creates pairs of trials of two configurations that have equal trial numbers.
    pub fn new(all_ours: &[Repeat], theirs: &[Repeat]) -> Self {
        let pairs = all_ours.iter().filter_map(|ours| {
            let theirs = theirs.iter().find(|theirs| theirs.trial == ours.trial)?;
            let mut ours = *ours;
            // The score of fewer decisions has the coarser steps.
            if let (Some(size), Some(other)) = (&mut ours.size, theirs.size) {
                size.n_decisions = size.n_decisions.min(other.n_decisions);
            }
            Some((ours, *theirs))
        });
        let (ours, theirs): (Vec<Repeat>, Vec<Repeat>) = pairs.unzip();
        let n_places = |trials: &[Repeat]| {
            trials
                .iter()
                .map(Repeat::place)
                .collect::<BTreeSet<_>>()
                .len()
        };
        // Tables of earlier versions do not contain the numbers of shared splits.
        let (n_ours, n_theirs) = (n_places(&ours), n_places(&theirs));
        let places = if n_ours <= n_theirs { &ours } else { &theirs };
        let merge = |trials: &[Repeat]| merged(trials, |number| places[number].place());
        let (merged_ours, merged_theirs) = (merge(&ours), merge(&theirs));
        let sized = if ours.is_empty() {
            all_ours
        } else {
            &merged_ours
        };
        Self {
            has_repeats: n_ours.min(n_theirs) < ours.len(),
            sizes: sized.iter().map(|trial| trial.size).collect(),
            ours: merged_ours,
            theirs: merged_theirs,
        }
    }

    /// Returns the number of paired trials; trials with equal split and projection count as one.
    pub fn n_trials(&self) -> usize {
        self.ours.len()
    }

    /// Returns the mean scores of the first and the second configuration over their common trials; NaN if there are none.
    pub fn means(&self) -> (f64, f64) {
        let mean =
            |trials: &[Repeat]| trials.iter().map(|t| t.score).sum::<f64>() / trials.len() as f64;
        (mean(&self.ours), mean(&self.theirs))
    }

    /// Tests whether the two configurations differ. Returns `None` if the sizes of the trials are unknown.
    ///
    /// # Errors
    /// If a trial has no training or no test rows.
    pub fn tested(&self) -> Result<Option<Tested>> {
        let Some(sizes) = self.sizes.as_ref().filter(|sizes| !sizes.is_empty()) else {
            return Ok(None);
        };
        let n_needed = trials_needed(sizes, CONFIDENCE)?;
        let splits: BTreeSet<usize> = self.ours.iter().map(|trial| trial.split).collect();
        let is_enough = n_needed.is_some_and(|needed| splits.len() >= needed);
        let n_projections = (self.ours.len() / splits.len().max(1)).max(1);
        let test = self.test(sizes)?;
        // Further trials would repeat the splits that exist.
        let is_final = self.has_repeats && !is_enough;
        Ok(Some(Tested {
            p_status: match (&test, is_enough) {
                (_, false) => PStatus::TooFewTrials,
                (None, true) => PStatus::TrialsMissing,
                (Some(_), true) => PStatus::Tested,
            },
            p_value: test.filter(|_| is_enough).map(|test| test.p_value),
            interval: test.map(|test| test.interval),
            n_needed: n_needed
                .filter(|_| !is_final)
                .map(|n_splits| n_splits * n_projections),
        }))
    }

    /// Compares the first configuration with the second; returns `None` for a single trial, or if a combination of split and projection is missing.
    fn test(&self, sizes: &[TrialSize]) -> Result<Option<Comparison>> {
        let (Some(ours), Some(theirs)) = (scores(&self.ours), scores(&self.theirs)) else {
            return Ok(None);
        };
        match (ours.ncols(), theirs.ncols()) {
            (1, 1) => {
                let (ours, theirs) = (ours.column(0).to_vec(), theirs.column(0).to_vec());
                compare(&ours, &theirs, sizes, CONFIDENCE)
            }
            _ => compare_crossed(ours.view(), theirs.view(), sizes, CONFIDENCE),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_stand_in_the_place_of_their_split_and_projection_whatever_their_order() {
        let trial = |trial: usize, (split, projection)| Repeat {
            trial,
            split,
            projection,
            score: trial as f64 / 10.0,
            size: None,
        };
        let all = [5, 0, 3, 1, 4, 2].map(|t| trial(t, (t / 2, Some(t % 2))));
        let expected = ndarray::array![[0.0, 0.1], [0.2, 0.3], [0.4, 0.5]];
        assert_eq!(scores(&all), Some(expected));
        assert_eq!(scores(&all[1..]), None, "one is missing");
        let own = [0, 1, 2].map(|t| trial(t, (t, None)));
        let expected = ndarray::array![[0.0], [0.1], [0.2]];
        assert_eq!(scores(&own), Some(expected));
        // Splits 0, 1 and 2 occur twice.
        let repeated = [0, 1, 2, 3, 4, 5].map(|t| trial(t, (t % 3, None)));
        let expected = ndarray::array![[0.15], [0.25], [0.35]];
        assert!(
            (scores(&repeated).unwrap() - expected)
                .iter()
                .all(|d| d.abs() < 1e-15)
        );
    }

    /// Repeating trials must not increase the significance of a difference.
    #[test]
    fn trials_that_repeat_splits_are_no_further_trials() {
        let trial = |trial: usize, score: f64| Repeat {
            trial,
            split: trial % 2,
            projection: None,
            score,
            size: Some(TrialSize {
                n_train: 300,
                n_test: 100,
                n_decisions: 100,
            }),
        };
        let of = |n: usize, scores: [f64; 2]| -> Vec<Repeat> {
            (0..n).map(|t| trial(t, scores[t % 2])).collect()
        };
        let pair = |n| Paired::new(&of(n, [0.9, 0.8]), &of(n, [0.7, 0.6]));
        let (twice, often) = (pair(2), pair(40));
        assert_eq!(often.n_trials(), 2);
        assert_eq!(often.means(), twice.means());
        let [twice, often] = [twice, often].map(|pair| pair.tested().unwrap().unwrap());
        assert_eq!(often.p_status, PStatus::TooFewTrials);
        assert_eq!((often.p_value, often.n_needed), (None, None));
        assert_eq!(often.interval, twice.interval);
        // Without repeated splits, further trials increase the power of the test.
        assert_eq!(twice.n_needed, Some(4));
    }
}
