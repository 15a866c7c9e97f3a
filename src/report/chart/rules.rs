//! Reference lines of a chart, such as a chance level, a limit, or a published value.

use super::legend::LegendEntry;
use super::view::View;
use crate::report::pictures::{Area, Drawing, MUTED, Point, Stroke};
use crate::table::{Along, At, Rule};

/// Dash patterns of the reference lines in a chart: length of a dash and of a gap, pixels.
const DASHES: [(u32, u32); 4] = [(5, 4), (2, 3), (9, 3), (1, 2)];

/// Returns the legend entries of the reference lines of a chart; lines with equal labels share one entry.
pub(super) fn entries(view: &View) -> Vec<LegendEntry> {
    let rules = view.spec.rules.iter().enumerate();
    let rules = rules.filter(|(number, rule)| first_of(view, rule) == *number);
    let entries = rules.map(|(_, rule)| {
        let stroke = stroke(view, rule);
        LegendEntry::new(rule.words.to_string(), move |drawing, area| {
            drawing.line(area.at(0.0, 0.5), area.at(1.0, 0.5), stroke);
        })
    });
    entries.collect()
}

/// Returns the index of the first reference line with the label of `rule`.
fn first_of(view: &View, rule: &Rule) -> usize {
    let mut rules = view.spec.rules.iter();
    let same = rules.position(|other| other.words == rule.words);
    same.unwrap_or(0)
}

fn stroke(view: &View, rule: &Rule) -> Stroke {
    Stroke {
        colour: MUTED,
        width: 1.3,
        dash: Some(DASHES[first_of(view, rule) % DASHES.len()]),
    }
}

/// Draws all reference lines of a panel.
pub(super) fn draw(drawing: &mut Drawing, view: &View, panel: usize, frame: Area) {
    for rule in &view.spec.rules {
        for line in lines(view, rule, panel) {
            let points: Vec<Point> = line.iter().map(|&(x, y)| frame.at(x, y)).collect();
            drawing.polyline(&points, stroke(view, rule));
        }
    }
}

/// Returns the polylines of a reference line in a panel, in coordinates from 0 to 1 along the panel's width and height.
fn lines(view: &View, rule: &Rule, panel: usize) -> Vec<Vec<Point>> {
    let own = match rule.along {
        Along::X => &view.x,
        Along::Y => &view.y,
    };
    let point = |own: f64, other: f64| match rule.along {
        Along::X => (own, other),
        Along::Y => (other, own),
    };
    let across = |at: f64| vec![point(at, 0.0), point(at, 1.0)];
    let column = match &rule.at {
        At::Value(value) => return own.place(*value).map(across).into_iter().collect(),
        At::Column(column) => column,
    };
    let Some(numbers) = view.table.numbers(column) else {
        return Vec::new();
    };
    let mut places: Vec<(f64, f64)> = view
        .here(panel)
        .filter_map(|place| {
            let along = match rule.along {
                Along::X => place.y,
                Along::Y => place.x,
            };
            Some((along, own.place(numbers[place.row])?))
        })
        .collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    places.dedup();
    let is_function = places.windows(2).all(|pair| pair[0].0 != pair[1].0);
    let mut levels: Vec<f64> = places.iter().map(|place| place.1).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    if levels.len() < 2 || !is_function {
        return levels.into_iter().map(across).collect();
    }
    let line: Vec<Point> = places.iter().map(|&(along, at)| point(at, along)).collect();
    vec![line]
}
