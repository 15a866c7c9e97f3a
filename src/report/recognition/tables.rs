//! The tables of a study of recognition, and one of all that is known of each cell.

use crate::error::Result;
use crate::recognition::ClassifierKind;
use crate::report::csv_tables::{LIMITS_FILE, VARIANCE_FILE, axes_beside};
use crate::study::table::{
    Cell, CellScore, Comparison, Confused, Confusion, Limit, Pareto, Published, StageTime, Tables,
    TrialScore, TrialTime, Variance,
};
use crate::table::{Better, Column, Columns, Data, Role, Scale, Table, Value};
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::StrDeserializer;
use std::path::Path;

/// The table of all that is known of each cell; it has no file.
pub const CELLS: &str = "cells.csv";

const FEATURES: &[(&str, &str)] = &[("centred_unit_norm", "centred, unit norm")];
const OVER_TIME: &[(&str, &str)] = &[
    ("", "all frames"),
    ("deepest", "deepest frame"),
    ("summarised", "moments and course"),
];
const CHOSEN: &[(&str, &str)] = &[("", "chosen")];

const ACCURACY: File = ("accuracy.csv", "Every trial");
const SUMMARY: File = ("summary.csv", "Cells over their trials");
const CONFUSION: File = ("confusion.csv", "What was taken for what");
const COMPARISON: File = (
    "comparison.csv",
    "Cells against the best of their condition",
);
const TIMING: File = ("timing.csv", "Times of every trial");
const PARETO: File = ("pareto.csv", "Accuracy and its cost");
const STAGES: File = ("stages.csv", "Times of the stages");
const CONFUSED: File = ("confused.csv", "Most often confused");
const PUBLISHED: File = ("published.csv", "Beside what was published");
const VARIANCE: File = (VARIANCE_FILE, "What makes trials differ");
const LIMITS: File = (LIMITS_FILE, "How often limits were reached");

/// Its name and title.
type File = (&'static str, &'static str);

/// Every table of a run, in the order of their files; then [`CELLS`].
///
/// # Errors
/// A row that has no form in a file.
pub fn tables_of(tables: &Tables, limits: &[Limit]) -> Result<Vec<Table>> {
    let axes = axes_of(&tables.accuracy);
    let mut made = vec![
        Table::of_columns(ACCURACY, columns::<TrialScore>(&axes), &tables.accuracy)?,
        Table::of_columns(SUMMARY, columns::<CellScore>(&axes), &tables.summary)?.summary(),
        Table::of_columns(CONFUSION, Confusion::columns(), &tables.confusion)?.summary(),
        Table::of_columns(COMPARISON, Comparison::columns(), &tables.comparison)?.summary(),
        Table::of_columns(TIMING, columns::<TrialTime>(&axes), &tables.timing)?.of_times(),
        Table::of_columns(PARETO, columns::<Pareto>(&axes), &tables.pareto)?.of_times(),
        Table::of_columns(STAGES, StageTime::columns(), &tables.stages)?.of_times(),
        Table::of_columns(CONFUSED, Confused::columns(), &tables.confused)?.summary(),
        Table::of_columns(PUBLISHED, columns::<Published>(&axes), &tables.published)?.summary(),
    ];
    if !tables.variance.is_empty() {
        made.push(Table::of_columns(VARIANCE, Variance::columns(), &tables.variance)?.summary());
    }
    made.push(Table::of_columns(LIMITS, Limit::columns(), limits)?.summary());
    Ok(with_cells(made))
}

/// The same of the files of a folder; without limits where an earlier version wrote none.
///
/// # Errors
/// A table that cannot be read, by its file, line and column.
pub fn read_tables(dir: &Path) -> Result<Vec<Table>> {
    let axes = axes_beside(&dir.join(ACCURACY.0))?;
    let mut read = vec![
        Table::read_columns(ACCURACY, columns::<TrialScore>(&axes), dir)?,
        Table::read_columns(SUMMARY, columns::<CellScore>(&axes), dir)?.summary(),
        Table::read_columns(CONFUSION, Confusion::columns(), dir)?.summary(),
        Table::read_columns(COMPARISON, Comparison::columns(), dir)?.summary(),
        Table::read_columns(TIMING, columns::<TrialTime>(&axes), dir)?.of_times(),
        Table::read_columns(PARETO, columns::<Pareto>(&axes), dir)?.of_times(),
        Table::read_columns(STAGES, StageTime::columns(), dir)?.of_times(),
        Table::read_columns(CONFUSED, Confused::columns(), dir)?.summary(),
        Table::read_columns(PUBLISHED, columns::<Published>(&axes), dir)?.summary(),
    ];
    if dir.join(VARIANCE_FILE).exists() {
        read.push(Table::read_columns(VARIANCE, Variance::columns(), dir)?.summary());
    }
    if dir.join(LIMITS_FILE).exists() {
        read.push(Table::read_columns(LIMITS, Limit::columns(), dir)?.summary());
    }
    Ok(with_cells(read))
}

/// What cells cost.
///
/// # Errors
/// A row that has no form in a file.
pub fn costs_table(costs: &[(Cell, Pareto)]) -> Result<Table> {
    let mut table = Table::of_columns(PARETO, columns::<Pareto>(&axes_of(costs)), costs)?;
    say(&mut table);
    Ok(table)
}

/// The axes that a study of these cells names itself.
fn axes_of<R>(rows: &[(Cell, R)]) -> Vec<Column> {
    let first = rows.first().map(|(cell, _)| cell.variant.values.iter());
    let axes = first.into_iter().flatten();
    axes.map(|axis| axis.column.clone()).collect()
}

/// Those of a cell, of the axes that its study names itself, and of a score.
fn columns<R: Columns>(axes: &[Column]) -> Vec<Column> {
    let axes = axes.iter().map(|axis| axis.clone().optional());
    Cell::columns()
        .into_iter()
        .chain(axes)
        .chain(R::columns())
        .collect()
}

fn with_cells(mut tables: Vec<Table>) -> Vec<Table> {
    for table in &mut tables {
        say(table);
    }
    let notes = [
        (
            "accuracy.csv",
            "Intervals are 95 % Wilson intervals of the test decisions of the trial.",
        ),
        (
            "summary.csv",
            "Means over trials; intervals are 95 % Wilson intervals at the test decisions of one trial.",
        ),
        (
            "comparison.csv",
            "A t-test paired over trials, corrected for their overlap; the p-value of Holm is corrected for the number of cells too.",
        ),
        (
            "published.csv",
            "Ours: the most accurate of the cells that have the settings of the claim, in each condition that these were measured in.",
        ),
        (
            "confused.csv",
            "The pairs of objects that the best cell confuses most often, all trials together.",
        ),
    ];
    for (file, note) in notes {
        if let Some(table) = tables.iter_mut().find(|table| table.file == file) {
            table.note = note.to_owned();
        }
    }
    let cells = cells_of(&tables);
    tables.extend(cells);
    tables
}

/// What people call codes, and what noise is measured in.
pub fn say(table: &mut Table) {
    let unit = table.column("noise_unit").and_then(|(_, data)| match data {
        Data::Words { levels, .. } => levels.first().cloned(),
        Data::Numbers(_) => None,
    });
    let chosen = has_chosen_c(table);
    for column in &mut table.columns {
        match (column.name.as_ref(), unit.as_deref()) {
            ("noise_std", Some("mm" | "n")) => {
                column.unit = if unit.as_deref() == Some("mm") {
                    "mm"
                } else {
                    "N"
                }
                .into();
                column.scale = Scale::Linear;
            }
            ("noise_std", _) => column.words = "noise".into(),
            ("features", _) => column.names = FEATURES,
            ("over_time", _) => column.names = OVER_TIME,
            ("c", _) if chosen => column.names = CHOSEN,
            // Rare confusions are seen, too.
            ("count", _) => column.scale = Scale::Log,
            // The pitch and the size say them.
            ("nx" | "ny", _) => column.role = Role::Note,
            _ => {}
        }
    }
}

/// Whether C is absent only where a classifier that has one chooses it.
fn has_chosen_c(table: &Table) -> bool {
    let (Some(c), Some((_, classifiers))) = (table.numbers("c"), table.column("classifier")) else {
        return false;
    };
    let has_c = |row: usize| match classifiers.value(row) {
        Some(Value::Word(word)) => {
            let word: StrDeserializer<serde::de::value::Error> = word.as_str().into_deserializer();
            ClassifierKind::deserialize(word).is_ok_and(ClassifierKind::has_c)
        }
        _ => false,
    };
    let mut absent = (0..table.n_rows).filter(|&row| c[row].is_nan());
    absent.all(has_c)
}

/// Each cell with its distance to the best of its condition and with what it costs.
fn cells_of(tables: &[Table]) -> Option<Table> {
    let of = |file: &str| tables.iter().find(|table| table.file == file);
    let (summary, comparison, pareto) =
        (of("summary.csv")?, of("comparison.csv")?, of("pareto.csv")?);
    let compared =
        ["difference", "p_holm", "p_status"].map(|name| summary.look_up(comparison, "cell", name));
    let costs =
        ["fit_s", "predict_us_per_decision"].map(|name| summary.look_up(pareto, "cell", name));
    let product = |names: [&str; 3]| -> Option<Vec<f64>> {
        let columns = names.map(|name| summary.numbers(name));
        let rows = 0..summary.n_rows;
        columns.iter().all(Option::is_some).then(|| {
            rows.map(|row| columns.iter().flatten().map(|column| column[row]).product())
                .collect()
        })
    };
    let cost = |name: &'static str, words: &'static str| {
        Column::new(name, Role::Cost, words, "", Scale::Log)
    };
    let measurements = product(["measurements", "frames", "fused_touches"])?;
    let taxels = product(["nx", "ny", "fused_touches"])?;
    let fused = summary.numbers("fused_touches")?;
    let taxels = taxels
        .iter()
        .zip(fused)
        .map(|(n, fused)| n / fused)
        .collect();
    let mut more: Vec<(Column, Data)> = compared.into_iter().flatten().collect();
    for (column, _) in &mut more {
        column.interval = None;
        if column.name == "difference" {
            column.role = Role::Value(Better::Neither);
        }
    }
    more.extend(costs.into_iter().flatten());
    more.push((
        cost("measurements_per_decision", "measurements a decision"),
        Data::Numbers(measurements),
    ));
    more.push((cost("taxels", "taxels"), Data::Numbers(taxels)));
    let table = summary.with((CELLS, "All cells"), more);
    Some(table.noted("All that is known of each cell, from summary.csv, comparison.csv and pareto.csv. Costs of time are of this machine."))
}
