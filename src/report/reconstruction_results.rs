//! The folder of a reconstruction study.

use crate::error::Result;
use crate::report::drawing::Drawing;
use crate::report::folder::Folder;
use crate::report::reconstruction_charts::draw_reconstruction_charts;
use crate::study::reconstruction::table::ReconstructionTables;
use std::path::{Path, PathBuf};

/// Writes tables, charts and the picture of sample frames into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_reconstruction(
    dir: &Path,
    tables: &ReconstructionTables,
    samples: &Drawing,
) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    folder.add_table("reconstruction.csv", &tables.reconstruction)?;
    folder.add_table("ensembles.csv", &tables.ensembles)?;
    folder.add_table("timing.csv", &tables.timing)?;
    folder.add_table("pareto.csv", &tables.pareto)?;
    for (name, title, drawing) in draw_reconstruction_charts(tables) {
        folder.add_chart(&name, &title, &drawing)?;
    }
    // As SVG, noisy taxels would be megabytes.
    folder.add("frames.png", samples.png()?);
    folder.write()
}
