//! Labels that can be read from the session or file of a touch.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result, Source};
use crate::audit::finding::percent;
use ndarray::Array2;
use std::collections::BTreeSet;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "session_labels",
    title: "Sessions and classes",
    run,
};

pub const SOURCE: Source = Source {
    name: "session",
    rows,
    holds_out_groups: false,
};

/// Returns one column per session with 1 for the touches of the session.
fn rows(context: &Context) -> Option<Array2<f64>> {
    let sessions = context.data.sessions.as_ref()?;
    let all: Vec<usize> = sessions
        .iter()
        .copied()
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    if all.len() < 2 || all.len() > context.sample.len() / 2 {
        return None;
    }
    let mut rows = Array2::zeros((context.sample.len(), all.len()));
    for (mut row, &touch) in rows.rows_mut().into_iter().zip(&context.sample) {
        let place = all.partition_point(|&session| session < sessions[touch]);
        row[place] = 1.0;
    }
    Some(rows)
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let Some(found) = context.readable.get(SOURCE.name) else {
        let why = "No sessions are given, or nearly as many sessions as touches.";
        return Ok(vec![Finding::not_checked("", why)]);
    };
    let sentence = format!(
        "The session of a touch names its class for {} of the touches; permuted labels give {}.",
        percent(found.accuracy),
        percent(found.chance)
    );
    let advice = "Record all classes in each session. If each session has its own classes, no split separates the class from the session.";
    let finding = Finding::tested("", found.accuracy, sentence, (found.p_value, true))
        .against(found.chance)
        .advice(advice)
        .shown_in("confounds");
    Ok(vec![finding])
}
