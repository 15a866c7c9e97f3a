//! Effect of model errors on recognition: classifiers are trained on touches of models and tested on touches of the exact meshes.
//!
//! All models of an object are touched in the same poses and to the same depth past their own first contact, as in other studies.

use crate::learning::classifiers::classifier::Classifier;
use crate::studies::object_detail::measured::{Level, Measured, Variant, levels, within};
use crate::studies::object_detail::plan::*;
use crate::studies::object_detail::rows::*;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::pressed_objects::simulate_array;
use crate::studies::shared_steps::{accuracy, touches_of};
use ndarray::Array2;
use std::ops::Range;

/// Classifier that is trained on touches of models of one method and tolerance.
pub(super) struct Learned {
    /// Index of the method and tolerance of the models on which the classifier is trained.
    number: usize,
    level: Level,
    classifier: ClassifierKind,
}

impl Learned {
    /// Returns all classifiers of the study: one for each kind of classifier, method and tolerance. Returns an empty list if the study has no recognition.
    pub fn all(plan: &ObjectDetailPlan) -> Vec<Self> {
        let kinds = plan.recognition().map_or(&[][..], |spec| &spec.classifiers);
        let of_level = |(number, level)| {
            kinds.iter().map(move |&classifier| Self {
                number,
                level,
                classifier,
            })
        };
        let levels = levels(plan).into_iter().enumerate();
        levels.flat_map(of_level).collect()
    }

    /// Returns the name of the work item that trains the classifier.
    pub fn name(&self) -> String {
        let (method, tolerance_mm) = self.level;
        format!(
            "{:?} from {method:?}{}",
            self.classifier,
            within(tolerance_mm)
        )
    }
}

/// Sensor that touches models for training and testing of classifiers.
pub(super) struct Sensor<'a> {
    plan: &'a ObjectDetailPlan,
    spec: &'a DetailRecognitionSpec,
    projection: Projection,
    seed: Seed,
}

/// Measurements of all touches of one model.
pub(super) struct ModelMeasurements {
    /// Measurements of the touches, shape (n_touches, m).
    measurements: Array2<f64>,
    /// Mean deflection error for equal depths past the first contact of the model and of the mesh, mm.
    own_contact_error_mm: f64,
}

impl<'a> Sensor<'a> {
    /// Creates the sensor of a study that has a table `[object_detail.recognition]`.
    pub fn new(plan: &'a ObjectDetailPlan, spec: &'a DetailRecognitionSpec) -> Result<Self> {
        let seed = Seed::new(plan.spec.seed);
        let grid = plan.array.shape();
        let stream = seed.named("object detail recognition");
        Ok(Self {
            plan,
            spec,
            projection: Projection::new(spec.ensemble, grid, spec.measurements, &stream)?,
            seed,
        })
    }

    /// Returns the measurements of all touches for each model of an object; the first model is the exact mesh. All models are touched in equal poses, while the
    /// object lies in its stable poses.
    pub fn measure(&self, made: &Measured) -> Result<Vec<ModelMeasurements>> {
        let object =
            |variant: &Variant| Object::of_one_part(&made.mesh.name, variant.model.clone());
        let placement = Placement {
            per_object: Some(self.spec.n_touches()),
            ..self.plan.placement.clone()
        };
        let mut touched = draw_touches(vec![object(&made.variants[0])], &placement, &self.seed)?;
        let measured = made.variants.iter().map(|variant| {
            touched[0].object = object(variant);
            let frames = simulate_array(&touched, &self.plan.array, 1, &Silent);
            Ok(ModelMeasurements {
                measurements: self.projection.measure(frames.to_array().view()),
                own_contact_error_mm: made.truth.error_past_own_contact(&variant.model).mean_mm,
            })
        });
        measured.collect()
    }

    /// Trains a classifier on touches of models of one method and tolerance, and tests it on touches of the exact meshes. The argument contains the
    /// measurements of all models of each object; the result is a row with the accuracies.
    pub fn row(
        &self,
        objects: &[Vec<ModelMeasurements>],
        learned: &Learned,
    ) -> Result<DetailRecognition> {
        let (number, n_training) = (learned.number, self.spec.training_touches);
        let of_level = |number: usize, touches: Range<usize>| {
            let objects = objects.iter();
            touches_of(
                objects.map(|felt| felt[number].measurements.view()),
                touches,
            )
        };
        let training = of_level(number, 0..n_training)?;
        let classifier = Classifier::new(learned.classifier).train(&training, &self.seed)?;
        let test = of_level(0, n_training..self.spec.n_touches())?;
        let (accuracy_on_mesh, on_mesh) = accuracy(&classifier, &test)?;
        let of_itself = of_level(number, n_training..self.spec.n_touches())?;
        let (accuracy_on_itself, on_itself) = accuracy(&classifier, &of_itself)?;
        let errors = objects.iter().map(|felt| felt[number].own_contact_error_mm);
        Ok(DetailRecognition {
            method: learned.level.0,
            tolerance_mm: learned.level.1,
            classifier: learned.classifier,
            n_objects: objects.len(),
            n_training: training.targets.len(),
            n_test: test.targets.len(),
            n_measurements: self.projection.n_measurements(),
            error_own_contact_median_mm: quantile(&mut errors.collect::<Vec<_>>(), 0.5),
            accuracy_on_mesh,
            accuracy_on_mesh_low: on_mesh.low,
            accuracy_on_mesh_high: on_mesh.high,
            accuracy_on_itself,
            accuracy_on_itself_low: on_itself.low,
            accuracy_on_itself_high: on_itself.high,
            n_capped: classifier.n_capped(),
        })
    }
}
