//! About how long parts of a recognition study take, processor-seconds: for `plan` right within a factor of three; a run weighs its items by
//! those that finished.

use crate::recognition::svm::Multiclass;
use crate::sensing::{N_COMPONENTS, N_STEPS};
use crate::study::measurement::WITH_COPIES;
use crate::study::plan::Plan;
use crate::study::sweep::Group;
use crate::study::table::Cell;
use crate::study::taxel_array::TaxelArray;
use crate::study::touch_set::TouchSet;

/// Seconds to make or to read a taxel of a frame.
const TAXEL_S: f64 = 8e-9;
/// Bringing an object to a skin takes so many times as long as to a grid: 8 to 12 in the study of layouts.
const SKIN: f64 = 10.0;
/// Seconds of a multiply-add of a product of matrices.
const PRODUCT_S: f64 = 4e-11;
/// Products with all frames until their principal components are found.
const LEARNING_PRODUCTS: f64 = 8.0;
/// Seconds to make features of an image's taxel.
const FEATURE_S: f64 = 1e-8;
/// Seconds of an SVM's solver for an entry of the kernel matrices of its binary problems.
const ENTRY_S: f64 = 1.5e-9;

/// Seconds to compare the poses of two touches.
const POSES_S: f64 = 2e-8;
/// How often all training touches of an object are compared until bandwidths are chosen.
const COMPARISONS: f64 = 60.0;

/// To make all touches on an array, so many frames each.
pub(super) fn touch_s(
    array: &TaxelArray,
    touched: &dyn TouchSet,
    (n_touches, n_frames): (usize, usize),
) -> f64 {
    // What a frame after the first takes, as a share of it.
    let frames = 1.0 + 0.25 * (n_frames as f64 - 1.0);
    let taxels = (n_touches * n_frames * array.n_taxels()) as f64;
    let place_s = match array.is_plain() {
        true => touched.place_s(),
        false => SKIN * touched.place_s(),
    };
    frames * place_s + 0.5 * TAXEL_S * taxels
}

/// To read and project all frames of a group once.
pub(super) fn measure_s(plan: &Plan, group: &Group, (n_touches, m): (usize, usize)) -> f64 {
    let n_values = plan.arrays[group.array].n_values();
    let project_s = (group.ensemble.about().taxel_s)(m as f64, n_values as f64);
    let learn_s = match group.learns() {
        true => LEARNING_PRODUCTS * PRODUCT_S * (WITH_COPIES * n_values * N_COMPONENTS) as f64,
        false => 0.0,
    };
    let n_frames = (n_touches * group.n_readings(plan) * group.frames) as f64;
    let frame_s = n_values as f64 * (TAXEL_S + project_s) + image_s(plan, group);
    n_frames * frame_s + learn_s
}

/// A fit in one trial of so many readings of each training touch, with what it chooses, and its test.
pub(super) fn fit_s(
    plan: &Plan,
    (cell, n_readings): (&Cell, usize),
    (n_classes, n_touches): (f64, f64),
) -> f64 {
    let n_train = cell.train_touches as f64 * n_classes;
    let recognition = &plan.spec.recognition;
    let n_test = match recognition.folds {
        None => recognition.test_share() * n_touches,
        Some(n) => n_touches / n as f64,
    };
    let n_candidates = |candidates: &Option<Vec<f64>>, chooses: bool| match candidates {
        Some(candidates) if chooses => candidates.len(),
        _ => 1,
    };
    let n_c = n_candidates(
        &recognition.choose_c,
        cell.classifier.has_c() && cell.c.is_none(),
    );
    let n_gamma = n_candidates(&recognition.choose_gamma, cell.classifier.has_gamma());
    let n_chosen = recognition
        .choose_touches
        .map_or(n_train, |n| n_train.min(n as f64 * n_classes));
    let choose_s = match n_c * n_gamma {
        1 => 0.0,
        // Each solution goes on from another, and products of rows are made once.
        n => {
            0.5 * (n * recognition.n_choice_folds()) as f64
                * train_s(plan, cell, n_chosen, n_classes)
        }
    };
    let n_first = n_train;
    let n_train = n_first * (n_readings + cell.tilted_copies.unwrap_or(0)) as f64;
    let test_s = (cell.classifier.about().test_s)(n_train, cell.n_features() as f64, n_classes);
    let informed_s = match recognition.is_informed() {
        false => 0.0,
        true => {
            let n_folds = recognition.n_choice_folds() as f64;
            let n_learned = n_train * (1.0 - 1.0 / n_folds);
            let n_pairs = n_first * (COMPARISONS * n_first / n_classes + n_test);
            n_folds * train_s(plan, cell, n_learned, n_classes) + POSES_S * n_pairs
        }
    };
    choose_s + train_s(plan, cell, n_train, n_classes) + informed_s + n_test * test_s
}

/// To make features of a frame, by way of its image.
fn image_s(plan: &Plan, group: &Group) -> f64 {
    let n = plan.arrays[group.array].n_values() as f64;
    let n_steps = match (group.ensemble.about().is_whole_frame, group.condition.noise) {
        (true, _) => 0,
        (false, 0.0) => 2 * N_STEPS + 1,
        (false, _) => 1,
    };
    let counts = group.counts_of_images().into_iter();
    let estimates = counts.map(|m| 0.5 * PRODUCT_S * n * (n_steps * m) as f64);
    estimates.sum::<f64>() + FEATURE_S * n * group.features_of_images().len() as f64
}

fn train_s(plan: &Plan, cell: &Cell, n_train: f64, n_classes: f64) -> f64 {
    let m = cell.n_features() as f64;
    let recognition = &plan.spec.recognition;
    let about = cell.classifier.about();
    if about.kernel.is_none() {
        return (about.train_s)(n_train, m, n_classes);
    }
    // Entries of all binary problems.
    let n_entries = match recognition.multiclass {
        Multiclass::OneVsOne => 2.0 * n_train * n_train,
        Multiclass::OneVsRest => n_classes * n_train * n_train,
    };
    n_entries * ENTRY_S + 0.5 * PRODUCT_S * n_train * n_train * m
}
