//! What a report says of a study beside its tables.

use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::report::page::{ReportPage, Snapshots};
use bubbletouch::study::provenance::{Manifest, PROGRAM};
use bubbletouch::study::{Samples, StudySpec};
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
pub fn add_touches(page: &mut ReportPage, study: &RecognitionStudy) -> Result<()> {
    let first = study.first();
    let mut settings = first.touched.settings();
    let n_touches = first.sweep.labels.len().to_string();
    settings.push(("Touches".to_owned(), n_touches));
    page.settings.splice(0..0, settings);
    let samples = first.touched.samples(&first.plan, &first.sweep)?;
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
