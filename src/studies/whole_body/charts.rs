//! Charts and answers of a whole-body study.

use crate::studies::prelude::*;
use crate::table::{Along, Rule, Shown, short_number};

/// Returns charts of the computing time per step. Some show it by the number of taxels, of touched taxels and of spheres; others show the time of each
/// stage in each scene.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let (recognition, timing, steps) = (&tables[1], &tables[3], &tables[4]);
    let ladder = |series: &str, name: &str, (x, line): (&str, &str), size: &str| {
        of_series(steps, series).map(|shown| ChartSpec {
            shown: vec![shown],
            lines: vec![line.to_owned()],
            rules: vec![Rule::at(Along::Y, 1000.0, "a millisecond")],
            ..steps.chart(
                name,
                format!("Time of a step by the size of {size}"),
                ("us_median", x),
            )
        })
    };
    let by_stage = of_series(timing, "scene").map(|shown| ChartSpec {
        shown: vec![shown],
        lines: vec!["compression".to_owned(), "n_threads".to_owned()],
        panels: Some("stage".to_owned()),
        mark: Mark::Points,
        rules: vec![Rule::at(Along::X, 1000.0, "a millisecond")],
        ..timing.chart(
            "time_by_stage",
            "From touch to answer: where the time of a step goes",
            ("name", "us_median"),
        )
    });
    let of_skin = "the skin, the touch the same";
    let of_touch = "the touch, the skin the same";
    let of_object = "the object, skin and touch the same";
    let taxels = ("n_taxels", "touched");
    let touched = ("touched_mean", "n_spheres");
    let spheres = ("n_spheres", "touched");
    let charts = [
        ladder("skin", "time_by_taxels", taxels, of_skin),
        ladder("touch", "time_by_touched", touched, of_touch),
        ladder("spheres", "time_by_spheres", spheres, of_object),
        by_stage,
        memory_chart(recognition),
    ];
    charts.into_iter().flatten().collect()
}

/// Returns answers about the time from touch to decision and about memory; the charts show the rest.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let (cases, timing) = (&tables[0], &tables[3]);
    let mut answers = Vec::new();
    let us = |row: usize| timing.number("us_median", row);
    let whole = (0..timing.n_rows).filter(|&row| timing.word("stage", row) == "whole");
    answers.extend(whole.max_by(|&a, &b| us(a).total_cmp(&us(b))).map(|row| {
        let [taxels, at_most, scene, compression] =
            ["n_taxels", "us_median", "name", "compression"].map(|name| timing.words(name, row));
        format!(
            "From touch to answer on {taxels} taxels: at most {at_most} (median over steps; scene {scene}, {compression})."
        )
    }));
    let bytes = cases.numbers("bytes_per_taxel").unwrap_or_default();
    answers.extend(bytes.iter().copied().reduce(f64::max).map(|most| {
        let most = short_number(most);
        format!("A body at rest takes at most {most} bytes a taxel.")
    }));
    answers
}

/// Returns a filter for the rows of a scaling series; `None` if the table has no such rows.
fn of_series(table: &Table, series: &str) -> Option<Shown> {
    let mut rows = 0..table.n_rows;
    let row = rows.find(|&row| table.word("series", row) == series)?;
    table.shown("series", row)
}

/// Returns the chart of recognition accuracy against the memory of the measurement matrix per taxel, with the Pareto front. Returns `None` if the table has
/// no rows.
fn memory_chart(recognition: &Table) -> Option<ChartSpec> {
    (recognition.n_rows > 0).then(|| ChartSpec {
        lines: vec!["compression".to_owned()],
        mark: Mark::Points,
        front: true,
        ..recognition.chart(
            "accuracy_by_memory",
            "Which object is it: accuracy against memory of a taxel",
            ("accuracy", "bytes_per_taxel"),
        )
    })
}
