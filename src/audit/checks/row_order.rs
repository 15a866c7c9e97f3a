//! Labels that can be read from the order of the touches in the file or in time.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result, Source};
use crate::audit::finding::percent;
use ndarray::Array2;

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
};

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let changes = context.labels.windows(2).filter(|pair| pair[0] != pair[1]);
    let is_sorted = changes.count() + 1 == context.n_classes;
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
