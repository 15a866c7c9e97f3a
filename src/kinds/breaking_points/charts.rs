//! What is charted and said: accuracy along each way, and where it is half of its best.

use super::plan::PlannedWay;
use super::rows::BreakingPoint;
use super::scale::WayScale;
use super::spec::DrivenTouches;
use super::study::{BREAKS, BreakingPointsStudy, SUMMARY};
use crate::kinds::{Findings, rows_of};
use crate::table::{Along, ChartSpec, Column, Role, Rule, Scale, Shown, Table, short_number};

impl Findings for BreakingPointsStudy {
    /// A chart a way.
    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let breaks: Vec<BreakingPoint> = rows_of(tables, BREAKS.name());
        let chart = |PlannedWay { spec: way, .. }: &PlannedWay| {
            let touches = match way.touches {
                DrivenTouches::All => "Training and test touches have it alike.",
                DrivenTouches::Training => {
                    "Training touches have it; what is tested stays as it was."
                }
                DrivenTouches::Test => "Test touches have it; what is learned stays as it was.",
            };
            let scale = match way.scale {
                WayScale::Linear => Scale::Linear,
                WayScale::Logarithmic => Scale::Log,
            };
            let of_way = || breaks.iter().filter(|row| row.way == way.name);
            let chance = of_way()
                .next()
                .map(|row| Rule::at(Along::Y, row.chance, "chance"));
            let halves = of_way().filter_map(|row| {
                let (classifier, place) = (row.classifier.about().words, break_words(row)?);
                let words = format!("{classifier}: half of its best at {place}");
                Some(Rule::at(Along::X, row.breaks_at?, words))
            });
            let label = way.label.clone();
            ChartSpec {
                name: way.name.clone(),
                title: format!("Accuracy by {label}"),
                note: touches.to_owned(),
                table: SUMMARY.name(),
                shown: vec![Shown {
                    column: "way".to_owned(),
                    value: way.name.as_str().into(),
                }],
                x: "value".to_owned(),
                x_is: Some(Column::new("value", Role::Note, label, "", scale)),
                y: "accuracy".to_owned(),
                lines: vec!["classifier".to_owned()],
                rules: chance.into_iter().chain(halves).collect(),
                ..ChartSpec::default()
            }
        };
        self.plan.ways.iter().map(chart).collect()
    }

    /// How many settings break recognition, where each does, and which do not.
    fn answers(&self, tables: &[Table]) -> Vec<String> {
        let breaks: Vec<BreakingPoint> = rows_of(tables, BREAKS.name());
        let place = |row: &BreakingPoint| {
            let words = row.classifier.about().words;
            Some(format!("{} ({words})", break_words(row)?))
        };
        let (mut said, mut unbroken) = (vec![String::new()], Vec::new());
        for PlannedWay { spec: way, .. } in &self.plan.ways {
            let rows = breaks.iter().filter(|row| row.way == way.name);
            let places: Vec<String> = rows.filter_map(place).collect();
            let (label, places) = (&way.label, places.join(", "));
            match places.is_empty() {
                true => unbroken.push(label.as_str()),
                false => said.push(format!("{label}: half of the best at {places}.")),
            }
        }
        said[0] = format!(
            "{} of {} settings, driven to their ends, take a classifier to half of its best accuracy or below.",
            said.len() - 1,
            self.plan.ways.len()
        );
        if !unbroken.is_empty() {
            said.push(format!("Nowhere: {}.", unbroken.join("; ")));
        }
        said
    }
}

/// Where it is half of its best, with the interval: `0.53 (0.48 to 0.6)`; none if it does not break.
fn break_words(row: &BreakingPoint) -> Option<String> {
    let end = |end: Option<f64>| end.map_or("beyond".to_owned(), three_digits);
    let (low, high) = (end(row.breaks_at_low), end(row.breaks_at_high));
    let at = three_digits(row.breaks_at?);
    Some(format!("{at} ({low} to {high})"))
}

/// Interpolated places have no more.
fn three_digits(value: f64) -> String {
    let digits = 10f64.powi(2 - value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32);
    short_number((value * digits).round() / digits)
}
