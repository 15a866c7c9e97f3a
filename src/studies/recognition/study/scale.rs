//! Memory estimate of a recognition study: frames, measurements, and data of the training.

use crate::engine::work_items::{Scale, Stage};
use crate::sensing::{Ensemble, N_COMPONENTS};
use crate::studies::recognition::measurements::{MeasurementInputs, UNTOUCHED};
use crate::studies::recognition::rows::{Configuration, join_values};
use crate::studies::recognition::study::{Job, RecognitionStudy};
use crate::studies::recognition::sweep::{LEARNED_FRAMES, StudyPart, WITH_COPIES};
use crate::studies::recognition::training::FamilyInputs;
use bubbletouch_svm::Multiclass;

/// Memory of the result rows of one configuration in one trial, bytes.
const CELL_BYTES: f64 = 4e3;
/// Memory of a number, bytes.
const NUMBER: f64 = 8.0;
/// Memory of an encoded frame beside its values, bytes: its place in the list and the header of its allocation.
const FRAME_BYTES: f64 = 32.0;
/// Number of directions in which principal components are sought beyond the components.
const OVERSAMPLING: f64 = 16.0;

/// Returns the size of a recognition study: numbers of work items, memory and disk space.
pub fn recognition_scale(study: &RecognitionStudy) -> Scale {
    let n_touches = study.of_parts(|part| part.sweep.labels.len().to_string());
    let mut touches = match study.n_arrays() {
        1 => format!("{n_touches} on one array"),
        n => format!("{n_touches} on each of {n} arrays"),
    };
    match study.test_keys() {
        keys if keys.is_empty() => {}
        keys => touches += &format!("; test touches with {keys}"),
    }
    let frames = |set: usize| {
        let (touched, array, n_frames) = study.on(set);
        let n_frames_in_all = (touched.labels().len() * n_frames) as f64;
        n_frames_in_all * (touched.frame_bytes((array, n_frames)) + FRAME_BYTES)
    };
    let frames: Vec<f64> = (0..study.touch_sets.len()).map(frames).collect();
    let n_alike = study.n_trials().min(rayon::current_num_threads());
    let stages = frames.iter().enumerate().map(|(set, bytes)| {
        let jobs = study.jobs(set, 0..1, |_| true);
        // Separate test touches are in memory together with the training touches.
        let tested = jobs.iter().map(|job| job.first().tested);
        let tested = tested.filter(|tested| *tested != set);
        let items = jobs.iter().flat_map(Job::bytes);
        Stage {
            bytes: bytes + largest(tested.map(|tested| frames[tested])),
            items: items.flat_map(|bytes| vec![bytes; n_alike]).collect(),
        }
    });
    Scale {
        objects: study.of_parts(|part| part.touched.class_names().len().to_string()),
        touches,
        n_configurations: study.n_configurations(),
        bytes: CELL_BYTES * (study.n_configurations() * study.n_trials()) as f64,
        stages: stages.collect(),
    }
}

impl Job<'_> {
    /// Returns the approximate memory of the job, bytes: of the job while its thread evaluates one family, then of each further family, which idle threads
    /// evaluate at the same time.
    pub(crate) fn bytes(&self) -> Vec<f64> {
        let (part, group) = self.study.group(self.families[0]);
        let array = &part.plan.array;
        let (n, m) = (array.n_values() as f64, self.first().n_measurements as f64);
        let n_read = (part.sweep.labels.len() * group.frames * group.n_readings(&part.plan)) as f64;
        let inputs = group.inputs(&part.plan);
        let shapes = array.image_shapes();
        let of_images = inputs.of_images.iter();
        let features: usize = of_images.map(|one| join_values(one.join, &shapes)).sum();
        let features = NUMBER * n_read * features as f64;
        let matrix = (group.ensemble.about().bytes)(m, n);
        let estimates: f64 = inputs.counts_of_images().iter().map(|&m| m as f64).sum();
        let estimates = match inputs.ensemble.gives_frames() {
            true => 0.0,
            false => NUMBER * n * 2.0 * estimates,
        };
        let values = NUMBER * n_read * m;
        let measuring = values + features + matrix + estimates;
        let fitting = match inputs.is_fitted() {
            true => fitting_bytes(&inputs, part.sweep.splits[0].train.len() * group.frames, m),
            false => 0.0,
        };
        let kept = features + if self.reads_values() { values } else { 0.0 };
        let families = self.families.iter().map(|&family| {
            let (part, family) = self.study.family(family);
            family_bytes(part, family, group.n_readings(&part.plan))
        });
        let mut items: Vec<f64> = families.collect();
        items.sort_by(|a, b| b.total_cmp(a));
        items[0] = (kept + items[0]).max(measuring).max(fitting);
        items
    }
}

/// Returns the memory while ensembles and image estimators are fitted to at most `n_train` training frames, bytes: the frames with their copies, and the
/// directions in which m or more principal components are sought.
fn fitting_bytes(inputs: &MeasurementInputs, n_train: usize, m: f64) -> f64 {
    let n = inputs.array.n_values() as f64;
    let n_train = n_train.min(LEARNED_FRAMES) as f64;
    let (n_fitted, n_components) = match inputs.of_images.is_empty() {
        true if inputs.ensemble != Ensemble::AdaptiveLearned => (n_train, m),
        _ => (WITH_COPIES as f64, N_COMPONENTS as f64),
    };
    let n_directions = (n_components + OVERSAMPLING).min(n_fitted).min(n);
    let frames = n_train + n_fitted + UNTOUCHED as f64;
    NUMBER * (n * frames + n_directions * (2.0 * n_fitted + 3.0 * n))
}

/// Returns the memory for evaluating a family of configurations, bytes: training rows and kernel values, or test rows and scores.
fn family_bytes(part: &StudyPart, family: &[Configuration], n_readings: usize) -> f64 {
    let (learned, configuration) = (&part.plan.spec.recognition, &family[0]);
    let n_classes = part.touched.class_names().len();
    let training = FamilyInputs::new(&part.plan, &part.sweep, family).training;
    let fuses = learned.touches_per_decision.values().iter().any(|&k| k > 1);
    let n_scores = match (configuration.classifier.has_c(), learned.multiclass) {
        // Without decisions on several touches, test rows are processed in blocks.
        (true, _) if !fuses => 0,
        (true, Multiclass::OneVsOne) => n_classes * (n_classes - 1) / 2,
        _ => n_classes,
    };
    let n_touches = n_classes * configuration.train_touches;
    let n_train = n_touches * (n_readings + configuration.n_copies());
    let n_choice = match training.c_grid.is_some() || training.gamma_grid.is_some() {
        true => training
            .cv_touches
            .map_or(n_touches, |n| n * n_classes)
            .min(n_touches),
        false => 0,
    };
    let n_features = configuration.n_features();
    let trained = (training.classifier).training_bytes([n_train, n_choice], n_classes, n_features);
    let n_test = part.sweep.splits.iter().map(|split| split.test.len());
    let (m, n_test) = (n_features as f64, n_test.max().unwrap_or(0) as f64);
    let rows = NUMBER * n_train as f64 * m;
    // Inner folds exist beside the fit on all rows; the model of expected decisions has one table per object and test pose.
    let (n_fits, n_tables) = match learned.is_informed() {
        false => (1.0, 0),
        true => (2.0, n_classes),
    };
    // The model may keep its training rows. Test rows are scaled; a score and its share in decisions on several touches are two numbers.
    let tested = 2.0 * rows + NUMBER * n_test * (2.0 * m + 2.0 * n_scores as f64 + n_tables as f64);
    (n_fits * (rows + trained as f64)).max(tested)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}
