//! Pareto front of a chart's points. Each panel has one front per condition of the world, because a designer cannot choose the condition.

use super::view::{Place, View};
use crate::report::advice::Candidates;
use crate::report::swept::{Setting, Swept, without};
use crate::table::{Better, Role};
use std::collections::HashMap;

/// Pareto fronts of a chart: the points that no other point under the same condition surpasses in both axes.
pub(super) struct Front<'a> {
    view: &'a View<'a>,
    /// Free settings that neither the series nor the panels show, and those of them of which each row changes at most one.
    settings: Vec<Setting<'a>>,
    one_at_a_time: Vec<Setting<'a>>,
    /// Pareto fronts of the chart: the panel index of each front, and its points in ascending order of x.
    pub fronts: Vec<(usize, Vec<&'a Place>)>,
}

/// Returns whether larger values on the y axis are better.
pub(super) fn is_more_better(view: &View) -> bool {
    let role = view.y_column.column.role;
    !matches!(role, Role::Value(Better::Less) | Role::Cost)
}

/// Returns the legend text for the line of the Pareto front.
pub(super) fn words(view: &View) -> String {
    let cost = match &view.x_column.column.unit[..] {
        "s" | "ms" | "us" | "µs" => "faster",
        _ => "cheaper",
    };
    format!("Pareto front: nothing is both {cost} and as good")
}

impl<'a> Front<'a> {
    /// Computes the Pareto fronts of a chart; the result is empty if the chart has none.
    pub fn new(view: &'a View<'a>) -> Self {
        let candidates = Candidates::of_columns(view.table, &view.spec.y, &view.spec.x);
        let of_panel = |candidates: &Candidates, panel: usize| {
            let places = view.here(panel).map(|place| (place.row, place));
            let places: HashMap<usize, &Place> = places.collect();
            let rows: Vec<usize> = view.here(panel).map(|place| place.row).collect();
            let conditions = candidates.by_condition_of(&rows).into_iter();
            let fronts = conditions.map(|of_one| {
                let front = candidates.front(&of_one).into_iter();
                (panel, front.map(|one| places[&one.row]).collect())
            });
            fronts.collect::<Vec<_>>()
        };
        let fronts = candidates.filter(|_| view.spec.front).map(|candidates| {
            let panels = 0..view.panels.names.len();
            panels
                .flat_map(|panel| of_panel(&candidates, panel))
                .collect()
        });
        let Swept {
            free,
            one_at_a_time,
            ..
        } = Swept::new(view.table, &view.rows);
        let shown = view.spec.lines.iter().chain(&view.spec.panels);
        let shown = shown.filter_map(|name| view.column(name).ok());
        Self {
            view,
            settings: without(&free, &shown.collect::<Vec<_>>()),
            one_at_a_time,
            fronts: fronts.unwrap_or_default(),
        }
    }

    /// Returns whether the table row with this index is on a Pareto front.
    pub fn has(&self, row: usize) -> bool {
        let mut points = self.fronts.iter().flat_map(|(_, front)| front);
        points.any(|place| place.row == row)
    }

    /// Returns the label of a point: the settings that neither the series nor the panel shows, or else the name of the series. In a study in which single
    /// settings are changed, only changed settings are named.
    pub fn label(&self, place: &Place) -> String {
        let first = self.view.rows[0];
        let is_base = |one: &&Setting| one.data.key(place.row) == one.data.key(first);
        let base: Vec<Setting> = self.one_at_a_time.iter().filter(is_base).copied().collect();
        match &Setting::short_words(&without(&self.settings, &base), place.row)[..] {
            "" => self.view.lines.names[place.line].clone(),
            words => words.to_owned(),
        }
    }
}
