//! Law: every point of a chart is a row of its table at the correct position. Every other row is counted on the chart.

use super::generator::{Generator, is_sample, n_studies};
use crate::chart_tables;
use crate::study::table;
use bubbletouch::report::chart::{Place, draw, omitted, places};
use bubbletouch::studies::recognition::charts::{charts, tables_of};
use bubbletouch::study::progress::Silent;
use bubbletouch::table::{ChartSpec, Mark, Table, Value};
use rand::Rng;
use rand::seq::SliceRandom;
use std::cmp::Ordering;
use std::collections::BTreeSet;

/// Axes of the charted studies: numbers, words, and settings that some configurations do not have.
const AXES: &[&str] = &[
    "signal.noise_std_full_scale",
    "signal.smoothing_mm",
    "signal.dead_fraction",
    "skin.pitch_mm",
    "skin.stroke_mm",
    "touches.frames",
    "sensing.ensemble",
    "sensing.ratio",
    "recognition.features",
    "recognition.classifier",
    "recognition.c",
    "recognition.train_touches",
    "recognition.touches_per_decision",
];

/// Returns the text of all elements of a picture, in order.
fn words_of(svg: &str) -> String {
    let mut said = String::new();
    for part in svg.split('<').skip(1) {
        let (_, text) = part.split_once('>').unwrap_or(("", ""));
        said += text;
        said.push(' ');
    }
    let said = said.replace("&lt;", "<").replace("&gt;", ">");
    plain(&said.replace("&quot;", "\"").replace("&amp;", "&"))
}

/// Replaces white space by single spaces.
fn plain(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the visible rows: of tiles at one position only the last, and none without a fill value.
fn seen(spec: &ChartSpec, table: &Table, places: &[Place]) -> usize {
    let Mark::Tiles { fill, .. } = &spec.mark else {
        return places.len();
    };
    let (_, data) = table.column(fill).unwrap();
    let filled = places
        .iter()
        .filter(|place| data.value(place.row).is_some());
    let at = |place: &Place| {
        let [x, y] = [place.x, place.y].map(f64::to_bits);
        (place.panel, place.line, x, y)
    };
    filled.map(at).collect::<BTreeSet<_>>().len()
}

/// Returns the numbers of rows in a sentence about omitted rows: drawn, all, and omitted for each reason.
fn counted(said: &str) -> (usize, usize, usize) {
    let number = |text: &str| {
        let mut words = text.split_whitespace();
        words.next().unwrap().parse::<usize>().unwrap()
    };
    let (drawn, reasons) = said.split_once("; ").expect(said);
    let (n, of) = drawn.split_once(" of ").expect(said);
    let left_out = reasons.trim_end_matches('.').split(", ").map(number).sum();
    (number(n), number(of), left_out)
}

/// Checks that positions along an axis have the order of the rows' entries or the reverse order, and that equal entries have equal positions. Lines that are
/// side by side at a word are compared one by one.
fn check_axis(table: &Table, column: &str, places: &[&Place], at: fn(&Place) -> f64, what: &str) {
    let what = format!("{column} of {what}");
    let (_, data) = table.column(column).unwrap();
    let mut orders = BTreeSet::new();
    for (number, first) in places.iter().enumerate() {
        for second in &places[number + 1..] {
            let place = at(first).partial_cmp(&at(second)).unwrap();
            match (data.value(first.row), data.value(second.row)) {
                (Some(Value::Number(a)), Some(Value::Number(b))) => match a.total_cmp(&b) {
                    Ordering::Equal => assert_eq!(place, Ordering::Equal, "{what}"),
                    // Numbers that differ in their last digits may have one position.
                    order if place != Ordering::Equal => {
                        orders.insert(order == place);
                    }
                    _ => assert!((a - b).abs() <= 1e-9 * a.abs().max(b.abs()), "{what}"),
                },
                (a, b) => assert_eq!(a == b, place == Ordering::Equal, "{what}"),
            }
        }
    }
    assert!(orders.len() < 2, "{what}: neither rising nor falling");
}

fn check(spec: &ChartSpec, tables: &[Table], text: &str) {
    let what = format!("chart {} of\n{text}", spec.name);
    let table = table(tables, spec.table);
    let places = places(spec, tables).unwrap();
    let rows: BTreeSet<usize> = places.iter().map(|place| place.row).collect();
    assert_eq!(rows.len(), places.len(), "{what}");
    assert!(rows.iter().all(|row| *row < table.n_rows), "{what}");
    let groups: BTreeSet<(usize, usize)> = places.iter().map(|p| (p.panel, p.line)).collect();
    for group in groups {
        let here = places.iter();
        let here: Vec<_> = here
            .filter(|place| (place.panel, place.line) == group)
            .collect();
        check_axis(table, &spec.x, &here, |place| place.x, &what);
    }
    let all: Vec<&Place> = places.iter().collect();
    check_axis(table, &spec.y, &all, |place| place.y, &what);
    // The line and the panel of a point correspond to the values of their columns.
    for place in &places {
        for other in &places {
            let same = |columns: &[String]| {
                columns.iter().all(|name| {
                    let (_, data) = table.column(name).unwrap();
                    data.value(place.row) == data.value(other.row)
                })
            };
            assert_eq!(same(&spec.lines), place.line == other.line, "{what}");
            let are_in_one = place.panel == other.panel;
            assert_eq!(same(spec.panels.as_slice()), are_in_one, "{what}");
        }
    }
    let (n, n_seen) = (table.n_rows, seen(spec, table, &places));
    let said = omitted(spec, tables).unwrap();
    if n_seen == n {
        assert_eq!(said, "", "{what}");
        return;
    }
    assert!(!said.is_empty(), "{n_seen} of {n} rows in {what}");
    assert_eq!(counted(&said), (n_seen, n, n - n_seen), "{said}: {what}");
    let svg = words_of(&draw(spec, tables).unwrap().svg(""));
    assert!(svg.contains(&plain(&said)), "{said} in {svg} of {what}");
}

#[test]
fn every_point_is_a_row_and_every_row_is_a_point_or_is_counted() {
    let (mut n_charts, mut n_counting) = (0, 0);
    for number in 0..n_studies() {
        let mut generator = Generator::new("charts", number);
        let mut study = generator.study(|_| true);
        let mut axes = AXES.to_vec();
        axes.shuffle(&mut generator.rng);
        let n_axes = generator.rng.gen_range(1..=3);
        let mut n_swept = 0;
        for key in axes {
            let mut values = generator.values(key);
            values.truncate(3);
            let swept = study.swept(key, values);
            if n_swept < n_axes && swept.load().is_ok() {
                study = swept;
                n_swept += 1;
            }
        }
        let Ok(tables) = study.load().unwrap().run(&Silent) else {
            continue;
        };
        let tables = tables_of(&tables).unwrap();
        for spec in charts(&tables, Some(true)) {
            check(&spec, &tables, &study.text());
            n_charts += 1;
            n_counting += u64::from(!omitted(&spec, &tables).unwrap().is_empty());
        }
    }
    assert!(
        n_charts >= n_studies() && (is_sample() || n_counting > 0),
        "{n_charts} {n_counting}"
    );
}

#[test]
fn every_row_of_synthetic_tables_is_a_point_or_is_counted() {
    for spec in chart_tables::charts() {
        check(&spec, &chart_tables::tables(), "chart_tables");
    }
}
