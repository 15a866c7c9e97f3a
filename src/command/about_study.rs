//! What a report says of a study beside its tables.

use super::study_args::{LoadedStudy, StudyArgs};
use bubbletouch::Result;
use bubbletouch::report::html::{Limit, ReportPage, Snapshots};
use bubbletouch::study::Outcome;
use bubbletouch::study::provenance::PROGRAM;

/// What the page says beside the tables.
pub fn report_page(
    loaded: &LoadedStudy,
    outcome: &Outcome,
    args: &StudyArgs,
    wall_s: f64,
) -> Result<ReportPage> {
    let spec = &loaded.plan.spec;
    let sample = loaded.touched.samples(&loaded.plan, &loaded.sweep)?;
    Ok(ReportPage {
        name: loaded.name.clone(),
        question: spec.question.clone(),
        expected: spec.expected.clone(),
        settings: settings(loaded),
        limits: limits(loaded, outcome),
        snapshots: Some(Snapshots {
            frames: sample.frames,
            pitch_mm: sample.pitch_mm,
            quantity: sample.quantity,
            caption: sample.caption,
        }),
        pareto: spec.report.pareto,
        wall_s: Some(wall_s),
        command: command_line(args),
        program: PROGRAM.to_owned(),
    })
}

fn settings(loaded: &LoadedStudy) -> Vec<(String, String)> {
    let spec = &loaded.plan.spec;
    let row = |name: &str, value: String| (name.to_owned(), value);
    let mut rows = loaded.touched.settings();
    rows.extend([
        row("Touches", loaded.sweep.labels.len().to_string()),
        row("Stroke", format!("{} mm", spec.skin.stroke_mm)),
        row("Trials", spec.trials.to_string()),
        row("Seed", spec.seed.to_string()),
    ]);
    rows
}

fn limits(loaded: &LoadedStudy, outcome: &Outcome) -> Vec<Limit> {
    let sum = |count: fn(&bubbletouch::study::ArrayOutcome) -> usize| -> u64 {
        outcome.arrays.iter().map(|array| count(array) as u64).sum()
    };
    let n_touches = sum(|a| a.n_touches);
    let n_capped = outcome
        .tables
        .accuracy
        .iter()
        .filter(|(_, score)| score.n_capped > 0)
        .count();
    let n_failed = outcome.tables.failures.len() as u64;
    let limit = |what: &str, count, of, meaning: &str| Limit {
        what: what.to_owned(),
        count,
        of,
        meaning: meaning.to_owned(),
    };
    vec![
        limit(
            "touches that met nothing",
            sum(|a| a.n_missed),
            n_touches,
            match loaded.plan.human_touch {
                Some(_) => {
                    "the hand was beyond the array or between its taxels; their frames hold no contact"
                }
                None => "no part of the object was over the array; their frames hold no contact",
            },
        ),
        limit(
            "touches with a saturated taxel",
            sum(|a| a.n_saturated),
            n_touches,
            "a taxel was at its stroke, where it cannot tell how much further the object pushes",
        ),
        limit(
            "fits stopped at the solver's iteration cap",
            n_capped as u64,
            outcome.tables.accuracy.len() as u64,
            "at least one of their SVMs is short of its tolerance",
        ),
        limit(
            "cells that failed",
            n_failed,
            outcome.tables.accuracy.len() as u64 + n_failed,
            "failures.csv says why; they are missing in every other table",
        ),
    ]
}

fn command_line(args: &StudyArgs) -> String {
    let mut command = format!("bubbletouch run {}", args.study.display());
    if let Some(objects) = &args.objects {
        command += &format!(" --objects {}", objects.display());
    }
    if let Some(seed) = args.seed {
        command += &format!(" --seed {seed}");
    }
    command
}
