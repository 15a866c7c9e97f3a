//! Lines across a chart: chance, limits, published values.

use super::scale::Scale;
use super::view::View;
use crate::report::colours::{INK, MUTED, PAPER};
use crate::report::drawing::{Area, Drawing, Point, Stroke};
use crate::report::legend::{LegendEntry, Mark};
use crate::table::{Along, At, Mark as TableMark, Rule};

/// How rules are told apart, in their order.
const DASHES: [(u32, u32); 4] = [(5, 4), (2, 3), (9, 3), (1, 2)];

/// The stroke of a rule by its number.
fn stroke(number: usize) -> Stroke {
    Stroke {
        colour: MUTED,
        width: 1.3,
        dash: Some(DASHES[number % DASHES.len()]),
    }
}

/// An entry a rule; rules of the same words share one.
pub(super) fn entries(view: &View) -> Vec<LegendEntry> {
    let rules = view.spec.rules.iter().enumerate();
    let rules = rules.filter(|(number, rule)| first_of(view, rule) == *number);
    rules
        .map(|(number, rule)| LegendEntry::new(rule.words.clone(), Mark::Rule(stroke(number))))
        .collect()
}

/// The number of the first rule of the same words.
fn first_of(view: &View, rule: &Rule) -> usize {
    let same = view
        .spec
        .rules
        .iter()
        .position(|other| other.words == rule.words);
    same.unwrap_or(0)
}

/// Draws all rules of a panel.
pub(super) fn draw(drawing: &mut Drawing, view: &View, panel: usize, frame: Area) {
    let is_tiles = matches!(view.spec.mark, TableMark::Tiles { .. });
    for rule in &view.spec.rules {
        for line in lines(view, rule, panel) {
            let at = |&(x, y): &Point| {
                (
                    frame.x + x * frame.width,
                    frame.y + (1.0 - y) * frame.height,
                )
            };
            let points: Vec<Point> = line.iter().map(at).collect();
            let mut stroke = stroke(first_of(view, rule));
            if is_tiles {
                // On fields of any colour.
                drawing.polyline(&points, Stroke::new(PAPER, 3.5));
                stroke.colour = INK;
            }
            drawing.polyline(&points, stroke);
        }
    }
}

/// Where a rule runs in a panel, as parts of its width and height.
fn lines(view: &View, rule: &Rule, panel: usize) -> Vec<Vec<Point>> {
    let (own, other, other_name) = match rule.along {
        Along::X => (&view.x, &view.y, &view.spec.y),
        Along::Y => (&view.y, &view.x, &view.spec.x),
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
    let is_x = |name: &str| name == view.spec.x;
    let mut places: Vec<(f64, f64)> = Vec::new();
    for place in view
        .places
        .iter()
        .filter(|place| view.panel_of(place) == panel)
    {
        let at = own.place(numbers[place.row]);
        let along = if is_x(other_name) { place.x } else { place.y };
        places.extend(at.map(|at| (along, at)));
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    places.dedup();
    let is_one = places.iter().all(|place| place.1 == places[0].1);
    let is_function = places.windows(2).all(|pair| pair[0].0 != pair[1].0);
    if is_one || !is_function {
        let mut all: Vec<f64> = places.iter().map(|place| place.1).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        return all.into_iter().map(across).collect();
    }
    match view.spec.mark {
        TableMark::Tiles { .. } => vec![
            stair(&places, other)
                .into_iter()
                .map(|(along, at)| point(at, along))
                .collect(),
        ],
        _ => vec![
            places
                .into_iter()
                .map(|(along, at)| point(at, along))
                .collect(),
        ],
    }
}

/// Level along each tile.
fn stair(places: &[(f64, f64)], other: &Scale) -> Vec<(f64, f64)> {
    let half = 0.5 / other.n_levels() as f64;
    let ends = |&(along, at): &(f64, f64)| [(along - half, at), (along + half, at)];
    places.iter().flat_map(ends).collect()
}
