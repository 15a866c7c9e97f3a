//! Files of a result folder except the tables: charts, pictures and the page.

use crate::error::Result;
use crate::report::chart;
pub use crate::report::chart_format::ChartFormat;
use crate::report::folder::NamedFile;
use crate::report::page::{Beside, StudyAbout, study_page};
pub use crate::report::study_content::{Beyond, Found, NamedPicture};
use crate::report::terminal::{paragraph, table_text};
use crate::table::{ChartSpec, Role, Table};
use rayon::prelude::*;

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
    for spec in found.charts {
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

/// Returns only the HTML page of a result folder, without other files.
///
/// # Errors
/// If a chart cannot be drawn.
pub(super) fn page_of(about: &StudyAbout, found: &Found) -> Result<String> {
    let draw = |spec: &ChartSpec| {
        let drawing = chart::draw(spec, found.tables)?;
        Ok(drawing.svg_with_data(&spec.title))
    };
    let beside = Beside {
        charts: found.charts.iter().map(draw).collect::<Result<_>>()?,
        ..Beside::default()
    };
    Ok(study_page(about, found, &beside))
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
