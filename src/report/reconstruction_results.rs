//! The folder of a reconstruction study.

use crate::error::Result;
use crate::report::drawing::Drawing;
use crate::report::folder::Folder;
use crate::report::page::plain::{charts, plain_page};
use crate::report::page::{Picture, Section, StudyAbout, figure};
use crate::report::reconstruction_charts::draw_reconstruction_charts;
use crate::report::reconstruction_text::reconstruction_sections;
use crate::report::study_tables::{StudyTables, TableFiles, table_file};
use crate::study::reconstruction::table::ReconstructionTables;
use std::path::Path;

const FILES: [&str; 4] = [
    "reconstruction.csv",
    "ensembles.csv",
    "timing.csv",
    "pareto.csv",
];

impl StudyTables for ReconstructionTables {
    const OF_PIECES: &'static [&'static str] = &["reconstruction.csv", "ensembles.csv"];
    const OF_ALL: &'static [&'static str] = &[];

    fn files(&self) -> Result<TableFiles> {
        Ok(vec![
            table_file(FILES[0], &self.reconstruction)?,
            table_file(FILES[1], &self.ensembles)?,
            table_file(FILES[2], &self.timing)?,
            table_file(FILES[3], &self.pareto)?,
        ])
    }
}

/// Tables, charts, the picture of sample frames and the page, tables first, for the folder `dir`: nothing is written yet.
///
/// # Errors
/// What cannot be drawn, or written as a table.
pub fn reconstruction_folder<'a>(
    dir: &'a Path,
    tables: &ReconstructionTables,
    samples: &Drawing,
    about: &StudyAbout,
) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    folder.add_files(tables.files()?);
    let drawn = draw_reconstruction_charts(tables);
    for (name, title, drawing) in &drawn {
        folder.add_chart(name, title, drawing);
    }
    // As SVG, noisy taxels would be megabytes.
    let png = samples.png()?;
    let size = (samples.width() as usize, samples.height() as usize);
    let frames = figure(&Picture::of_png(
        &png,
        size,
        "Sample frames and what came back of them",
    ));
    folder.add("frames.png", png);
    let mut found: Vec<Section> = reconstruction_sections(tables).into();
    found.push(charts(&drawn));
    found.push(Section::new("frames", "Sample frames", frames));
    folder.add("report.html", plain_page(about, found, &FILES));
    Ok(folder)
}
