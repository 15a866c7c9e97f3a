//! The folder of a study of any kind but for its tables: charts, pictures and the page.

use crate::error::Result;
use crate::report::chart::draw;
use crate::report::drawing::Drawing;
use crate::report::folder::Folder;
use crate::report::page::plain::{self, plain_page};
use crate::report::page::{Picture, Section, StudyAbout, figure};
use crate::report::terminal::wrap;
use crate::table::{ChartSpec, Table};
use std::path::Path;

/// A picture that is no chart: frames, bodies, objects.
pub struct NamedPicture {
    /// File name without ending.
    pub name: String,
    /// What it shows, in words.
    pub title: String,
    /// It.
    pub image: Image,
}

/// What a picture is made of.
pub enum Image {
    /// Shapes: written as SVG and PNG.
    Drawing(Drawing),
    /// A PNG, with its width and height in pixels.
    Png(Vec<u8>, (usize, usize)),
}

/// What a study found, for whoever shows it.
#[derive(Clone, Copy)]
pub struct Found<'a> {
    /// All tables.
    pub tables: &'a [Table],
    /// What is charted, the most telling first.
    pub charts: &'a [ChartSpec],
    /// What else is shown.
    pub pictures: &'a [NamedPicture],
    /// What was found, in sentences.
    pub answers: &'a [String],
}

/// Charts, pictures and the page, for the folder `dir`: nothing is written yet.
///
/// # Errors
/// What cannot be drawn.
pub fn folder_of<'a>(dir: &'a Path, about: &StudyAbout, found: &Found) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    let mut pictures = String::new();
    for NamedPicture { name, title, image } in found.pictures {
        pictures += &figure(&match image {
            Image::Drawing(drawing) => {
                folder.add_chart(name, title, drawing);
                Picture::of(drawing, title)
            }
            Image::Png(png, size) => {
                folder.add(format!("{name}.png"), png.clone());
                Picture::of_png(png, *size, title)
            }
        });
    }
    let mut charts = String::new();
    for spec in found.charts {
        let drawing = draw(spec, found.tables)?;
        folder.add_chart(&spec.name, &spec.title, &drawing);
        charts += &figure(&Picture::of(&drawing, &spec.title));
    }
    let sections = vec![
        plain::answer(found.answers),
        Section::new("charts", "Charts", charts),
        Section::new("pictures", "Pictures", pictures),
    ];
    let files: Vec<&str> = found.tables.iter().map(|table| table.file).collect();
    folder.add("report.html", plain_page(about, sections, &files));
    Ok(folder)
}

/// What a person reads at the end of a run, in lines of about `width` letters.
pub fn words_of(question: &str, _tables: &[Table], answers: &[String], width: usize) -> String {
    let mut words = format!("{question}\n\n");
    for line in answers.iter().flat_map(|answer| wrap(answer, width)) {
        words += &line;
        words.push('\n');
    }
    words
}
