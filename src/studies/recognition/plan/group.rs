//! Groups of configurations that share their measurements, and families of configurations that share their features.

use crate::studies::prelude::*;
use crate::studies::recognition::plan::Condition;
use crate::studies::recognition::rows::{Configuration, FeaturesOfImages};

/// Group of configurations whose results are computed from the same measurements of touches.
#[derive(Clone, Debug)]
pub struct MeasurementGroup {
    /// Index of the array in the plan's list of arrays.
    pub array: usize,
    /// Number F of frames per touch.
    pub frames: usize,
    /// Condition of the signal: the strengths of noise, smoothing and sensor errors.
    pub condition: Condition,
    /// Skin on which the test touches are simulated: the training skin or another one.
    pub test_sensor: TestSensor,
    /// Ensemble from which the measurement matrix is drawn.
    pub ensemble: Ensemble,
    /// Method that selects the taxels to read; `None` if the ensemble selects no taxels.
    pub selection: Option<Selection>,
    /// Configurations of the group, ordered by family.
    pub configurations: Vec<Configuration>,
}

impl MeasurementGroup {
    /// Returns the configurations of the group, divided into families. The configurations of a family use the same rows of features. Configurations of a family
    /// differ only in the penalty C, the number of touches per decision, and the choice of the next touch. Configurations with equal C are adjacent.
    pub fn families(&self) -> impl Iterator<Item = &[Configuration]> {
        let is_same = |a: &Configuration, b: &Configuration| {
            let alike = Configuration {
                configuration: a.configuration,
                c: a.c,
                touches_per_decision: a.touches_per_decision,
                next_touch: a.next_touch,
                ..b.clone()
            };
            alike == *a
        };
        self.configurations.chunk_by(is_same)
    }

    /// Returns the number of readings of each training touch.
    pub fn n_readings(&self, plan: &Plan) -> usize {
        let asked = plan.spec.recognition.readings_per_touch.unwrap_or(1);
        if self.condition.is_random_by_reading() {
            asked
        } else {
            1
        }
    }

    /// Returns the kinds of image features that the group's configurations use, each kind once.
    pub fn features_of_images(&self) -> Vec<FeaturesOfImages> {
        let mut all: Vec<FeaturesOfImages> = Vec::new();
        for one in self
            .configurations
            .iter()
            .filter_map(Configuration::of_images)
        {
            if !all.contains(&one) {
                all.push(one);
            }
        }
        all
    }

    /// Returns the numbers m of measurements per frame that are computed for the group. If smaller sets of measurements are prefixes of larger ones, this is
    /// only the largest number m; otherwise every m.
    pub fn projected(&self) -> Vec<usize> {
        let mut counts: Vec<usize> = self.configurations.iter().map(|c| c.measurements).collect();
        counts.sort_unstable();
        counts.dedup();
        if self.ensemble.is_prefix_nested() {
            counts.drain(..counts.len() - 1);
        }
        counts
    }
}
