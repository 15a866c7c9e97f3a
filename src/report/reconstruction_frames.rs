//! A picture of a few frames: clean, noisy, reconstructed.

use super::reconstruction_charts::{cell_words, noise_words};
use crate::error::Result;
use crate::report::axis::solver_name;
use crate::report::drawing::Drawing;
use crate::report::snapshots::snapshots;
use crate::sensing::Ensemble;
use crate::signal::Quantity;
use crate::study::reconstruction::SampleFrames;
use crate::study::reconstruction::table::{ReconstructionCell, ReconstructionTables};
use ndarray::Array2;

/// The cells whose frames are drawn: at the loudest noise, the best of about a quarter and of the fewest measurements.
pub fn shown_cells(tables: &ReconstructionTables) -> Vec<&ReconstructionCell> {
    let levels = tables.reconstruction.iter().map(|(cell, _)| cell.noise_std);
    let loudest = levels.max_by(f64::total_cmp);
    loudest.map_or_else(Vec::new, |level| chosen(tables, level))
}

/// A row a touch: as it was, as it was read, and as [`shown_cells`] found it.
pub fn draw_samples(
    tables: &ReconstructionTables,
    samples: &SampleFrames,
    (ny, nx): (usize, usize),
    pitch_mm: f64,
    quantity: Quantity,
) -> Result<Drawing> {
    let loudest = samples.noisy.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((level, noisy)) = loudest else {
        return snapshots(&[], pitch_mm, quantity, "");
    };
    let shown = shown_cells(tables);
    let mut frames = Vec::new();
    for (row, name) in samples.names.iter().enumerate() {
        let grid = |frames: &Array2<f64>| {
            let values = frames.row(row).to_vec();
            Array2::from_shape_vec((ny, nx), values).expect("one value a taxel")
        };
        frames.push((name.replace('_', " "), grid(&samples.clean)));
        frames.push(("full, noisy".to_owned(), grid(noisy)));
        for cell in &shown {
            let title = format!("{} of m = {}", solver_name(cell.solver), cell.measurements);
            frames.push((title, grid(&samples.reconstructed[&cell.cell])));
        }
    }
    let words: Vec<String> = shown.iter().map(|cell| cell_words(cell)).collect();
    let Some((first, _)) = tables.reconstruction.first() else {
        return snapshots(&[], pitch_mm, quantity, "");
    };
    let unit = first.noise_unit;
    let caption = format!("{}; {}", noise_words(*level, unit), words.join("; "));
    snapshots(&frames, pitch_mm, quantity, &caption)
}

/// The best cell at the m nearest to a quarter of the taxels, and at the fewest measurements.
fn chosen(tables: &ReconstructionTables, level: f64) -> Vec<&ReconstructionCell> {
    let cells = || {
        let rows = tables.reconstruction.iter();
        rows.filter(|(c, _)| c.noise_std == level && c.ensemble != Ensemble::Identity)
    };
    let off = |cell: &ReconstructionCell| (cell.ratio / 4.0).ln().abs();
    let quarter = cells()
        .min_by(|a, b| off(&a.0).total_cmp(&off(&b.0)))
        .map(|row| row.0.measurements);
    let fewest = cells().map(|(cell, _)| cell.measurements).min();
    let best = |m: usize| {
        let of_m = cells().filter(|(cell, _)| cell.measurements == m);
        of_m.min_by(|a, b| a.1.error.total_cmp(&b.1.error))
            .map(|(cell, _)| cell)
    };
    [quarter, fewest]
        .into_iter()
        .flatten()
        .filter_map(best)
        .collect()
}
