//! Content of a study's page and result folder.

use crate::report::page::Section;
use crate::table::{ChartSpec, Table};

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
