//! Metadata of a study for its page.

use crate::engine::provenance::Manifest;
use crate::report::chart_format::ChartFormat;

/// Metadata of a study: name, question, provenance and report options.
#[derive(Clone, Debug, Default)]
pub struct StudyAbout {
    /// Name of the study.
    pub name: String,
    /// Question of the study, one sentence.
    pub question: String,
    /// Result that was expected before the run; may be empty.
    pub expected: String,
    /// Duration of the run, seconds; NaN if unknown.
    pub wall_s: f64,
    /// Command that reproduces the folder.
    pub command: String,
    /// Program and version: `bubbletouch 0.1.0`.
    pub program: String,
    /// Provenance of the results, if known.
    pub manifest: Option<Manifest>,
    /// Whether all charts are written as files, without an upper limit.
    pub all_charts: bool,
    /// File format of the charts.
    pub chart_format: ChartFormat,
}
