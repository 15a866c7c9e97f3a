//! Report on the differences between two result folders, as text and as a page.

use super::changes::{ChangedColumn, ComparedTable, changes};
use super::differences::Difference;
use super::rank_agreement::RankAgreement;
use crate::engine::program::PROGRAM;
use crate::error::Result;
use crate::report::chart::Chart;
use crate::report::page::StudyAbout;
use crate::report::study_folder::Found;
use crate::report::study_folder::{Beyond, files_with, words_of};
use crate::spelling::counted;
use crate::table::{Along, At, File, Mark, Role, Rule, Table};

const TABLES: File<ComparedTable> = File::new("tables.csv", "Rows of both runs", "");
const CHANGES: File<ChangedColumn> = File::new("changes.csv", "Columns that differ", "");
const VALUES: File<Difference> = File::new("differences.csv", "Values of both runs", "");
const COSTS: File<Difference> = File::new("costs.csv", "Costs of both runs", "");

/// Chart of a column: values of the second run against values of the first run.
const CHART: Chart = Chart {
    table: VALUES.name(),
    name: "{table}_{column}",
    title: "{column} in both runs",
    note: "{note} Up: second. Across: first. Each point is a setting.",
    each: &["table", "column"],
    x: "first",
    y: "second",
    lines: &["significance"],
    mark: Mark::Points,
    square: true,
    rules: &[Rule::constant(
        Along::Y,
        At::Column("first"),
        "no difference",
    )],
    ..Chart::LINES
};

/// Comparison of two result folders.
pub struct Comparison {
    /// Differences of means over common trials; empty if no row of the one has all settings of a row of the other.
    pub differences: Vec<Difference>,
    ranks: Option<RankAgreement>,
    /// Tables of the rows, the changed columns, the values and the costs.
    tables: [Table; 4],
}

impl Comparison {
    /// Compares the tables of two result folders, given their differences of means and the agreement of their rankings.
    ///
    /// # Errors
    /// If rows cannot be serialised as CSV.
    pub fn new(
        [first, second]: [&[Table]; 2],
        (differences, ranks): (Vec<Difference>, Option<RankAgreement>),
    ) -> Result<Self> {
        let is_cost = |row: &Difference| {
            let table = second.iter().find(|table| table.file == row.table);
            let column = table.and_then(|table| table.column(&row.column));
            column.is_some_and(|(column, _)| column.role == Role::Cost)
        };
        let of = |costs: bool| {
            let rows = differences.iter().filter(|row| is_cost(row) == costs);
            most_significant_first(rows.cloned().collect())
        };
        let (compared, changed) = changes(first, second);
        let tables = [
            TABLES.table(&compared)?,
            CHANGES.table(&changed)?,
            VALUES.table(&of(false))?,
            COSTS.table(&of(true))?,
        ];
        Ok(Self {
            differences,
            ranks,
            tables,
        })
    }

    /// Returns the answers and the tables except the costs as text, wrapped at `width` characters.
    pub fn text(&self, width: usize) -> String {
        let tables = self.tables[..3].iter().filter(|table| table.n_rows > 0);
        words_of(&tables.collect::<Vec<_>>(), &self.answers(), width)
    }

    /// Returns the HTML page with the charts and the tables.
    ///
    /// # Errors
    /// If a chart cannot be drawn.
    pub fn page(&self, [first, second]: [&str; 2]) -> Result<Vec<u8>> {
        let about = StudyAbout {
            name: format!("{first} and {second}"),
            program: PROGRAM.to_owned(),
            wall_s: f64::NAN,
            ..StudyAbout::default()
        };
        let note = format!("First: {first}; second: {second}.");
        let tables = self.tables.each_ref();
        let tables = tables.map(|table| table.clone().noted(&note));
        let found = Found {
            tables: &tables,
            charts: &CHART.specs(&tables),
            answers: &self.answers(),
        };
        // The page is the last file.
        let page = files_with(&about, &found, || Ok(Beyond::default()))?.pop();
        Ok(page.map_or_else(Vec::new, |(_, page)| page))
    }

    fn answers(&self) -> Vec<String> {
        let mut answers = vec![match self.tables[1].n_rows {
            0 => "All entries of the common rows are equal.".to_owned(),
            n => format!("{} differ.", counted(n, "column")),
        }];
        if self.differences.is_empty() {
            answers.push("No row of the one has all settings of a row of the other.".to_owned());
        }
        answers.extend(self.ranks.iter().flat_map(RankAgreement::words));
        answers
    }
}

/// Returns the rows ordered from the most to the least significant difference.
fn most_significant_first(mut rows: Vec<Difference>) -> Vec<Difference> {
    let p = |row: &Difference| row.p_holm.unwrap_or(1.0);
    let size = |row: &Difference| row.difference.abs() / row.first.abs().max(row.second.abs());
    rows.sort_by(|a, b| {
        let by_p = a
            .significance
            .cmp(&b.significance)
            .then(p(a).total_cmp(&p(b)));
        by_p.then(size(b).total_cmp(&size(a)))
    });
    rows
}
