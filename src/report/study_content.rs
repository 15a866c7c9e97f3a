//! The content of a study's page and folder beside its tables.

use crate::report::page::Section;
use crate::table::{ChartSpec, Table};

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
