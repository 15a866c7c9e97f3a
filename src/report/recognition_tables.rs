//! The tables of a recognition study as files.

use crate::error::Result;
use crate::kinds::recognition::Outcome;
use crate::report::csv_tables::{LIMITS_FILE, VARIANCE_FILE};
use crate::report::study_tables::{StudyTables, TableFiles, table_file};

impl StudyTables for Outcome {
    const OF_PIECES: &'static [&'static str] = &["accuracy.csv"];
    const OF_ALL: &'static [&'static str] = &[
        "summary.csv",
        "confusion.csv",
        "comparison.csv",
        "confused.csv",
        "published.csv",
        VARIANCE_FILE,
        LIMITS_FILE,
    ];

    fn files(&self) -> Result<TableFiles> {
        let tables = &self.tables;
        let mut files = vec![
            table_file("accuracy.csv", &tables.accuracy)?,
            table_file("summary.csv", &tables.summary)?,
            table_file("confusion.csv", &tables.confusion)?,
            table_file("comparison.csv", &tables.comparison)?,
            table_file("timing.csv", &tables.timing)?,
            table_file("pareto.csv", &tables.pareto)?,
            table_file("stages.csv", &tables.stages)?,
            table_file("confused.csv", &tables.confused)?,
            table_file("published.csv", &tables.published)?,
            table_file(LIMITS_FILE, &self.limits)?,
        ];
        if !tables.variance.is_empty() {
            files.push(table_file(VARIANCE_FILE, &tables.variance)?);
        }
        Ok(files)
    }
}
