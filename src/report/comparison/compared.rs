//! Report on the differences between two result folders, as sentences, a table and a page.

use crate::engine::provenance::PROGRAM;
use crate::error::Result;
use crate::quantile::quantile;
use crate::report::differences::{ColumnDifferences, Difference, Significance};
use crate::report::entries::{ColumnEntries, TableEntries};
use crate::report::page::StudyAbout;
use crate::report::rank_agreement::RankAgreement;
use crate::report::study_content::Found;
use crate::report::study_folder::{Beyond, files_with};
use crate::report::terminal::{paragraph, table_text};
use crate::spelling::counted;
use crate::table::{
    Along, At, Better, ChartSpec, File, Mark, Role, Rule, Shown, Table, short_number,
};

const VALUES: File<Difference> = File::new("differences.csv", "Values of both runs", "");
const COSTS: File<Difference> = File::new("costs.csv", "Costs of both runs", "");

/// Returns the differences between two result folders as sentences and a table, wrapped at `width` characters. The most significant differences come first.
///
/// # Errors
/// If rows cannot be serialised as CSV.
pub fn differences_text(found: &[ColumnDifferences], width: usize) -> Result<String> {
    Ok(format!(
        "{}\n{}",
        sentences_text(&sentences(found), width),
        table_text(&values(found)?, width)
    ))
}

/// Returns one paragraph for each sentence, wrapped at `width` characters.
pub fn sentences_text(sentences: &[String], width: usize) -> String {
    let sentences = sentences.iter();
    sentences.map(|said| paragraph(said, width)).collect()
}

/// Returns the HTML page that compares two folders: the differences, and the agreement of the two rankings of designs.
///
/// # Errors
/// Returns the errors of [`differences_text`], or an error if a chart cannot be drawn.
pub fn differences_page(
    (found, ranks, entries): (&[ColumnDifferences], Option<&RankAgreement>, &[String]),
    (first, second): (&str, &str),
) -> Result<Vec<u8>> {
    let note =
        format!("First: {first}; second: {second}. The most significant differences come first.");
    let about = StudyAbout {
        name: format!("{first} and {second}"),
        program: PROGRAM.to_owned(),
        wall_s: f64::NAN,
        ..StudyAbout::default()
    };
    let values = values(found)?.noted(note);
    let charts = found.iter().filter(|one| !is_cost(one));
    let charts =
        charts.filter_map(|one| Some(chart(&values, one, one.rows.first()?, (first, second))));
    let charts: Vec<ChartSpec> = charts.collect();
    let costs = table(&COSTS, found.iter().filter(|one| is_cost(one)))?;
    let ranks = ranks.map_or_else(Vec::new, RankAgreement::words);
    let found = Found {
        tables: &[values, costs],
        charts: &charts,
        answers: &[sentences(found), entries.to_vec(), ranks].concat(),
    };
    // The page is the last file.
    let page = files_with(&about, &found, || Ok(Beyond::default()))?.pop();
    Ok(page.map_or_else(Vec::new, |(_, page)| page))
}

/// Returns a chart of one column: values of the second run against values of the first run.
fn chart(
    values: &Table,
    one: &ColumnDifferences,
    Difference { table, column, .. }: &Difference,
    (first, second): (&str, &str),
) -> ChartSpec {
    let shown = |column: &str, value: &str| Shown {
        column: column.to_owned(),
        value: value.into(),
    };
    let name = format!("{}_{column}", table.trim_end_matches(".csv"));
    let title = format!("{} in both runs", one.column.words);
    ChartSpec {
        note: format!("Up: {second}. Across: {first}. Each point is a setting of {table}."),
        shown: vec![shown("table", table), shown("column", column)],
        lines: vec!["significance".to_owned()],
        mark: Mark::Points,
        square: true,
        rules: vec![Rule {
            along: Along::Y,
            at: At::Column("first".to_owned()),
            words: "no difference".to_owned(),
        }],
        ..values.chart(name, title, ("second", "first"))
    }
}

fn is_cost(one: &ColumnDifferences) -> bool {
    one.column.role == Role::Cost
}

fn values(found: &[ColumnDifferences]) -> Result<Table> {
    table(&VALUES, found.iter().filter(|one| !is_cost(one)))
}

/// Returns the table of the differences in one column, ordered from the most to the least significant row.
fn table<'a>(
    file: &File<Difference>,
    columns: impl Iterator<Item = &'a ColumnDifferences>,
) -> Result<Table> {
    let rows = columns.flat_map(|column| column.rows.iter().cloned());
    let mut rows: Vec<Difference> = rows.collect();
    rows.sort_by(|a, b| {
        let p = |row: &Difference| row.p_holm.unwrap_or(1.0);
        let size = |row: &Difference| row.difference.abs() / row.first.abs().max(row.second.abs());
        let by_p = a
            .significance
            .cmp(&b.significance)
            .then(p(a).total_cmp(&p(b)));
        by_p.then(size(b).total_cmp(&size(a)))
    });
    file.table(&rows)
}

/// Returns sentences about the differences between two result folders: of values that changed, of other values, of costs, and the number of common settings of
/// each table.
fn sentences(found: &[ColumnDifferences]) -> Vec<String> {
    let mut said = Vec::new();
    let mut last = "";
    for one in found {
        let Some(Difference { table, .. }) = one.rows.first() else {
            continue;
        };
        // Columns of one table are adjacent in `found`.
        if std::mem::replace(&mut last, table) != table {
            let settings = format!(
                "{table}: {} settings are in both runs, {} in the first alone, {} in the second alone.",
                one.n_both, one.n_first_only, one.n_second_only
            );
            said.push((3, settings));
        }
        let is_equal = one.counts(|_| true) == [0, 0];
        said.push(match is_cost(one) {
            true => (2, cost_words(one)),
            false => (usize::from(is_equal), value_words(one)),
        });
    }
    said.sort_by_key(|(rank, _)| *rank);
    said.into_iter().map(|(_, words)| words).collect()
}

/// Returns sentences about all differences except differences of means: outcomes, numbers absent in one run, and other columns.
pub fn entries_words(found: &[ColumnDifferences], tables: &[TableEntries]) -> Vec<String> {
    let has_moved = |file: &str, column: &str| {
        let mut of_column = found.iter().filter(|one| one.column.name == column);
        of_column.any(|one| {
            let mut rows = one.rows.iter();
            rows.any(|row| row.table == file && row.difference != 0.0)
        })
    };
    // A table without trials has one row for each setting; the sentence about settings already counts these rows.
    let counts_rows = |table: &TableEntries| {
        found.iter().any(|one| {
            let is_of_table = one.rows.first().is_some_and(|row| row.table == table.file);
            let alone = [one.n_first_only, one.n_second_only];
            is_of_table && alone == [table.n_first_only, table.n_second_only]
        })
    };
    let said = tables.iter();
    let said = said.map(|table| table_words(table, counts_rows(table), has_moved));
    said.flatten().collect()
}

/// Returns sentences about the rows and entries of one table that differ. If another sentence counts the rows, `counts_rows` is true. For a column whose mean
/// another sentence reports, `has_moved` returns true.
fn table_words(
    table: &TableEntries,
    counts_rows: bool,
    has_moved: impl Fn(&str, &str) -> bool,
) -> Vec<String> {
    let file = table.file;
    let mut said = Vec::new();
    if table.n_first_only + table.n_second_only > 0 && !counts_rows {
        said.push(format!(
            "{file}: {} are in both runs, {} in the first alone, {} in the second alone.",
            counted(table.n_both, "row"),
            table.n_first_only,
            table.n_second_only
        ));
    }
    if !table.one_sided.is_empty() {
        let columns = table.one_sided.join(", ");
        said.push(format!("{file}: only one of the runs has {columns}."));
    }
    let mut others = Vec::new();
    for entries in &table.columns {
        let (name, words) = (&entries.column.name, &entries.column.words);
        if entries.column.role == Role::Outcome {
            said.push(outcome_words(file, entries));
            continue;
        }
        let [first, second] = [entries.n_first_only, entries.n_second_only];
        if first + second > 0 {
            said.push(format!(
                "{file}: {words}: {} a number in the first run alone, {second} in the second alone.",
                match first {
                    1 => "1 row has".to_owned(),
                    n => format!("{n} rows have"),
                }
            ));
        }
        if entries.n_changed() > first + second && !has_moved(file, name) {
            others.push(format!("{name} in {}", counted(entries.n_changed(), "row")));
        }
    }
    if !others.is_empty() {
        said.push(format!(
            "{file}: other columns that differ: {}.",
            others.join(", ")
        ));
    }
    said
}

/// Maximum number of changed outcomes that a sentence lists, such as `right` to `wrong`.
const MAX_CHANGES: usize = 8;

/// Returns a sentence about an outcome column, such as `stability.csv: outcome: 1279 the same, 226 changed (226 from right to not finite).`
fn outcome_words(file: &str, entries: &ColumnEntries) -> String {
    let listed = entries.changes.iter().take(MAX_CHANGES);
    let listed = listed.map(|(from, to, n)| format!("{n} from {from} to {to}"));
    let mut listed: Vec<String> = listed.collect();
    if entries.changes.len() > MAX_CHANGES {
        listed.push("and others".to_owned());
    }
    format!(
        "{file}: {}: {} the same, {} changed ({}).",
        entries.column.words,
        entries.n_same,
        entries.n_changed(),
        listed.join(", ")
    )
}

/// Returns a sentence about the differences in a cost column, such as `time to train: median 1.02 times that of the first run, 0.9 to 1.1 times.`
fn cost_words(one: &ColumnDifferences) -> String {
    // Equal costs may be zero, such as the spheres of a mesh.
    let ratio = |row: &Difference| match row.difference == 0.0 {
        true => 1.0,
        false => row.second / row.first,
    };
    let mut ratios: Vec<f64> = one.rows.iter().map(ratio).collect();
    let [middle, least, most] = [0.5, 0.0, 1.0].map(|q| short_number(quantile(&mut ratios, q)));
    let words = &one.column.words;
    let n_changed = one.rows.iter().filter(|row| row.difference != 0.0).count();
    // Ratios are rounded: a small change can round to 1.
    let small = match n_changed > 0 && [&middle, &least, &most].iter().all(|ratio| *ratio == "1") {
        true => format!(
            " {n_changed} of {} settings differ by less than that says.",
            one.rows.len()
        ),
        false => String::new(),
    };
    format!("{words}: median {middle} times that of the first run, {least} to {most} times.{small}")
}

/// Returns a sentence about the differences in a value column: the numbers of better and worse settings, and how many are significant.
fn value_words(one: &ColumnDifferences) -> String {
    let [more, less] = match one.column.role {
        Role::Value(Better::Neither) => ["larger", "smaller"],
        _ => ["better", "worse"],
    };
    let [better, worse] = one.counts(|_| true);
    let is_significant = |row: &Difference| row.significance == Significance::Significant;
    let [surely_better, surely_worse] = one.counts(is_significant);
    let is_tested = |row: &Difference| {
        let untested = [Significance::Untested, Significance::Same];
        row.p_holm.is_some() || !untested.contains(&row.significance)
    };
    let mut needed = one.rows.iter().filter_map(|row| row.n_trials_needed);
    let tested = if one.rows.iter().any(is_tested) {
        format!("more than chance explains: {surely_better} {more}, {surely_worse} {less}")
    } else if let Some(n) = needed.next() {
        format!("not tested: {n} trials are needed")
    } else {
        "not tested".to_owned()
    };
    let n_same = one.rows.len() - better - worse;
    format!(
        "{}: {n_same} the same, {better} {more} in the second, {worse} {less}; {tested}.",
        one.column.words
    )
}
