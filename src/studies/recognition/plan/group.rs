//! Groups of configurations that share their measurements, and the families within them.

use crate::inputs::sensor_errors::TestedOn;
use crate::sensing::Ensemble;
use crate::studies::recognition::plan::signal::Condition;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::rows::cell::Cell;
use crate::studies::recognition::rows::image_features::FeaturesOfImages;

/// Configurations that are computed from the same measurements.
#[derive(Clone, Debug)]
pub struct Group {
    /// Index of the array in the plan.
    pub array: usize,
    /// Number of frames per touch.
    pub frames: usize,
    /// Strengths of the signal steps.
    pub condition: Condition,
    /// Skin of the test touches.
    pub tested_on: TestedOn,
    /// Ensemble of the measurement matrix.
    pub ensemble: Ensemble,
    /// Configurations, ordered by family.
    pub cells: Vec<Cell>,
}

impl Group {
    /// Returns the configurations by family. A family shares the rows of the same features; its configurations differ only in C and in the fused touches.
    /// Configurations with equal C are adjacent.
    pub fn families(&self) -> impl Iterator<Item = &[Cell]> {
        let family = |cell: &Cell| {
            let (m, kind) = (cell.measurements, cell.classifier);
            let rows = (
                (cell.over_time, cell.features),
                (cell.foremost_full_scale, cell.tilted_copies),
            );
            let spoiled = (cell.mislabelled_fraction, cell.class_imbalance);
            (m, rows, kind, cell.train_touches, spoiled)
        };
        self.cells.chunk_by(move |a, b| family(a) == family(b))
    }

    /// Returns the number of readings of each touch.
    pub fn n_readings(&self, plan: &Plan) -> usize {
        let asked = plan.spec.recognition.training_readings.unwrap_or(1);
        if self.condition.is_random_by_reading() {
            asked
        } else {
            1
        }
    }

    /// Returns the distinct image features of the group's configurations.
    pub fn features_of_images(&self) -> Vec<FeaturesOfImages> {
        let mut all: Vec<FeaturesOfImages> =
            self.cells.iter().filter_map(Cell::of_images).collect();
        let mut known = Vec::new();
        all.retain(|one| {
            let is_new = !known.contains(one);
            known.push(*one);
            is_new
        });
        all
    }

    /// Returns the numbers of measurements to compute: only the largest m if smaller sets are prefixes of it, otherwise every m.
    pub fn projected(&self) -> Vec<usize> {
        let mut counts: Vec<usize> = self.cells.iter().map(|c| c.measurements).collect();
        counts.sort_unstable();
        counts.dedup();
        if self.ensemble.is_prefix_nested() {
            counts.drain(..counts.len() - 1);
        }
        counts
    }
}
