//! What an object's errors do to recognition: classifiers that learn from models and are tested on the meshes themselves.
//!
//! Every model of an object is touched as a study touches that has no other: in the same places, as far past its own first
//! contact. The leading touches train, the others test.

use super::deflection::Truth;
use super::plan::{ObjectDetailPlan, RecognitionPlan};
use super::score::own_contact_error_mm;
use super::spec::DetailMethod;
use super::table::DetailRecognition;
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

/// Makes measurements of models, for learning.
pub(super) struct Sensor<'a> {
    patch: Patch,
    placement: Placement,
    projection: Projection,
    plan: &'a RecognitionPlan,
    seed: Seed,
}

/// What was felt of the models of an object, the mesh itself first.
pub(super) struct Felt {
    /// n_touches × m each.
    measurements: Vec<Array2<f64>>,
    /// Mean deflection errors past their own contact.
    own_contact_errors_mm: Vec<f64>,
}

/// Measurements of one level of each object.
struct Level<'a>(Vec<&'a Array2<f64>>);

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
    pub(super) fn measure(&self, name: &str, variants: &[Variant], truth: &Truth) -> Result<Felt> {
        let object = |variant: &Variant| Object::of_one_part(name, variant.model.clone());
        let mut touched = draw_touches(vec![object(&variants[0])], &self.placement, &self.seed)?;
        let measured = variants.iter().map(|variant| {
            touched[0].object = object(variant);
            let frames = simulate_array(&touched, &self.patch, 1, &Silent);
            Ok(self.projection.measure(frames.kept.to_array()?.view()))
        });
        let measurements = measured.collect::<Result<_>>()?;
        let errors = variants
            .iter()
            .map(|variant| own_contact_error_mm(truth, variant));
        Ok(Felt {
            measurements,
            own_contact_errors_mm: errors.collect(),
        })
    }

    /// What learns.
    pub(super) fn kinds(&self) -> &[ClassifierKind] {
        &self.plan.classifiers
    }

    /// What a classifier learns from a level, by its number, from what was felt of the models of each object.
    pub(super) fn row(
        &self,
        objects: &[Felt],
        (number, (method, tolerance_mm)): (usize, (DetailMethod, Option<f64>)),
        kind: ClassifierKind,
    ) -> Result<DetailRecognition> {
        let level = |number: usize| {
            Level(
                objects
                    .iter()
                    .map(|felt| &felt.measurements[number])
                    .collect(),
            )
        };
        let (truth, level) = (level(0), level(number));
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
        let (on_mesh, on_mesh_interval) = accuracy(&truth)?;
        let (on_itself, on_itself_interval) = accuracy(&level)?;
        let n_test = objects.len() * self.plan.n_test;
        let errors = objects
            .iter()
            .map(|felt| felt.own_contact_errors_mm[number]);
        let mut errors: Vec<f64> = errors.collect();
        Ok(DetailRecognition {
            method,
            tolerance_mm,
            classifier: kind,
            n_objects: objects.len(),
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
            .0
            .iter()
            .map(|rows| rows.slice(s![first..last, ..]))
            .collect();
        let features = concatenate(Axis(0), &views).expect("every object has as many columns");
        let labels = (0..views.len()).flat_map(|label| std::iter::repeat_n(label, last - first));
        Ok((features, labels.collect()))
    }
}
