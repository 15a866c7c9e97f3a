//! From frames to objects: the checks of `[sensing]` and `[recognition]`.

use super::axis::Axis;
use super::check::{Check, not_negative, positive};
use super::plan::Amount;
use super::spec::{RecognitionSpec, SensingSpec, StudySpec};
use super::training::{ChoicePlan, DEFAULT_FOLDS};
use crate::error::Result;
use crate::recognition::ClassifierKind;
use crate::recognition::over_time::OverTime;
use crate::world::Patch;

impl Check<'_> {
    pub fn amounts(&self, sensing: &SensingSpec, arrays: &[Patch]) -> Result<Vec<Amount>> {
        let smallest = arrays.iter().map(|a| a.grid.n_taxels()).min().unwrap_or(0);
        match (&sensing.ratio, &sensing.measurements) {
            (Some(ratios), None) => {
                let ratios = self.axis(
                    "sensing.ratio",
                    ratios,
                    |r| r.is_finite() && r >= 1.0,
                    "at least 1",
                )?;
                if let Some(ratio) = ratios.iter().find(|&&r| r > smallest as f64) {
                    return Err(self.error(
                        "sensing.ratio",
                        ratio,
                        format!("at most {smallest}, the taxels of the smallest array"),
                    ));
                }
                Ok(ratios.into_iter().map(Amount::Ratio).collect())
            }
            (None, Some(counts)) => {
                let counts = self.list("sensing.measurements", counts.values())?;
                if let Some(m) = counts.iter().find(|&&m| m == 0 || m > smallest) {
                    return Err(self.error(
                        "sensing.measurements",
                        m,
                        format!("1 to {smallest}, the taxels of the smallest array"),
                    ));
                }
                Ok(counts.into_iter().map(Amount::Measurements).collect())
            }
            (Some(_), Some(_)) => {
                Err(self.error("sensing", "both ratio and measurements", "one of them"))
            }
            (None, None) => Ok(vec![Amount::Ratio(1.0)]),
        }
    }

    pub fn penalties(&self, spec: &StudySpec) -> Result<Vec<Option<f64>>> {
        let allowed = "a positive number";
        for (key, is_set) in [
            ("recognition.c", spec.recognition.c.is_some()),
            ("recognition.choose_c", spec.recognition.choose_c.is_some()),
        ] {
            self.is_of_use(
                key,
                is_set,
                spec,
                ClassifierKind::has_c,
                "a C (an SVM or logistic regression)",
            )?;
        }
        match (&spec.recognition.c, &spec.recognition.choose_c) {
            (Some(_), Some(_)) => {
                Err(self.error("recognition", "both c and choose_c", "one of them"))
            }
            (None, None) => Ok(vec![Some(1.0)]),
            (Some(axis), None) => {
                let values = self.axis("recognition.c", axis, positive, allowed)?;
                Ok(values.into_iter().map(Some).collect())
            }
            (None, Some(candidates)) => {
                self.axis(
                    "recognition.choose_c",
                    &Axis::Many(candidates.clone()),
                    positive,
                    allowed,
                )?;
                Ok(vec![None])
            }
        }
    }

    /// How C and γ are chosen, for fits that leave one of them open.
    pub fn choice(&self, spec: &StudySpec) -> Result<ChoicePlan> {
        let recognition = &spec.recognition;
        if let (Some(_), Some(_)) = (recognition.gamma, &recognition.choose_gamma) {
            return Err(self.error("recognition", "both gamma and choose_gamma", "one of them"));
        }
        for (key, is_set) in [
            ("recognition.gamma", recognition.gamma.is_some()),
            (
                "recognition.choose_gamma",
                recognition.choose_gamma.is_some(),
            ),
        ] {
            self.is_of_use(
                key,
                is_set,
                spec,
                ClassifierKind::has_gamma,
                "a γ (an RBF or polynomial SVM)",
            )?;
        }
        let is_open = recognition.choose_c.is_some() || recognition.choose_gamma.is_some();
        for (key, count) in [
            ("recognition.choose_folds", recognition.choose_folds),
            ("recognition.choose_touches", recognition.choose_touches),
        ] {
            let Some(count) = count else { continue };
            self.positive_count(key, count)?;
            if !is_open {
                let allowed = "choose_c or choose_gamma beside it, which it belongs to";
                return Err(self.error(key, count, allowed));
            }
        }
        let folds = recognition.choose_folds.unwrap_or(DEFAULT_FOLDS);
        if folds < 2 {
            return Err(self.error("recognition.choose_folds", folds, "at least 2"));
        }
        let c = recognition.choose_c.clone().unwrap_or_default();
        let gamma_multiples = match &recognition.choose_gamma {
            None => Vec::new(),
            Some(multiples) => self.axis(
                "recognition.choose_gamma",
                &Axis::Many(multiples.clone()),
                positive,
                "a positive number, times 'scale'",
            )?,
        };
        Ok(ChoicePlan {
            c,
            gamma_multiples,
            folds,
            touches: recognition.choose_touches,
        })
    }

    /// Refuses a key that no swept classifier has a use for: it would be silently ignored.
    fn is_of_use(
        &self,
        key: &str,
        is_set: bool,
        spec: &StudySpec,
        has_it: fn(ClassifierKind) -> bool,
        what: &str,
    ) -> Result<()> {
        let mut kinds = spec.recognition.classifier.values().into_iter();
        if !is_set || kinds.any(has_it) {
            return Ok(());
        }
        let given = "given, but no classifier of the study has a use for it";
        Err(self.error(
            key,
            given,
            format!("a classifier with {what}, or no such key"),
        ))
    }

    /// Keys that belong to some kinds of classifiers: each in its range, and none that no classifier of the study has.
    pub fn kinds(&self, spec: &StudySpec) -> Result<()> {
        let recognition = &spec.recognition;
        type Has = fn(ClassifierKind) -> bool;
        let has_neighbours: Has = |kind| kind.about().has_neighbours;
        let has_trees: Has = |kind| kind.about().has_trees;
        let has_depth: Has = |kind| kind.about().has_depth;
        for (key, given, has_it, what) in [
            (
                "recognition.n_neighbours",
                recognition.n_neighbours,
                has_neighbours,
                "neighbours (k_nearest)",
            ),
            (
                "recognition.n_trees",
                recognition.n_trees,
                has_trees,
                "trees (random_forest)",
            ),
            (
                "recognition.max_depth",
                recognition.max_depth,
                has_depth,
                "a depth (decision_tree or random_forest)",
            ),
        ] {
            self.is_of_use(key, given.is_some(), spec, has_it, what)?;
            if let Some(count) = given {
                self.positive_count(key, count)?;
            }
        }
        if let Some(gib) = recognition.solver_memory_gib {
            let allowed = "a positive number of gibibytes";
            self.value("recognition.solver_memory_gib", gib, positive, allowed)?;
        }
        if !(1..=20).contains(&recognition.degree) {
            let given = recognition.degree;
            return Err(self.error("recognition.degree", given, "from 1 to 20"));
        }
        let allowed = "zero or a positive number";
        self.value(
            "recognition.coef0",
            recognition.coef0,
            not_negative,
            allowed,
        )?;
        Ok(())
    }

    /// What is made of a touch's frames: no more of them than there are.
    pub fn over_time(
        &self,
        spec: &RecognitionSpec,
        frames: &[usize],
    ) -> Result<Vec<Option<OverTime>>> {
        let Some(axis) = &spec.over_time else {
            return Ok(vec![None]);
        };
        let values = self.list("recognition.over_time", axis.values())?;
        let fewest = frames.iter().copied().min().unwrap_or(0);
        for &value in &values {
            if let OverTime::Stacked(k) = value
                && k > fewest
            {
                let allowed = format!("at most {fewest}, the frames of a touch");
                return Err(self.error("recognition.over_time", String::from(value), allowed));
            }
        }
        Ok(values.into_iter().map(Some).collect())
    }
}
