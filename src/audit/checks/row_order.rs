//! Labels that can be read from the order of the touches in the file or in time.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result, Source};
use crate::audit::finding::percent;
use ndarray::Array2;
use std::collections::BTreeSet;

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
};

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    // A given test set follows the training touches, and is sorted for itself.
    let is_test = context.data.is_test.as_deref();
    let part = |touch: usize| is_test.is_some_and(|is_test| is_test[touch]);
    let is_sorted = [false, true].into_iter().all(|of_test| {
        let touches = (0..context.labels.len()).filter(|&touch| part(touch) == of_test);
        let labels: Vec<usize> = touches.map(|touch| context.labels[touch]).collect();
        let classes: BTreeSet<usize> = labels.iter().copied().collect();
        let n_changes = labels.windows(2).filter(|pair| pair[0] != pair[1]).count();
        n_changes + 1 <= classes.len().max(1)
    });
    let Some(found) = context.readable.get(SOURCE.name) else {
        return Ok(vec![Finding::not_checked("", "There are too few touches.")]);
    };
    let advice = "Record the classes in random order, or hold out sessions that contain all classes. Anything that changes with time names the class.";
    let finding = match is_sorted && !context.data.is_in_order_of_time {
        true => Finding::note(
            "",
            found.accuracy,
            "The touches are sorted by class, so that the file does not show in which order they were recorded.".to_owned(),
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
