//! The Pareto front of a chart's points: one in each panel for each condition of the world, since nobody chooses that.

use super::view::{Place, View, value_words};
use crate::table::{Better, Column, Data, Role, front};
use std::collections::{HashMap, HashSet};

/// Points of fronts that are numbered and named below a chart, at most.
const MOST_NAMED: usize = 24;

/// Points on fronts.
pub(super) struct Front {
    /// Of each front its panel, and its points along x by their number among the places.
    fronts: Vec<(usize, Vec<usize>)>,
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
        Some((column, _)) if column.unit.ends_with('s') => "faster",
        _ => "cheaper",
    };
    format!("Pareto front: nothing is both {cost} and as good")
}

impl Front {
    /// Of a chart; without points if it has none.
    pub fn of(view: &View) -> Self {
        let mut found = Self {
            fronts: Vec::new(),
            rows: HashSet::new(),
        };
        if !view.spec.front {
            return found;
        }
        let columns = view.table.columns.iter().zip(&view.table.data);
        let conditions: Vec<&Data> = columns
            .filter(|(c, _)| c.role == Role::Condition)
            .map(|(_, data)| data)
            .collect();
        let mut groups: Vec<(usize, Vec<usize>)> = Vec::new();
        let mut known: HashMap<(usize, Vec<u64>), usize> = HashMap::new();
        for (number, place) in view.places.iter().enumerate() {
            let of = |data: &&Data| data.key(place.row);
            let key = (place.panel, conditions.iter().map(of).collect());
            let group = *known.entry(key).or_insert_with(|| {
                groups.push((place.panel, Vec::new()));
                groups.len() - 1
            });
            groups[group].1.push(number);
        }
        let more = is_more_better(view);
        for (panel, group) in groups {
            // Places keep the order of values, so they serve as well as these.
            let points: Vec<(f64, f64)> = group
                .iter()
                .map(|&n| (view.places[n].x, view.places[n].y))
                .collect();
            let is_on = front(&points, |a, b| if more { a > b } else { a < b });
            let mut on: Vec<usize> = group
                .iter()
                .zip(is_on)
                .filter(|(_, on)| *on)
                .map(|(&n, _)| n)
                .collect();
            on.sort_by(|&a, &b| view.places[a].x.total_cmp(&view.places[b].x));
            found.rows.extend(on.iter().map(|&n| view.places[n].row));
            found.fronts.push((panel, on));
        }
        found
    }

    /// Whether a row is on it.
    pub fn has(&self, row: usize) -> bool {
        self.rows.contains(&row)
    }

    /// The fronts of a panel.
    pub fn of_panel(&self, panel: usize) -> impl Iterator<Item = &Vec<usize>> {
        self.fronts
            .iter()
            .filter(move |front| front.0 == panel)
            .map(|front| &front.1)
    }

    /// Points with their numbers, panel by panel along x; none if they are too many.
    pub fn numbered<'a>(&'a self, view: &'a View) -> impl Iterator<Item = (usize, &'a Place)> {
        let n: usize = self.fronts.iter().map(|front| front.1.len()).sum();
        let all = self.fronts.iter().flat_map(|front| &front.1);
        let all = all
            .filter(move |_| n <= MOST_NAMED)
            .map(|&place| &view.places[place]);
        all.enumerate().map(|(number, place)| (number + 1, place))
    }

    /// A line a numbered point.
    pub fn list(&self, view: &View) -> Vec<String> {
        let numbered = self.numbered(view).map(|(_, place)| place);
        Self::said(view, numbered)
    }

    /// The ends of the first front, the cheaper first.
    pub fn ends(&self, view: &View) -> Option<[String; 2]> {
        let (_, front) = self.fronts.first()?;
        let ends = [front.first()?, front.last()?].map(|&place| &view.places[place]);
        Self::said(view, ends.into_iter()).try_into().ok()
    }

    /// Of each point what was chosen, what it reaches, and what it costs.
    fn said<'a>(view: &View, places: impl Iterator<Item = &'a Place>) -> Vec<String> {
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
