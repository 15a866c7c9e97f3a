//! Metadata of a study for its page.

use crate::engine::provenance::Manifest;
use crate::report::chart_format::ChartFormat;

/// Metadata of a study for its page: name, question, provenance and report options.
#[derive(Clone, Debug, Default)]
pub struct StudyAbout {
    /// Name of the study.
    pub name: String,
    /// Question that the study answers, in one sentence.
    pub question: String,
    /// Answer that the author of the study expected before the run; may be empty.
    pub expected: String,
    /// Duration of the run, seconds; NaN if unknown.
    pub wall_s: f64,
    /// Command that reproduces the result folder.
    pub command: String,
    /// Name and version of the program, such as `bubbletouch 0.1.0`.
    pub program: String,
    /// Provenance of the results (program, machine, times and hashes), if known.
    pub manifest: Option<Manifest>,
    /// Whether all charts are written as files; otherwise, their number is limited.
    pub all_charts: bool,
    /// File format of the charts.
    pub chart_format: ChartFormat,
}
