//! Pareto front of a chart's points. Each panel has one front per condition of the world, because a designer cannot choose the condition.

use super::view::{Place, View};
use crate::report::swept::Setting;
use crate::table::{Better, Role, front};
use std::collections::HashMap;

/// Maximum number of points on Pareto fronts that are numbered and listed below a chart.
const MAX_NAMED: usize = 24;

/// Pareto fronts of a chart: the points that no other point under the same condition surpasses in both axes.
pub(super) struct Front<'a> {
    view: &'a View<'a>,
    /// Pareto fronts of the chart: the panel index of each front, and its points in ascending order of x.
    pub fronts: Vec<(usize, Vec<&'a Place>)>,
}

/// Returns whether larger values on the y axis are better.
pub(super) fn is_more_better(view: &View) -> bool {
    let y = view.column(&view.spec.y).map(|y| y.column.role);
    !matches!(y, Ok(Role::Value(Better::Less) | Role::Cost))
}

/// Returns the legend text for the line of the Pareto front.
pub(super) fn words(view: &View) -> String {
    let cost = match view.column(&view.spec.x) {
        Ok(x) if matches!(&x.column.unit[..], "s" | "ms" | "us" | "µs") => "faster",
        _ => "cheaper",
    };
    format!("Pareto front: nothing is both {cost} and as good")
}

impl<'a> Front<'a> {
    /// Computes the Pareto fronts of a chart; the result is empty if the chart has none.
    pub fn new(view: &'a View) -> Self {
        let conditions = Setting::of_roles(view.table, &[Role::Condition]);
        let conditions: Vec<Setting> = conditions.collect();
        let more = is_more_better(view);
        let mut fronts = Vec::new();
        let panels = (0..view.panels.names.len()).filter(|_| view.spec.front);
        for panel in panels {
            let here = view.places.iter().filter(|place| place.panel == panel);
            let places: HashMap<usize, &Place> =
                here.clone().map(|place| (place.row, place)).collect();
            let rows: Vec<usize> = here.map(|place| place.row).collect();
            for group in Setting::groups(&conditions, view.table, &rows) {
                let group = group.iter().map(|row| places[row]);
                // The mapping of values to positions is monotonic, so positions replace values here.
                let points: Vec<(f64, f64)> = group.clone().map(|p| (p.x, p.y)).collect();
                let is_on = front(&points, |a, b| if more { a > b } else { a < b });
                let on = group.zip(is_on).filter(|(_, is_on)| *is_on);
                let mut on: Vec<&Place> = on.map(|(place, _)| place).collect();
                on.sort_by(|a, b| a.x.total_cmp(&b.x));
                fronts.push((panel, on));
            }
        }
        Self { view, fronts }
    }

    /// Returns whether the table row with this index is on a Pareto front.
    pub fn has(&self, row: usize) -> bool {
        let mut points = self.fronts.iter().flat_map(|(_, front)| front);
        points.any(|place| place.row == row)
    }

    /// Returns the numbered points of all Pareto fronts, panel by panel along x; returns none if there are too many to list.
    pub fn numbered(&self) -> impl Iterator<Item = (usize, &'a Place)> {
        let all = self.fronts.iter().flat_map(|front| &front.1);
        let n = all.clone().count();
        let all = all.filter(move |_| n <= MAX_NAMED).copied();
        all.enumerate().map(|(number, place)| (number + 1, place))
    }

    /// Returns one line of text for each numbered point of a Pareto front.
    pub fn list(&self) -> Vec<String> {
        self.said(self.numbered().map(|(_, place)| place))
    }

    /// Returns a description of each point of a Pareto front: its settings, its value and its cost.
    fn said(&self, places: impl Iterator<Item = &'a Place>) -> Vec<String> {
        let view = self.view;
        let settings =
            Setting::of_roles(view.table, &[Role::Choice, Role::Condition, Role::Subject]);
        let settings = settings.filter(|one| one.varies(&view.rows));
        let settings: Vec<Setting> = settings.collect();
        let of = |name: &str, row| view.column(name).map(|column| column.label(row));
        let said = places.map(|place| {
            let row = place.row;
            let given = settings.iter().filter(|one| one.data.value(row).is_some());
            let words: Vec<String> = given.map(|one| one.title(row)).collect();
            let [y, x] = [&view.spec.y, &view.spec.x].map(|name| of(name, row).unwrap_or_default());
            format!("{}: {y} at {x}", words.join(", "))
        });
        said.collect()
    }
}
