//! Files of a result folder except the tables: charts, pictures and the page, and the content from which they are made.

use crate::engine::provenance::Manifest;
use crate::error::Result;
use crate::inputs::content_hash::short_hash;
use crate::report::chart;
use crate::report::folder::NamedFile;
use crate::report::page::{Beside, Section, study_page};
use crate::report::terminal::{paragraph, table_text};
use crate::table::{ChartSpec, Role, Table};
use rayon::prelude::*;
use serde::Deserialize;
use std::collections::HashSet;

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

/// Maximum number of charts on the page; also the maximum number of drawn charts, unless all charts are requested. With a larger value, the page is too large
/// for a phone and drawing takes minutes.
pub const MAX_CHARTS: usize = 24;

/// Returns the files of a result folder: tables, charts, pictures and the page. The function `beyond` computes additional content while charts are drawn.
/// Charts without drawable rows are omitted.
///
/// # Errors
/// If a chart or picture cannot be drawn.
pub fn files_with(
    about: &StudyAbout,
    found: &Found,
    beyond: impl FnOnce() -> Result<Beyond> + Send,
) -> Result<Vec<NamedFile>> {
    let mut beside = Beside::default();
    let mut charts = Vec::new();
    for spec in &with_file_names(found.charts) {
        if charts.len() >= MAX_CHARTS && !about.all_charts {
            beside.left_out.push(spec.name.clone());
        } else if !chart::places(spec, found.tables)?.is_empty() {
            charts.push(spec.clone());
        }
    }
    let format = about.chart_format;
    let draw = |spec: &ChartSpec| {
        let drawing = chart::draw(spec, found.tables)?;
        let png = (format != ChartFormat::Svg).then(|| drawing.png());
        Ok((png.transpose()?, drawing))
    };
    let draw_all = || charts.par_iter().map(draw).collect();
    let (drawn, beyond): (Result<Vec<_>>, _) = rayon::join(draw_all, beyond);
    let mut files = Vec::new();
    for (ChartSpec { name, title, .. }, (png, drawing)) in charts.iter().zip(drawn?) {
        files.extend(png.map(|png| (format!("{name}.png"), png)));
        if format != ChartFormat::Png {
            files.push((format!("{name}.svg"), drawing.svg(title).into_bytes()));
        }
        beside.charts.push(drawing.svg_with_data(title));
    }
    // More charts would make the page slow.
    charts.truncate(MAX_CHARTS);
    let found = Found {
        charts: &charts,
        ..*found
    };
    beside.beyond = beyond?;
    let page = study_page(about, &found, &beside).into_bytes();
    let pictures = beside.beyond.pictures.into_iter();
    files.extend(pictures.map(|picture| (picture.name + ".png", picture.png)));
    files.push(("report.html".to_owned(), page));
    Ok(files)
}

/// Maximum length of a chart's file name without extension, bytes. File systems allow 255 bytes, of which the name of the temporary file needs about 40.
const MAX_NAME: usize = 200;

/// Number of hexadecimal digits of the hash that ends a shortened name. With fewer digits, two long names may become equal.
const NAME_DIGITS: usize = 12;

/// Returns the charts with names that are distinct file names, also if the file system ignores case. The end of a long name is replaced by a hash of the name;
/// a repeated name gets a number. Other names are unchanged.
fn with_file_names(charts: &[ChartSpec]) -> Vec<ChartSpec> {
    let mut charts = charts.to_vec();
    for chart in &mut charts {
        chart.name = short_name(&chart.name);
    }
    let given = charts.iter().map(|chart| chart.name.to_lowercase());
    let given: HashSet<String> = given.collect();
    let mut known = HashSet::new();
    for chart in &mut charts {
        let numbered = (2..).map(|n| format!("{}_{n}", chart.name));
        let numbered = numbered.filter(|name| !given.contains(&name.to_lowercase()));
        let mut candidates = std::iter::once(chart.name.clone()).chain(numbered);
        let name = candidates.find(|name| known.insert(name.to_lowercase()));
        chart.name = name.expect("numbers do not end");
    }
    charts
}

/// Returns a name of at most [`MAX_NAME`] bytes, which ends in a hash of the given name if that is longer.
fn short_name(name: &str) -> String {
    if name.len() <= MAX_NAME {
        return name.to_owned();
    }
    let start = name.chars().scan(0, |end, letter| {
        *end += letter.len_utf8();
        (*end + NAME_DIGITS < MAX_NAME).then_some(letter)
    });
    let start: String = start.collect();
    format!("{start}_{}", short_hash(name, NAME_DIGITS))
}

/// Returns the text that the terminal shows after a run: the first table, the answers, and the other tables, at about `width` characters per line.
pub fn words_of(tables: &[&Table], answers: &[String], width: usize) -> String {
    let first = tables.first();
    let mut words = first.map_or_else(String::new, |table| table_text(table, width) + "\n");
    for answer in answers {
        words += &paragraph(answer, width);
    }
    for table in tables.iter().skip(1) {
        words += &format!("\n{}\n{}", table.title, table_text(table, width));
    }
    words
}

/// Returns the first table that has rows and at least one column of values or outcomes.
pub fn first_found(tables: &[Table]) -> Option<&Table> {
    let is_found = |role: Role| matches!(role, Role::Value(_) | Role::Outcome);
    let mut tables = tables.iter().filter(|table| table.n_rows > 0);
    tables.find(|table| table.columns.iter().any(|column| is_found(column.role)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chart_files_have_distinct_names_that_a_file_system_takes() {
        let long = |end: &str| format!("{}{end}", "accuracy_by_long_setting_".repeat(12));
        let given = [
            "confusion".to_owned(),
            "Confusion".to_owned(),
            "confusion".to_owned(),
            "confusion_2".to_owned(),
            long("a"),
            long("b"),
            long("a"),
        ];
        let charts = given.clone().map(|name| ChartSpec {
            name,
            ..ChartSpec::default()
        });
        let named = with_file_names(&charts);
        let names: Vec<&str> = named.iter().map(|chart| &chart.name[..]).collect();
        assert_eq!(names[0], "confusion");
        assert_eq!(names[1..4], ["Confusion_3", "confusion_4", "confusion_2"]);
        let lower: HashSet<String> = names.iter().map(|name| name.to_lowercase()).collect();
        assert_eq!(lower.len(), names.len());
        let temporary = ".svg.4194304.1000000.partial";
        assert!(names.iter().all(|name| name.len() + temporary.len() <= 255));
    }
}
