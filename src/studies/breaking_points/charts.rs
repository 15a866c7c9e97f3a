//! What is charted and said: accuracy along each way, and where it is half of its best.

use crate::studies::breaking_points::plan::PlannedWay;
use crate::studies::breaking_points::scale::WayScale;
use crate::studies::breaking_points::spec::{DrivenTouches, WaySpec};
use crate::studies::breaking_points::study::BreakingPointsStudy;
use crate::table::{Along, ChartSpec, Column, Role, Rule, Scale, Shown, Table, short_number};

impl BreakingPointsStudy {
    /// A chart a way.
    pub(crate) fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let breaks = &tables[2];
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
            let of_way = of_way(breaks, way);
            let chance = of_way.first().map(|&row| breaks.number("chance", row));
            let chance = chance.map(|chance| Rule::at(Along::Y, chance, "chance"));
            let halves = of_way.iter().filter_map(|&row| {
                let classifier = breaks.words("classifier", row);
                let words = format!("{classifier}: half of its best at {}", place(breaks, row)?);
                Some(Rule::at(Along::X, breaks.number("breaks_at", row), words))
            });
            let (name, label) = (way.name.clone(), way.label.clone());
            let title = format!("Accuracy by {label}");
            ChartSpec {
                note: touches.to_owned(),
                shown: vec![Shown {
                    column: "way".to_owned(),
                    value: way.name.as_str().into(),
                }],
                x_is: Some(Column::new("value", Role::Note, label, "", scale)),
                lines: vec!["classifier".to_owned()],
                rules: chance.into_iter().chain(halves).collect(),
                ..tables[1].chart(name, title, ("accuracy", "value"))
            }
        };
        self.plan.ways.iter().map(chart).collect()
    }

    /// How many settings break recognition, where each does, and which do not.
    pub(crate) fn answers(&self, tables: &[Table]) -> Vec<String> {
        let breaks = &tables[2];
        let place_of = |row: usize| {
            let classifier = breaks.words("classifier", row);
            Some(format!("{} ({classifier})", place(breaks, row)?))
        };
        let (mut said, mut unbroken) = (vec![String::new()], Vec::new());
        for PlannedWay { spec: way, .. } in &self.plan.ways {
            let rows = of_way(breaks, way).into_iter();
            let places: Vec<String> = rows.filter_map(place_of).collect();
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

/// The rows of a way among those of all breaking points.
fn of_way(breaks: &Table, way: &WaySpec) -> Vec<usize> {
    let rows = 0..breaks.n_rows;
    rows.filter(|&row| breaks.word("way", row) == way.name)
        .collect()
}

/// Where it is half of its best, with the interval: `0.53 (0.48 to 0.6)`; none if it does not break.
fn place(breaks: &Table, row: usize) -> Option<String> {
    let number = |column| Some(breaks.number(column, row)).filter(|place| !place.is_nan());
    let end = |column| number(column).map_or("beyond".to_owned(), three_digits);
    let at = three_digits(number("breaks_at")?);
    let (low, high) = (end("breaks_at_low"), end("breaks_at_high"));
    Some(format!("{at} ({low} to {high})"))
}

/// Interpolated places have no more.
fn three_digits(value: f64) -> String {
    let digits = 10f64.powi(2 - value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32);
    short_number((value * digits).round() / digits)
}
