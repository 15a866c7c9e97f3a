//! What a reconstruction study prints at its end.

use super::reconstruction_charts::{cell_words, noise_words, values_of};
use crate::report::axis::{basis_name, ensemble_name, short_number, solver_name};
use crate::report::page::{Section, plain};
use crate::report::terminal::{align_right, plain_table, wrap};
use crate::study::reconstruction::table::{
    ReconstructionCell, ReconstructionScore, ReconstructionTables, ReconstructionTime,
};

use comfy_table::Table;

type Row<'a> = (
    &'a ReconstructionCell,
    &'a ReconstructionScore,
    &'a ReconstructionTime,
);

/// For each noise level and number of measurements, the best cell of every solver; then what compression costs or gains
/// beside full sampling. Lines are at most about `width` letters long.
pub fn reconstruction_summary(tables: &ReconstructionTables, width: usize) -> String {
    let rows = rows(tables);
    if rows.is_empty() {
        return "No cell has been computed.\n".to_owned();
    }
    let table = best_table(&rows, width);
    let mut text = format!("{}\n\n{table}\n\n", wrap(NOTE, width).join("\n"));
    for sentence in answers(&rows) {
        text += &sentence;
        text.push('\n');
    }
    text
}

/// The same for a page.
pub(super) fn reconstruction_sections(tables: &ReconstructionTables) -> [Section; 2] {
    let rows = rows(tables);
    let table = best_table(&rows, 200);
    [
        plain::answer(&answers(&rows)),
        plain::table("best", "Best cells", NOTE, &table),
    ]
}

const NOTE: &str = "The best dictionary and ensemble of each solver; error is relative to the clean frames, full is that of \
    the noisy frame itself.";

fn rows(tables: &ReconstructionTables) -> Vec<Row<'_>> {
    let rows = tables.reconstruction.iter().zip(&tables.timing);
    rows.map(|((cell, score), (_, time))| (cell, score, time))
        .collect()
}

fn best_table(rows: &[Row], width: usize) -> Table {
    let mut table = plain_table(width);
    table.set_header([
        "noise",
        "m",
        "solver",
        "dictionary",
        "ensemble",
        "error [95 %]",
        "full",
        "frames/s a core",
    ]);
    for best in best_cells(rows) {
        let (cell, score, time) = best;
        table.add_row([
            short_number(cell.noise_std),
            cell.measurements.to_string(),
            solver_name(cell.solver).to_owned(),
            basis_name(cell.dictionary).to_owned(),
            ensemble_name(cell.ensemble).to_owned(),
            format!(
                "{:.3} [{:.3}, {:.3}]",
                score.error, score.error_low, score.error_high
            ),
            format!("{:.3}", score.full_sampling_error),
            format!("{:.0}", time.frames_per_s_per_core),
        ]);
    }
    align_right(&mut table, [0, 1, 6, 7]);
    table
}

/// The lowest error of each noise level, m and solver, in the order of the tables.
fn best_cells<'a>(rows: &[Row<'a>]) -> Vec<Row<'a>> {
    let cells = || rows.iter().map(|row| row.0);
    let mut best = Vec::new();
    for noise in values_of(cells(), |c| c.noise_std) {
        let mut counts = values_of(cells(), |c| c.measurements);
        counts.sort_unstable();
        for m in counts {
            for solver in values_of(cells(), |c| c.solver) {
                let same = rows.iter().filter(|(c, ..)| {
                    c.noise_std == noise && c.measurements == m && c.solver == solver
                });
                best.extend(same.min_by(|a, b| a.1.error.total_cmp(&b.1.error)));
            }
        }
    }
    best
}

/// At each noise level: the fewest measurements from which some cell is as good as full sampling, and the best cell of all.
fn answers(rows: &[Row]) -> Vec<String> {
    let mut sentences = Vec::new();
    for (noise, unit) in values_of(rows.iter().map(|row| row.0), |c| {
        (c.noise_std, c.noise_unit)
    }) {
        let of_level = || rows.iter().filter(|(c, ..)| c.noise_std == noise);
        let words = noise_words(noise, unit);
        if let Some((cell, score, time)) = of_level().min_by(|a, b| a.1.error.total_cmp(&b.1.error))
        {
            sentences.push(format!(
                "With {words}: least error {:.3} ({}; {:.0} frames/s a core).",
                score.error,
                cell_words(cell),
                time.frames_per_s_per_core
            ));
        }
        let as_good = of_level().filter(|(_, s, _)| s.error <= s.full_sampling_error);
        let fewest = as_good.min_by(|a, b| {
            let key = |row: &Row| (row.0.measurements, row.1.error);
            key(a)
                .partial_cmp(&key(b))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        if let Some((cell, score, _)) = fewest {
            sentences.push(format!(
                "As good as full sampling ({:.3}) from {} measurements ({:.0}:1): {:.3} ({}).",
                score.full_sampling_error,
                cell.measurements,
                cell.ratio,
                score.error,
                cell_words(cell)
            ));
        }
    }
    sentences
}
