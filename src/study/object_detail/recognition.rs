//! What an object's errors do to recognition: classifiers that learn from models and are tested on the meshes themselves.
//!
//! Every model of an object is touched as a study touches that has no other: in the same places, as far past its own first
//! contact. The leading touches train, the others test.

use super::plan::{ObjectDetailPlan, RecognitionPlan};
use super::table::{DetailCell, DetailRecognition, DetailScore};
use super::variants::Variant;
use crate::error::Result;
use crate::objects::Object;
use crate::quantile::quantile;
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::classifier::Classifier;
use crate::recognition::dataset::dataset;
use crate::recognition::interval::Interval;
use crate::sensing::Projection;
use crate::study::CONFIDENCE;
use crate::study::progress::Silent;
use crate::study::simulation::{draw_touches, simulate_array};
use crate::world::{Patch, Placement};
use ndarray::{Array1, Array2, Axis, concatenate, s};
use rayon::prelude::*;

/// Makes measurements of models, for learning.
pub(super) struct Sensor<'a> {
    patch: Patch,
    placement: Placement,
    projection: Projection,
    plan: &'a RecognitionPlan,
    seed: Seed,
}

/// One level of all objects.
struct Level<'a> {
    cell: &'a DetailCell,
    /// Mean deflection error of each object past its own contact, mm.
    errors: Vec<f64>,
    /// Measurements of each object.
    objects: Vec<&'a Array2<f64>>,
}

impl<'a> Sensor<'a> {
    /// For a study in which something learns.
    pub(super) fn of(plan: &'a ObjectDetailPlan) -> Result<Option<Self>> {
        let Some(wanted) = &plan.recognition else {
            return Ok(None);
        };
        let seed = Seed::new(plan.spec.seed);
        let grid = (plan.patch.grid.ny, plan.patch.grid.nx);
        let stream = seed.named("object detail recognition");
        Ok(Some(Self {
            patch: plan.patch,
            placement: Placement {
                per_object: Some(wanted.n_training + wanted.n_test),
                ..plan.placement.clone()
            },
            projection: Projection::new(wanted.ensemble, grid, wanted.n_measurements, &stream)?,
            plan: wanted,
            seed,
        }))
    }

    /// Measurements of each model of an object (n_touches × m), in their order; the first is the mesh itself, and all are
    /// touched in the same places of its rest poses.
    pub(super) fn measure(&self, name: &str, variants: &[Variant]) -> Result<Vec<Array2<f64>>> {
        let object = |variant: &Variant| Object::of_one_part(name, variant.model.clone());
        let mut touched = draw_touches(vec![object(&variants[0])], &self.placement, &self.seed)?;
        let measured = variants.iter().map(|variant| {
            touched[0].object = object(variant);
            let frames = simulate_array(&touched, &self.patch, 1, &Silent);
            Ok(self.projection.measure(frames.kept.to_array()?.view()))
        });
        measured.collect()
    }

    /// A row a level and classifier, from what was felt of the models of each object. `rows` are theirs in the same order, the
    /// meshes themselves first.
    pub(super) fn recognise(
        &self,
        rows: &[(DetailCell, DetailScore)],
        objects: &[Vec<Array2<f64>>],
    ) -> Result<Vec<DetailRecognition>> {
        let n_levels = objects.first().map_or(0, Vec::len);
        let of_level = |level: usize| rows.iter().skip(level).step_by(n_levels);
        let levels = (0..n_levels).map(|level| Level {
            cell: &rows[level].0,
            errors: of_level(level)
                .map(|(_, score)| score.error_own_contact_mm)
                .collect(),
            objects: objects.iter().map(|felt| &felt[level]).collect(),
        });
        let levels: Vec<Level> = levels.collect();
        let Some(truth) = levels.first() else {
            return Ok(Vec::new());
        };
        let kinds = &self.plan.classifiers;
        let cells = levels
            .iter()
            .flat_map(|level| kinds.iter().map(move |&kind| (level, kind)));
        let cells: Vec<_> = cells.collect();
        cells
            .into_par_iter()
            .map(|(level, kind)| self.row(level, truth, kind))
            .collect()
    }

    fn row(&self, level: &Level, truth: &Level, kind: ClassifierKind) -> Result<DetailRecognition> {
        let n_training = self.plan.n_training;
        let (features, labels) = level.rows(0, n_training)?;
        let n_rows = labels.len();
        let classifier = Classifier::new(kind).train(&dataset(features, labels)?, &self.seed)?;
        let accuracy = |tested: &Level| -> Result<(usize, Interval)> {
            let (features, labels) = tested.rows(n_training, n_training + self.plan.n_test)?;
            let predicted = classifier.labels(features.view())?;
            let right = predicted
                .iter()
                .zip(&labels)
                .filter(|(a, b)| a == b)
                .count();
            Ok((right, Interval::wilson(right, labels.len(), CONFIDENCE)?))
        };
        let (on_mesh, on_mesh_interval) = accuracy(truth)?;
        let (on_itself, on_itself_interval) = accuracy(level)?;
        let n_test = level.objects.len() * self.plan.n_test;
        let mut errors = level.errors.clone();
        Ok(DetailRecognition {
            method: level.cell.method,
            tolerance_mm: level.cell.tolerance_mm,
            classifier: kind,
            n_objects: level.objects.len(),
            n_training: n_rows,
            n_test,
            n_measurements: self.projection.n_measurements(),
            error_own_contact_median_mm: quantile(&mut errors, 0.5),
            accuracy_on_mesh: on_mesh as f64 / n_test as f64,
            accuracy_on_mesh_low: on_mesh_interval.low,
            accuracy_on_mesh_high: on_mesh_interval.high,
            accuracy_on_itself: on_itself as f64 / n_test as f64,
            accuracy_on_itself_low: on_itself_interval.low,
            accuracy_on_itself_high: on_itself_interval.high,
            n_capped: classifier.n_capped(),
        })
    }
}

impl Level<'_> {
    /// The touches `first..last` of every object, and its number as their label.
    fn rows(&self, first: usize, last: usize) -> Result<(Array2<f64>, Array1<usize>)> {
        let views: Vec<_> = self
            .objects
            .iter()
            .map(|rows| rows.slice(s![first..last, ..]))
            .collect();
        let features = concatenate(Axis(0), &views).expect("every object has as many columns");
        let labels = (0..views.len()).flat_map(|label| std::iter::repeat_n(label, last - first));
        Ok((features, labels.collect()))
    }
}
