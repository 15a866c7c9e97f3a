//! `bubbletouch report`: redraws the charts and the page of a result folder from its tables.

use super::classify::word;
use crate::command::options::results_folder::{checked_manifest, load_study};
use crate::command::program;
use crate::command::terminal::{note, say};
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::study_folder::ChartFormat;
use bubbletouch::shell_line::shell_line;
use bubbletouch::study::provenance::MANIFEST_FILE;
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};

/// Redraw the charts and the page of a results folder
///
/// The tables and the study must be unchanged since the run: manifest.json contains the SHA-256 of each.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch report results/cans --chart-format both")]
pub struct Args {
    /// Results folder that bubbletouch run wrote
    results: PathBuf,
    /// Write every chart as a file, not only the first 24
    #[arg(long, help_heading = "Output")]
    all_charts: bool,
    /// Write charts as svg, png or both
    #[arg(long, value_name = "FORMAT", default_value = "svg", value_parser = word::<ChartFormat>, help_heading = "Output")]
    chart_format: ChartFormat,
}

pub fn report(args: &Args) -> Result<()> {
    let folder = &args.results;
    let manifest = checked_manifest(folder)?;
    if manifest.is_none() {
        note(format_args!(
            "note: whether the tables are those of a run is not known: there is no {}",
            folder.join(MANIFEST_FILE).display()
        ));
    }
    let study = load_study(folder, manifest.as_ref(), None)?;
    let (name, command) = match &manifest {
        Some(of) if !of.study.is_empty() => (of.study.clone(), of.command.clone()),
        _ => {
            let study = folder.join("study.toml").display().to_string();
            let name = folder_name(folder)?;
            // A run reads this study file, so it must not overwrite it.
            let again = folder.with_file_name(format!("{name}.again"));
            let again = again.display().to_string();
            let words = [&*program(), "run", &study, "--out", &again];
            (name, shell_line(&words))
        }
    };
    let about = StudyAbout {
        name,
        command,
        manifest,
        all_charts: args.all_charts,
        chart_format: args.chart_format,
        ..StudyAbout::default()
    };
    study.report(folder, about)?;
    let page = folder.join("report.html");
    say(format_args!("Wrote {}", page.display()))
}

fn folder_name(folder: &Path) -> Result<String> {
    let whole = folder.canonicalize();
    let whole = whole.map_err(|e| Error::io(folder, "read", e))?;
    let name = whole.file_name().unwrap_or_default();
    Ok(name.to_string_lossy().into_owned())
}
