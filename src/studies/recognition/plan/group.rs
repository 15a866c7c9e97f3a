//! Groups of cells that share their measurements, and the families and fits within them.

use crate::inputs::sensor_errors::TestedOn;
use crate::sensing::Ensemble;
use crate::studies::recognition::plan::signal::Condition;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::rows::cell::Cell;
use crate::studies::recognition::rows::image_features::FeaturesOfImages;

/// Cells that are read from the same measurements.
#[derive(Clone, Debug)]
pub struct Group {
    /// Index into the plan's arrays.
    pub array: usize,
    /// Frames a touch.
    pub frames: usize,
    /// What happens to the signal.
    pub condition: Condition,
    /// The skin that test touches are made with.
    pub tested_on: TestedOn,
    /// How measurements are made.
    pub ensemble: Ensemble,
    /// Its cells, family by family.
    pub cells: Vec<Cell>,
}

impl Group {
    /// Its cells by family. The cells of a family learn from the same rows of the same features: they differ only in C
    /// and in which touches are fused, those with the same C following each other.
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

    /// How many times each touch is read.
    pub fn n_readings(&self, plan: &Plan) -> usize {
        let asked = plan.spec.recognition.training_readings.unwrap_or(1);
        if self.condition.is_random_by_reading() {
            asked
        } else {
            1
        }
    }

    /// What its cells learn from that is made of images, each once.
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

    /// The measurements that serve every cell: of the largest m if smaller ones are its prefixes, else one set per m.
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
