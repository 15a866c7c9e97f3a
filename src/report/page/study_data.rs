//! The numbers of a study of recognition as its page holds them: a column a quantity, settings by their number among an axis's values.

use crate::report::answer::Answer;
use crate::report::axis::Axis;
use crate::report::chart_plan::{ChartPlan, plan_charts};
use crate::report::page::confusion_data::{ConfusionData, confusion_data};
use crate::report::page::tables::{p_name, p_value, too_few_trials};
use crate::report::varying::Levels;
use crate::report::x_scale::{Spacing, spacing};
use crate::study::table::{Cell, CellScore, Tables};
use serde::Serialize;
use std::collections::HashMap;

/// What the script draws from.
#[derive(Serialize)]
pub(super) struct StudyData {
    axes: Vec<AxisData>,
    start: Start,
    cells: Columns,
    /// The conditions of the world in words.
    conditions: Vec<String>,
    /// Share recognised by guessing, if the number of classes is known.
    chance: Option<f64>,
    confusion: Option<ConfusionData>,
    /// What p-values are called.
    p: &'static str,
    /// Whether there are none for want of trials.
    too_few_trials: bool,
}

/// A setting that varies.
#[derive(Serialize)]
struct AxisData {
    name: &'static str,
    heading: String,
    title: String,
    labels: Vec<String>,
    ticks: Vec<String>,
    phrases: Vec<String>,
    numbers: Option<Vec<f64>>,
    scale: &'static str,
    /// The value that charts keep where they do not show the axis.
    base: usize,
    /// Whether it is a condition of the world, as noise is, and nobody's choice.
    condition: bool,
    /// Whether it varies only because others do.
    follows: bool,
    /// The axis that it can stand for along x.
    instead: Option<usize>,
}

/// What a chart shows at first.
#[derive(Serialize)]
struct Start {
    x: isize,
    lines: isize,
    panels: isize,
    colour: isize,
}

/// A value a cell, in the order of the summary.
#[derive(Default, Serialize)]
struct Columns {
    cell: Vec<usize>,
    levels: Vec<Vec<usize>>,
    /// The number of its condition.
    condition: Vec<usize>,
    /// The place of the best cell of the same condition.
    best: Vec<usize>,
    /// Taxels of the array.
    taxels: Vec<usize>,
    /// Measurements a decision.
    measurements: Vec<usize>,
    accuracy: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
    f1: Vec<f64>,
    n_test: Vec<usize>,
    n_trials: Vec<usize>,
    difference: Vec<Option<f64>>,
    p: Vec<Option<f64>>,
    fit_s: Vec<Option<f64>>,
    decide_us: Vec<Option<f64>>,
}

impl StudyData {
    /// The data of a study; none without cells, or if they are all alike.
    pub fn of(tables: &Tables, answer: &Answer) -> Option<Self> {
        let rows: Vec<&Cell> = tables.summary.iter().map(|(cell, _)| cell).collect();
        let settings = answer.settings();
        let plans = plan_charts(&rows);
        let best = rows.iter().position(|c| c.cell == answer.best.0.cell)?;
        let mut shown: Vec<&Levels> = settings.single().chain(&settings.following).collect();
        shown.retain(|levels| levels.axis != Axis::Signal);
        let plan = plans.first()?;
        let start = Start::of(plan, &shown);
        if start.x < 0 {
            return None;
        }
        let ratio = shown.iter().position(|levels| levels.axis == Axis::Ratio);
        let of_signal: Vec<Axis> = settings.one_at_a_time.iter().map(|l| l.axis).collect();
        let axes = shown.iter().map(|levels| {
            let base = match of_signal.contains(&levels.axis) {
                true => rows[0],
                false => rows[best],
            };
            let follows = settings.following.contains(levels);
            let instead = ratio.filter(|_| follows && levels.axis == Axis::Measurements);
            AxisData::of(levels, base, follows, instead)
        });
        let axes = axes.collect();
        let names = class_names(tables);
        Some(Self {
            axes,
            start,
            cells: Columns::of(tables, answer, &shown),
            conditions: answer
                .findings
                .iter()
                .map(|finding| finding.condition.clone())
                .collect(),
            chance: (!names.is_empty()).then(|| 1.0 / names.len() as f64),
            confusion: confusion_data(tables, answer, names),
            p: p_name(tables),
            too_few_trials: too_few_trials(tables).is_some(),
        })
    }

    /// As JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("numbers and texts have a JSON form")
    }
}

/// Names of the classes in the order in which the table of confusions first has them as touched, then as taken for.
fn class_names(tables: &Tables) -> Vec<&str> {
    let rows = &tables.confusion;
    let touched = rows.iter().map(|row| row.object.as_str());
    let all = touched.chain(rows.iter().map(|row| row.predicted.as_str()));
    let mut known = std::collections::HashSet::new();
    all.filter(|name| known.insert(*name)).collect()
}

impl AxisData {
    fn of(levels: &Levels, base: &Cell, follows: bool, instead: Option<usize>) -> Self {
        let axis = levels.axis;
        let value = axis.value(base);
        Self {
            name: axis.name(),
            heading: levels.heading(),
            title: axis.title(base),
            labels: levels.values.iter().map(|v| v.label.clone()).collect(),
            ticks: levels.values.iter().map(|v| v.tick.clone()).collect(),
            phrases: levels.values.iter().map(|v| axis.phrase_of(v)).collect(),
            numbers: levels.numbers(),
            scale: match spacing(levels) {
                Spacing::Logarithmic => "log",
                Spacing::OfRoots => "sqrt",
                Spacing::Even => "linear",
                Spacing::Words => "words",
            },
            base: levels.values.iter().position(|v| *v == value).unwrap_or(0),
            condition: axis.is_condition(),
            follows,
            instead,
        }
    }
}

impl Start {
    fn of(plan: &ChartPlan, shown: &[&Levels]) -> Self {
        let place = |axis: Axis| {
            let found = shown.iter().position(|levels| levels.axis == axis);
            found.map_or(-1, |place| place as isize)
        };
        let optional = |levels: &Option<Levels>| levels.as_ref().map_or(-1, |l| place(l.axis));
        let lines = optional(&plan.lines);
        let classifier = place(Axis::Classifier);
        Self {
            x: place(plan.x.axis),
            lines,
            panels: optional(&plan.panels),
            colour: if classifier < 0 { lines } else { classifier },
        }
    }
}

impl Columns {
    fn of(tables: &Tables, answer: &Answer, axes: &[&Levels]) -> Self {
        let rows = &tables.summary;
        let column =
            |value: fn(&CellScore) -> f64| rows.iter().map(|(_, s)| decimals(value(s))).collect();
        let compared: HashMap<usize, _> = tables.comparison.iter().map(|c| (c.cell, c)).collect();
        let costs: HashMap<usize, _> = tables.pareto.iter().map(|(c, p)| (c.cell, p)).collect();
        let place: HashMap<usize, usize> = rows
            .iter()
            .enumerate()
            .map(|(place, (cell, _))| (cell.cell, place))
            .collect();
        let mut columns = Self {
            cell: rows.iter().map(|(cell, _)| cell.cell).collect(),
            levels: axes.iter().map(|levels| places(levels, rows)).collect(),
            condition: rows
                .iter()
                .map(|(cell, _)| answer.condition(cell))
                .collect(),
            best: rows
                .iter()
                .map(|(cell, _)| place[&answer.finding(cell).best.0.cell])
                .collect(),
            taxels: rows.iter().map(|(cell, _)| cell.nx * cell.ny).collect(),
            measurements: rows
                .iter()
                .map(|(cell, _)| cell.measurements_of_decision())
                .collect(),
            accuracy: column(|s| s.accuracy),
            low: column(|s| s.accuracy_low),
            high: column(|s| s.accuracy_high),
            f1: column(|s| s.macro_f1),
            n_test: rows.iter().map(|(_, s)| s.n_test).collect(),
            n_trials: rows.iter().map(|(_, s)| s.n_trials).collect(),
            ..Self::default()
        };
        for (cell, _) in rows {
            let row = compared.get(&cell.cell);
            let row = row.filter(|row| row.cell != row.best_cell);
            columns
                .difference
                .push(row.map(|row| decimals(row.difference)));
            columns.p.push(row.and_then(|row| p_value(row)).map(digits));
            let cost = costs.get(&cell.cell);
            columns.fit_s.push(cost.map(|row| digits(row.fit_s)));
            let decide_us = cost.map(|row| digits(row.predict_us_per_decision));
            columns.decide_us.push(decide_us);
        }
        columns
    }
}

fn places(levels: &Levels, rows: &[(Cell, CellScore)]) -> Vec<usize> {
    let place = |(cell, _): &(Cell, CellScore)| {
        let value = levels.axis.value(cell);
        levels.values.iter().position(|v| *v == value).unwrap_or(0)
    };
    rows.iter().map(place).collect()
}

/// Four decimals of a share: a page says three.
fn decimals(share: f64) -> f64 {
    (share * 1e4).round() / 1e4
}

/// Four digits that count.
fn digits(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}
