//! Tables of a recognition study, and a combined table of all results of each configuration.

use crate::error::{Error, Result};
use crate::files::has_table;
use crate::learning::classifiers::ClassifierKind;
use crate::report::csv_tables::LIMITS_FILE;
use crate::report::swept::{Setting, Swept};
use crate::statistics::bootstrap::coverage_of_95;
use crate::statistics::grouped::FEW_GROUPS;
use crate::statistics::p_status::CONFIDENCE;
use crate::studies::recognition::rows::configuration::Configuration;
use crate::studies::recognition::rows::table_rows::{
    Comparison, ConfigurationScore, Confused, Confusion, Limit, Pareto, Prediction, Predictions,
    Published, Recall, SelectedTaxel, StageTime, Tables, TrialScore, TrialTime, Variance,
};
use crate::studies::recognition::spec::study::StudySpec;
use crate::studies::recognition::tables::chance::ChanceLevels;
use crate::studies::recognition::tables::robustness::{ROBUSTNESS, robustness};
use crate::studies::study::AnyFile;
use crate::table::{Better, Column, Columns, Data, File, Role, Scale, Table};
use serde::Serialize;
use std::path::Path;

/// Returns the table with the given file name; `None` if there is no such table or if it has no rows.
pub(crate) fn filled<'a>(tables: &'a [Table], file: &str) -> Option<&'a Table> {
    let mut tables = tables.iter();
    tables.find(|table| table.file == file && table.n_rows > 0)
}

/// Name of the combined table of all results of each configuration; the table is not written to a file.
pub const CONFIGURATIONS: &str = "configurations.csv";

const ACCURACY: File<(Configuration, TrialScore)> = File::new(
    "accuracy.csv",
    "Every trial",
    "Intervals are 95 % Wilson intervals of the test decisions of the trial.",
);
const SUMMARY: File<(Configuration, ConfigurationScore)> = File::new(
    "summary.csv",
    "Configurations over their trials",
    "Means over trials.",
)
.summary();
/// Note for studies without held-out groups and folds: the test rows from which the intervals in `summary.csv` are computed.
pub(crate) const OVER_TRIAL: &str =
    "Intervals are 95 % Wilson intervals at the test decisions of one trial.";
/// Note for studies with folds but without held-out groups: the test rows from which the intervals in `summary.csv` are computed.
pub(crate) const OVER_FOLDS: &str =
    "Intervals are 95 % Wilson intervals at the test decisions of all folds, each touch once.";
pub(crate) const CONFUSION: File<Confusion> =
    File::new("confusion.csv", "Confusion matrix", "").summary();
const COMPARISON: File<Comparison> = File::new(
    "comparison.csv",
    "Configurations against the best of their condition",
    "A t-test paired over trials, corrected for their overlap; Holm's p-value is also corrected for the number of configurations.",
)
.summary();
const TIMING: File<(Configuration, TrialTime)> =
    File::new("timing.csv", "Times of every trial", "").of_times();
const PARETO: File<(Configuration, Pareto)> =
    File::new("pareto.csv", "Accuracy and its cost", "").of_times();
const STAGES: File<StageTime> = File::new("stages.csv", "Times of the stages", "").of_times();
const CONFUSED: File<Confused> = File::new(
    "confused.csv",
    "Most frequent confusions",
    "The pairs of objects that the best configuration confuses most often in all trials.",
)
.summary();
const PUBLISHED: File<(Configuration, Published)> = File::new(
    "published.csv",
    "Published accuracies",
    "Ours: for each condition, the most accurate configuration with the settings of the claim.",
)
.summary();
const VARIANCE: File<Variance> =
    File::new("variance.csv", "Sources of the variance between trials", "").summary();
/// Name of the table of selected taxels.
pub(crate) const SELECTED_TAXELS: &str = "selected.csv";

const SELECTED: File<(Configuration, SelectedTaxel)> = File::new(
    SELECTED_TAXELS,
    "Selected taxels of the first trial",
    "Taxels are selected on training touches alone. If configurations have equal measurements, only the first one is listed.",
)
.summary();
const RECALL: File<Recall> = File::new("recall.csv", "Recall of each object", "").summary();
const PREDICTIONS: File<Prediction> = File::new(
    "predictions.csv",
    "Every decision",
    "One column score_CLASS for each class follows. Classifiers with probabilities have their natural logarithms, others the value that decides.",
);
const LIMITS: File<Limit> = File::new(LIMITS_FILE, "How often limits were reached", "").summary();

/// Table files that every recognition study writes. Tables of configurations also have the columns of the axes in `[axes]`.
pub const TABLES: &[&dyn AnyFile] = &[
    &ACCURACY,
    &SUMMARY,
    &CONFUSION,
    &COMPARISON,
    &TIMING,
    &PARETO,
    &STAGES,
    &CONFUSED,
    &PUBLISHED,
    &LIMITS,
];

/// Table files of studies that have several projections per split, sweep a condition, select taxels, or ask for recall or predictions.
pub const TABLES_OF_PARTS: &[&dyn AnyFile] =
    &[&VARIANCE, &ROBUSTNESS, &SELECTED, &RECALL, &PREDICTIONS];

/// Returns all tables of a run in the order of their files, followed by [`CONFIGURATIONS`].
///
/// # Errors
/// If a row cannot be written to a file.
pub fn tables_of(tables: &Tables) -> Result<Vec<Table>> {
    let first = tables.accuracy.first();
    let axes = first.map_or_else(Vec::new, |(configuration, _)| {
        configuration.variant.values.to_vec()
    });
    let axes = axes.into_iter().map(|axis| axis.column.clone().optional());
    From::Rows(tables).all(axes.collect(), tables.has_folds)
}

/// Reads all tables of a result folder in the order of their files. The last table is [`CONFIGURATIONS`].
///
/// # Errors
/// If a table cannot be read; the error names its file, line and column.
pub fn read_tables(folder: &Path) -> Result<Vec<Table>> {
    let study = folder.join("study.toml");
    let text = crate::files::read_to_string(&study).unwrap_or_default();
    let study = StudySpec::parse(&study.display().to_string(), &text);
    let has_folds = study
        .as_ref()
        .is_ok_and(|study| study.recognition.folds.is_some());
    let axes = study.map_or_else(|_| Vec::new(), |study| study.axis_columns());
    let axes = axes.into_iter().map(Column::optional).collect();
    From::Folder(folder).all(axes, has_folds)
}

/// Source of the table rows: the results of a run, or the files of a result folder.
enum From<'a> {
    Rows(&'a Tables),
    Folder(&'a Path),
}

impl From<'_> {
    /// Returns all tables. Tables of configurations have one column for each axis in the table `[axes]` of the study.
    fn all(&self, axes: Vec<Column>, has_folds: bool) -> Result<Vec<Table>> {
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
        // Tables that only some studies have.
        tables.extend(self.filled(&VARIANCE, |tables| &tables.variance, &[])?);
        tables.extend(self.filled(&SELECTED, |tables| &tables.selected, &axes)?);
        tables.extend(self.filled(&RECALL, |tables| &tables.recall, &[])?);
        let name = PREDICTIONS.name();
        match self {
            Self::Rows(rows) if !rows.predictions.rows.is_empty() => {
                tables.push(predictions(Path::new(name), csv_of(&rows.predictions)?)?);
            }
            Self::Folder(folder) if has_table(folder, name) => {
                let path = folder.join(name);
                let csv = crate::files::read(&path);
                let a_table = "a table that bubbletouch run wrote";
                let csv = csv.map_err(|e| Error::unreadable(&path, a_table, e))?;
                tables.push(predictions(&path, csv)?);
            }
            _ => {}
        }
        tables.push(self.table(&LIMITS, |tables| &tables.limits, &[])?);
        tables.iter_mut().for_each(say);
        for table in &mut tables {
            if table.file == SUMMARY.name() {
                table.note += " ";
                table.note += if has_folds { OVER_FOLDS } else { OVER_TRIAL };
            }
            if let Some(note) = note_of_groups(table) {
                table.note = note;
            }
            if let Some(note) = note_of_few_trials(table) {
                table.note += &note;
            }
        }
        let of = |file: &str| tables.iter().find(|table| table.file == file);
        if let (Some(summary), Some(confusion)) = (of(SUMMARY.name()), of(CONFUSION.name())) {
            let read = match self {
                Self::Rows(_) => None,
                Self::Folder(folder) => ROBUSTNESS.read_if_there(folder)?,
            };
            // Folders of earlier versions lack the table.
            let robustness = match read {
                None => robustness(summary, confusion)?,
                read => read,
            };
            tables.extend(robustness);
        }
        let configurations = cells_of(&tables).map(with_changes);
        tables.extend(configurations);
        Ok(tables)
    }

    /// Returns a table that only some studies have; `None` if it has no rows or no file.
    fn filled<R: Columns + Serialize>(
        &self,
        file: &File<R>,
        rows: fn(&Tables) -> &Vec<R>,
        axes: &[Column],
    ) -> Result<Option<Table>> {
        let is_there = match self {
            Self::Rows(tables) => !rows(tables).is_empty(),
            Self::Folder(folder) => has_table(folder, file.name()),
        };
        is_there.then(|| self.table(file, rows, axes)).transpose()
    }

    fn table<R: Columns + Serialize>(
        &self,
        file: &File<R>,
        rows: fn(&Tables) -> &Vec<R>,
        axes: &[Column],
    ) -> Result<Table> {
        let mut columns = R::columns();
        let behind = Configuration::columns().len().min(columns.len());
        columns.splice(behind..behind, axes.iter().cloned());
        match self {
            Self::Rows(tables) => file.of_columns(columns, rows(tables)),
            Self::Folder(folder) => file.read_columns(columns, folder),
        }
    }
}

/// Start of the names of the columns of scores, before the name of the class.
const SCORE: &str = "score_";

/// Returns the content of `predictions.csv`.
fn csv_of(predictions: &Predictions) -> Result<Vec<u8>> {
    let write = || -> std::result::Result<Vec<u8>, csv::Error> {
        let mut writer = csv::WriterBuilder::new()
            .has_headers(false)
            .from_writer(Vec::new());
        let columns = Prediction::columns()
            .into_iter()
            .map(|column| column.name.to_string());
        let scores = predictions
            .classes
            .iter()
            .map(|class| format!("{SCORE}{class}"));
        writer.write_record(columns.chain(scores))?;
        for (row, scores) in &predictions.rows {
            let scores: Vec<Option<f64>> = scores
                .iter()
                .map(|&s| Some(s).filter(|s| !s.is_nan()))
                .collect();
            writer.serialize((row, scores))?;
        }
        writer
            .into_inner()
            .map_err(|error| error.into_error().into())
    };
    write().map_err(|e| Error::io(PREDICTIONS.name(), "write", std::io::Error::other(e)))
}

/// Returns the table of predictions for the content of its file. The header names the classes.
fn predictions(path: &Path, csv: Vec<u8>) -> Result<Table> {
    let mut columns = Prediction::columns();
    let mut reader = csv::Reader::from_reader(&csv[..]);
    let header = reader.headers().cloned().unwrap_or_default();
    let scores = header
        .iter()
        .filter_map(|name| Some((name, name.strip_prefix(SCORE)?)));
    columns.extend(scores.map(|(name, class)| {
        let words = format!("score of {class}");
        Column::new(name.to_owned(), Role::Note, words, "", Scale::Linear)
    }));
    PREDICTIONS.parse(columns, path, csv)
}

/// Sets the unit of the noise column, which depends on the rows of the table.
pub(crate) fn set_noise_unit(table: &mut Table) {
    let unit = match (table.n_rows > 0).then(|| table.word("noise_unit", 0)) {
        Some("mm") => "mm",
        Some("n") => "N",
        _ => return,
    };
    let noise = table
        .columns
        .iter_mut()
        .find(|column| column.name == "noise_std");
    if let Some(column) = noise {
        (column.unit, column.scale) = (unit.into(), Scale::Linear);
    }
}

/// Sets the unit of the noise column and the meaning of an empty C, which depend on the rows of the table.
fn say(table: &mut Table) {
    set_noise_unit(table);
    let has_c = |row| {
        let kind = toml::Value::from(table.word("classifier", row)).try_into();
        kind.is_ok_and(ClassifierKind::has_c)
    };
    // C is chosen if the classifier has a C and the column is empty.
    let is_chosen = |row| !table.number("c", row).is_nan() || has_c(row);
    let is_chosen = (0..table.n_rows).all(is_chosen);
    let c = table.columns.iter_mut().find(|column| column.name == "c");
    c.filter(|_| !is_chosen)
        .into_iter()
        .for_each(|c| c.names = &[]);
}

/// Returns a note that intervals are computed over held-out groups; `None` if single test rows are held out.
pub(crate) fn note_of_groups(table: &Table) -> Option<String> {
    let n_groups = table.numbers("n_groups")?;
    let least = n_groups.iter().copied().fold(f64::INFINITY, f64::min);
    let few = match least < FEW_GROUPS as f64 {
        true => format!("; some come from {least}: fewer than {FEW_GROUPS} groups say little"),
        false => format!(", at least {least}"),
    };
    Some(format!(
        "Intervals are 95 % intervals from the groups that are held out, not from single test decisions{few}."
    ))
}

/// Returns a note on the actual coverage of the bootstrap intervals; `None` if the coverage is 95 %.
fn note_of_few_trials(table: &Table) -> Option<String> {
    let low = table.numbers("bootstrap_low")?;
    let n_trials = table.numbers("n_trials")?.iter().zip(low);
    let n_trials = n_trials.filter(|(_, low)| low.is_finite());
    let fewest = n_trials.map(|(&n, _)| n as usize).min()?;
    let coverage = coverage_of_95(fewest).filter(|&coverage| coverage < CONFIDENCE)?;
    let percent = (100.0 * coverage).round();
    Some(format!(
        " Bootstrap intervals are nominally of 95 %, about {percent} % with {fewest} trials."
    ))
}

/// Name of the column in [`CONFIGURATIONS`] that contains the chance level. The column is present only if configurations differ in it.
pub(crate) const CHANCE: &str = "chance";

/// Returns the column of chance levels, one per configuration. Returns `None` if all configurations have equal levels, or if a confusion matrix is not
/// stored.
fn chance_of_cells(summary: &Table, confusion: &Table) -> Option<(Column, Data)> {
    let chances = ChanceLevels::new(confusion);
    let chance = (0..summary.n_rows).map(|row| {
        let own = chances.own(summary.number("configuration", row));
        own.map(|chance| chance.accuracy)
    });
    let chance = Data::Numbers(chance.collect::<Option<_>>()?);
    let role = Role::Value(Better::Neither);
    let column = Column::new(CHANCE, role, "chance", "", Scale::Share);
    chance.varies(0..summary.n_rows).then_some((column, chance))
}

/// Returns a table with one row per configuration: its results, its difference to the best configuration under the same condition, and its costs.
fn cells_of(tables: &[Table]) -> Option<Table> {
    let of = |file: &str| tables.iter().find(|table| table.file == file);
    let summary = of(SUMMARY.name())?;
    let found = |table: &Table, column| summary.look_up(table, "configuration", column);
    let (comparison, pareto) = (of(COMPARISON.name())?, of(PARETO.name())?);
    let product = |name: &'static str, words: &'static str, factors: &[&str]| {
        let numbers = |row| factors.iter().map(move |name| summary.number(name, row));
        let products = (0..summary.n_rows).map(|row| numbers(row).product());
        let column = Column::new(name, Role::Cost, words, "", Scale::Log);
        Some((column, Data::Numbers(products.collect())))
    };
    let more = [
        found(comparison, "difference").map(|(column, data)| {
            let column = Column {
                role: Role::Value(Better::Neither),
                interval: None,
                ..column
            };
            (column, data)
        }),
        found(comparison, "p_holm"),
        found(comparison, "p_status"),
        found(pareto, "fit_s"),
        found(pareto, "predict_us_per_decision"),
        product(
            "measurements_per_decision",
            "measurements a decision",
            &["measurements", "frames", "touches_per_decision"],
        ),
        product("taxels", "taxels", &["nx", "ny"]),
        chance_of_cells(summary, of(CONFUSION.name())?),
    ];
    let note = "All that is known of each configuration, from summary.csv, comparison.csv and pareto.csv. Costs of time are of this machine.";
    Some(
        summary
            .with(
                (CONFIGURATIONS, "All configurations"),
                more.into_iter().flatten(),
            )
            .noted(note),
    )
}

/// Name of the column in [`CONFIGURATIONS`] with the one setting that a row changes; present only if single settings are changed.
pub(crate) const CHANGED: &str = "changed";
/// Text of [`CHANGED`] in rows that change no setting.
pub(crate) const UNCHANGED: &str = "unchanged";
/// Name of the column in [`CONFIGURATIONS`] with the value of the changed setting.
pub(crate) const CHANGED_TO: &str = "changed_to";

/// Returns the table of configurations. If single settings are changed, two columns name the changed setting and its value. The settings are in descending order
/// of the accuracy that they cost at most.
fn with_changes(table: Table) -> Table {
    let mut alone = Swept::of(&table).one_at_a_time;
    if alone.is_empty() {
        return table;
    }
    let rows = table.all_rows();
    let least = |one: &Setting| {
        let own = rows.iter().filter(|&&row| one.varies(&[0, row]));
        let accuracy = own.map(|&row| table.number("accuracy", row));
        accuracy.fold(f64::INFINITY, f64::min)
    };
    alone.sort_by(|a, b| least(a).total_cmp(&least(b)));
    let change = |row: usize| alone.iter().position(|one| one.varies(&[0, row]));
    let names = alone.iter().map(|one| one.column.words.to_string());
    let codes = rows
        .iter()
        .map(|&row| change(row).map_or(0, |place| 1 + place as u32));
    let names = Data::Words {
        levels: [UNCHANGED.to_owned()].into_iter().chain(names).collect(),
        codes: codes.collect(),
    };
    let label =
        |&row: &usize| change(row).map_or_else(String::new, |place| alone[place].label(row));
    let values = Data::Words {
        levels: rows.iter().map(label).collect(),
        codes: (0..table.n_rows as u32).collect(),
    };
    let column = |name: &'static str, words: &'static str| {
        Column::new(name, Role::Note, words, "", Scale::Words)
    };
    let changes = [
        (column(CHANGED, "changed setting"), names),
        (column(CHANGED_TO, "changed to"), values),
    ];
    let changed = table.with((table.file, table.title), changes);
    changed.noted(table.note.clone())
}
