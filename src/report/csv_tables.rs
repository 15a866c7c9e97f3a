//! Result tables as CSV, out and in.
//!
//! Floats are written in the shortest form that reads back as the same bits, so equal tables are equal bytes. An absent
//! value is an empty field. A table without rows has its header, but for columns that only some studies have.

use crate::error::{Error, Result};
use crate::report::folder::Folder;
use crate::report::recognition::tables_of;
use crate::study::table::{
    Cell, CellScore, Comparison, Confused, Confusion, Pareto, Published, StageTime, Tables,
    TrialScore, TrialTime, Variance,
};
use crate::study::{StudySpec, sha256};
use crate::table::Column;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

/// File names of the tables, in the order in which [`write_tables`] writes them.
pub const TABLE_FILES: [&str; 9] = [
    "accuracy.csv",
    "summary.csv",
    "confusion.csv",
    "comparison.csv",
    "timing.csv",
    "pareto.csv",
    "stages.csv",
    "confused.csv",
    "published.csv",
];

/// What failed, and why.
pub const FAILURES_FILE: &str = "failures.csv";

/// The table of variance components, of studies that have them.
pub const VARIANCE_FILE: &str = "variance.csv";
/// How often limits of the model were reached, beside the tables.
pub const LIMITS_FILE: &str = "limits.csv";

/// SHA-256 of tables by their files' names.
#[derive(Clone, Debug, Default)]
pub struct TableHashes {
    /// Of those without times: the same for the same study.
    pub repeatable: BTreeMap<String, String>,
    /// Of those with times, which no two runs share.
    pub times: BTreeMap<String, String>,
}

impl TableHashes {
    /// Of files, by the names of those that are the same for the same study.
    pub fn of<N: Into<String>>(
        files: impl IntoIterator<Item = (N, Vec<u8>)>,
        is_repeatable: impl Fn(&str) -> bool,
    ) -> Self {
        let mut hashes = Self::default();
        for (name, content) in files {
            let name = name.into();
            let known = match is_repeatable(&name) {
                true => &mut hashes.repeatable,
                false => &mut hashes.times,
            };
            known.insert(name, sha256(content));
        }
        hashes
    }
}

/// What is asked for where a table is missing.
const A_TABLE: &str = "a table of results as bubbletouch run writes it";

/// SHA-256 of a file as it stands there.
pub fn sha256_of(path: &Path) -> Result<String> {
    let content = std::fs::read(path).map_err(|e| Error::unreadable(path, A_TABLE, e))?;
    Ok(sha256(content))
}

/// Those of them that hold times, which no two runs share.
pub const TIME_TABLES: [&str; 3] = ["timing.csv", "pareto.csv", "stages.csv"];

/// Writes every table into `dir` (created if missing), each as a whole file; returns their paths.
///
/// # Errors
/// A row that has no form in a file; a file that cannot be written.
pub fn write_tables(dir: &Path, tables: &Tables) -> Result<Vec<PathBuf>> {
    Folder::of_tables(dir, &tables_of(tables, &[])?).write()
}

/// Reads the tables that [`write_tables`] wrote.
pub fn read_tables(dir: &Path) -> Result<Tables> {
    let path = |table: usize| dir.join(TABLE_FILES[table]);
    Ok(Tables {
        accuracy: read_cell_rows::<TrialScore>(&path(0))?,
        summary: read_cell_rows::<CellScore>(&path(1))?,
        confusion: read_rows::<Confusion>(&path(2))?,
        comparison: read_rows::<Comparison>(&path(3))?,
        timing: read_cell_rows::<TrialTime>(&path(4))?,
        pareto: read_cell_rows::<Pareto>(&path(5))?,
        stages: read_rows::<StageTime>(&path(6))?,
        confused: read_rows::<Confused>(&path(7))?,
        published: read_cell_rows::<Published>(&path(8))?,
        variance: match dir.join(VARIANCE_FILE) {
            path if path.exists() => read_rows::<Variance>(&path)?,
            _ => Vec::new(),
        },
    })
}

/// Reads a table whose rows are a [`Cell`] followed by `R`.
pub fn read_cell_rows<R: DeserializeOwned>(path: &Path) -> Result<Vec<(Cell, R)>> {
    // Each line is read once for either half: through one struct with two flattened halves, serde would take an empty field for an
    // empty text, not for an absent value. The columns that only some studies have are read by their names.
    let cells: Vec<Cell> = read_rows(path)?;
    let rest: Vec<R> = read_rows(path)?;
    let axes = axes_beside(path)?;
    let mut file = csv::Reader::from_path(path).map_err(|e| read_error(path, e))?;
    let header = file.headers().map_err(|e| read_error(path, e))?.clone();
    let rows = file.into_records().zip(cells.into_iter().zip(rest));
    let rows = rows.map(|(row, (cell, rest))| {
        let row = row.map_err(|e| read_error(path, e))?;
        let field = |name: &str| row.get(header.iter().position(|column| column == name)?);
        Ok((cell.with_row(&axes, field), rest))
    });
    rows.collect()
}

/// The columns of the axes of the study whose results stand in a folder; none where no study stands beside them.
pub(super) fn axes_beside(table: &Path) -> Result<Vec<Column>> {
    let path = table.with_file_name("study.toml");
    let Ok(text) = std::fs::read_to_string(&path) else {
        return Ok(Vec::new());
    };
    let study = StudySpec::parse(&path.display().to_string(), &text);
    Ok(study.map_or_else(|_| Vec::new(), |study| study.axis_columns()))
}

/// Reads a table; the error names the file and the line.
pub fn read_rows<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>> {
    let file = File::open(path).map_err(|e| Error::unreadable(path, A_TABLE, e))?;
    csv::Reader::from_reader(file)
        .into_deserialize()
        .map(|row| row.map_err(|e| read_error(path, e)))
        .collect()
}

fn read_error(path: &Path, error: csv::Error) -> Error {
    let line = error.position().map(|position| position.line());
    let place = match line {
        Some(line) => format!("{}: line {line}", path.display()),
        None => path.display().to_string(),
    };
    let said = error.to_string();
    match error.into_kind() {
        csv::ErrorKind::Io(source) => Error::unreadable(path, A_TABLE, source),
        _ => Error::input(place, said, "a result table with this version's columns"),
    }
}
