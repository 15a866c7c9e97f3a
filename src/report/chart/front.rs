//! The Pareto front of a chart's points: one in each panel for each condition of the world, since nobody chooses that.

use super::view::{Place, View, value_words};
use crate::table::{Better, Column, Data, Role, front};
use std::collections::{HashMap, HashSet};

/// Points of fronts that are numbered and named below a chart, at most.
const MOST_NAMED: usize = 24;

/// Points on fronts.
pub(super) struct Front<'a> {
    view: &'a View<'a>,
    /// Of each front its panel, and its points along x.
    fronts: Vec<(usize, Vec<&'a Place>)>,
    rows: HashSet<usize>,
}

/// Whether more of y is better.
pub(super) fn is_more_better(view: &View) -> bool {
    let y = view.column(&view.spec.y).map(|(column, _)| column.role);
    !matches!(y, Some(Role::Value(Better::Less) | Role::Cost))
}

/// What the legend calls the front.
pub(super) fn words(view: &View) -> String {
    let cost = match view.column(&view.spec.x) {
        Some((column, _)) if matches!(&column.unit[..], "s" | "ms" | "us" | "µs") => "faster",
        _ => "cheaper",
    };
    format!("Pareto front: nothing is both {cost} and as good")
}

impl<'a> Front<'a> {
    /// Of a chart; without points if it has none.
    pub fn of(view: &'a View) -> Self {
        let conditions = view.table.columns.iter();
        let conditions = conditions.filter(|column| column.role == Role::Condition);
        let conditions: Vec<&str> = conditions.map(|column| &column.name[..]).collect();
        let more = is_more_better(view);
        let mut fronts = Vec::new();
        let n_panels = if view.spec.front {
            view.panels.names.len()
        } else {
            0
        };
        for panel in 0..n_panels {
            let here = view.places.iter().filter(|place| place.panel == panel);
            let places: HashMap<usize, &Place> =
                here.clone().map(|place| (place.row, place)).collect();
            let rows = here.map(|place| place.row);
            for group in view.table.groups(&conditions, rows) {
                let group = group.iter().map(|row| places[row]);
                // Places keep the order of values, so they serve as well as these.
                let points: Vec<(f64, f64)> = group.clone().map(|p| (p.x, p.y)).collect();
                let is_on = front(&points, |a, b| if more { a > b } else { a < b });
                let on = group.zip(is_on).filter(|(_, is_on)| *is_on);
                let mut on: Vec<&Place> = on.map(|(place, _)| place).collect();
                on.sort_by(|a, b| a.x.total_cmp(&b.x));
                fronts.push((panel, on));
            }
        }
        let rows = fronts.iter().flat_map(|(_, front)| front);
        Self {
            rows: rows.map(|place| place.row).collect(),
            view,
            fronts,
        }
    }

    /// Whether a row is on it.
    pub fn has(&self, row: usize) -> bool {
        self.rows.contains(&row)
    }

    /// The fronts of a panel.
    pub fn of_panel(&self, panel: usize) -> impl Iterator<Item = &Vec<&'a Place>> {
        let here = self.fronts.iter().filter(move |front| front.0 == panel);
        here.map(|front| &front.1)
    }

    /// Points with their numbers, panel by panel along x; none if they are too many.
    pub fn numbered(&self) -> impl Iterator<Item = (usize, &'a Place)> {
        let all = self.fronts.iter().flat_map(|front| &front.1);
        let n = all.clone().count();
        let all = all.filter(move |_| n <= MOST_NAMED).copied();
        all.enumerate().map(|(number, place)| (number + 1, place))
    }

    /// A line a numbered point.
    pub fn list(&self) -> Vec<String> {
        self.said(self.numbered().map(|(_, place)| place))
    }

    /// The ends of the first front, the cheaper first.
    pub fn ends(&self) -> Option<[String; 2]> {
        let (_, front) = self.fronts.first()?;
        let ends = [*front.first()?, *front.last()?];
        self.said(ends.into_iter()).try_into().ok()
    }

    /// Of each point what was chosen, what it reaches, and what it costs.
    fn said(&self, places: impl Iterator<Item = &'a Place>) -> Vec<String> {
        let view = self.view;
        let columns = view.table.columns.iter().zip(&view.table.data);
        let names: Vec<(&Column, &Data)> = columns
            .filter(|(c, _)| matches!(c.role, Role::Choice | Role::Condition | Role::Subject))
            .filter(|(_, data)| varies(data, &view.rows))
            .collect();
        let of = |name: &str, row: usize| {
            let found = view.column(name);
            found.map_or_else(String::new, |(column, data)| value_words(column, data, row))
        };
        let said = places.map(|place| {
            let phrase = |(column, data): &(&Column, &Data)| match data.value(place.row) {
                Some(value) => match data {
                    Data::Words { .. } => column.value_words(&value),
                    Data::Numbers(_) => column.phrase(&value),
                },
                None => String::new(),
            };
            let mut words: Vec<String> = names.iter().map(phrase).collect();
            words.retain(|word| !word.is_empty());
            let (y, x) = (of(&view.spec.y, place.row), of(&view.spec.x, place.row));
            format!("{}: {y} at {x}", words.join(", "))
        });
        said.collect()
    }
}

fn varies(data: &Data, rows: &[usize]) -> bool {
    let Some(first) = rows.first().map(|&row| data.value(row)) else {
        return false;
    };
    rows.iter().any(|&row| data.value(row) != first)
}
