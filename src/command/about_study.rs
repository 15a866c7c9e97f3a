//! What a report says of a study beside its tables.

use super::study_args::{LoadedStudy, StudyArgs};
use bubbletouch::Result;
use bubbletouch::report::page::{Limit, ReportPage, Snapshots};
use bubbletouch::study::provenance::{Manifest, PROGRAM};
use bubbletouch::study::{ArrayOutcome, Outcome, Samples, StudySpec};
use std::path::Path;

/// What a page says without the study's objects.
pub fn page_of_spec(spec: &StudySpec, name: &str) -> ReportPage {
    let row = |name: &str, value: String| (name.to_owned(), value);
    ReportPage {
        name: name.to_owned(),
        question: spec.question.clone(),
        expected: spec.expected.clone(),
        settings: vec![
            row("Stroke", format!("{} mm", spec.skin.stroke_mm)),
            row("Trials", spec.trials.to_string()),
            row("Seed", spec.seed.to_string()),
        ],
        pareto: spec.report.pareto,
        program: PROGRAM.to_owned(),
        ..ReportPage::default()
    }
}

/// Adds what is known of objects and touches.
pub fn add_touches(page: &mut ReportPage, loaded: &LoadedStudy) -> Result<()> {
    let mut settings = loaded.touched.settings();
    let n_touches = loaded.sweep.labels.len().to_string();
    settings.push(("Touches".to_owned(), n_touches));
    page.settings.splice(0..0, settings);
    let samples = loaded.touched.samples(&loaded.plan, &loaded.sweep)?;
    page.gallery = gallery(&samples);
    page.snapshots = Some(snapshots(
        &samples,
        samples.frames.clone(),
        &samples.caption,
    ));
    Ok(())
}

/// Adds what a manifest knows.
pub fn add_manifest(page: &mut ReportPage, manifest: Manifest) {
    page.wall_s = manifest.wall_s();
    page.command = manifest.command.clone();
    page.manifest = Some(manifest);
}

fn snapshots(
    samples: &Samples,
    frames: Vec<(String, ndarray::Array2<f64>)>,
    caption: &str,
) -> Snapshots {
    Snapshots {
        frames,
        pitch_mm: samples.pitch_mm,
        quantity: samples.quantity,
        caption: caption.to_owned(),
    }
}

/// Every object; before them what the picture shows, if that is something else.
fn gallery(samples: &Samples) -> Vec<Snapshots> {
    let mut sets = Vec::new();
    if samples.each.is_empty() || samples.caption != samples.each_caption {
        let frames = samples.frames.clone();
        sets.push(snapshots(samples, frames, &samples.caption));
    }
    if !samples.each.is_empty() {
        let frames = samples.each.clone();
        sets.push(snapshots(samples, frames, &samples.each_caption));
    }
    sets
}

/// How often limits were reached.
pub fn limits(loaded: &LoadedStudy, outcome: &Outcome) -> Vec<Limit> {
    let sum = |count: fn(&ArrayOutcome) -> usize| -> u64 {
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
    let mut limits = vec![
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
    ];
    let strokes = outcome.arrays.iter().map(|array| array.patch.taxel.stroke);
    let n_deep: usize = strokes
        .map(|stroke| loaded.touched.n_deeper_than(stroke))
        .sum();
    if n_deep > 0 {
        limits.push(limit(
            "touches deeper than the stroke",
            n_deep as u64,
            n_touches,
            "the patch went on past the depth at which its first taxel was at its stroke: more taxels are saturated, the deeper the more",
        ));
    }
    limits
}

/// The command that makes a study's folder again.
pub fn command_line(args: &StudyArgs) -> String {
    line_of("run", args)
}

/// The command that puts the shards of a study together, told where they were written as they were.
pub fn merge_line(args: &StudyArgs, out: Option<&Path>) -> String {
    let out = out.map(|folder| format!(" --out {}", folder.display()));
    line_of("merge", args) + &out.unwrap_or_default()
}

fn line_of(subcommand: &str, args: &StudyArgs) -> String {
    let mut command = format!("bubbletouch {subcommand} {}", args.study.display());
    if let Some(objects) = &args.objects {
        command += &format!(" --objects {}", objects.display());
    }
    if let Some(seed) = args.seed {
        command += &format!(" --seed {seed}");
    }
    command
}
