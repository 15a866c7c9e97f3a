//! Laws of the chart renderer that hold for every chart.

use crate::chart_tables::{charts, tables};
use crate::command::says;
use bubbletouch::report::chart::{draw, places};
use bubbletouch::table::{ChartSpec, Value};

/// Returns the chart with this name.
fn chart(name: &str) -> ChartSpec {
    let mut all = charts().into_iter();
    all.find(|spec| spec.name == name).unwrap()
}

#[test]
fn every_point_stands_inside_its_panel() {
    let tables = tables();
    for spec in charts() {
        let places = places(&spec, &tables).unwrap();
        assert!(!places.is_empty(), "{}", spec.name);
        for place in places {
            let ends = place.interval.into_iter().flatten();
            let mut all = ends.chain([place.x, place.y]);
            let is_inside = all.all(|part| (0.0..=1.0).contains(&part));
            assert!(is_inside, "{}: {place:?}", spec.name);
        }
    }
}

#[test]
fn equal_charts_are_equal_bytes_and_say_their_title_lines_and_units() {
    let tables = tables();
    for spec in charts() {
        let drawing = draw(&spec, &tables).unwrap();
        let svg = drawing.svg(&spec.title);
        assert_eq!(svg, draw(&spec, &tables).unwrap().svg(&spec.title));
    }
    let lines = "RBF SVM | k nearest | 64:1 | noise 20 % | 95 % interval | chance (1 in 24)";
    let zero = "crosstalk (%) | compression 256:1 | linear SVM, gaussian";
    let front = "time of one decision | 100 µs | Pareto front: nothing is both faster and as good";
    let tiles = "not finite | 1 ms | missed contact | mass of a taxel (kg)";
    for (name, words) in [
        ("lines", lines),
        ("zero", zero),
        ("front", front),
        ("tiles", tiles),
        ("rows", "hand on a mug | a millisecond"),
        ("whiskers", "5th percentile to 95th percentile"),
    ] {
        let svg = draw(&chart(name), &tables).unwrap().svg("");
        says(&svg, &words.split(" | ").collect::<Vec<_>>());
    }
}

#[test]
fn what_is_alike_in_rows_and_columns_lies_on_the_diagonal() {
    let tables = tables();
    let spec = chart("diagonal");
    let places = places(&spec, &tables).unwrap();
    let counts = tables[0].numbers("count").unwrap();
    for place in places.iter().filter(|place| counts[place.row] == 60.0) {
        assert!((place.x - (1.0 - place.y)).abs() < 1e-9, "{place:?}");
    }
}

#[test]
fn a_number_that_stands_for_none_is_named_and_no_line_leads_to_it() {
    let mut tables = tables();
    let mut spec = charts().swap_remove(1);
    assert_eq!((&spec.name[..], &spec.x[..]), ("zero", "crosstalk"));
    let n_lines = |spec: &ChartSpec, tables: &[_]| {
        let svg = draw(spec, tables).unwrap().svg("");
        (
            svg.matches("stroke-width=\"2\" fill=\"none\"").count(),
            svg.contains(">no cable<"),
        )
    };
    spec.shown.clear();
    let (joined, is_said) = n_lines(&spec, &tables);
    assert!(joined > 0 && !is_said, "{joined} lines");
    let table = tables.iter_mut().find(|table| table.file == spec.table);
    let table = table.unwrap();
    let place = table.place("crosstalk").unwrap();
    table.columns[place].names = &[("0", "no cable")];
    let words = table.columns[place].value_words(&Value::Number(0.0));
    assert_eq!(words, "no cable");
    assert_eq!(n_lines(&spec, &tables), (0, true));
}

#[test]
fn many_lines_have_their_names_at_their_ends_one_below_the_other() {
    let tables = tables();
    let mut spec = charts().swap_remove(0);
    let svg = |spec: &ChartSpec| draw(spec, &tables).unwrap().svg_with_data("");
    assert!(svg(&spec).contains(">classifier:<"));
    spec.shown = charts()[2].shown[..2].to_vec();
    spec.lines.push("ensemble".to_owned());
    spec.panels = None;
    let svg = svg(&spec);
    assert!(!svg.contains(">classifier, ensemble:<"));
    let heights = svg.split("data-toggle").skip(1).map(|end| {
        let (_, text) = end.split_once("<text").unwrap();
        let (_, height) = text.split_once(" y=\"").unwrap();
        height.split('"').next().unwrap().parse().unwrap()
    });
    let heights: Vec<f64> = heights.collect();
    let mut gaps = heights.windows(2).map(|pair| pair[1] - pair[0]);
    let are_apart = heights.len() > 4 && gaps.all(|gap| gap >= 14.0);
    assert!(are_apart, "{heights:?}");
}

#[test]
fn the_legend_stands_above_all_data() {
    let tables = tables();
    for spec in charts() {
        let svg = draw(&spec, &tables).unwrap().svg("");
        // The first grid line belongs to the panel; every marker of the legend is above it.
        let height = |text: &str| -> Option<f64> {
            let at = svg.find(&format!(">{text}<"))?;
            let tag = &svg[svg[..at].rfind('<')?..at];
            let y = tag.split(" y=\"").nth(1)?.split('"').next()?;
            y.parse().ok()
        };
        let legend = spec.rules.first().and_then(|rule| height(&rule.words));
        let highest_tick = svg.split("text-anchor=\"end\"").skip(1).count();
        assert!(highest_tick > 0, "{}", spec.name);
        if let Some(legend) = legend {
            let panel = charts_top(&svg);
            assert!(legend < panel, "{}: {legend} and {panel}", spec.name);
        }
    }
}

/// Returns the position of the highest label of a vertical axis.
fn charts_top(svg: &str) -> f64 {
    let texts = svg.split("<text ");
    let labels = texts.filter(|text| text.contains("text-anchor=\"end\""));
    let heights =
        labels.filter_map(|text| text.split("y=\"").nth(1)?.split('"').next()?.parse().ok());
    heights.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_chart_of_what_is_not_there_names_what_is() {
    let tables = tables();
    let spec = charts().swap_remove(0);
    let said = |spec: ChartSpec| draw(&spec, &tables).err().unwrap().to_string();
    let other = ChartSpec {
        table: "other.csv",
        ..spec.clone()
    };
    assert!(said(other).contains("one of taken.csv, scores.csv, stable.csv"));
    let column = ChartSpec {
        x: "pitch".to_owned(),
        ..spec.clone()
    };
    assert!(said(column).contains("column \"pitch\"; one of noise, crosstalk"));
    let mut nothing = spec;
    nothing.shown[0].value = Value::Number(7.0);
    assert!(said(nothing).contains("no row of scores.csv"));
}
