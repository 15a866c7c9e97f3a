//! Content of a study's page and result folder: metadata, tables, charts, pictures and sections.

use crate::engine::provenance::Manifest;
use crate::report::page::Section;
use crate::table::{ChartSpec, Table};
use serde::Deserialize;

/// Picture in a report that is not a chart, for example of frames, spheres or objects.
pub struct NamedPicture {
    /// File name of the picture, without extension.
    pub name: String,
    /// Title of the picture.
    pub title: String,
    /// Content of the PNG file.
    pub png: Vec<u8>,
    /// Width and height of the picture on the page, pixels.
    pub size: (usize, usize),
}

/// Results of a study from which reports are written.
#[derive(Clone, Copy)]
pub struct Found<'a> {
    /// All tables of the study.
    pub tables: &'a [Table],
    /// Specifications of the charts, with the most important chart first.
    pub charts: &'a [ChartSpec],
    /// Answers to the study's question, one sentence each.
    pub answers: &'a [String],
}

/// Additional content of a study's result folder, which is neither a table nor a chart.
#[derive(Default)]
pub struct Beyond {
    /// Pictures that are not charts, for example of frames or objects.
    pub pictures: Vec<NamedPicture>,
    /// Additional sections of the study's HTML page after the answer.
    pub first_sections: Vec<Section>,
    /// Additional sections of the study's HTML page before the tables.
    pub sections: Vec<Section>,
}

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

/// File formats in which charts are written. Pictures of frames and objects are always PNG files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChartFormat {
    /// SVG files only, about a fifth of the size of PNG files.
    #[default]
    Svg,
    /// PNG files only, with two pixels per unit of the SVG file.
    Png,
    /// Two files per chart, in the formats SVG and PNG.
    Both,
}
