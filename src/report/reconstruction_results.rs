//! The folder of a reconstruction study.

use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::report::csv_tables::to_csv;
use crate::report::drawing::Drawing;
use crate::report::reconstruction_charts::draw_reconstruction_charts;
use crate::report::results::make_folder;
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
    let mut files = Vec::new();
    for (name, bytes) in [
        ("reconstruction.csv", to_csv(&tables.reconstruction)),
        ("ensembles.csv", to_csv(&tables.ensembles)),
        ("timing.csv", to_csv(&tables.timing)),
        ("pareto.csv", to_csv(&tables.pareto)),
    ] {
        let bytes =
            bytes.map_err(|e| Error::io(dir.join(name), "write", std::io::Error::other(e)))?;
        files.push((name.to_owned(), bytes));
    }
    for (name, title, drawing) in draw_reconstruction_charts(tables) {
        files.push((format!("{name}.png"), drawing.png()?));
        files.push((format!("{name}.svg"), drawing.svg(&title).into_bytes()));
    }
    // As SVG, noisy taxels would be megabytes.
    files.push(("frames.png".to_owned(), samples.png()?));
    make_folder(dir)?;
    let mut paths = Vec::new();
    for (name, bytes) in files {
        let path = dir.join(name);
        write_bytes(&path, &bytes)?;
        paths.push(path);
    }
    Ok(paths)
}
