//! Reader of CSV tables with one row per line. Semicolons, tabs and spaces are also accepted as separators, and one header line is allowed.

use crate::error::{Error, Result};
use crate::inputs::arrays::file_array::{ElementKind, Elements, FileArray};
use std::path::Path;

/// Reads a CSV table as numbers or, if an entry is not a number, as texts. An empty entry among numbers is NaN. The first line is a header if an entry is not a
/// number and the other lines contain numbers. A column without a name contains row numbers and is skipped.
///
/// # Errors
/// If the file cannot be read, is empty, or its lines differ in the number of entries.
pub fn read(path: &Path) -> Result<FileArray> {
    let place = path.display().to_string();
    let text = crate::files::read(path).map_err(|e| Error::io(path, "read", e))?;
    let text = String::from_utf8(text)
        .map_err(|_| Error::input(&place, "a text that is not UTF-8", "a .csv file in UTF-8"))?;
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = text.lines().enumerate();
    let is_data = |line: &str| !line.trim().is_empty() && !line.starts_with('#');
    let Some((_, first)) = lines.find(|(_, line)| is_data(line)) else {
        return Err(Error::input(place, "an empty file", "rows of numbers"));
    };
    let separator = [',', ';', '\t'].into_iter().find(|s| first.contains(*s));
    let mut rows: Vec<(usize, Vec<String>)> = Vec::new();
    for (number, line) in text.lines().enumerate().filter(|(_, line)| is_data(line)) {
        let cells = match separator {
            None => numbers_or_text(line),
            Some(separator) => cells(line, separator),
        };
        if let Some((first, known)) = rows.first()
            && known.len() != cells.len()
        {
            let place = format!("{place}, line {}", number + 1);
            let allowed = format!("{}, as line {} has", known.len(), first + 1);
            return Err(Error::input(
                place,
                format!("{} values", cells.len()),
                allowed,
            ));
        }
        rows.push((number, cells));
    }
    let is_number = |cell: &String| cell.is_empty() || cell.parse::<f64>().is_ok();
    let are_numbers =
        |rows: &[(usize, Vec<String>)]| rows.iter().all(|(_, cells)| cells.iter().all(is_number));
    let are_all_numbers = are_numbers(&rows[1..]) && (rows.len() > 1 || are_numbers(&rows));
    let mut n_columns = rows[0].1.len();
    if are_all_numbers && !rows[0].1.iter().all(is_number) {
        let names = rows.remove(0).1;
        let is_unnamed = names[0].is_empty() && n_columns > 1;
        if is_unnamed {
            n_columns -= 1;
            rows.iter_mut().for_each(|(_, cells)| drop(cells.remove(0)));
        }
    }
    let shape = vec![rows.len(), n_columns];
    let cells = rows.into_iter().flat_map(|(_, cells)| cells);
    if !are_all_numbers {
        return Ok(FileArray {
            place,
            shape,
            kind: ElementKind::Text,
            elements: Elements::Texts(cells.collect()),
        });
    }
    let mut is_whole = true;
    let numbers = cells.map(|cell| {
        is_whole &= cell.parse::<i64>().is_ok();
        cell.parse().unwrap_or(f64::NAN)
    });
    let numbers = numbers.collect();
    Ok(FileArray {
        place,
        shape,
        kind: match is_whole {
            true => ElementKind::Integer,
            false => ElementKind::Float(f64::EPSILON),
        },
        elements: Elements::Numbers(numbers),
    })
}

/// Returns the numbers in a line of numbers separated by spaces; returns any other line as one text.
fn numbers_or_text(line: &str) -> Vec<String> {
    let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
    match words.iter().all(|word| word.parse::<f64>().is_ok()) {
        true => words,
        false => vec![line.trim().trim_matches('"').to_owned()],
    }
}

/// Splits a line of a CSV file at the separator; returns the entries without their quotes.
fn cells(line: &str, separator: char) -> Vec<String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(separator as u8)
        .from_reader(line.as_bytes());
    let record = reader.records().next().and_then(std::result::Result::ok);
    let record = record.unwrap_or_default();
    record.iter().map(|cell| cell.trim().to_owned()).collect()
}
