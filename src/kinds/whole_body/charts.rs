//! What is charted, and what was found in sentences.

use super::memory_chart::memory_chart;
use crate::table::{Along, At, ChartSpec, Mark, Rule, Shown, Table, Value, short_number};

/// What a step costs by skin, by touch and by spheres, then where the time of a scene goes.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let [_, recognition, _, timing, steps, ..] = tables else {
        return Vec::new();
    };
    let ladder = |series: &str, name: &str, x: &str, lines: &[&str], title: &str| {
        let is_there = (0..steps.n_rows).any(|row| steps.word("series", row) == series);
        is_there.then(|| ChartSpec {
            name: name.to_owned(),
            title: format!("Time of a step by the size of {title}"),
            note: steps.note.clone(),
            table: steps.file,
            shown: vec![of_series(series)],
            x: x.to_owned(),
            y: "us_median".to_owned(),
            lines: lines.iter().map(|&line| line.to_owned()).collect(),
            rules: vec![millisecond(Along::Y)],
            ..ChartSpec::default()
        })
    };
    let ladders = [
        ladder(
            "skin",
            "time_by_taxels",
            "n_taxels",
            &["touched"],
            "the skin, the touch the same",
        ),
        ladder(
            "touch",
            "time_by_touched",
            "touched_mean",
            &["n_spheres"],
            "the touch, the skin the same",
        ),
        ladder(
            "spheres",
            "time_by_spheres",
            "n_spheres",
            &["touched"],
            "the object, skin and touch the same",
        ),
    ];
    let has_scenes = (0..timing.n_rows).any(|row| timing.word("series", row) == "scene");
    let by_stage = has_scenes.then(|| ChartSpec {
        name: "time_by_stage".to_owned(),
        title: "From touch to answer: where the time of a step goes".to_owned(),
        note: timing.note.clone(),
        table: timing.file,
        shown: vec![of_series("scene")],
        x: "us_median".to_owned(),
        y: "name".to_owned(),
        lines: vec!["compression".to_owned(), "n_threads".to_owned()],
        panels: Some("stage".to_owned()),
        mark: Mark::Points,
        rules: vec![millisecond(Along::X)],
        ..ChartSpec::default()
    });
    let others = [by_stage, memory_chart(recognition)];
    ladders.into_iter().chain(others).flatten().collect()
}

fn of_series(series: &str) -> Shown {
    Shown {
        column: "series".to_owned(),
        value: Value::Word(series.to_owned()),
    }
}

fn millisecond(along: Along) -> Rule {
    Rule {
        along,
        at: At::Value(1000.0),
        words: "a millisecond".to_owned(),
    }
}

/// From touch to answer; growth with the skin and steps a second; memory; recognition.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let [cases, recognition, _, timing, steps, ..] = tables else {
        return Vec::new();
    };
    let mut answers = Vec::new();
    let us = |row: usize| timing.number("us_median", row);
    let whole = (0..timing.n_rows).filter(|&row| timing.word("stage", row) == "whole");
    answers.extend(whole.max_by(|&a, &b| us(a).total_cmp(&us(b))).map(|row| {
        format!(
            "From touch to answer on {} taxels: at most {} (median over steps; scene {}, {}).",
            timing.words("n_taxels", row),
            timing.words("us_median", row),
            timing.words("name", row),
            timing.words("compression", row)
        )
    }));
    let skins = (0..steps.n_rows).filter(|&row| steps.word("series", row) == "skin");
    for rungs in steps.groups(&["touched"], skins) {
        let (first, last) = (rungs[0], rungs[rungs.len() - 1]);
        let growth = steps.number("us_median", last) / steps.number("us_median", first);
        answers.push(format!(
            "From {} to {} taxels with {} touched, the time of a step is {} times as long: {} ({} steps/s).",
            steps.words("n_taxels", first),
            steps.words("n_taxels", last),
            steps.words("touched", last),
            short_number((100.0 * growth).round() / 100.0),
            steps.words("us_median", last),
            short_number(steps.number("steps_per_s", last).round())
        ));
    }
    let bytes = cases.numbers("bytes_per_taxel").unwrap_or_default();
    answers.extend(bytes.iter().copied().reduce(f64::max).map(|most| {
        format!(
            "A body at rest takes at most {} bytes a taxel.",
            short_number(most)
        )
    }));
    answers.extend((0..recognition.n_rows).map(|row| {
        let accuracy = |column| recognition.number(column, row);
        format!(
            "{} objects from {} measurements of {}: accuracy {:.3} [{:.3}, {:.3}].",
            recognition.words("n_objects", row),
            recognition.words("n_measurements", row),
            recognition.words("compression", row),
            accuracy("accuracy"),
            accuracy("accuracy_low"),
            accuracy("accuracy_high")
        )
    }));
    answers
}
