//! A picture of a few test frames: as they were, as they were read, and as some cells reconstruct them.

use super::rows::ReconstructionCell;
use super::study::ReconstructionStudy;
use crate::error::Result;
use crate::report::snapshots::snapshots;
use crate::report::study_folder::NamedPicture;
use crate::sensing::{Reconstructor, SensedDictionary};
use crate::study::millimetres;
use crate::study::progress::Silent;
use crate::table::Table;
use ndarray::Array2;

impl ReconstructionStudy {
    /// Of the loudest noise; none where nothing was reconstructed.
    pub(super) fn sample_frames(&self, tables: &[Table]) -> Result<Vec<NamedPicture>> {
        let Some(cells) = tables.first().filter(|cells| cells.n_rows > 0) else {
            return Ok(Vec::new());
        };
        let touches = self.frames(&Silent)?;
        let loudest = touches
            .noisy
            .iter()
            .max_by(|a, b| a.level.total_cmp(&b.level));
        let Some(noisy) = loudest else {
            return Ok(Vec::new());
        };
        let all = self.plan.cells();
        let shown = shown_rows(cells, noisy.level);
        let shown_cells = shown
            .iter()
            .map(|&row| &all[cells.number("cell", row) as usize]);
        let shown_cells: Vec<&ReconstructionCell> = shown_cells.collect();
        let read = touches.pick(&noisy.frames);
        let back = |cell: &&ReconstructionCell| {
            let dictionary = touches.learn(&self.plan, cell.dictionary)?;
            let projection = self.plan.projection(cell.ensemble, cell.measurements)?;
            let sensed = SensedDictionary::new(&projection, &dictionary)?;
            let effort = &self.plan.spec.reconstruction.effort();
            let reconstructor = Reconstructor::new(cell.solver, &sensed, effort, noisy.std)?;
            Ok(reconstructor
                .reconstruct(projection.measure(read.view()).view())?
                .frames)
        };
        let back = shown_cells.iter().map(back);
        let back = back.collect::<Result<Vec<Array2<f64>>>>()?;
        let grid = self.plan.patch.grid;
        let mut frames = Vec::new();
        let clean = touches.pick(&touches.test);
        for (sample, (_, name)) in touches.shown.iter().enumerate() {
            let of_sample = |frames: &Array2<f64>| {
                let values = frames.row(sample).to_vec();
                Array2::from_shape_vec((grid.ny, grid.nx), values).expect("one value a taxel")
            };
            frames.push((name.replace('_', " "), of_sample(&clean)));
            frames.push(("full, noisy".to_owned(), of_sample(&read)));
            for (&row, back) in shown.iter().zip(&back) {
                let [solver, m] = ["solver", "measurements"].map(|name| cells.words(name, row));
                frames.push((format!("{solver} of m = {m}"), of_sample(back)));
            }
        }
        let noise = super::charts::noise_words(cells, shown.first().copied().unwrap_or(0));
        let words = shown
            .iter()
            .map(|&row| super::charts::cell_words(cells, row));
        let caption = format!("{noise}; {}", words.collect::<Vec<_>>().join("; "));
        let pitch_mm = millimetres(grid.pitch);
        let picture = snapshots(&frames, pitch_mm, self.plan.quantity(), &caption)?;
        Ok(vec![NamedPicture {
            name: "frames".to_owned(),
            title: "Sample frames and what came back of them".to_owned(),
            png: picture.png()?,
            size: (picture.width / 2, picture.height / 2),
        }])
    }
}

/// The best cell at the m nearest to a quarter of the taxels, and at the fewest measurements.
fn shown_rows(cells: &Table, level: f64) -> Vec<usize> {
    let of_level: Vec<usize> = (0..cells.n_rows)
        .filter(|&row| cells.number("noise_std", row) == level)
        .filter(|&row| cells.word("ensemble", row) != "identity")
        .collect();
    let m = |row: usize| cells.number("measurements", row);
    let off = |row: usize| (cells.number("ratio", row) / 4.0).ln().abs();
    let rows = || of_level.iter().copied();
    let quarter = rows().min_by(|&a, &b| off(a).total_cmp(&off(b)));
    let fewest = rows().min_by(|&a, &b| m(a).total_cmp(&m(b)));
    let best = |like: usize| {
        let of_m = rows().filter(|&row| m(row) == m(like));
        of_m.min_by(|&a, &b| {
            cells
                .number("error", a)
                .total_cmp(&cells.number("error", b))
        })
    };
    [quarter, fewest]
        .into_iter()
        .flatten()
        .filter_map(best)
        .collect()
}
