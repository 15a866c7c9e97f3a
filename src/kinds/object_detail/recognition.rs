//! What an object's errors do to recognition: classifiers that learn from models and are tested on the meshes themselves.
//!
//! Every model of an object is touched as a study touches that has no other: in the same places, as far past its own first
//! contact.

use super::deflection::Truth;
use super::plan::ObjectDetailPlan;
use super::rows::DetailRecognition;
use super::score::own_contact_error_mm;
use super::spec::{DetailMethod, DetailRecognitionSpec};
use super::variants::Variant;
use crate::error::Result;
use crate::kinds::model_recognition::{Accuracy, touches_of};
use crate::objects::Object;
use crate::quantile::quantile;
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::classifier::Classifier;
use crate::sensing::Projection;
use crate::study::progress::Silent;
use crate::study::simulation::{draw_touches, simulate_array};
use crate::world::{Patch, Placement};
use ndarray::Array2;

/// Makes measurements of models, for learning.
pub(super) struct Sensor<'a> {
    patch: Patch,
    placement: Placement,
    projection: Projection,
    spec: &'a DetailRecognitionSpec,
    seed: Seed,
}

/// What was felt of the models of an object, the mesh itself first.
pub(super) struct Felt {
    /// n_touches × m each.
    measurements: Vec<Array2<f64>>,
    /// Mean deflection errors past their own contact.
    own_contact_errors_mm: Vec<f64>,
}

impl<'a> Sensor<'a> {
    /// For a study in which something learns.
    pub fn of(plan: &'a ObjectDetailPlan) -> Result<Option<Self>> {
        let Some(wanted) = plan.recognition() else {
            return Ok(None);
        };
        let seed = Seed::new(plan.spec.seed);
        let grid = (plan.patch.grid.ny, plan.patch.grid.nx);
        let stream = seed.named("object detail recognition");
        Ok(Some(Self {
            patch: plan.patch,
            placement: Placement {
                per_object: Some(wanted.training_touches + wanted.test_touches),
                ..plan.placement.clone()
            },
            projection: Projection::new(wanted.ensemble, grid, wanted.measurements, &stream)?,
            spec: wanted,
            seed,
        }))
    }

    /// Measurements of each model of an object, in their order; the first is the mesh itself, and all are touched in the same places of
    /// its rest poses.
    pub fn measure(&self, name: &str, variants: &[Variant], truth: &Truth) -> Result<Felt> {
        let object = |variant: &Variant| Object::of_one_part(name, variant.model.clone());
        let mut touched = draw_touches(vec![object(&variants[0])], &self.placement, &self.seed)?;
        let measured = variants.iter().map(|variant| {
            touched[0].object = object(variant);
            let frames = simulate_array(&touched, &self.patch, 1, &Silent);
            Ok(self.projection.measure(frames.kept.to_array()?.view()))
        });
        let measurements = measured.collect::<Result<_>>()?;
        let variants = variants.iter();
        let errors = variants.map(|variant| own_contact_error_mm(truth, variant));
        Ok(Felt {
            measurements,
            own_contact_errors_mm: errors.collect(),
        })
    }

    /// What a classifier learns from a level, by its number, from what was felt of the models of each object.
    pub fn row(
        &self,
        objects: &[Felt],
        (number, (method, tolerance_mm)): (usize, (DetailMethod, Option<f64>)),
        kind: ClassifierKind,
    ) -> Result<DetailRecognition> {
        let n_training = self.spec.training_touches;
        let n_all = n_training + self.spec.test_touches;
        let level = |level: usize| {
            objects
                .iter()
                .map(move |felt| felt.measurements[level].view())
        };
        let training = touches_of(level(number), 0..n_training)?;
        let classifier = Classifier::new(kind).train(&training, &self.seed)?;
        let tests = [
            touches_of(level(0), n_training..n_all)?,
            touches_of(level(number), n_training..n_all)?,
        ];
        let on_mesh = Accuracy::of(&classifier, &tests[0])?;
        let on_itself = Accuracy::of(&classifier, &tests[1])?;
        let errors = objects.iter();
        let mut errors: Vec<f64> = errors
            .map(|felt| felt.own_contact_errors_mm[number])
            .collect();
        Ok(DetailRecognition {
            method,
            tolerance_mm,
            classifier: kind,
            n_objects: objects.len(),
            n_training: training.targets.len(),
            n_test: tests[0].targets.len(),
            n_measurements: self.projection.n_measurements(),
            error_own_contact_median_mm: quantile(&mut errors, 0.5),
            accuracy_on_mesh: on_mesh.share,
            accuracy_on_mesh_low: on_mesh.interval.low,
            accuracy_on_mesh_high: on_mesh.interval.high,
            accuracy_on_itself: on_itself.share,
            accuracy_on_itself_low: on_itself.interval.low,
            accuracy_on_itself_high: on_itself.interval.high,
            n_capped: classifier.n_capped(),
        })
    }
}
