//! Charts and answers of a reconstruction study, and a picture of sample frames.

use crate::report::advice::Candidates;
use crate::studies::prelude::*;
use crate::studies::reconstruction::rows::*;
use crate::table::{Along, At, Rule, Value};

/// Error of a frame that is not compressed.
const FULL_SAMPLING: At = At::Column("full_sampling_error");
/// Time of a frame at 1,000 frames per second, µs.
const US_PER_FRAME: At = At::Value(1000.0);

/// Charts of the reconstruction error by computing time, and of the error by the number of measurements.
pub(super) const CHARTS: &[Chart] = &[
    Chart {
        table: BOTH,
        name: "error_by_time",
        title: "Error against the time of a frame: {best}, within the interval of the best",
        x: "us_per_frame",
        y: "error",
        lines: &["solver"],
        panels: Some("noise_std"),
        rules: &[
            Rule::constant(Along::Y, FULL_SAMPLING, "the noisy frame itself"),
            Rule::constant(Along::X, US_PER_FRAME, "1,000 frames/s"),
        ],
        ..Chart::FRONT
    },
    Chart {
        table: CONFIGURATIONS.name(),
        name: "error_{ensemble}_noise_{noise_std}",
        title: "Error of reconstructed frames by measurements, {ensemble}, {noise_std}",
        each: &["noise_std", "ensemble"],
        x: "measurements",
        y: "error",
        lines: &["solver"],
        panels: Some("dictionary"),
        rules: &[Rule::constant(
            Along::Y,
            FULL_SAMPLING,
            "full sampling: the noisy frame itself",
        )],
        ..Chart::LINES
    },
];

/// Returns the answers: the best configuration for each noise level, and the fastest one within the interval of the best.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let both = tables.iter().find(|table| table.file == BOTH);
    let both = both.and_then(|both| Candidates::of_columns(both, "error", "us_per_frame"));
    both.map_or_else(Vec::new, |both| both.sentences())
}

/// Returns the noise of a configuration as text, such as `noise 10 %`.
pub(super) fn noise_words(configurations: &Table, row: usize) -> String {
    let column = configurations.column("noise_std").map(|(column, _)| column);
    let level = Value::Number(configurations.number("noise_std", row));
    column.map_or_else(String::new, |column| column.phrase(&level))
}

/// Returns the settings of a configuration as text, such as `LMMSE, PCA, SBHE, m = 1024`.
pub(super) fn cell_words(configurations: &Table, row: usize) -> String {
    let names = ["solver", "dictionary", "ensemble", "measurements"];
    let [solver, dictionary, ensemble, m] = names.map(|column| configurations.words(column, row));
    format!("{solver}, {dictionary}, {ensemble}, m = {m}")
}
