//! Labels that can be read from the order of the touches in the file or in time.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result, Source};
use crate::audit::finding::percent;
use ndarray::Array2;
use std::collections::{BTreeMap, BTreeSet};

pub const ABOUT: CheckAbout = CheckAbout {
    name: "row_order",
    title: "Order of the touches",
    run,
};

pub const SOURCE: Source = Source {
    name: "row_order",
    rows: |context| {
        let n = context.sample.len();
        Array2::from_shape_vec(
            (n, 1),
            context.sample.iter().map(|&row| row as f64).collect(),
        )
        .ok()
    },
    holds_out_groups: true,
    is_tested: true,
};

/// Minimum number of touches that follow a touch of their class, in parts with several classes. Fewer touches may be sorted by chance.
const MIN_REPEATS: usize = 10;

/// Returns whether the touches of each part are sorted by class.
fn is_sorted(labels: &[usize], part: impl Fn(usize) -> usize) -> bool {
    let mut parts = BTreeMap::<usize, Vec<usize>>::new();
    for (touch, &label) in labels.iter().enumerate() {
        parts.entry(part(touch)).or_default().push(label);
    }
    let n_classes = |labels: &[usize]| labels.iter().collect::<BTreeSet<_>>().len();
    let n_runs = |labels: &[usize]| labels.chunk_by(|a, b| a == b).count();
    let is_sorted = |labels: &Vec<usize>| n_runs(labels) == n_classes(labels);
    let repeats = parts.values().filter(|labels| n_classes(labels) > 1);
    let n_repeats: usize = repeats.map(|labels| labels.len() - n_classes(labels)).sum();
    parts.values().all(is_sorted) && n_repeats >= MIN_REPEATS
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    // A given test set follows the training touches, and is sorted for itself.
    let is_test = context.data.is_test.as_deref();
    let part = |touch: usize| usize::from(is_test.is_some_and(|is_test| is_test[touch]));
    let groups = context.data.groups.as_deref();
    let is_sorted = is_sorted(&context.labels, part)
        || groups.is_some_and(|groups| is_sorted(&context.labels, |touch| groups[touch]));
    let Some(found) = context.readable.get(SOURCE.name) else {
        return Ok(vec![Finding::not_checked("", "There are too few touches.")]);
    };
    let advice = "Record the classes in random order, or hold out sessions that contain all classes. Anything that changes with time names the class.";
    let finding = match is_sorted && !context.data.is_in_order_of_time {
        true => Finding::note(
            "",
            found.accuracy,
            "The touches are sorted by class, at least within groups, so that the file does not show in which order they were recorded.".to_owned(),
        )
        .advice("Give the times of the touches (times), or a session for each touch. If the classes were recorded one after the other, any drift names the class."),
        false => Finding::tested(
            "",
            found.accuracy,
            format!(
                "The place in the file names the class of {} of the touches; permuted labels give {}.",
                percent(found.accuracy),
                percent(found.chance)
            ),
            (found.p_value, true),
        )
        .advice(advice),
    };
    Ok(vec![finding.against(found.chance).shown_in("confounds")])
}
