//! What a study says of itself, beside its tables.

use crate::engine::provenance::Manifest;
use crate::report::chart_format::ChartFormat;

/// What a study says of itself, beside its tables.
#[derive(Clone, Debug, Default)]
pub struct StudyAbout {
    /// The study's name.
    pub name: String,
    /// What it asks.
    pub question: String,
    /// What was expected before it ran; may be empty.
    pub expected: String,
    /// Seconds from start to end; NaN if they are not known.
    pub wall_s: f64,
    /// The command that makes the folder again.
    pub command: String,
    /// Program and version: `bubbletouch 0.1.0`.
    pub program: String,
    /// Where the results come from, if known.
    pub manifest: Option<Manifest>,
    /// Whether every chart is drawn as a file, however many there are.
    pub all_charts: bool,
    /// File format of the charts.
    pub chart_format: ChartFormat,
}
