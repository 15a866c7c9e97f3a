//! What is charted: what each choice costs and gives, with the fronts.

use super::study::{CHAINS, CONTACT};
use crate::table::{ChartSpec, Mark, Table};

/// A chart of contact, of decisions and of trainings: of those parts that there are.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let chart = |name: &str, (table, x, y): (&'static str, &str, &str)| ChartSpec {
        name: format!("speed_accuracy_{name}"),
        table,
        x: x.to_owned(),
        y: y.to_owned(),
        mark: Mark::Points,
        front: true,
        ..ChartSpec::default()
    };
    let contact = ChartSpec {
        title: "Contact: error of the deflections against the time of a touch".to_owned(),
        note: "Medians over objects. What is right says exact contact.".to_owned(),
        lines: vec!["way".to_owned()],
        panels: Some("touched".to_owned()),
        ..chart(
            "contact",
            (CONTACT.pareto.name(), "us_per_touch", "error_mm"),
        )
    };
    let decision = ChartSpec {
        title: "Recognition: accuracy against the time of a decision".to_owned(),
        note: "Press, noise, compression and answer of one touch, one thread; tested on the exact objects.".to_owned(),
        lines: vec!["classifier".to_owned()],
        ..chart("decision", (CHAINS.pareto.name(), "decision_us", "accuracy"))
    };
    let training = ChartSpec {
        title: "Recognition: accuracy against the time of a training".to_owned(),
        note: "One thread; tested on the exact objects.".to_owned(),
        lines: vec!["classifier".to_owned()],
        ..chart("training", (CHAINS.pareto.name(), "fit_s", "accuracy"))
    };
    let all = [contact, decision, training].into_iter();
    let is_there = |chart: &ChartSpec| {
        let table = tables.iter().find(|table| table.file == chart.table);
        table.is_some_and(|table| table.n_rows > 0)
    };
    all.filter(is_there).collect()
}
