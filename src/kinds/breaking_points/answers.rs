//! What was found, in sentences.

use super::plan::PlannedWay;
use super::rows::BreakingPoint;
use super::study::BREAKS;
use crate::kinds::rows_of;
use crate::table::{Table, short_number};

/// How many settings break recognition, where each does, and which do not.
pub(super) fn answers(ways: &[PlannedWay], tables: &[Table]) -> Vec<String> {
    let breaks: Vec<BreakingPoint> = rows_of(tables, BREAKS.name());
    let place = |row: &BreakingPoint| {
        Some(format!(
            "{} ({})",
            break_words(row)?,
            row.classifier.about().words
        ))
    };
    let (mut said, mut unbroken) = (Vec::new(), Vec::new());
    for PlannedWay { spec: way, .. } in ways {
        let rows = breaks.iter().filter(|row| row.way == way.name);
        let places: Vec<String> = rows.filter_map(place).collect();
        match places.is_empty() {
            true => unbroken.push(way.label.as_str()),
            false => said.push(format!(
                "{}: half of the best at {}.",
                way.label,
                places.join(", ")
            )),
        }
    }
    let first = format!(
        "{} of {} settings, driven to their ends, take a classifier to half of its best accuracy or below.",
        said.len(),
        ways.len()
    );
    said.insert(0, first);
    if !unbroken.is_empty() {
        said.push(format!("Nowhere: {}.", unbroken.join("; ")));
    }
    said
}

/// Where it is half of its best, with the interval: `0.53 (0.48 to 0.6)`; none if it does not break.
pub(super) fn break_words(row: &BreakingPoint) -> Option<String> {
    let end = |end: Option<f64>| end.map_or("beyond".to_owned(), three_digits);
    let (low, high) = (end(row.breaks_at_low), end(row.breaks_at_high));
    Some(format!(
        "{} ({low} to {high})",
        three_digits(row.breaks_at?)
    ))
}

/// Interpolated places have no more.
fn three_digits(value: f64) -> String {
    let digits = 10f64.powi(2 - value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32);
    short_number((value * digits).round() / digits)
}
