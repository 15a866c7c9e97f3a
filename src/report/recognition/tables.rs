//! The tables of a study of recognition, and one of all that is known of each cell.

use crate::error::Result;
use crate::recognition::ClassifierKind;
use crate::report::csv_tables::LIMITS_FILE;
use crate::study::StudySpec;
use crate::study::table::{
    Cell, CellScore, Comparison, Confused, Confusion, Limit, Pareto, Published, StageTime, Tables,
    TrialScore, TrialTime, Variance,
};
use crate::table::{Better, Column, Columns, Data, File, Role, Scale, Table};
use serde::Serialize;
use std::path::Path;

/// The table of all that is known of each cell; it has no file.
pub const CELLS: &str = "cells.csv";

const ACCURACY: File<(Cell, TrialScore)> = File::new(
    "accuracy.csv",
    "Every trial",
    "Intervals are 95 % Wilson intervals of the test decisions of the trial.",
);
const SUMMARY: File<(Cell, CellScore)> = File::new(
    "summary.csv",
    "Cells over their trials",
    "Means over trials; intervals are 95 % Wilson intervals at the test decisions of one trial.",
)
.summary();
const CONFUSION: File<Confusion> =
    File::new("confusion.csv", "What was taken for what", "").summary();
const COMPARISON: File<Comparison> = File::new(
    "comparison.csv",
    "Cells against the best of their condition",
    "A t-test paired over trials, corrected for their overlap; the p-value of Holm is corrected for the number of cells too.",
)
.summary();
const TIMING: File<(Cell, TrialTime)> =
    File::new("timing.csv", "Times of every trial", "").of_times();
const PARETO: File<(Cell, Pareto)> =
    File::new("pareto.csv", "Accuracy and its cost", "").of_times();
const STAGES: File<StageTime> = File::new("stages.csv", "Times of the stages", "").of_times();
const CONFUSED: File<Confused> = File::new(
    "confused.csv",
    "Most often confused",
    "The pairs of objects that the best cell confuses most often, all trials together.",
)
.summary();
const PUBLISHED: File<(Cell, Published)> = File::new(
    "published.csv",
    "Beside what was published",
    "Ours: the most accurate of the cells that have the settings of the claim, in each condition that these were measured in.",
)
.summary();
const VARIANCE: File<Variance> =
    File::new("variance.csv", "What makes trials differ", "").summary();
const LIMITS: File<Limit> = File::new(LIMITS_FILE, "How often limits were reached", "").summary();

/// Every table of a run, in the order of their files; then [`CELLS`].
///
/// # Errors
/// A row that has no form in a file.
pub fn tables_of(tables: &Tables) -> Result<Vec<Table>> {
    let first = tables.accuracy.first();
    let axes = first
        .into_iter()
        .flat_map(|(cell, _)| cell.variant.values.iter());
    let axes = axes.map(|axis| axis.column.clone().optional()).collect();
    From::Rows(tables).all(axes)
}

/// The same of the files of a folder; without limits where an earlier version wrote none.
///
/// # Errors
/// A table that cannot be read, by its file, line and column.
pub fn read_tables(folder: &Path) -> Result<Vec<Table>> {
    let study = folder.join("study.toml");
    let axes = match std::fs::read_to_string(&study) {
        Ok(text) => StudySpec::parse(&study.display().to_string(), &text)
            .map_or_else(|_| Vec::new(), |study| study.axis_columns()),
        Err(_) => Vec::new(),
    };
    From::Folder(folder).all(axes.into_iter().map(Column::optional).collect())
}

/// Where rows come from.
enum From<'a> {
    Rows(&'a Tables),
    Folder(&'a Path),
}

impl From<'_> {
    /// Those of cells have the columns of the axes that the study names itself.
    fn all(&self, axes: Vec<Column>) -> Result<Vec<Table>> {
        let mut tables = vec![
            self.table(&ACCURACY, |tables| &tables.accuracy, &axes)?,
            self.table(&SUMMARY, |tables| &tables.summary, &axes)?,
            self.table(&CONFUSION, |tables| &tables.confusion, &[])?,
            self.table(&COMPARISON, |tables| &tables.comparison, &[])?,
            self.table(&TIMING, |tables| &tables.timing, &axes)?,
            self.table(&PARETO, |tables| &tables.pareto, &axes)?,
            self.table(&STAGES, |tables| &tables.stages, &[])?,
            self.table(&CONFUSED, |tables| &tables.confused, &[])?,
            self.table(&PUBLISHED, |tables| &tables.published, &axes)?,
        ];
        let (has_variance, has_limits) = match self {
            Self::Rows(tables) => (!tables.variance.is_empty(), true),
            Self::Folder(folder) => {
                let has = |file: &str| folder.join(file).exists();
                (has(VARIANCE.name()), has(LIMITS.name()))
            }
        };
        if has_variance {
            tables.push(self.table(&VARIANCE, |tables| &tables.variance, &[])?);
        }
        if has_limits {
            tables.push(self.table(&LIMITS, |tables| &tables.limits, &[])?);
        }
        tables.iter_mut().for_each(say);
        let cells = cells_of(&tables);
        tables.extend(cells);
        Ok(tables)
    }

    fn table<R: Columns + Serialize>(
        &self,
        file: &File<R>,
        rows: fn(&Tables) -> &Vec<R>,
        axes: &[Column],
    ) -> Result<Table> {
        let mut columns = R::columns();
        let behind = Cell::columns().len().min(columns.len());
        columns.splice(behind..behind, axes.iter().cloned());
        match self {
            Self::Rows(tables) => file.of_columns(columns, rows(tables)),
            Self::Folder(folder) => file.read_columns(columns, folder),
        }
    }
}

/// What only the rows tell: the unit of noise, and what C is where it is absent.
fn say(table: &mut Table) {
    let unit = match table.column("noise_unit") {
        Some((_, Data::Words { levels, .. })) => levels.first().map(|level| &level[..]),
        _ => None,
    };
    let unit = match unit {
        Some("mm") => Some("mm"),
        Some("n") => Some("N"),
        _ => None,
    };
    if let (Some(unit), Some(place)) = (unit, table.place("noise_std")) {
        let column = &mut table.columns[place];
        (column.unit, column.scale) = (unit.into(), Scale::Linear);
    }
    if let (Some(place), false) = (table.place("c"), has_chosen_c(table)) {
        table.columns[place].names = &[];
    }
}

/// Whether C is absent only where a classifier that has one chooses it.
fn has_chosen_c(table: &Table) -> bool {
    let (Some(c), Some((_, classifiers))) = (table.numbers("c"), table.column("classifier")) else {
        return false;
    };
    let has_c = |row: usize| {
        let word = classifiers
            .value(row)
            .map(|word| toml::Value::from(word.to_string()));
        let kind = word.and_then(|word| word.try_into::<ClassifierKind>().ok());
        kind.is_some_and(ClassifierKind::has_c)
    };
    let mut absent = (0..table.n_rows).filter(|&row| c[row].is_nan());
    absent.all(has_c)
}

/// Each cell with its distance to the best of its condition and with what it costs.
fn cells_of(tables: &[Table]) -> Option<Table> {
    let of = |file: &str| tables.iter().find(|table| table.file == file);
    let (summary, comparison, pareto) = (
        of(SUMMARY.name())?,
        of(COMPARISON.name())?,
        of(PARETO.name())?,
    );
    let compared =
        ["difference", "p_holm", "p_status"].map(|name| summary.look_up(comparison, "cell", name));
    let costs =
        ["fit_s", "predict_us_per_decision"].map(|name| summary.look_up(pareto, "cell", name));
    let product = |names: &[&str]| -> Option<Data> {
        let columns = names.iter().map(|name| summary.numbers(name));
        let columns: Vec<&[f64]> = columns.collect::<Option<_>>()?;
        let of_row = |row: usize| columns.iter().map(|column| column[row]).product();
        Some(Data::Numbers((0..summary.n_rows).map(of_row).collect()))
    };
    let cost = |name: &'static str, words: &'static str| {
        Column::new(name, Role::Cost, words, "", Scale::Log)
    };
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
        product(&["measurements", "frames", "fused_touches"])?,
    ));
    more.push((cost("taxels", "taxels"), product(&["nx", "ny"])?));
    let mut table = summary.with((CELLS, "All cells"), more);
    table.note = "All that is known of each cell, from summary.csv, comparison.csv and pareto.csv. Costs of time are of this machine.".to_owned();
    Some(table)
}
