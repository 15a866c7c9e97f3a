//! Inputs that determine the evaluation of a family of configurations in a trial, without the measurements.
//!
//! The method `Trial::evaluate` receives these inputs and no plan, so it cannot depend on any other value of a study. The identity of a work item consists of
//! the canonical bytes of these inputs and of the inputs of its measurements.

use crate::inputs::content_hash::{Hashed, canonical};
use crate::inputs::memory::GIB;
use crate::learning::classifiers::classifier::Classifier;
use crate::learning::evaluation::next_touch::{NextTouch, Poses};
use crate::studies::prelude::*;
use crate::studies::recognition::rows::RowInputs;
use crate::studies::recognition::spec::{Metric, RecognitionSpec};
use crate::studies::recognition::sweep::{Sweep, TrainingRows};
use bubbletouch_svm::DEFAULT_MEMORY_BYTES;
use ndarray::{Array1, Axis};
use std::collections::HashSet;

/// Inputs of a trial that all families of configurations share.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TrialInputs<'a> {
    /// Seed from which all random numbers of the study are derived.
    pub seed: u64,
    /// Number of the trial, from 0.
    pub number: usize,
    /// Numbers of the split and of the projection, if each split is combined with several projections; otherwise `None`.
    pub crossed: Option<(usize, usize)>,
    /// Split of all touches into training and test touches.
    pub split: &'a Hashed<Split>,
    /// Number of the first split with the same training and test touches as this split; `None` if this split is the first.
    pub distinct_split: Option<usize>,
    /// Number of the block of poses on which the trial is tested; `None` if the split does not hold out blocks of poses.
    pub tested_block: Option<usize>,
    /// Number of the touched object for each touch.
    pub labels: &'a Hashed<Array1<usize>>,
    /// Group number of each touch; `None` if the split may divide groups.
    pub group_keys: Option<&'a Hashed<Array1<usize>>>,
}

/// Inputs of a family of configurations that are equal in all its trials.
#[derive(Clone, Debug, Serialize)]
pub struct FamilyInputs<'a> {
    /// Inputs that determine how feature rows are computed from measurements.
    pub rows: RowInputs,
    /// Settings that reduce or relabel the training touches of a split.
    pub training_rows: TrainingRows,
    /// Classifier, and the candidate values from which its C and γ are selected.
    pub training: TrainingInputs,
    /// Settings of a decision for each configuration of the family, in the order of the configurations. Configurations with equal C are adjacent.
    pub decisions: Vec<Decision>,
    /// Pose of each touch; `None` if no configuration selects touches by their poses.
    pub poses: Option<&'a Hashed<Poses>>,
    /// Whether the result contains each decision with its scores.
    pub keeps_predictions: bool,
    /// Whether the result contains the log-loss.
    pub keeps_log_loss: bool,
}

/// Inputs that determine how a classifier is trained. Parameters that the classifier does not use have their default values.
#[derive(Clone, Debug, Serialize)]
pub struct TrainingInputs {
    /// Classifier and its parameters; the penalty C is set by each [`Decision`].
    pub classifier: Classifier,
    /// Candidate values of the penalty C; `None` if C is given.
    pub c_grid: Option<Vec<f64>>,
    /// Candidate values of the kernel parameter γ, as multiples of its default; `None` if γ is given.
    pub gamma_grid: Option<Vec<f64>>,
    /// Maximum number of training touches per object that are used to choose C and γ; `None` for all.
    pub cv_touches: Option<usize>,
    /// Number of folds of the inner cross-validation; `None` if no inner cross-validation is needed.
    pub n_folds: Option<usize>,
}

/// Settings in which the configurations of a family differ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// Penalty C of the classifier; `None` if C is chosen by cross-validation or the classifier has no C.
    pub c: Option<f64>,
    /// Number of test touches of an object that are combined into one decision.
    pub touches_per_decision: usize,
    /// Rule that chooses the touches of a decision after the first touch.
    pub next_touch: NextTouch,
}

impl TrialInputs<'_> {
    /// Returns the seed of the trial's random numbers that are used for the purpose `name`.
    pub fn stream(&self, name: &str) -> Seed {
        let seed = Seed::new(self.seed).named(name);
        seed.numbered(self.number as u64)
    }

    /// Checks that the trial has the training rows and the inner folds that the training of a family needs. Each training touch gives `n_per_touch` rows.
    ///
    /// # Errors
    /// If a fold cannot be drawn, or a parameter of the classifier exceeds the number of its training rows.
    pub fn check(&self, family: &FamilyInputs, n_per_touch: usize) -> Result<()> {
        let (split, labels) = self.training(&family.training_rows)?;
        let inputs = &family.training;
        let mut n_touches = split.train.len();
        if inputs.n_folds.is_some() {
            let labels = labels.select(Axis(0), &split.train);
            let keys = self
                .group_keys
                .map(|keys| keys.select(Axis(0), &split.train));
            let all: Vec<usize> = (0..n_touches).collect();
            let chosen_on = (inputs.c_grid.is_some() || inputs.gamma_grid.is_some())
                .then(|| inputs.choosing_rows(labels.view()));
            let informed = family.decisions.iter().any(Decision::is_informed);
            let held_out = informed.then_some(all);
            for rows in chosen_on.iter().chain(&held_out) {
                let of = (&labels, keys.as_ref());
                let folds = inputs.folds(of, rows, &self.stream("validation"))?;
                let smallest = folds.iter().map(|fold| fold.train.len()).min();
                n_touches = n_touches.min(smallest.unwrap_or(n_touches));
            }
        }
        let classifier = &inputs.classifier;
        let checked = classifier.check_rows(n_per_touch * n_touches);
        checked.map_err(|error| Error::from(error).under("key recognition."))
    }

    /// Returns the group of each test touch; `None` if the split does not hold out whole groups.
    pub fn test_groups(&self, test: &[usize]) -> Option<Vec<usize>> {
        match (self.tested_block, self.group_keys) {
            (Some(block), _) => Some(vec![block; test.len()]),
            (None, Some(keys)) => Some(test.iter().map(|&touch| keys[touch]).collect()),
            (None, None) => None,
        }
    }

    /// Returns the number of objects that the trial distinguishes.
    pub fn n_objects(&self) -> usize {
        self.labels.iter().max().map_or(0, |last| last + 1)
    }
}

impl<'a> FamilyInputs<'a> {
    /// Returns the training inputs of a family, which is given as a list of at least one configuration.
    pub fn new(plan: &Plan, sweep: &'a Sweep, family: &[Configuration]) -> Self {
        let recognition = &plan.spec.recognition;
        let decisions = family.iter().map(|configuration| Decision {
            c: configuration.c,
            touches_per_decision: configuration.touches_per_decision,
            next_touch: configuration.next_touch.unwrap_or_default(),
        });
        let decisions: Vec<Decision> = decisions.collect();
        let has = |wanted: fn(&Decision) -> bool| decisions.iter().any(wanted);
        let configuration = &family[0];
        let poses = sweep.poses.as_ref();
        Self {
            rows: configuration.rows(),
            training_rows: TrainingRows::new(plan, configuration),
            training: TrainingInputs::new(
                recognition,
                configuration.classifier,
                has(Decision::is_informed),
            ),
            poses: poses.filter(|_| has(|decision| decision.next_touch != NextTouch::Random)),
            decisions,
            keeps_predictions: plan.spec.report.predictions,
            keeps_log_loss: plan.spec.report.metrics.contains(&Metric::LogLoss),
        }
    }

    /// Returns groups of settings with equal penalty C; all settings of a group use one trained classifier.
    pub fn fits(&self) -> impl Iterator<Item = &[Decision]> {
        self.decisions.chunk_by(|a, b| a.c == b.c)
    }
}

impl Decision {
    /// Returns whether a rule for the next touch uses the classifier's decisions on training touches.
    pub fn is_informed(&self) -> bool {
        self.next_touch == NextTouch::MostInformative
    }
}

impl TrainingInputs {
    fn new(recognition: &RecognitionSpec, kind: ClassifierKind, is_informed: bool) -> Self {
        let mut classifier = recognition.of_kinds.applied_to(Classifier::new(kind));
        classifier.scaling = recognition.scaling;
        if kind.uses("multiclass") {
            classifier.multiclass = recognition.multiclass;
        }
        if kind.uses("class_weight") {
            classifier.class_weight = recognition.class_weight;
        }
        if kind.uses("solver") {
            classifier.solver = recognition.solver;
        }
        if kind.uses("solver_memory_gib") {
            classifier.memory_bytes = solver_memory(recognition.solver_memory_gib);
        }
        let used = |key, grid: &Option<Vec<f64>>| grid.clone().filter(|_| kind.uses(key));
        let c_grid = used("c_grid", &recognition.c_grid);
        let gamma_grid = used("gamma_grid", &recognition.gamma_grid);
        let is_chosen = c_grid.is_some() || gamma_grid.is_some();
        Self {
            cv_touches: recognition.cv_touches.filter(|_| is_chosen),
            n_folds: (is_chosen || is_informed).then(|| recognition.n_choice_folds()),
            classifier,
            c_grid,
            gamma_grid,
        }
    }
}

impl Sweep {
    /// Checks that every family of configurations can be trained in every trial.
    ///
    /// # Errors
    /// Returns the errors of [`TrialInputs::check`].
    pub(crate) fn check_training(&self, plan: &Plan) -> Result<()> {
        let mut checked = HashSet::new();
        let families = |group| MeasurementGroup::families(group).map(move |family| (group, family));
        for (group, family) in self.groups.iter().flat_map(families) {
            let inputs = FamilyInputs::new(plan, self, family);
            let n_per_touch = group.n_readings(plan) + inputs.rows.n_copies;
            let needed = (n_per_touch, &inputs.training_rows, &inputs.training);
            if checked.insert(canonical(&needed)) {
                for number in 0..self.splits.len() {
                    self.trial(plan, number)?.check(&inputs, n_per_touch)?;
                }
            }
        }
        Ok(())
    }

    /// Returns the inputs of the trial with this number, which all families of configurations share.
    ///
    /// # Errors
    /// If the study has no trial with this number.
    pub fn trial(&self, plan: &Plan, number: usize) -> Result<TrialInputs<'_>> {
        let Some(split) = self.splits.get(number) else {
            let last = self.splits.len() - 1;
            let allowed = format!("0 to {last}, the study's trials");
            return Err(Error::input("trial", number, allowed));
        };
        let spec = &plan.spec;
        let is_crossed = spec.projections_per_split.is_some();
        let of_split = spec.split_of(number);
        let first = spec.split_of(self.first_equal[number]);
        Ok(TrialInputs {
            seed: spec.seed,
            number,
            crossed: is_crossed.then(|| (of_split, spec.projection_of(number))),
            split,
            distinct_split: (first != of_split).then_some(first),
            tested_block: spec.recognition.split.tested_block(of_split),
            labels: &self.labels,
            group_keys: self.group_keys.as_ref(),
        })
    }
}

/// Returns the maximum memory for the kernel values of a solver, bytes; the default of `gib` is 2 GiB.
pub fn solver_memory(gib: Option<f64>) -> usize {
    gib.map_or(DEFAULT_MEMORY_BYTES, |gib| (gib * GIB) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::sensor_errors::Strengths;
    use crate::learning::classifiers::foreign::Foreign;
    use crate::world::ImageShape;
    use bubbletouch_sim::features::{Features, foreign};

    #[test]
    fn another_version_is_another_input_and_a_strength_of_zero_is_none() {
        let own = |version| ClassifierKind::Foreign(Foreign::new("own_kind", version).unwrap());
        let classifier = |version| identity(&Classifier::new(own(version)));
        assert_eq!(classifier("1"), classifier("1"));
        assert_ne!(classifier("1"), classifier("2"));
        let rows = |version| {
            let own = foreign::Foreign::new("own_features", version).unwrap();
            identity(&RowInputs {
                image_shapes: vec![ImageShape { ny: 4, nx: 4 }],
                measurements: 4,
                frames: 1,
                temporal_features: None,
                features: Features::Foreign(own),
                depth_window_full_scale: None,
                n_copies: 0,
            })
        };
        assert_ne!(rows("1"), rows("2"));
        let strength = |value| identity(&Strengths::default().with("gain_std", value));
        assert_eq!(strength(Some(0.0)), strength(None));
        assert_ne!(strength(Some(0.1)), strength(None));
    }
}
