//! Charts and answers of a reconstruction study, and a picture of sample frames.

use crate::report::advice::Candidates;
use crate::studies::prelude::*;
use crate::studies::reconstruction::rows::*;
use crate::table::{Along, At, Rule, Value};

/// Time of a frame at 1,000 frames per second, µs.
const US_PER_FRAME: f64 = 1000.0;

/// Returns a chart of the reconstruction error by computing time with one panel per noise level, and for each level charts of the error by the number of
/// measurements.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let configurations = &tables[0];
    let mut charts: Vec<ChartSpec> = by_time(tables).into_iter().collect();
    for of_level in configurations.groups(&["noise_std"], 0..configurations.n_rows) {
        let ensembles = configurations.groups(&["ensemble"], of_level.iter().copied());
        let compressed = ensembles
            .iter()
            .filter(|rows| configurations.word("ensemble", rows[0]) != "identity");
        charts.extend(compressed.map(|rows| by_measurements(configurations, rows)));
    }
    charts
}

/// Returns answers for each noise level: the smallest number of measurements that is as good as the noisy frame, for all levels first, and the most accurate
/// configuration.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let (configurations, timing) = (&tables[0], &tables[2]);
    let number = |column: &'static str| move |row: usize| configurations.number(column, row);
    let (error, full) = (number("error"), number("full_sampling_error"));
    let said = |row: usize| {
        format!(
            "{:.2} in {} a frame ({})",
            error(row),
            timing.words("us_per_frame", row),
            cell_words(configurations, row)
        )
    };
    let levels = configurations.groups(&["noise_std"], 0..configurations.n_rows);
    let fewest = levels.iter().filter_map(|rows| {
        let as_good = rows.iter().copied().filter(|&row| error(row) <= full(row));
        let key = |row: usize| (number("measurements")(row), error(row));
        let row = as_good.min_by(|&a, &b| key(a).partial_cmp(&key(b)).expect("errors are numbers"))?;
        Some(format!(
            "With {}, {} measurements are at least as good as the noisy frame itself (error {:.2}): error {}.",
            noise_words(configurations, row),
            configurations.words("measurements", row),
            full(row),
            said(row)
        ))
    });
    let least = levels.iter().filter_map(|rows| {
        let row = rows
            .iter()
            .copied()
            .min_by(|&a, &b| error(a).total_cmp(&error(b)))?;
        let noise = noise_words(configurations, row);
        Some(format!("With {noise}: least error {}.", said(row)))
    });
    fewest.chain(least).collect()
}

/// Returns a chart of the reconstruction error by the time of a frame, with one panel per noise level and one colour per solver.
fn by_time(tables: &[Table]) -> Option<ChartSpec> {
    let both = tables.iter().find(|table| table.file == BOTH)?;
    let rows = both.all_rows();
    let (error, time) = (both.column("error")?.0, both.column("us_per_frame")?.0);
    let best = Candidates::of_columns(both, error, time).as_good_words(&rows);
    let noisy = Rule {
        along: Along::Y,
        at: At::Column("full_sampling_error".to_owned()),
        words: "the noisy frame itself".to_owned(),
    };
    Some(ChartSpec {
        lines: vec!["solver".to_owned()],
        panels: Some("noise_std".to_owned()),
        mark: Mark::Points,
        front: true,
        rules: vec![noisy, Rule::at(Along::X, US_PER_FRAME, "1,000 frames/s")],
        ..both.chart(
            "error_by_time",
            format!("Error against the time of a frame: {best}, within the interval of the best"),
            ("error", "us_per_frame"),
        )
    })
}

/// Returns a chart of the reconstruction error by number of measurements, with one panel per dictionary and one line per solver. A reference line shows the
/// error of the noisy frame.
fn by_measurements(configurations: &Table, rows: &[usize]) -> ChartSpec {
    let (code, ensemble) = (
        configurations.word("ensemble", rows[0]),
        configurations.words("ensemble", rows[0]),
    );
    let level = configurations.number("noise_std", rows[0]);
    // A number and its unit stay on one line.
    let noise = noise_words(configurations, rows[0]).replace(' ', "\u{a0}");
    let full = configurations.number("full_sampling_error", rows[0]);
    let rule = Rule::at(Along::Y, full, "full sampling: the noisy frame itself");
    let shown = ["noise_std", "ensemble"].into_iter();
    ChartSpec {
        shown: shown
            .filter_map(|column| configurations.shown(column, rows[0]))
            .collect(),
        lines: vec!["solver".to_owned()],
        panels: Some("dictionary".to_owned()),
        rules: (full > 0.0).then_some(rule).into_iter().collect(),
        ..configurations.chart(
            format!("error_{code}_noise_{level}"),
            format!("Error of reconstructed frames by measurements, {ensemble}, {noise}"),
            ("error", "measurements"),
        )
    }
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
