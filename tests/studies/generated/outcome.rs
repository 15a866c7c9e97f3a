//! Tables of a study as rows of text.

use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::report::folder::table_files;
use bubbletouch::studies::recognition::charts::tables_of;
use bubbletouch::study::progress::Silent;
use std::collections::BTreeMap;

/// Row of a table: the text of each column.
pub type Row = BTreeMap<String, String>;

/// Content of tables by file name.
pub type Tables = BTreeMap<String, Vec<u8>>;

/// Files of times, which differ between runs.
const TIMES: [&str; 3] = ["timing.csv", "pareto.csv", "stages.csv"];

/// Returns the tables without times.
pub fn without_times(mut tables: Tables) -> Tables {
    tables.retain(|name, _| !TIMES.contains(&&name[..]));
    tables
}

/// Runs a study in memory; returns its tables by file name, or an error if the run refuses it.
pub fn run(study: &RecognitionStudy) -> bubbletouch::Result<Tables> {
    let files = table_files(&tables_of(&study.run(&Silent)?)?);
    Ok(files.into_iter().collect())
}

/// Returns the rows of a CSV file.
pub fn rows(csv: &[u8]) -> Vec<Row> {
    let mut reader = csv::Reader::from_reader(csv);
    let rows = reader.deserialize();
    rows.map(Result::unwrap).collect()
}

/// Returns rows without some columns, sorted.
pub fn sorted_without(rows: Vec<Row>, columns: &[&str]) -> Vec<Row> {
    let mut rows: Vec<Row> = rows
        .into_iter()
        .map(|mut row| {
            row.retain(|column, _| !columns.contains(&column.as_str()));
            row
        })
        .collect();
    rows.sort();
    rows
}
