//! The folder of a study of any kind but for its tables: charts, pictures and the page.

use crate::error::Result;
use crate::report::chart;
use crate::report::drawing::Drawing;
use crate::report::folder::Folder;
use crate::report::page::{Beside, Picture, Section, StudyAbout, study_page};
use crate::report::terminal::{paragraph, table_text};
use crate::table::{ChartSpec, Role, Table};
use std::path::Path;

/// A picture that is no chart: frames, bodies, objects.
pub struct NamedPicture {
    /// File name without ending.
    pub name: String,
    /// What it shows, in words.
    pub title: String,
    /// A PNG file's bytes.
    pub png: Vec<u8>,
    /// Width and height in the page, pixels.
    pub size: (usize, usize),
}

/// What a study found, for whoever shows it.
#[derive(Clone, Copy)]
pub struct Found<'a> {
    /// All tables.
    pub tables: &'a [Table],
    /// What is charted, the most telling first.
    pub charts: &'a [ChartSpec],
    /// What was found, in sentences.
    pub answers: &'a [String],
}

/// What a folder has beside tables, charts and answers.
#[derive(Default)]
pub struct Beyond {
    /// Pictures that are no charts.
    pub pictures: Vec<NamedPicture>,
    /// Sections of the page.
    pub sections: Vec<Section>,
}

/// Charts that are drawn, unless all are asked for; of all, those in the page (for readers without script) and as PNG. More: a page too
/// heavy for a phone, and minutes for what the page shows anyway when it is asked.
pub const MOST_CHARTS: usize = 24;

/// Letters of a picture that stays an SVG in the page: a point a row of ten thousand is megabytes.
const LIGHT: usize = 300_000;

/// Charts, pictures and the page, for the folder `dir`: nothing is written yet. A chart that no row has a place in is left out.
///
/// # Errors
/// What cannot be drawn.
pub fn folder_of<'a>(dir: &'a Path, about: &StudyAbout, found: &Found) -> Result<Folder<'a>> {
    folder_with(dir, about, found, || Ok(Beyond::default()))
}

/// The same with what else there is, which is made while charts are drawn.
pub fn folder_with<'a>(
    dir: &'a Path,
    about: &StudyAbout,
    found: &Found,
    beyond: impl FnOnce() -> Result<Beyond> + Send,
) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    let mut beside = Beside::default();
    let mut charts = Vec::new();
    for spec in found.charts {
        if charts.len() >= MOST_CHARTS && !about.all_charts {
            beside.left_out.push(spec.name.clone());
            continue;
        }
        if chart::places(spec, found.tables)?.is_empty() {
            continue;
        }
        let number = charts.len();
        charts.push(spec.clone());
        let drawing = chart::draw(spec, found.tables)?;
        if number < MOST_CHARTS {
            beside.charts.push(light_picture(&drawing, &spec.title)?);
            folder.add_chart(&spec.name, &spec.title, &drawing);
        } else {
            folder.add(format!("{}.svg", spec.name), drawing.svg(&spec.title));
        }
    }
    let (folder, beyond) = rayon::join(|| folder.drawn(), beyond);
    let (mut folder, beyond) = (folder?, beyond?);
    beside.sections = beyond.sections;
    for picture in beyond.pictures {
        let in_page = Picture::of_png(&picture.png, picture.size, &picture.title);
        beside.pictures.push(in_page);
        folder.add(format!("{}.png", picture.name), picture.png);
    }
    // More would make the page slow; each can be arranged to show what the others do.
    charts.truncate(MOST_CHARTS);
    let found = Found {
        charts: &charts,
        ..*found
    };
    folder.add("report.html", study_page(about, &found, beside));
    Ok(folder)
}

/// A page alone.
///
/// # Errors
/// What cannot be drawn.
pub(super) fn page_of(about: &StudyAbout, found: &Found) -> Result<String> {
    let mut beside = Beside::default();
    for spec in found.charts {
        let drawing = chart::draw(spec, found.tables)?;
        beside.charts.push(light_picture(&drawing, &spec.title)?);
    }
    Ok(study_page(about, found, beside))
}

/// A drawing for the page, as SVG if that is light.
fn light_picture(drawing: &Drawing, title: &str) -> Result<Picture> {
    let picture = Picture::of(drawing, title);
    if picture.element.len() <= LIGHT {
        return Ok(picture);
    }
    let size = (drawing.width as usize, drawing.height as usize);
    Ok(Picture::of_png(&drawing.png()?, size, title))
}

/// What a person reads at the end of a run, in lines of about `width` letters: the first table in which something was found, and the answers.
pub fn words_of(tables: &[Table], answers: &[String], width: usize) -> String {
    let mut words = String::new();
    let is_found = |table: &&Table| {
        let roles = table.columns.iter().map(|column| column.role);
        let mut roles = roles.filter(|role| matches!(role, Role::Value(_) | Role::Outcome));
        table.n_rows > 0 && roles.next().is_some()
    };
    if let Some(table) = tables.iter().find(is_found) {
        words += &table_text(table, width);
        words.push('\n');
    }
    for answer in answers {
        words += &paragraph(answer, width);
    }
    words
}
