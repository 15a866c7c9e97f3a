//! Inputs that determine the measurements of a group of configurations, without the frames of its touches.
//!
//! The function `measure_group` receives these inputs and no plan, so it cannot depend on any other value of a study. Groups whose inputs have equal canonical
//! bytes share their measurements.

use crate::inputs::content_hash::Hashed;
use crate::signal::{Noise, SignalStep};
use crate::studies::prelude::*;
use crate::studies::recognition::plan::Condition;
use crate::studies::recognition::rows::FeaturesOfImages;
use crate::studies::recognition::sweep::{Sweep, TrainingRows};
use ndarray::Array1;
use std::collections::BTreeSet;

/// All inputs that determine the measurements of a group of configurations.
#[derive(Clone, Debug, Serialize)]
pub struct MeasurementInputs<'a> {
    /// Array of taxels that is pressed on the objects.
    pub array: &'a TaxelArray,
    /// Seed from which all random numbers of the study are derived.
    pub seed: u64,
    /// Number of projections (measurement matrices) that are combined with each split; `None` if each trial has its own projection.
    pub projections_per_split: Option<usize>,
    /// Speed at which the array approaches the object when the taxels are read, m/s.
    pub speed: f64,
    /// Signal chain of the training touches.
    pub signal: SignalInputs,
    /// Skin on which the test touches are simulated: the training skin or another one.
    pub test_sensor: TestSensor,
    /// Inputs of the test touches, where they differ from the training touches; `None` if the study has no table `[test]`.
    pub test: Option<TestInputs<'a>>,
    /// Ensemble from which the measurement matrix is drawn.
    pub ensemble: Ensemble,
    /// Method that selects the taxels to read; `None` if the ensemble selects no taxels.
    pub selection: Option<Selection>,
    /// Numbers m of measurements to compute, distinct and ascending.
    pub projected: Vec<usize>,
    /// Number of readings of each training touch, each with its own noise.
    pub n_readings: usize,
    /// Kinds of image features that are computed from the measurements.
    pub of_images: Vec<FeaturesOfImages>,
    /// Inputs of the tilted copies of training touches; `None` if there are no copies.
    pub copies: Option<CopyInputs>,
}

/// Measurement inputs of the test touches that differ from the inputs of the training touches.
#[derive(Clone, Debug, Serialize)]
pub struct TestInputs<'a> {
    /// Array of taxels of the test touches. Frames of test and training touches have equal shapes.
    pub array: &'a TaxelArray,
    /// Speed at which the array approaches the object when the taxels are read, m/s.
    pub speed: f64,
    /// Signal chain that is applied to the test touches.
    pub signal: SignalInputs,
}

/// Trial for which measurements are computed: its number and its split.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredTrial<'a> {
    /// Number of the trial, from 0.
    pub number: usize,
    /// Split into training and test touches; `None` if the measurements do not depend on the split. Measurements depend on the split if something is fitted to
    /// training touches, or if test touches have another skin.
    pub split: Option<&'a Hashed<Split>>,
    /// Group of each touch; `None` if each touch is its own group, or the measurements do not depend on groups. The selection of taxels depends on them.
    pub group_keys: Option<&'a Hashed<Array1<usize>>>,
    /// Training touches to which a projection or an image estimator is fitted, as a split, and the label of each touch; `None` if nothing is fitted.
    pub fitted: Option<&'a (Split, Array1<usize>)>,
}

/// Inputs of the signal chain. Signal steps without effect are omitted.
#[derive(Clone, Debug, Serialize)]
pub struct SignalInputs {
    /// Steps of the signal chain, in order of application.
    pub steps: Vec<StepSpec>,
    /// Unit of the noise standard deviation; if there is no noise, the unit is the full scale.
    pub noise_unit: NoiseUnit,
    /// Strengths of the signal steps: noise, smoothing and sensor errors.
    pub condition: Condition,
}

/// Inputs that determine the tilted copies of training touches.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CopyInputs {
    /// Number of copies of each touch, at least 1.
    pub n_copies: usize,
    /// Number of training touches per class that are copied, in drawing order; `None` for all.
    pub n_touches: Option<usize>,
    /// Maximum tilt of a copy about each axis, radians.
    pub tilt: f64,
}

impl MeasurementInputs<'_> {
    /// Returns the number and the split of a trial for the computation of measurements.
    pub fn trial<'s>(&self, sweep: &'s Sweep, number: usize) -> MeasuredTrial<'s> {
        let depends = self.is_fitted() || self.has_own_test() || self.copies.is_some();
        let split = depends.then(|| &sweep.splits[number]);
        let group_keys = sweep
            .group_keys
            .as_ref()
            .filter(|_| self.selection.is_some());
        MeasuredTrial {
            number,
            split,
            group_keys,
            fitted: None,
        }
    }

    /// Returns whether a projection or an image estimator is fitted to training touches.
    pub fn is_fitted(&self) -> bool {
        is_fitted((self.ensemble, self.selection), !self.of_images.is_empty())
    }

    /// Returns the training rows to which the measurements of a configuration of the group are fitted. Configurations with equal rows share their measurements.
    /// If nothing is fitted for the configuration alone, it shares the measurements of the group's first training rows.
    pub fn fitted_rows(
        &self,
        plan: &Plan,
        group: &MeasurementGroup,
        configuration: &Configuration,
    ) -> TrainingRows {
        if !self.is_fitted() {
            return TrainingRows::default();
        }
        let has_images = configuration.of_images().is_some();
        let of = match is_fitted((self.ensemble, self.selection), has_images) {
            true => configuration,
            false => &group.configurations[0],
        };
        let rows = TrainingRows::new(plan, of);
        // Only greedy selection uses labels.
        let uses_labels = self.selection == Some(Selection::Greedy);
        TrainingRows {
            mislabelled_fraction: rows.mislabelled_fraction.filter(|_| uses_labels),
            ..rows
        }
    }

    /// Returns whether test touches are read by another skin or signal chain than training touches.
    pub fn has_own_test(&self) -> bool {
        self.test.is_some() || self.test_sensor != TestSensor::SameSkin
    }

    /// Returns the distinct numbers of measurements from which images of frames are estimated, ascending.
    pub fn counts_of_images(&self) -> Vec<usize> {
        let counts = self.of_images.iter().map(|one| one.measurements);
        counts.collect::<BTreeSet<_>>().into_iter().collect()
    }
}

impl MeasuredTrial<'_> {
    /// Returns the split of the trial into training and test touches.
    ///
    /// # Panics
    /// If the measurements do not depend on the split.
    pub fn split(&self) -> &Split {
        self.split.expect("measurements that depend on a split")
    }
}

/// Returns whether measurements depend on a fit to training touches. Images of ensembles that give whole frames are the frames themselves.
fn is_fitted((ensemble, selection): (Ensemble, Option<Selection>), has_images: bool) -> bool {
    let is_learned = ensemble.is_learned() && selection != Some(Selection::Random);
    is_learned || (has_images && !ensemble.gives_frames())
}

impl SignalInputs {
    /// Returns the signal steps of a skin whose sensor errors are drawn with the given seed.
    pub fn steps(&self, skin: &Seed) -> Vec<SignalStep> {
        let condition = &self.condition;
        let step = |&step: &StepSpec| match step {
            StepSpec::Force => SignalStep::Force,
            StepSpec::Noise => SignalStep::Noise(Noise {
                std: condition.noise,
                unit: self.noise_unit,
            }),
            StepSpec::Smoothing => SignalStep::Smoothing {
                width: condition.smoothing,
            },
            StepSpec::Error(error) => condition.strengths.step(error, skin),
        };
        self.steps.iter().map(step).collect()
    }
}

/// Returns the signal inputs of a plan for a given signal condition (strengths of noise and sensor errors).
fn signal_inputs(plan: &Plan, condition: Condition) -> SignalInputs {
    let is_active = |step: &&StepSpec| match step {
        StepSpec::Force => true,
        StepSpec::Noise => condition.noise != 0.0,
        StepSpec::Smoothing => condition.smoothing != 0.0,
        StepSpec::Error(error) => condition.strengths.present().any(|(own, ..)| own == *error),
    };
    let steps = plan.spec.signal.steps.iter();
    SignalInputs {
        steps: steps.filter(is_active).copied().collect(),
        noise_unit: match condition.noise == 0.0 {
            true => NoiseUnit::FullScale,
            false => plan.noise_unit,
        },
        condition,
    }
}

impl MeasurementGroup {
    /// Returns the inputs of the signal chain under the condition of this group.
    pub fn signal(&self, plan: &Plan) -> SignalInputs {
        signal_inputs(plan, self.condition.clone())
    }

    /// Returns all inputs that determine the measurements of this group.
    pub fn inputs<'a>(&self, plan: &'a Plan) -> MeasurementInputs<'a> {
        self.inputs_of(plan, &self.configurations)
    }

    /// Returns all inputs that determine the measurements that some configurations of this group alone need.
    pub fn inputs_of<'a>(
        &self,
        plan: &'a Plan,
        configurations: &[Configuration],
    ) -> MeasurementInputs<'a> {
        let mut of_images: Vec<FeaturesOfImages> = Vec::new();
        for one in configurations.iter().filter_map(Configuration::of_images) {
            if !of_images.contains(&one) {
                of_images.push(one);
            }
        }
        let test = plan.tested.as_deref().map(|tested| {
            let condition = plan.tested_condition(self.condition.clone());
            TestInputs {
                array: &tested.array,
                speed: tested.speed,
                signal: signal_inputs(tested, condition),
            }
        });
        MeasurementInputs {
            array: &plan.array,
            seed: plan.spec.seed,
            projections_per_split: plan.spec.projections_per_split,
            speed: plan.speed,
            signal: self.signal(plan),
            test_sensor: self.test_sensor,
            test,
            ensemble: self.ensemble,
            selection: self.selection,
            projected: self.projected(configurations),
            n_readings: self.n_readings(plan),
            of_images,
            copies: CopyInputs::new(plan, configurations),
        }
    }
}

impl CopyInputs {
    /// Returns the inputs of the tilted copies, whose number is the largest that any of the configurations uses; `None` without copies.
    fn new(plan: &Plan, configurations: &[Configuration]) -> Option<Self> {
        let recognition = &plan.spec.recognition;
        let copied = configurations.iter().filter(|one| one.n_copies() > 0);
        let n_touches = copied.clone().map(|one| one.train_touches).max();
        Some(Self {
            n_copies: copied.map(Configuration::n_copies).max()?,
            n_touches: n_touches.filter(|_| recognition.train_touches.is_some()),
            tilt: recognition.copies_tilt(),
        })
    }
}
