//! What is charted: accuracy along each way, and where it is half of its best.

use super::answers::break_words;
use super::plan::PlannedWay;
use super::rows::BreakingPoint;
use super::scale::WayScale;
use super::spec::DrivenTouches;
use super::study::{BREAKS, SUMMARY};
use crate::kinds::rows_of;
use crate::table::{Along, At, ChartSpec, Column, Role, Rule, Scale, Shown, Table, Value};

/// A chart a way.
pub(super) fn charts(ways: &[PlannedWay], tables: &[Table]) -> Vec<ChartSpec> {
    let breaks: Vec<BreakingPoint> = rows_of(tables, BREAKS.name());
    let chart = |way: &PlannedWay| {
        let of_way = breaks.iter().filter(|row| row.way == way.spec.name);
        chart_of(way, &of_way.collect::<Vec<_>>())
    };
    ways.iter().map(chart).collect()
}

fn chart_of(PlannedWay { spec: way, .. }: &PlannedWay, breaks: &[&BreakingPoint]) -> ChartSpec {
    let touches = match way.touches {
        DrivenTouches::All => "Training and test touches have it alike.",
        DrivenTouches::Training => "Training touches have it; what is tested stays as it was.",
        DrivenTouches::Test => "Test touches have it; what is learned stays as it was.",
    };
    let scale = match way.scale {
        WayScale::Linear => Scale::Linear,
        WayScale::Logarithmic => Scale::Log,
    };
    let chance = breaks.first().map(|row| Rule {
        along: Along::Y,
        at: At::Value(row.chance),
        words: "chance".to_owned(),
    });
    let halves = breaks.iter().filter_map(|row| {
        let words = format!("{}: half of its best at", row.classifier.about().words);
        Some(Rule {
            along: Along::X,
            at: At::Value(row.breaks_at?),
            words: format!("{words} {}", break_words(row)?),
        })
    });
    ChartSpec {
        name: way.name.clone(),
        title: format!("Accuracy by {}", way.label),
        note: touches.to_owned(),
        table: SUMMARY.name(),
        shown: vec![Shown {
            column: "way".to_owned(),
            value: Value::Word(way.name.clone()),
        }],
        x: "value".to_owned(),
        x_is: Some(Column::new(
            "value",
            Role::Note,
            way.label.clone(),
            "",
            scale,
        )),
        y: "accuracy".to_owned(),
        lines: vec!["classifier".to_owned()],
        rules: chance.into_iter().chain(halves).collect(),
        ..ChartSpec::default()
    }
}
