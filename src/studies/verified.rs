//! Comparison of recomputed work items with the rows of a result folder.

use crate::error::{Error, Result};
use crate::table::Table;
use std::collections::BTreeSet;
use std::path::Path;

/// Compares recomputed table rows with the rows of a result folder; returns the number of equal rows, without tables of computing times. If `is_whole` is set,
/// all work items were recomputed; missing rows, additional rows and different summaries are then also errors.
///
/// # Errors
/// If a row differs; the error names file and line.
pub fn same_rows(folder: &Path, again: &[Table], is_whole: bool) -> Result<usize> {
    let mut n_rows = 0;
    let of_items = again
        .iter()
        .filter(|table| table.repeats && !table.csv.is_empty());
    for table in of_items.filter(|table| is_whole || !table.is_summary) {
        let path = folder.join(table.file);
        let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, "read", e))?;
        let content = String::from_utf8_lossy(&table.csv);
        let header = content.lines().next().unwrap_or_default();
        let same_columns = match is_whole || text.lines().next() == Some(header) {
            true => None,
            false => columns_of(&text, header),
        };
        let lines = same_columns.as_deref().unwrap_or(&text).lines();
        let stands: BTreeSet<&str> = lines.clone().collect();
        for row in content.lines().skip(1) {
            if !stands.contains(row) {
                let nearest = lines.zip(1..).max_by_key(|(other, _)| n_alike(row, other));
                let (nearest, line) = nearest.unwrap_or(("(none)", 1));
                return Err(Error::input(
                    format!("{}:{line}", path.display()),
                    format!("has the row\n  {nearest}"),
                    format!("\n  again it is\n  {row}"),
                ));
            }
            n_rows += 1;
        }
        if is_whole && content != text {
            let given = "differs from the table that all work items give";
            let allowed = "the rows of one run, each once, in their order";
            return Err(Error::input(path.display(), given, allowed));
        }
    }
    Ok(n_rows)
}

/// Returns a table with only the columns of `header`; `None` if the table lacks one of them. The restriction is needed because some columns exist only if a row
/// has a value. For example, a table without groups has no column of group counts.
fn columns_of(text: &str, header: &str) -> Option<String> {
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.has_headers(false).from_reader(text.as_bytes());
    let mut rows = reader.records();
    let names = rows.next()?.ok()?;
    let places = header
        .split(',')
        .map(|column| names.iter().position(|name| name == column));
    let places: Vec<usize> = places.collect::<Option<_>>()?;
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header.split(',')).ok()?;
    for row in rows {
        let row = row.ok()?;
        writer
            .write_record(places.iter().filter_map(|&place| row.get(place)))
            .ok()?;
    }
    String::from_utf8(writer.into_inner().ok()?).ok()
}

/// Returns the number of equal bytes at the start of two rows. Rows begin with their configuration, so similar configurations have long equal starts.
fn n_alike(a: &str, b: &str) -> usize {
    let pairs = a.bytes().zip(b.bytes());
    pairs.take_while(|(a, b)| a == b).count()
}
