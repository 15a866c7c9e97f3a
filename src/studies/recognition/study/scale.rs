//! Memory estimate of a recognition study: frames, measurements, and data of the training.

use crate::engine::work_items::scale::Scale;
use crate::sensing::N_COMPONENTS;
use crate::studies::recognition::measurements::measurement::UNTOUCHED;
use crate::studies::recognition::measurements::measurement_inputs::MeasurementInputs;
use crate::studies::recognition::plan::group::MeasurementGroup;
use crate::studies::recognition::rows::configuration::Configuration;
use crate::studies::recognition::rows::image_features::join_values;
use crate::studies::recognition::study::load::{SPLIT_BYTES, TOUCH_BYTES};
use crate::studies::recognition::study::recognition_study::RecognitionStudy;
use crate::studies::recognition::sweep::configurations::StudyPart;
use crate::studies::recognition::sweep::learned_frames::WITH_COPIES;
use crate::studies::recognition::training::evaluation_inputs::FamilyInputs;
use bubbletouch_sim::frame_coding::most_bytes;
use bubbletouch_svm::Multiclass;
use std::collections::HashSet;
use std::sync::Arc;

/// Memory of the result rows of one configuration in one trial, bytes.
const CELL_BYTES: f64 = 4e3;
/// Memory per value of the training rows, bytes. The memory covers four copies of a value: original, scaled, sorted by class, and as support vectors.
const TRAINING_BYTES: f64 = 32.0;
/// Memory per feature value of the test rows, bytes. The memory covers three copies of a value: original, scaled, and in the format of the kernel.
const TEST_BYTES: f64 = 20.0;
/// Memory of an encoded frame beside its values, bytes: its place in the list and the header of its allocation.
const FRAME_BYTES: f64 = 32.0;
/// Memory of a score and of its share in decisions on several touches, bytes.
const SCORE_BYTES: f64 = 16.0;

/// Returns the size of a recognition study: numbers of work items, memory and disk space.
pub fn recognition_scale(study: &RecognitionStudy) -> Scale {
    type Placed<'a> = (&'a StudyPart, &'a MeasurementGroup);
    let n_values = |(part, group): Placed| part.plan.arrays[group.array].n_values();
    let n_frames = |(part, group): Placed| (part.sweep.labels.len() * group.frames) as f64;
    let m = |on: Placed| {
        let most = on.1.projected().into_iter().max().unwrap_or(0);
        on.1.ensemble
            .n_measurements(most, on.0.plan.arrays[on.1.array].n_values()) as f64
    };
    let n_read = |on: Placed| n_frames(on) * on.1.n_readings(&on.0.plan) as f64;
    let measured = |on: Placed| {
        let matrix = on.1.ensemble.about().bytes;
        let of_images = on.1.features_of_images().into_iter();
        let shapes = on.0.plan.arrays[on.1.array].image_shapes();
        let numbers: usize = of_images.map(|one| join_values(one.join, &shapes)).sum();
        let learned = learned_bytes(&on.1.inputs(&on.0.plan), n_values(on) as f64)
            + 8.0 * n_read(on) * numbers as f64;
        8.0 * n_read(on) * m(on) + matrix(m(on), n_values(on) as f64) + learned
    };
    let groups = || {
        let parts = study.parts().iter();
        parts.flat_map(|part| part.sweep.groups.iter().map(move |group| (part, group)))
    };
    let learned = |(part, group): Placed| {
        let n_test = part.sweep.splits.iter().map(|split| split.test.len());
        let (n_test, n_classes) = (n_test.max().unwrap_or(0), part.touched.class_names().len());
        let n_read = n_classes * group.n_readings(&part.plan);
        let bytes =
            |family: &[Configuration]| family_bytes(part, family, n_test, (n_classes, n_read));
        largest(group.families().map(bytes))
    };
    // Separate test touches are in memory together with the training touches.
    let n_made = |(part, _): Placed| 1.0 + f64::from(u8::from(part.plan.tested.is_some()));
    let most = |g: &Placed| n_made(*g) * n_frames(*g) * most_bytes(n_values(*g)) as f64;
    let largest_frames = groups().max_by(|a, b| most(a).total_cmp(&most(b)));
    let frames = largest_frames.map_or(0.0, |g| {
        let array = (&g.0.plan.arrays[g.1.array], g.1.frames);
        n_made(g) * n_frames(g) * (g.0.touched.frame_bytes(array) + FRAME_BYTES)
    });
    let n_touches = study.of_parts(|part| part.sweep.labels.len().to_string());
    let mut touches = match study.n_arrays() {
        1 => format!("{n_touches} on one array"),
        n => format!("{n_touches} on each of {n} arrays"),
    };
    match study.test_keys() {
        keys if keys.is_empty() => {}
        keys => touches += &format!("; test touches with {keys}"),
    }
    Scale {
        objects: study.of_parts(|part| part.touched.class_names().len().to_string()),
        touches,
        n_configurations: study.n_configurations(),
        bytes: frames
            + touch_bytes(study)
            + CELL_BYTES * (study.n_configurations() * study.n_trials()) as f64,
        // While a thread is blocked by other threads, it computes another group. Two items can therefore be in memory.
        item_bytes: 2.0 * largest(groups().map(measured)) + largest(groups().map(learned)),
    }
}

/// Returns the memory of the touches of all parts and of their splits, bytes.
fn touch_bytes(study: &RecognitionStudy) -> f64 {
    let mut known = HashSet::new();
    let parts = study.parts().iter();
    let bytes = parts.map(|part| {
        let sets = [&part.touched, &part.tested];
        let new = sets.map(|set| known.insert(Arc::as_ptr(set).cast::<()>()));
        let n_sets = new.into_iter().filter(|is_new| *is_new).count() as f64;
        let of_splits = SPLIT_BYTES * part.sweep.splits.len() as f64;
        part.sweep.labels.len() as f64 * (n_sets * TOUCH_BYTES + of_splits)
    });
    bytes.sum()
}

/// Returns the memory of learned ensembles and image estimators, bytes: the frames for fitting (n values each), and the fitted results.
fn learned_bytes(inputs: &MeasurementInputs, n: f64) -> f64 {
    let frames = (2 * WITH_COPIES + UNTOUCHED) as f64;
    let estimates: f64 = inputs.counts_of_images().iter().map(|&m| m as f64).sum();
    match inputs.is_fitted() {
        true => 8.0 * n * (frames + estimates + 3.0 * N_COMPONENTS as f64),
        false => 0.0,
    }
}

/// Returns the memory for evaluating a family of configurations, bytes: training and test rows, scores, and kernel values.
fn family_bytes(
    part: &StudyPart,
    family: &[Configuration],
    n_test: usize,
    (n_classes, n_read): (usize, usize),
) -> f64 {
    let (learned, configuration) = (&part.plan.spec.recognition, &family[0]);
    let training = FamilyInputs::new(&part.plan, &part.sweep, family).training;
    let fuses = learned.touches_per_decision.values().iter().any(|&k| k > 1);
    let n_scores = match (configuration.classifier.has_c(), learned.multiclass) {
        // Without decisions on several touches, test rows are processed in blocks.
        (true, _) if !fuses => 0,
        (true, Multiclass::OneVsOne) => n_classes * (n_classes - 1) / 2,
        _ => n_classes,
    };
    let n_copied = n_classes * configuration.tilt_augmentation.unwrap_or(0);
    let n_rows = |touches: usize| touches * (n_read + n_copied);
    let n_train = n_rows(configuration.train_touches);
    let n_choice = match training.c_grid.is_some() || training.gamma_grid.is_some() {
        true => training.cv_touches.map_or(n_train, n_rows).min(n_train),
        false => 0,
    };
    let n_features = configuration.n_features();
    let classifier = &training.classifier;
    let kernel_values = classifier.kernel_bytes([n_train, n_choice], n_classes, n_features);
    let (m, n_train, n_test) = (n_features as f64, n_train as f64, n_test as f64);
    // Inner folds exist beside the fit on all rows; the model of expected decisions has one table per object and test pose.
    let (n_copies, n_tables) = match learned.is_informed() {
        false => (1.0, 0),
        true => (2.0, rayon::current_num_threads() * n_classes),
    };
    TRAINING_BYTES * n_copies * n_train * m
        + 8.0 * n_test * n_tables as f64
        + TEST_BYTES * n_test * m
        + SCORE_BYTES * n_test * n_scores as f64
        + kernel_values as f64
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}
