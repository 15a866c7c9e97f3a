//! The folder of a reconstruction study.

use crate::error::Result;
use crate::report::drawing::Drawing;
use crate::report::folder::Folder;
use crate::report::page::plain::{charts, plain_page};
use crate::report::page::{Picture, Section, StudyAbout, figure};
use crate::report::reconstruction_charts::draw_reconstruction_charts;
use crate::report::reconstruction_text::reconstruction_sections;
use crate::study::reconstruction::table::ReconstructionTables;
use std::path::{Path, PathBuf};

const FILES: [&str; 4] = [
    "reconstruction.csv",
    "ensembles.csv",
    "timing.csv",
    "pareto.csv",
];

/// Writes tables, charts, the picture of sample frames and the page into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_reconstruction(
    dir: &Path,
    tables: &ReconstructionTables,
    samples: &Drawing,
    about: &StudyAbout,
) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    let [cells, ensembles, timing, pareto] = FILES;
    folder.add_table(cells, &tables.reconstruction)?;
    folder.add_table(ensembles, &tables.ensembles)?;
    folder.add_table(timing, &tables.timing)?;
    folder.add_table(pareto, &tables.pareto)?;
    let drawn = draw_reconstruction_charts(tables);
    for (name, title, drawing) in &drawn {
        folder.add_chart(name, title, drawing)?;
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
    folder.write()
}
